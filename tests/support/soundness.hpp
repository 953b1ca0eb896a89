// What is wrong with a result on a sound problem, if anything: used by tests and by validation/sound-problems.
#pragma once

#include <Eigen/Eigenvalues>
#include <cmath>
#include <string>

#include "mottle/core/error.hpp"
#include "mottle/updating/methods/updater.hpp"
#include "mottle/updating/prediction/prediction.hpp"
#include "mottle/updating/verdict/verdict.hpp"

namespace mottle::test {

using namespace updating;  // of which these are the tests

/// Whether each interval is ordered; ends that are nan mean "not determined".
inline bool are_ordered(const Eigen::MatrixXd& ends) {
  for (Eigen::Index i = 0; i < ends.rows(); ++i) {
    if (ends(i, 0) > ends(i, 1) || std::isnan(ends(i, 0)) != std::isnan(ends(i, 1))) return false;
  }
  return true;
}

/// Smallest eigenvalue of the covariance as a correlation.
inline double smallest_eigenvalue(const Eigen::MatrixXd& covariance) {
  const Eigen::VectorXd standard_deviation = covariance.diagonal().cwiseMax(0.0).cwiseSqrt();
  const Eigen::VectorXd inverse = standard_deviation.unaryExpr([](double d) { return d > 0.0 ? 1.0 / d : 0.0; });
  const Eigen::MatrixXd correlation = inverse.asDiagonal() * covariance * inverse.asDiagonal();
  return Eigen::SelfAdjointEigenSolver<Eigen::MatrixXd>(correlation, Eigen::EigenvaluesOnly).eigenvalues()(0);
}

/// What is wrong with a result, empty where nothing is.
inline std::string fault_of(const UpdatingResult& result) {
  constexpr double k_rounding = 1e-10;
  if (!result.mean.allFinite() || !result.covariance.allFinite()) return "mean or covariance is not finite";
  if (result.covariance.diagonal().minCoeff() < 0.0) return "a variance is negative";
  if (smallest_eigenvalue(result.covariance) < -k_rounding) return "the covariance is indefinite";
  const PopulationOnScales* population = result.estimate ? result.estimate->population() : nullptr;
  if (population == nullptr) return "there is no population on the scales";
  if (!population->mean.allFinite() || !population->covariance.allFinite() ||
      smallest_eigenvalue(population->covariance) < -k_rounding)
    return "the population on the scales is none";
  if (!result.intervals) return "";
  if (!are_ordered(result.intervals->mean)) return "an interval of a mean is reversed";
  if (!are_ordered(result.intervals->std)) return "an interval of a deviation is reversed";
  if ((result.intervals->correlation_lower.array() > result.intervals->correlation_upper.array()).any())
    return "an interval of a correlation is reversed";
  return "";
}

/// The same of the verdict and of a prediction, which must come to an end on every result.
inline std::string fault_of(const UpdatingProblem& problem, const UpdatingResult& result, const RunContext& context) {
  if (std::string fault = fault_of(result); !fault.empty()) return fault;
  const Verdict verdict = judge(problem, result);
  for (const VerdictTest& test : verdict.tests) {
    if (!std::isfinite(test.statistic)) return "the statistic of " + test.name + " is not finite";
  }
  try {
    const Prediction prediction = predict(problem.model, problem.space, *result.estimate,
                                          {.noise_std = problem.tests.repeatability_std, .draws = 200}, context);
    return prediction.interval.allFinite() ? "" : "a predicted interval is not finite";
  } catch (const SystemFailure& error) {
    // So little may be known of a population that half of its draws are impossible: then there is no prediction.
    return std::string(error.what()).find("the population is too wide") == std::string::npos ? error.what() : "";
  }
}

}  // namespace mottle::test
