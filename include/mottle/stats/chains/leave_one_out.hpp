// How well a model predicts data that it has not seen, from the log-likelihood of each datum under draws of the
// posterior of all.
#pragma once

#include <Eigen/Core>

#include "mottle/layers.hpp"

namespace mottle::stats {

/// Expected log predictive density of as many new data as there are, larger being better.
struct PredictiveAccuracy {
  double elpd = 0.0;                  ///< sum of `pointwise`
  double standard_error = 0.0;        ///< sqrt(n) times the standard deviation of `pointwise`; nan: one datum
  double effective_parameters = 0.0;  ///< ln density of the data in sample, less `elpd`
  Eigen::VectorXd pointwise = {};     ///< of each datum
};

/// Leave-one-out by importance sampling.
struct LeaveOneOut : PredictiveAccuracy {
  /// Shape of the generalised Pareto distribution of the largest weights, of each datum: above 0.7 its density is not
  /// to be relied on; infinite: too few draws to fit it. 0 where all of these weights are alike.
  Eigen::VectorXd pareto_k = {};
};

/// Shape above which a datum's importance weights are not reliable.
constexpr double k_unreliable_pareto_k = 0.7;

/// Shape of the generalised Pareto distribution of the largest of independent importance weights, as in LeaveOneOut.
///
/// @param log_weights  [draw]; -infinity: a weight of 0
double pareto_k_of(const Eigen::Ref<const Eigen::ArrayXd>& log_weights);

/// Density of each datum under the posterior of the others.
///
///   ln p(z_i | z_-i) = ln (sum_s w_s p(z_i | x_s) / sum_s w_s),   w_s ~ 1 / p(z_i | x_s)
///
/// the M = ceil(min(S / 5, 3 sqrt(S / r))) largest w_s replaced by the expected order statistics of a generalised
/// Pareto distribution that is fitted to them, and none larger than the largest.
///
/// @param log_likelihood       ln p(z_i | x_s), finite [draw x datum]
/// @param relative_efficiency  r, effective draws over S, of each datum; nan: 1 [datum]
/// @throws InvalidInput        no draw or datum, sizes that do not fit, an entry that is not finite
/// Source: [Vehtari2017]; [Vehtari2024] for the smoothing; [Zhang2009] for the fit, with the weak prior of
/// [Vehtari2024] on the shape.
LeaveOneOut leave_one_out(const Eigen::Ref<const Eigen::MatrixXd>& log_likelihood,
                          const Eigen::Ref<const Eigen::VectorXd>& relative_efficiency);

/// The widely applicable information criterion on the scale of elpd: ln of the mean density of each datum, less the
/// variance of its log density.
///
/// @param log_likelihood  [draw x datum], >= 2 draws
/// @throws InvalidInput   as leave_one_out()
/// Source: [Watanabe2010]; [Vehtari2017], Eq. 11.
PredictiveAccuracy widely_applicable_information(const Eigen::Ref<const Eigen::MatrixXd>& log_likelihood);

}  // namespace mottle::stats
