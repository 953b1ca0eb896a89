// What AUTOSPC holds, how degrees of freedom are numbered and named, and what displacement systems do to matrices.
#include "mottle/fem/assembly/assembly.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <Eigen/Eigenvalues>
#include <algorithm>
#include <functional>

#include "core/message_of.hpp"
#include "fem/models.hpp"
#include "mottle/linalg/batched/dense_modes.hpp"

namespace mottle::fem {
namespace {

using test::dense;
using ::testing::HasSubstr;

/// How many of the held components are translations and rotations.
std::pair<int, int> constrained_counts(const AssembledModel& assembled) {
  std::pair<int, int> counts;
  for (const AutomaticConstraint& constraint : assembled.automatic_constraints) {
    ++(constraint.component < 3 ? counts.first : counts.second);
  }
  return counts;
}

/// Eigenvalues of the stiffness, ascending, relative to the largest.
Eigen::VectorXd stiffnesses(const AssembledModel& assembled) {
  const Eigen::MatrixXd matrix = dense(assembled.stiffness.at(Eigen::VectorXd()));
  const Eigen::VectorXd values = Eigen::SelfAdjointEigenSolver<Eigen::MatrixXd>(matrix).eigenvalues();
  return values / values(values.size() - 1);
}

test::ModelMaker one_brick() {
  test::ModelMaker maker;
  const int metal = maker.material(1, 2e11, 0.3, 7800.0);
  for (int k = 0; k < 8; ++k) {
    const bool is_right = k % 4 == 1 || k % 4 == 2;
    maker.node(k + 1, {is_right ? 1.0 : 0.0, k % 4 > 1 ? 1.0 : 0.0, k > 3 ? 1.0 : 0.0});
  }
  maker.model.elements<SolidElement>().push_back({.id = 1, .nodes = {0, 1, 2, 3, 4, 5, 6, 7}, .material = metal});
  return maker;
}

/// Rods along a chain of points, with an area of 1e-4.
test::ModelMaker rods(const std::vector<Eigen::Vector3d>& points, const std::vector<std::pair<int, int>>& ends) {
  test::ModelMaker maker;
  const int metal = maker.material(1, 2e11, 0.3, 7800.0);
  const FieldIndex area = maker.field("PROD", 1, "A", 1e-4);
  for (std::size_t k = 0; k < points.size(); ++k) maker.node(static_cast<int>(k) + 1, points[k]);
  for (const auto& [a, b] : ends)
    maker.rod(static_cast<int>(maker.model.elements<RodElement>().size()) + 1, a, b, metal, area);
  return maker;
}

TEST(AutomaticConstraints, HoldTheRotationsOfSolidsAlone) {
  const AssembledModel assembled = assemble(one_brick().model, {});
  EXPECT_EQ(constrained_counts(assembled), std::pair(0, 24));
  const Eigen::VectorXd values = stiffnesses(assembled);
  EXPECT_LT(values.head(6).cwiseAbs().maxCoeff(), 1e-14);
  EXPECT_GT(values(6), 1e-3) << "six rigid motions and no more";
}

TEST(AutomaticConstraints, LeaveTheRotationsInPlaceWhenOff) {
  FiniteElementModel model = one_brick().model;
  model.settings.automatic_constraints = AutomaticConstraints::none;
  const AssembledModel assembled = assemble(model, {});
  EXPECT_TRUE(assembled.automatic_constraints.empty());
  EXPECT_EQ(assembled.equations.size(), 48U);
}

// A rod's points have mass across it, which is a mode of 0 Hz and stays; their rotations have none.
TEST(AutomaticConstraints, LeaveEquationsWithMassOrStiffness) {
  test::ModelMaker maker = rods({{0, 0, 0}, {1, 0, 0}}, {{0, 1}});
  maker.node(3, {9, 9, 9});
  maker.model.settings.automatic_constraints = AutomaticConstraints::null;
  const AssembledModel assembled = assemble(maker.model, {});
  EXPECT_EQ(constrained_counts(assembled), std::pair(3, 9));
  EXPECT_EQ(assembled.equations.size(), 6U);
}

// A spring of K = 0 that a parameter sets: its equation is null on the card alone.
TEST(AutomaticConstraints, LeaveWhatAParameterMayStiffen) {
  test::ModelMaker maker;
  maker.scalar_point(1);
  maker.scalar_point(2);
  maker.spring(1, 0, 0, -1, 0, 0.0);
  maker.spring(2, 1, 0, -1, 0, 5.0);
  maker.model.settings.automatic_constraints = AutomaticConstraints::null;
  EXPECT_EQ(assemble(maker.model, {}).equations.size(), 1U);
  const FieldIndex stiffness = maker.model.elements<ScalarElement>().front().value;
  EXPECT_EQ(assemble(maker.model, {{{stiffness}, false}}).equations.size(), 2U);
}

// Each point of a straight chain resists along one direction only, which is oblique: two translations are held, though
// every component by itself has stiffness.
TEST(AutomaticConstraints, HoldTheSoftDirectionsOfAnObliqueChain) {
  const Eigen::Vector3d along(1.0, 2.0, 2.0);
  const AssembledModel assembled = assemble(rods({0.0 * along, along, 2.0 * along}, {{0, 1}, {1, 2}}).model, {});
  EXPECT_EQ(constrained_counts(assembled), std::pair(6, 9));
  // Three points on a line: one rigid motion, and lambda = 1 and 3 (chain of two springs).
  const Eigen::VectorXd values = stiffnesses(assembled);
  ASSERT_EQ(values.size(), 3);
  EXPECT_NEAR(values(0), 0.0, 1e-15);
  EXPECT_NEAR(values(1), 1.0 / 3.0, 1e-15);
}

TEST(AutomaticConstraints, HoldAPlaneTrussAcrossItsPlane) {
  const Eigen::Matrix3d turn = Eigen::AngleAxisd(0.4, Eigen::Vector3d(2, -1, 1).normalized()).toRotationMatrix();
  test::ModelMaker maker =
      rods({turn * Eigen::Vector3d(0, 0, 0), turn * Eigen::Vector3d(1, 0, 0), turn * Eigen::Vector3d(0.3, 0.8, 0)},
           {{0, 1}, {1, 2}, {2, 0}});
  const AssembledModel assembled = assemble(maker.model, {});
  EXPECT_EQ(constrained_counts(assembled), std::pair(3, 9));
}

TEST(AutomaticConstraints, HoldNothingWhereAllIsStiff) {
  test::ModelMaker maker;
  const int section = maker.beam_property(1, maker.material(1, 2e11, 0.3, 7800.0), 1e-3, 1e-9, 1e-9, 1e-9);
  maker.node(1, {0, 0, 0});
  maker.node(2, {1, 2, 3});
  maker.beam(1, 0, 1, section);
  EXPECT_TRUE(assemble(maker.model, {}).automatic_constraints.empty());
}

TEST(AutomaticConstraints, LeaveAloneWhatARigidBodyStiffens) {
  test::ModelMaker maker = one_brick();
  const int hub = maker.node(9, {0.5, 0.5, 2.0});
  maker.model.rigid_bodies.push_back({1, hub, Components{0x7}, {4, 5, 6, 7}});
  const AssembledModel assembled = assemble(maker.model, {});
  EXPECT_EQ(constrained_counts(assembled), std::pair(0, 24)) << "the hub's rotations move the face";
}

TEST(AutomaticConstraints, HoldAScalarPointWithoutSpring) {
  test::ModelMaker maker;
  maker.scalar_point(1);
  maker.scalar_point(2);
  maker.spring(1, 0, 0, -1, 0, 5.0);
  const AssembledModel assembled = assemble(maker.model, {});
  EXPECT_EQ(constrained_counts(assembled), std::pair(1, 0));
  EXPECT_EQ(assembled.equations.size(), 1U);
}

TEST(Assembly, RefusesAModelInWhichNothingIsFree) {
  test::ModelMaker maker;
  maker.node(1, {0, 0, 0});
  EXPECT_THAT(test::message_of<InvalidInput>([&] { assemble(maker.model, {}); }), HasSubstr("no free degree"));
}

TEST(Assembly, NamesTheElementThatCannotBe) {
  FiniteElementModel model = one_brick().model;
  std::swap(model.elements<SolidElement>()[0].nodes[0], model.elements<SolidElement>()[0].nodes[6]);
  EXPECT_THAT(test::message_of<InvalidInput>([&] { assemble(model, {}); }), testing::StartsWith("CHEXA 1: "));
}

// A blank number on a CELAS2 or PELAS card has no field; it is a spring of zero.
TEST(Assembly, ASpringWithoutANumberIsNone) {
  test::ModelMaker maker;
  maker.scalar_point(1);
  maker.spring(1, 0, 0, -1, 0, 5.0);
  maker.model.elements<ScalarElement>().push_back({.id = 2, .nodes = {0, -1}});
  EXPECT_EQ(dense(assemble(maker.model, {}).stiffness.at(Eigen::VectorXd()))(0, 0), 5.0);
}

TEST(Assembly, TermsThatReachLittleAndMuchOfThePatternAscend) {
  constexpr int k_points = 100;
  test::ModelMaker maker;
  for (int k = 0; k < k_points; ++k) maker.scalar_point(k + 1);
  // Cards from the chain's far end to its near one, so that no term is built in its order.
  for (int k = k_points - 1; k > 0; --k) maker.spring(k, k - 1, 0, k, 0, 1.0 + k);
  maker.spring(k_points, 0, 0, -1, 0, 1.0);
  std::vector<FieldParameter> parameters(2);
  for (int k = 1; k < k_points; ++k) {
    if (k % 40 == 0) parameters[0].fields.push_back(test::field_of(maker.model, "CELAS2", k, "K"));
    if (k % 2 == 1) parameters[1].fields.push_back(test::field_of(maker.model, "CELAS2", k, "K"));
  }
  const AssembledModel assembled = assemble(maker.model, parameters);
  ASSERT_EQ(assembled.stiffness.terms.size(), 3U);
  for (const SeparableMatrix::Term& term : assembled.stiffness.terms) {
    const auto descent = std::adjacent_find(term.positions.begin(), term.positions.end(), std::greater_equal<>());
    EXPECT_TRUE(descent == term.positions.end());
    EXPECT_EQ(term.positions.size(), term.values.size());
  }
  Eigen::MatrixXd expected = Eigen::MatrixXd::Zero(k_points, k_points);
  expected(0, 0) = 1.0;
  for (int k = 1; k < k_points; ++k) {
    const double stiffness = k % 40 == 0 ? 5.0 : (k % 2 == 1 ? 3.0 : 1.0 + k);
    expected(k - 1, k - 1) += stiffness;
    expected(k, k) += stiffness;
    expected(k, k - 1) = expected(k - 1, k) = -stiffness;
  }
  EXPECT_EQ(dense(assembled.stiffness.at(Eigen::Vector2d(5.0, 3.0))), expected);  // sums of integers are exact
}

TEST(Assembly, NamesDegreesOfFreedom) {
  test::ModelMaker maker;
  maker.node(7, {0, 0, 0});
  maker.scalar_point(8);
  EXPECT_EQ(degree_of_freedom_name(maker.model, 0, 2), "7:+Z");
  EXPECT_EQ(degree_of_freedom_name(maker.model, 0, 3), "7:+RX");
  EXPECT_EQ(degree_of_freedom_name(maker.model, 1, 0), "8");
}

// Displacement systems only turn the components: frequencies stay, and shapes turned back are the same.
TEST(Assembly, DisplacementSystemsChangeNoFrequency) {
  test::ModelMaker maker;
  const int section = maker.beam_property(1, maker.material(1, 2e11, 0.3, 7800.0), 1e-3, 2e-7, 1e-7, 1e-7);
  for (int k = 0; k < 4; ++k) maker.node(k + 1, {0.4 * k, 0.1 * k * k, 0.2 * k});
  for (int k = 0; k < 3; ++k) maker.beam(k + 1, k, k + 1, section);
  maker.point_mass(4, 3, 2.0).offset = {0.1, 0.0, 0.3};
  FiniteElementModel turned = maker.model;
  turned.coordinate_systems = {{.id = 1, .kind = CoordinateSystem::Kind::cylindrical, .origin = {0.2, -1, 0}},
                               {.id = 2, .kind = CoordinateSystem::Kind::spherical, .origin = {1, 2, 3}}};
  for (int k = 0; k < 4; ++k) turned.nodes[static_cast<std::size_t>(k)].displacement_system = k % 2;
  const auto frequencies = [](FiniteElementModel model) {
    model.settings.coupled_mass = true;
    model.fixed.emplace_back(0, k_all_components);
    const AssembledModel assembled = assemble(model, {});
    return solve_modes(dense(assembled.stiffness.at(Eigen::VectorXd())), dense(assembled.mass.at(Eigen::VectorXd())), 5)
        .values;
  };
  // The largest eigenvalue, of which rounding is 1e-16, is about 1e6 times the lowest.
  EXPECT_LT((frequencies(turned).array() / frequencies(maker.model).array() - 1.0).abs().maxCoeff(), 1e-8);
}

}  // namespace
}  // namespace mottle::fem
