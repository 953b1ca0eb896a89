// Levels of the noise by linear theory about the parameters that meet the tests best.
#pragma once

#include <Eigen/Core>
#include <cstdint>
#include <optional>

#include "mottle/layers.hpp"
#include "updating/methods/bayes_tests.hpp"
#include "updating/methods/posterior_target.hpp"

namespace mottle::updating {

/// f ~ outputs + slopes (u' - scores) of the parameters' scores.
struct Linearised {
  Eigen::VectorXd scores;
  Eigen::VectorXd outputs;
  Eigen::MatrixXd slopes;  ///< J [output x parameter]
};

/// min over u of |V^-1/2 (e - J u)|^2 + |u|^2, V the variances of the tests' means by noise and the model's error: the
/// parameters' scores given the levels are normal about where it is, with covariance axes diag(deviations^2) axes'.
struct LinearPosterior {
  Eigen::VectorXd scores;
  double squares = 0.0;
  double log_determinant = 0.0;  ///< of V + J J'
  Eigen::MatrixXd axes;          ///< [parameter x parameter]
  Eigen::VectorXd deviations;
};

/// What must live longer than it: all that it is made of.
class LinearNoise {
 public:
  LinearNoise(const UpdatingProblem& problem, const NoiseLevels& noise, const CommonLikelihood& likelihood,
              const RunContext& context, std::int64_t& evaluations)
      : problem_(problem), noise_(noise), likelihood_(likelihood), context_(context), evaluations_(evaluations) {}

  /// Gauss-Newton from the peak on, with noise of these levels.
  /// @throws SystemFailure  the model has no derivatives on the way
  Linearised best(const PosteriorPeak& peak, const Eigen::VectorXd& levels) const;
  LinearPosterior given(const Linearised& at, const Eigen::VectorXd& levels) const;
  /// ln p(z | levels), up to a constant:
  ///
  ///   N(z; f - J u, V + J J') prod_k r_k^(-(n_k - 1) / 2) exp(-S_k / 2 r_k)
  ///
  /// n_k tests with the sum of squares S_k about their mean, r_k the variance of their noise.
  double log_density(const Linearised& at, const Eigen::VectorXd& levels) const;

 private:
  std::optional<Eigen::VectorXd> outputs_at(const Eigen::VectorXd& scores) const;
  Eigen::VectorXd variables(const Eigen::VectorXd& scores) const;
  Linearised linearised(const Eigen::VectorXd& scores, const Eigen::VectorXd& outputs) const;
  Eigen::VectorXd precision_roots(const Eigen::VectorXd& levels) const;
  double cost(const Eigen::VectorXd& scores, const Eigen::VectorXd& outputs, const Eigen::VectorXd& levels) const;

  const UpdatingProblem& problem_;
  const NoiseLevels& noise_;
  const CommonLikelihood& likelihood_;
  const RunContext& context_;
  std::int64_t& evaluations_;
};

}  // namespace mottle::updating
