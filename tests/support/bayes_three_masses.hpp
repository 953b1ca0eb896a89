// One test of the three masses under three models, whose posteriors and evidences are known by quadrature.
#pragma once

#include <Eigen/Core>
#include <array>
#include <memory>
#include <vector>

#include "support/three_masses.hpp"

namespace mottle::test {

/// What adaptive quadrature over (k1, k2, k5) gives.
struct ThreeMassesReference {
  const char* model;
  double k6;  ///< 0: the model has no such spring
  double log_evidence;
  Eigen::Vector3d mean;
  Eigen::Vector3d standard_deviation;
};

inline std::array<ThreeMassesReference, 3> three_masses_references() {
  return {{{"k6 = 3", 3.0, 8.6435911, {1.0120188, 1.0400786, 0.9316923}, {0.1566877, 0.1618705, 0.0714800}},
           {"k6 = 3.5", 3.5, -5.3808755, {0.5911040, 1.6228500, 0.6753985}, {0.0939480, 0.1866338, 0.0926951}},
           {"no k6", 0.0, -4.6166521, {2.8409248, 0.4252349, 3.2710055}, {0.0861511, 0.0410631, 0.0825094}}}};
}

/// k1, k2, k5 log-normal of mean 1.5 and standard deviation 0.5, independent; one test of three frequencies, noise 1 %.
struct OneTestOfThreeMasses {
  explicit OneTestOfThreeMasses(double k6) {
    const std::vector<ParameterTargets> targets{{"k1", {"spring:k1"}}, {"k2", {"spring:k2"}}, {"k5", {"spring:k5"}}};
    std::vector<Parameter> parameters;
    for (const ParameterTargets& target : targets) parameters.push_back({target.parameter, "N/m"});
    const Distribution prior({.kind = DistributionKind::lognormal, .mean = 1.5, .std = 0.5});
    space = std::make_unique<ParameterSpace>(parameters, JointDistribution({prior, prior, prior}));
    MassSpringSystem system = three_mass_system(k6);
    if (k6 == 0.0) system.springs.pop_back();
    model = std::make_unique<StructureModel>(separate(system, targets), OutputSelection{.frequencies = {1, 2, 3}},
                                             Eigen::VectorXd::Constant(3, 1.5));
  }
  UpdatingProblem problem() const {
    const Eigen::RowVector3d z(0.1600, 0.3150, 0.4480);
    return {.model = *model,
            .derivatives = model.get(),
            .space = *space,
            .tests = {Eigen::MatrixXd(z), 0.01 * z.transpose()},
            .cloud = {.samples = 200}};
  }

  std::unique_ptr<ParameterSpace> space;
  std::unique_ptr<StructureModel> model;
};

}  // namespace mottle::test
