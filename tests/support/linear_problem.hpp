// Twelve specimens of a linear model with known answers, for methods that estimate a population.
#pragma once

#include <Eigen/Core>
#include <memory>
#include <vector>

#include "mottle/core/random.hpp"
#include "mottle/stats/distributions/standard_normal.hpp"
#include "mottle/updating/methods/updater.hpp"
#include "support/linear_model.hpp"

namespace mottle::test {

using namespace updating;  // of which these are the tests

/// Four outputs of two correlated parameters, linear, so that every step has a closed form.
struct LinearProblem {
  LinearProblem() : model(Eigen::Vector4d(1.0, 2.0, 0.0, -1.0), slope()), noise(0.05, 0.1, 0.04, 0.08) {
    const Distribution first({.kind = DistributionKind::normal, .mean = 2.5, .std = 1.0});
    const Distribution second({.kind = DistributionKind::normal, .mean = 6.0, .std = 1.0});
    space = std::make_unique<ParameterSpace>(std::vector<Parameter>{{"a", "-"}, {"b", "-"}},
                                             JointDistribution({first, second}));
    tests = draw(12, noise);
  }

  static Eigen::MatrixXd slope() {
    Eigen::MatrixXd g(4, 2);
    g << 1.0, 0.5, -1.0, 2.0, 0.3, 0.7, 1.5, -0.2;
    return g;
  }

  /// Tests of new specimens, with noise of these standard deviations.
  Eigen::MatrixXd draw(Eigen::Index count, const Eigen::VectorXd& sigma) const {
    Eigen::MatrixXd x(count, 2);
    Eigen::MatrixXd e(count, 4);
    for (Eigen::Index s = 0; s < count; ++s) {
      RandomStream stream({.seed = 5}, static_cast<std::uint32_t>(s));
      const double u = standard_normal_quantile(stream.uniform());
      x.row(s) << 3.0 + 0.3 * u, 5.0 + 0.2 * u + 0.25 * standard_normal_quantile(stream.uniform());
      for (Eigen::Index k = 0; k < 4; ++k) e(s, k) = sigma(k) * standard_normal_quantile(stream.uniform());
    }
    return model.evaluate(x, {}).outputs + e;
  }

  UpdatingProblem problem(const Eigen::VectorXd& repeatability) const {
    return {.model = model,
            .space = *space,
            .tests = {tests, repeatability},
            .cloud = {.samples = 50},
            .iterations = 50,
            .tolerance = 1e-6};
  }

  LinearModel model;
  Eigen::Vector4d noise;
  std::unique_ptr<ParameterSpace> space;
  Eigen::MatrixXd tests;
};

}  // namespace mottle::test
