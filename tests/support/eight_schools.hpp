// The eight schools of [Rubin1981] as a population of one-parameter structures: each is measured in an output of its
// own, so that each has its own noise.
#pragma once

#include <Eigen/Core>
#include <limits>
#include <memory>

#include "mottle/updating/methods/hierarchical.hpp"
#include "support/linear_model.hpp"

namespace mottle::test {

using namespace updating;  // of which these are the tests

/// mu ~ N(0, 5), tau ~ half-Cauchy(5); reference values by quadrature over (mu, tau).
struct EightSchools {
  static constexpr double log_evidence = -31.3113474;
  static constexpr double mean = 4.3968207;
  static constexpr double mean_std = 3.3177045;
  static constexpr double scatter = 3.5977055;       // posterior mean of tau
  static constexpr double first_school = 6.2118842;  // posterior mean of theta_1

  EightSchools() : model(Eigen::VectorXd::Zero(8), Eigen::VectorXd::Ones(8)) {
    constexpr PhysicalLimit k_free{.lower = -1e9, .excludes_lower = false};
    const Distribution prior({.kind = DistributionKind::normal, .mean = 0.0, .std = 5.0});
    space = std::make_unique<ParameterSpace>(std::vector<Parameter>{{"x", "-", -1e8, 1e8, k_free}},
                                             JointDistribution({prior}));
    const Eigen::VectorXd effects{{28.0, 8.0, -3.0, 7.0, -1.0, 1.0, 18.0, 12.0}};
    const Eigen::VectorXd errors{{15.0, 10.0, 16.0, 11.0, 9.0, 11.0, 10.0, 18.0}};
    tests.values = Eigen::MatrixXd::Constant(8, 8, std::numeric_limits<double>::quiet_NaN());
    tests.values.diagonal() = effects;
    tests.repeatability_std = errors;
  }
  UpdatingProblem problem() const {
    return {.model = model, .space = *space, .tests = tests, .cloud = {.samples = 100}};
  }
  static HierarchicalOptions options() {
    HierarchicalOptions options;
    options.scatter_degrees_of_freedom = 1.0;
    return options;
  }

  LinearModel model;
  std::unique_ptr<ParameterSpace> space;
  TestData tests;
};

}  // namespace mottle::test
