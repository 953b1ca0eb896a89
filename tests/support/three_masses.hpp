// The three-mass example of [Mares2006] for tests: model, prior, and the ten specimens of the reference data.
#pragma once

#include <Eigen/Core>
#include <cmath>
#include <fstream>
#include <memory>
#include <string>

#include "mottle/model/parameters/parameter_space.hpp"
#include "mottle/model/structure_model.hpp"
#include "mottle/model/structures/affine_matrices.hpp"
#include "mottle/updating/methods/updater.hpp"

namespace mottle::test {

using namespace updating;  // of which these are the tests

inline MassSpringSystem three_mass_system(double k6 = 3.0) {
  return {.masses = {{"m1", 1.0}, {"m2", 1.0}, {"m3", 1.0}},
          .springs = {{"k1", k_ground, 0, 1.0},
                      {"k2", k_ground, 1, 1.0},
                      {"k3", k_ground, 2, 1.0},
                      {"k4", 0, 1, 1.0},
                      {"k5", 1, 2, 1.0},
                      {"k6", 0, 2, k6}},
          .dampers = {}};
}

/// Case 1 of the paper: k1, k2, k5 ~ N(2, 0.3) in [0.5, 3], outputs f1 to f3.
struct ThreeMasses {
  explicit ThreeMasses(double k6 = 3.0) {
    const std::vector<ParameterTargets> targets{{"k1", {"spring:k1"}}, {"k2", {"spring:k2"}}, {"k5", {"spring:k5"}}};
    std::vector<Parameter> parameters;
    for (const ParameterTargets& target : targets) parameters.push_back({target.parameter, "N/m", 0.5, 3.0, {}});
    const Distribution prior({.kind = DistributionKind::normal, .mean = 2.0, .std = 0.3});
    space = std::make_unique<ParameterSpace>(parameters, JointDistribution({prior, prior, prior}));
    model =
        std::make_unique<StructureModel>(separate(three_mass_system(k6), targets),
                                         OutputSelection{.frequencies = {1, 2, 3}}, Eigen::VectorXd::Constant(3, 2.0));
  }

  UpdatingProblem problem(const Eigen::MatrixXd& tests) const {
    return {.model = *model,
            .derivatives = model.get(),
            .space = *space,
            .tests = {tests, Eigen::VectorXd::Zero(tests.cols())},
            .cloud = {},
            .iterations = 30};
  }

  std::unique_ptr<ParameterSpace> space;
  std::unique_ptr<StructureModel> model;
};

inline Eigen::VectorXd standard_deviations(const UpdatingResult& result) {
  return result.covariance.diagonal().cwiseSqrt();
}

/// Frequencies of a batch of (k1, k2, k5), as tests.
inline Eigen::MatrixXd frequencies_of(const ThreeMasses& structure, const Eigen::MatrixXd& parameters) {
  return structure.model->evaluate(parameters, {}).outputs;
}

/// The ten specimens without random numbers: deviations of k1, k2, k5 from (1.08, 1.09, 0.96) along the discrete
/// orthogonal polynomials of degree 1, 2 and 3 on ten points, scaled to deviations (0.288, 0.130, 0.241): this is how
/// the reference data is made, and its stiffnesses are reproduced to all printed digits.
inline Eigen::MatrixXd oracle_parameters() {
  Eigen::MatrixXd x(10, 3);
  for (int i = 0; i < 10; ++i) {
    const double t = i - 4.5;
    x.row(i) << t, t * t - 8.25, t * t * t - 14.65 * t;
  }
  const Eigen::RowVector3d mean(1.08, 1.09, 0.96);
  const Eigen::RowVector3d standard_deviation(0.288, 0.130, 0.241);
  for (int j = 0; j < 3; ++j) {
    const double scale = standard_deviation(j) / std::sqrt(x.col(j).squaredNorm() / 9.0);
    x.col(j) = (x.col(j) * scale).array() + mean(j);
  }
  return x;
}

}  // namespace mottle::test
