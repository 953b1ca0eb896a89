// Tests of a posterior of parameters that all specimens have in common.
#pragma once

#include <Eigen/Core>

#include "mottle/layers.hpp"
#include "updating/methods/common_likelihood.hpp"

namespace mottle::updating {

/// A point of the posterior at which outputs and sensitivities are known: that of the largest likelihood.
struct PosteriorPeak {
  Eigen::VectorXd scores;            ///< standard normal, of parameters and levels of the noise
  Eigen::VectorXd parameters;        ///< [parameter]
  Eigen::VectorXd outputs = {};      ///< [output]
  Eigen::MatrixXd sensitivity = {};  ///< [output x parameter]
};

/// Puts the tests into the result:
///
///   residuals: r' B (B' V B)^-1 B' r, B the directions that no parameter moves, r the tests' means less the outputs, V
///     the variance of such a mean, against chi-squared;
///   specimens: sum_k S_k / r_k, S_k the sum of squares of the tests about their mean, against chi-squared;
///   bounds, prior-shift: see mean_limits.hpp.
///
/// Noise that is estimated takes in what residuals and specimens would show: neither is tested then.
void test_posterior(const UpdatingProblem& problem, const CommonLikelihood& likelihood, const NoiseLevels& noise,
                    const PosteriorPeak& peak, UpdatingResult& result);

}  // namespace mottle::updating
