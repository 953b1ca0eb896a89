// A chain of equal masses and springs of unknown stiffness, fixed at one end, and one test of its lowest frequencies: a
// model of as many parameters as one likes.
#pragma once

#include <fmt/format.h>

#include <memory>
#include <vector>

#include "mottle/model/parameters/parameter_space.hpp"
#include "mottle/model/structure_model.hpp"
#include "mottle/model/structures/affine_matrices.hpp"
#include "mottle/updating/methods/updater.hpp"

namespace mottle::test {

using namespace updating;  // of which these are the tests

/// Stiffnesses log-normal with mean 1000 N/m and standard deviation 100 N/m; tests at 900 to 1150 N/m, noise 0.5 %.
struct SpringChain {
  explicit SpringChain(int springs) {
    MassSpringSystem system;
    std::vector<ParameterTargets> targets;
    std::vector<Parameter> parameters;
    std::vector<int> modes;
    for (int i = 0; i < springs; ++i) {
      const std::string name = fmt::format("k{}", i + 1);
      system.masses.push_back({fmt::format("m{}", i + 1), 1.0});
      system.springs.push_back({name, i == 0 ? k_ground : i - 1, i, 1.0});
      targets.push_back({name, {"spring:" + name}});
      parameters.push_back({name, "N/m"});
      if (i < k_modes) modes.push_back(i + 1);
    }
    const Distribution prior({.kind = DistributionKind::lognormal, .mean = 1000.0, .std = 100.0});
    space = std::make_unique<ParameterSpace>(
        parameters, JointDistribution(std::vector<Distribution>(static_cast<std::size_t>(springs), prior)));
    model = std::make_unique<StructureModel>(separate(system, targets), OutputSelection{.frequencies = modes},
                                             Eigen::VectorXd::Constant(springs, 1000.0));
    const Eigen::RowVectorXd truth = Eigen::RowVectorXd::LinSpaced(springs, 900.0, 1150.0);
    tested = model->evaluate(truth, {}).outputs;
  }
  UpdatingProblem problem() const {
    constexpr double k_noise = 0.005;
    return {.model = *model,
            .derivatives = model.get(),
            .space = *space,
            .tests = {tested, k_noise * tested.transpose()},
            .cloud = {.samples = 100}};
  }

  static constexpr int k_modes = 8;
  std::unique_ptr<ParameterSpace> space;
  std::unique_ptr<StructureModel> model;
  Eigen::MatrixXd tested;
};

}  // namespace mottle::test
