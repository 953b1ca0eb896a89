// A linear model of two parameters that all specimens have in common, and the error that the mean of a sampled
// posterior may have.
#pragma once

#include <Eigen/Core>
#include <cmath>
#include <memory>
#include <vector>

#include "mottle/updating/estimate/posterior.hpp"
#include "mottle/updating/methods/updater.hpp"
#include "support/linear_model.hpp"

namespace mottle::test {

using namespace updating;  // of which these are the tests

inline constexpr double k_stated_errors = 4.0;  // standard errors: once in 16,000 cases of a normal error

/// The error of a posterior mean, by the effective sample size that the method states.
inline double mean_error(const UpdatingResult& result, Eigen::Index i) {
  return k_stated_errors * std::sqrt(result.covariance(i, i) / result.posterior->ess_bulk(i));
}

/// Two parameters with prior N((1, 2), diag(0.2, 0.5)^2), three outputs y = a + G x, four specimens.
struct CommonLinear {
  CommonLinear() : model(Eigen::Vector3d(1.0, 0.0, 2.0), slope()) {
    const Distribution first({.kind = DistributionKind::normal, .mean = 1.0, .std = 0.2});
    const Distribution second({.kind = DistributionKind::normal, .mean = 2.0, .std = 0.5});
    const PhysicalLimit limit{.lower = -1e9, .excludes_lower = false};
    space = std::make_unique<ParameterSpace>(
        std::vector<Parameter>{{"a", "-", -50.0, 50.0, limit}, {"b", "-", -50.0, 50.0, limit}},
        JointDistribution({first, second}));
    tests.values.resize(4, 3);
    tests.values << 3.0, 2.5, 4.4, 3.1, 2.7, 4.3, 2.9, 2.6, 4.45, 3.05, 2.4, 4.35;
    tests.repeatability_std = Eigen::Vector3d(0.1, 0.2, 0.05);
  }
  static Eigen::MatrixXd slope() {
    Eigen::MatrixXd g(3, 2);
    g << 1.0, 0.5, -1.0, 2.0, 0.3, 0.7;
    return g;
  }
  UpdatingProblem problem() const {
    return {.model = model, .space = *space, .tests = tests, .cloud = {.samples = 100}};
  }
  LinearModel model;
  std::unique_ptr<ParameterSpace> space;
  TestData tests;
};

}  // namespace mottle::test
