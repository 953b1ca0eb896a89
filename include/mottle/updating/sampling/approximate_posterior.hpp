// Approximate Bayesian computation: posteriors from simulated data alone, without a likelihood. It knows points, the
// summaries of data simulated at each and nothing else: no model, no tests.
#pragma once

#include <Eigen/Core>
#include <functional>
#include <vector>

#include "mottle/core/random.hpp"
#include "mottle/core/run_context.hpp"
#include "mottle/layers.hpp"

namespace mottle::updating {

/// Data simulated at many points.
struct SimulationTable {
  Eigen::MatrixXd points;     ///< [simulation x coordinate]
  Eigen::MatrixXd summaries;  ///< of the data, in units of which one is small [simulation x summary]
  Eigen::VectorXd
      log_weight;  ///< ln of prior over proposal density, up to a constant; -infinity: not possible [simulation]
  /// Moves points [draw x coordinate] as the observed summary differs from those of their data [draw x summary]; empty:
  /// by weighted linear regression of the accepted points on the summaries.
  std::function<Eigen::MatrixXd(const Eigen::MatrixXd& points, const Eigen::MatrixXd& summaries,
                                const Eigen::VectorXd& observed)>
      adjustment = {};
};

/// Draws of an approximate posterior.
struct AcceptedDraws {
  Eigen::MatrixXd points;     ///< adjusted to the observed summary [draw x coordinate]
  Eigen::VectorXd weights;    ///< of sum 1 [draw]
  Eigen::VectorXd distances;  ///< of their summaries from that observed [draw]
  Eigen::VectorXd mean;       ///< [coordinate]
  Eigen::MatrixXd covariance;
  double tolerance = 0.0;  ///< largest distance that is accepted
  double effective = 0.0;  ///< 1 / sum of squared weights
};

/// Accepts the simulations whose summaries are nearest to that observed.
///
///   w_k ~ exp(log_weight_k) (1 - d_k^2 / tolerance^2),   d_k = |s_k - s|
///   adjusted: by the table's adjustment, or x_k - B' (s_k - s), B of the weighted linear regression of points on
///   summaries
///
/// A regression over points that were proposed in a narrow region draws the posterior towards its middle; an adjustment
/// that is known, as of a location and a scale, does not.
///
/// @param fraction  of the simulations that are possible, in (0, 1]; at least 2 (summaries + 2) are accepted
/// @param adjust    false: the accepted points as they are
/// @throws InvalidInput  fewer possible simulations than that
/// Source: [Beaumont2002].
AcceptedDraws accept_nearest(const SimulationTable& table, const Eigen::Ref<const Eigen::VectorXd>& observed,
                             double fraction, bool adjust = true);

/// Points that are uniform in an ellipsoid: all have one density, so that none outweighs the others, in however many
/// coordinates [draw x coordinate].
///
/// @param covariance  of the points; the ellipsoid reaches sqrt(coordinates + 2) of its standard deviations
/// @param key         names the random streams, one a draw
Eigen::MatrixXd propose_uniformly(const Eigen::Ref<const Eigen::VectorXd>& centre,
                                  const Eigen::Ref<const Eigen::MatrixXd>& covariance, Eigen::Index count,
                                  const StreamKey& key);

/// Carries what estimates are off by from one set of data to another: points [draw x coordinate] about the estimates of
/// their own data [draw x coordinate], to data whose estimate is `observed`.
using ErrorCarrier = std::function<Eigen::MatrixXd(const Eigen::MatrixXd& points, const Eigen::MatrixXd& estimates,
                                                   const Eigen::RowVectorXd& observed)>;

/// How 95 % intervals hold the truth, found from data simulated at a known point.
struct IntervalCalibration {
  std::size_t chosen = 0;         ///< which of the trials gives the narrowest stretched intervals
  Eigen::VectorXd factor;         ///< that its intervals are to be stretched by, about the median [coordinate]
  Eigen::VectorXd coverage;       ///< of its intervals before that [coordinate]
  double checked_coverage = 0.0;  ///< mean of the coordinates after, in the half that did not make the factors
  double checked_standard_error = 0.0;
};

/// Finds what the 95 % intervals of accepted draws must be stretched by. To each set of simulated data they are carried
/// about its own estimate, in its own scale, and it is counted whether they hold the truth.
///
/// The factor of a coordinate is the smallest that makes 95 % of the intervals hold the truth, counted as order
/// statistic ceil(0.95 (n + 1)) of n data sets. The trial chosen has the least mean logarithm of the width after.
///
/// @param trials     draws for the real data, by different tolerances
/// @param estimate   of the real data [coordinate]
/// @param estimates  of data simulated at `truth` [data set x coordinate], at least 40
/// Source: [Syring2019] for the calibration of a scale by simulation; [Vovk2005], ch. 2, for the order statistic.
IntervalCalibration calibrate_intervals(const std::vector<AcceptedDraws>& trials,
                                        const Eigen::Ref<const Eigen::VectorXd>& estimate,
                                        const Eigen::Ref<const Eigen::MatrixXd>& estimates,
                                        const Eigen::Ref<const Eigen::VectorXd>& truth, const ErrorCarrier& carry);

}  // namespace mottle::updating
