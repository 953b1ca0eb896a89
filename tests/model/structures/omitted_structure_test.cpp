// A structure whose deck omits degrees of freedom: frequencies, shapes and derivatives against condensation by hand.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>
#include <memory>
#include <numbers>

#include "fem/models.hpp"
#include "model/structures.hpp"
#include "mottle/model/solvers/exact_solver.hpp"
#include "mottle/model/structure_model.hpp"
#include "mottle/model/structures/finite_element_structure.hpp"

namespace mottle::model {
namespace {

using test::one_each;
using ::testing::Contains;

constexpr double k_mass_1 = 2.0, k_mass_2 = 0.7;

/// Ground - k1 - m1 - k2 - m2 - k3 - ground; m2 is omitted.
FiniteElementModel chain(double second_mass = k_mass_2) {
  test::ModelMaker maker;
  for (const int id : {1, 2}) maker.scalar_point(id);
  maker.spring(1, 0, 0, -1, 0, 300.0);
  maker.spring(2, 0, 0, 1, 0, 500.0);
  maker.spring(3, 1, 0, -1, 0, 200.0);
  maker.mass(11, 0, 0, k_mass_1);
  if (second_mass > 0.0) maker.mass(12, 1, 0, second_mass);
  maker.model.omitted_set.emplace_back(1, Components{1});
  return maker.model;
}

/// u2 follows u1 by r = k2 / (k2 + k3): f = sqrt((k1 + k3 r) / (m1 + m2 r^2)) / (2 pi).
double condensed_hz(const Eigen::Vector3d& k) {
  const double ratio = k(1) / (k(1) + k(2));
  return std::sqrt((k(0) + k(2) * ratio) / (k_mass_1 + k_mass_2 * ratio * ratio)) / (2.0 * std::numbers::pi);
}

const std::vector<ParameterTargets>& springs() {
  static const std::vector<ParameterTargets> k_springs = one_each({"CELAS2:1:K", "CELAS2:2:K", "CELAS2:3:K"});
  return k_springs;
}

StructureModel model_of(OutputSelection outputs) {
  auto structure = std::make_unique<FiniteElementStructure>(chain(), springs(), Eigen::Vector3d::Ones());
  const Eigen::VectorXd reference = structure->reference();
  return {std::make_unique<ExactSolver>(std::move(structure)), std::move(outputs), reference};
}

TEST(OmittedDegreesOfFreedom, CondenseAnewForEachSample) {
  const StructureModel model = model_of({.frequencies = {1}});
  Eigen::MatrixXd samples(3, 3);
  samples << 300, 500, 200, 250, 700, 100, 310, 90, 400;
  const Eigen::MatrixXd f = model.evaluate(samples, {}).outputs;
  for (Eigen::Index s = 0; s < 3; ++s) {
    const double expected = condensed_hz(samples.row(s).transpose());
    EXPECT_NEAR(f(s, 0) / expected, 1.0, 1e-12) << s;
  }
}

TEST(OmittedDegreesOfFreedom, FollowStaticallyInShapes) {
  const StructureModel model =
      model_of({.frequencies = {1}, .shape_modes = {1}, .shape_degrees_of_freedom = {"1", "2"}});
  const Eigen::RowVectorXd y = model.evaluate(Eigen::RowVector3d(300, 500, 200), {}).outputs;
  EXPECT_NEAR(y(2) / y(1), 500.0 / 700.0, 1e-12);
}

// Central differences of the condensed mass with steps of 1e-5 are good to 1e-9, those of the formula to 1e-9.
TEST(OmittedDegreesOfFreedom, HaveTheDerivativesOfTheCondensedMatrices) {
  const StructureModel model = model_of({.frequencies = {1}});
  const Eigen::Vector3d at(300, 500, 200);
  const Eigen::MatrixXd jacobian = model.jacobian(at);
  for (int i = 0; i < 3; ++i) {
    const double step = 1e-4 * at(i);
    Eigen::Vector3d up = at, down = at;
    up(i) += step;
    down(i) -= step;
    const double expected = (condensed_hz(up) - condensed_hz(down)) / (2.0 * step);
    EXPECT_NEAR(jacobian(0, i) / expected, 1.0, 1e-7) << i;
  }
}

TEST(OmittedDegreesOfFreedom, SayThatEachSampleIsReduced) {
  const FiniteElementStructure structure(chain(), springs(), Eigen::Vector3d::Ones());
  EXPECT_FALSE(structure.is_separable());
  EXPECT_EQ(structure.parameter_role(0), "reduced anew for each sample (ASET, OMIT)");
  EXPECT_THAT(structure.description(structure.reference()),
              Contains("static reduction (ASET, OMIT): 1 degrees of freedom are kept, 1 omitted"));
}

TEST(OmittedDegreesOfFreedom, WithoutMassLeaveTheMatricesSeparable) {
  const FiniteElementStructure structure(chain(0.0), springs(), Eigen::Vector3d::Ones());
  EXPECT_TRUE(structure.is_separable());
  EXPECT_EQ(structure.parameter_role(0), "exactly separable, linearly: no re-assembly");
  EXPECT_THAT(
      structure.description(structure.reference()),
      Contains(
          "static reduction (ASET, OMIT): 1 degrees of freedom are kept, 1 omitted, none of which has mass: exact"));
}

}  // namespace
}  // namespace mottle::model
