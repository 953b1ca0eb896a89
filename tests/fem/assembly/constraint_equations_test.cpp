// Rigid bodies, interpolations and multipoint equations, seen through what assemble() makes of them.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <numbers>

#include "core/message_of.hpp"
#include "fem/models.hpp"
#include "mottle/linalg/sparse/sparse_modes.hpp"

namespace mottle::fem {
namespace {

using test::at_equations;
using test::dense;
using test::rigid_motions;
using ::testing::HasSubstr;

constexpr double k_rounding = 1e-13;  // arms of up to 5 and a 6 x 6 inversion

/// Five points in general position, two of them in a cylindrical displacement system; no element, nothing held.
test::ModelMaker points() {
  test::ModelMaker maker;
  maker.model.settings.automatic_constraints = AutomaticConstraints::none;
  const Eigen::Matrix3d axes = Eigen::AngleAxisd(0.7, Eigen::Vector3d(1, 2, 3).normalized()).toRotationMatrix();
  maker.model.coordinate_systems.push_back(
      {.id = 1, .kind = CoordinateSystem::Kind::cylindrical, .origin = {1, 1, 1}, .axes = axes});
  maker.node(1, {0, 0, 0});
  maker.node(2, {1, 2, -1}, 0);
  maker.node(3, {3, 1, 1});
  maker.node(4, {-2, 1, 2}, 0);
  maker.node(5, {1, -3, 2});
  return maker;
}

/// How far the dependent components are from following a rigid motion of the whole.
double rigid_error(const FiniteElementModel& model) {
  const AssembledModel assembled = assemble(model, {});
  const Eigen::MatrixXd motions = rigid_motions(model);
  return (assembled.expansion * at_equations(assembled, motions) - motions).cwiseAbs().maxCoeff();
}

std::string refusal(const FiniteElementModel& model) {
  return test::message_of<InvalidInput>([&] { assemble(model, {}); });
}

TEST(RigidBodies, FollowARigidMotionWithOffsetsAndDisplacementSystems) {
  FiniteElementModel model = points().model;
  model.rigid_bodies.push_back({9, 1, k_all_components, {0, 2, 3}});
  EXPECT_EQ(assemble(model, {}).dependent_degrees_of_freedom, 18);
  EXPECT_LT(rigid_error(model), k_rounding);
}

TEST(RigidBodies, LeaveTheOtherComponentsFree) {
  FiniteElementModel model = points().model;
  model.rigid_bodies.push_back({9, 0, 0x5, {2}});  // components 1 and 3
  const AssembledModel assembled = assemble(model, {});
  EXPECT_EQ(assembled.equations.size(), 28U);
  EXPECT_LT(rigid_error(model), k_rounding);
}

TEST(RigidBodies, MayHangOnOneAnother) {
  FiniteElementModel model = points().model;
  model.rigid_bodies.push_back({9, 1, k_all_components, {2}});  // before the one that it depends on
  model.rigid_bodies.push_back({8, 0, k_all_components, {1}});
  model.rigid_bodies.push_back({7, 2, k_all_components, {3, 4}});
  EXPECT_EQ(assemble(model, {}).equations.size(), 6U);
  EXPECT_LT(rigid_error(model), k_rounding);
}

TEST(RigidBodies, RefuseToDependInACircle) {
  FiniteElementModel model = points().model;
  model.rigid_bodies.push_back({9, 1, k_all_components, {2}});
  model.rigid_bodies.push_back({8, 2, k_all_components, {1}});
  EXPECT_THAT(refusal(model), HasSubstr("depends on itself"));
}

TEST(RigidBodies, RefuseADegreeOfFreedomThatDependsTwice) {
  FiniteElementModel model = points().model;
  model.rigid_bodies.push_back({9, 0, k_all_components, {2}});
  model.rigid_bodies.push_back({8, 1, 0x4, {2}});
  EXPECT_EQ(refusal(model), "RBE2 8: 3:+Z is dependent here and already in RBE2 9; a component can depend once");
}

TEST(RigidBodies, RefuseADegreeOfFreedomThatIsFixed) {
  FiniteElementModel model = points().model;
  model.rigid_bodies.push_back({9, 0, k_all_components, {2}});
  model.fixed.emplace_back(2, Components{0x10});
  EXPECT_THAT(refusal(model), HasSubstr("RBE2 9: 3:+RY is dependent here and fixed"));
}

TEST(RigidBodies, OnAFixedPointAreFixedToo) {
  FiniteElementModel model = points().model;
  model.rigid_bodies.push_back({9, 0, k_all_components, {2}});
  model.fixed.emplace_back(0, k_all_components);
  const AssembledModel assembled = assemble(model, {});
  EXPECT_EQ(assembled.equations.size(), 18U);
  EXPECT_EQ(Eigen::MatrixXd(assembled.expansion).middleRows(12, 6).cwiseAbs().maxCoeff(), 0.0);
}

// A point mass m at the end of an arm a along x, carried by k along z and kr about y at the other end:
// w = w0 - a theta, so M = [m, -m a; -m a, m a^2].
TEST(RigidBodies, CarryAMassOnAnArmAsTheClosedForm) {
  test::ModelMaker maker;
  const int base = maker.node(1, {0, 0, 0}), end = maker.node(2, {0.4, 0, 0});
  maker.spring(1, base, 2, -1, 0, 1000.0);
  maker.spring(2, base, 4, -1, 0, 50.0);
  maker.point_mass(3, end, 2.5);
  maker.model.rigid_bodies.push_back({4, base, k_all_components, {end}});
  maker.model.fixed.emplace_back(base, Components{0x2b});  // all but z and the rotation about y
  const AssembledModel assembled = assemble(maker.model, {});
  const Eigen::VectorXd none;
  const Eigen::Matrix2d mass = (Eigen::Matrix2d() << 2.5, -1.0, -1.0, 0.4).finished();
  EXPECT_LT((dense(assembled.mass.at(none)) - mass).cwiseAbs().maxCoeff(), 1e-15);
  EXPECT_EQ(dense(assembled.stiffness.at(none)), Eigen::MatrixXd(Eigen::Vector2d(1000.0, 50.0).asDiagonal()));
}

TEST(RigidBars, FollowARigidMotionFromIndependentsAtBothEnds) {
  FiniteElementModel model = points().model;
  // Ends at (0, 0, 0) and (3, 1, 1): x, y, z and the rotation about x of A with y and z of B fix the motion.
  model.rigid_bars.push_back({9, {0, 2}, {Components{0x0f}, Components{0x06}}, {Components{0x30}, Components{0x39}}});
  EXPECT_EQ(assemble(model, {}).equations.size(), 24U);
  EXPECT_LT(rigid_error(model), k_rounding);
}

TEST(RigidBars, RefuseIndependentsThatLeaveThemFree) {
  FiniteElementModel model = points().model;
  // Three translations at both ends leave the rotation about the bar.
  model.rigid_bars.push_back({9, {0, 2}, {Components{0x07}, Components{0x07}}, {Components{0x38}, Components{0x38}}});
  EXPECT_THAT(refusal(model), HasSubstr("RBAR 9: its 6 independent components do not fix"));
  model.rigid_bars[0].independent = {Components{0x0f}, Components{0x02}};
  EXPECT_THAT(refusal(model), HasSubstr("its 5 independent components"));
}

/// Node 5 follows the four others, of which two have only translations.
Interpolation mean_of_four() {
  return {.id = 9,
          .reference = 4,
          .reference_components = k_all_components,
          .sources = {{0, 0x7, 1.0}, {1, 0x3f, 0.5}, {2, 0x7, 2.0}, {3, 0x7, 1.5}}};
}

TEST(Interpolations, FollowARigidMotion) {
  FiniteElementModel model = points().model;
  model.interpolations.push_back(mean_of_four());
  EXPECT_EQ(assemble(model, {}).dependent_degrees_of_freedom, 6);
  EXPECT_LT(rigid_error(model), 1e-12);  // the normal equations of the fit have a condition of about 100
}

// A load at the reference goes to the sources as T' f. Force and moment about the reference stay what they were.
TEST(Interpolations, HandOnAForceAndAMomentUnchanged) {
  FiniteElementModel model = points().model;
  model.interpolations.push_back(mean_of_four());
  const AssembledModel assembled = assemble(model, {});
  const Eigen::Matrix<double, 6, 1> load{1.0, -2.0, 3.0, 0.5, -0.7, 0.9};
  const Eigen::VectorXd forces = Eigen::MatrixXd(assembled.expansion).middleRows(24, 6).transpose() * load;
  Eigen::Vector3d force = Eigen::Vector3d::Zero(), moment = Eigen::Vector3d::Zero();
  for (std::size_t k = 0; k < assembled.equations.size(); ++k) {
    const auto [node, component] = assembled.equations[k];
    const Node& point = model.nodes[static_cast<std::size_t>(node)];
    const Eigen::Matrix3d axes = point.displacement_system < 0
                                     ? Eigen::Matrix3d::Identity().eval()
                                     : model.coordinate_systems[0].directions_at(point.position);
    const Eigen::Vector3d part = forces(static_cast<Eigen::Index>(k)) * axes.col(component % 3);
    if (component < 3) {
      force += part;
      moment += (point.position - model.nodes[4].position).cross(part);
    } else {
      moment += part;
    }
  }
  EXPECT_LT((force - load.head<3>()).norm(), 1e-12);
  EXPECT_LT((moment - load.tail<3>()).norm(), 1e-12);
}

// Corners (+-1, +-2, 0) about the reference with equal weights: w is their mean, and the rotation about x by least
// squares is the sum of y w / the sum of y^2 = (+-2 w) / 16.
TEST(Interpolations, AreMeanAndSlopeOfARectangle) {
  test::ModelMaker maker;
  maker.model.settings.automatic_constraints = AutomaticConstraints::none;
  Interpolation element{.id = 1, .reference = 4, .reference_components = 0x0c};
  int id = 1;
  for (const double x : {-1.0, 1.0}) {
    for (const double y : {-2.0, 2.0}) element.sources.push_back({maker.node(id++, {x, y, 0}), 0x7, 1.0});
  }
  maker.node(5, {0, 0, 0});
  maker.model.interpolations.push_back(element);
  const Eigen::MatrixXd expansion = assemble(maker.model, {}).expansion;
  for (int k = 0; k < 4; ++k) {
    const int column = 6 * k + 2;
    EXPECT_NEAR(expansion(26, column), 0.25, 1e-15);
    EXPECT_NEAR(expansion(27, column), k % 2 == 0 ? -0.125 : 0.125, 1e-15);
  }
  EXPECT_NEAR(expansion.row(26).cwiseAbs().sum(), 1.0, 1e-14) << "nothing else moves it along z";
}

TEST(Interpolations, WithExchangedDependentsSayTheSame) {
  FiniteElementModel model = points().model;
  Interpolation element = mean_of_four();
  model.interpolations = {element};
  const AssembledModel plain = assemble(model, {});
  element.dependents = {{0, Components{0x7}}, {2, Components{0x6}}, {3, Components{0x1}}};
  model.interpolations = {element};
  const AssembledModel exchanged = assemble(model, {});
  ASSERT_EQ(exchanged.equations.size(), plain.equations.size());
  EXPECT_LT(rigid_error(model), 1e-11);
  // Whatever the exchanged equations let the nodes do fulfils the plain ones too.
  const Eigen::MatrixXd motions = exchanged.expansion;
  EXPECT_LT((plain.expansion * at_equations(plain, motions) - motions).cwiseAbs().maxCoeff(), 1e-11);
}

TEST(Interpolations, RefuseSourcesOnALine) {
  test::ModelMaker maker;
  for (int k = 0; k < 4; ++k) maker.node(k + 1, {1.0 * k, 0, 0});
  maker.model.interpolations.push_back(
      {.id = 1, .reference = 0, .reference_components = 0x7, .sources = {{1, 0x7, 1.0}, {2, 0x7, 1.0}, {3, 0x7, 1.0}}});
  EXPECT_THAT(refusal(maker.model), HasSubstr("RBE3 1: its sources do not determine"));
}

// 2 u1 - 3 u2 + u3 = 0.
TEST(MultipointEquations, SolveForTheirFirstTerm) {
  test::ModelMaker maker;
  maker.model.settings.automatic_constraints = AutomaticConstraints::none;
  for (int k = 1; k <= 3; ++k) maker.scalar_point(k);
  maker.model.multipoint_equations.push_back({{{0, 0, 2.0}, {1, 0, -3.0}, {2, 0, 1.0}}});
  const AssembledModel assembled = assemble(maker.model, {});
  ASSERT_EQ(assembled.equations.size(), 2U);
  EXPECT_EQ(Eigen::MatrixXd(assembled.expansion).row(0), Eigen::RowVector2d(1.5, -0.5));
  maker.model.multipoint_equations[0].terms[0].coefficient = 0.0;
  EXPECT_THAT(refusal(maker.model), HasSubstr("the first coefficient"));
}

/// Two beams of four parts, tied by a rigid body and an interpolation, partly in a cylindrical system.
FiniteElementModel free_frame() {
  test::ModelMaker maker;
  maker.model.settings.coupled_mass = true;
  maker.model.coordinate_systems.push_back(
      {.id = 1, .kind = CoordinateSystem::Kind::cylindrical, .origin = {0.3, 0.2, 0.5}});
  const int metal = maker.material(1, 2e11, 0.3, 7800.0);
  const int section = maker.beam_property(1, metal, 1e-3, 2e-7, 1e-7, 2e-7);
  for (int k = 0; k <= 4; ++k) maker.node(k + 1, {0.5 * k, 0, 0.1 * k}, k % 2 == 0 ? 0 : -1);
  for (int k = 0; k <= 4; ++k) maker.node(k + 6, {2.2, 0.3 + 0.4 * k, 0.7}, k % 2 == 0 ? -1 : 0);
  for (int k = 0; k < 4; ++k) {
    maker.beam(k + 1, k, k + 1, section, Eigen::Vector3d::UnitY());
    maker.beam(k + 5, k + 5, k + 6, section, Eigen::Vector3d::UnitX());
  }
  maker.model.rigid_bodies.push_back({1, 4, k_all_components, {5}});
  const int sensor = maker.node(11, {3, 3, 3}, 0);
  maker.point_mass(2, sensor, 1.5);
  maker.model.interpolations.push_back({.id = 3,
                                        .reference = sensor,
                                        .reference_components = k_all_components,
                                        .sources = {{6, 0x7, 1.0}, {8, 0x7, 1.0}, {2, 0x7, 1.0}}});
  return maker.model;
}

// Rounding of K phi for a rigid phi: 1e-16 of the largest stiffness times the arms.
TEST(AFreeStructure, HasNoStiffnessAgainstRigidMotions) {
  const FiniteElementModel model = free_frame();
  const AssembledModel assembled = assemble(model, {});
  EXPECT_TRUE(assembled.automatic_constraints.empty());
  const Eigen::MatrixXd stiffness = dense(assembled.stiffness.at(Eigen::VectorXd()));
  const Eigen::MatrixXd forces = stiffness * at_equations(assembled, rigid_motions(model));
  EXPECT_LT(forces.cwiseAbs().maxCoeff(), 1e-13 * stiffness.cwiseAbs().maxCoeff());
}

TEST(AFreeStructure, HasExactlySixRigidBodyModes) {
  const AssembledModel assembled = assemble(free_frame(), {});
  const Eigen::VectorXd none;
  SparseModeSolver solver;
  const SparseModes modes =
      solver.solve(assembled.stiffness.at(none), assembled.mass.at(none), {.modes = 8, .counts_below = true});
  ASSERT_EQ(modes.failure, "");
  EXPECT_TRUE(modes.is_complete());
  EXPECT_LT(modes.values.head(6).cwiseAbs().maxCoeff(), 1e-6 * modes.values(6));
  EXPECT_GT(modes.values(6), 100.0);
}

}  // namespace
}  // namespace mottle::fem
