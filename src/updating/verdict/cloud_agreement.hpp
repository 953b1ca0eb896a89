// Whether the updated model's cloud has the scatter of the tests.
#pragma once

#include <Eigen/Core>
#include <string>
#include <vector>

#include "mottle/layers.hpp"
#include "updating/verdict/test_plan.hpp"

namespace mottle::updating {

/// The scatter of the outputs: measured, and of the updated model.
struct ScatterComparison {
  Eigen::VectorXd tested;  ///< variance among the tests [output]
  Eigen::VectorXd model;   ///< the same of the updated model with the noise that is known [output]
  Eigen::MatrixXd cloud;   ///< the updated model's outputs, without noise [sample x output]
  Eigen::VectorXi count;   ///< specimens that have the output; fewer than two: it is not tested [output]
  /// The noise is part of `model`; else that may scatter less than the tests [output]
  std::vector<bool> is_whole;
  std::vector<std::string> names;
};

/// Whether the variance of each output in the updated model is that of the tests: the most unlikely of their ratios,
/// each against chi-squared and, where that finds it unlikely, against the variances of as many specimens drawn from
/// the cloud and the noise; the larger of the two p-values counts. An output that has a kink where modes cross, or is
/// curved otherwise, may be far from normal: a few tests then seldom show its rare values, and their variance is small.
/// The variance that was fitted is not taken off the sampling variance, so that it refuses a right model more seldom
/// than its level; it sees where a cloud cannot have the scatter that the estimate was to give it, by curvature or by
/// scatter that has a least value. It takes a quarter of a test's share of the level.
PlannedTest cloud_agreement_test(const ScatterComparison& comparison);

}  // namespace mottle::updating
