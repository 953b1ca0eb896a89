// Shear panels against closed forms, and with rods as the whole panel.
#include "mottle/fem/elements/shear_panel.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <Eigen/Dense>
#include <cmath>

#include "core/message_of.hpp"
#include "fem/models.hpp"
#include "mottle/core/error.hpp"

namespace mottle::fem {
namespace {

using Eigen::Vector3d;
using Motion = Eigen::Matrix<double, 12, 1>;

PanelNodes quadrilateral(double ax, double ay, double bx, double by, double cx, double cy, double dx, double dy) {
  PanelNodes nodes;
  nodes << ax, bx, cx, dx, ay, by, cy, dy, 0.0, 0.0, 0.0, 0.0;
  return nodes;
}

/// Displacements in the plane, by their gradients.
Motion linear(const PanelNodes& nodes, double u_x, double u_y, double v_x, double v_y) {
  const Eigen::Matrix3d gradient = (Eigen::Matrix3d() << u_x, u_y, 0, v_x, v_y, 0, 0, 0, 0).finished();
  return (gradient * nodes).reshaped();
}

// Area 3 x 2, shear 0.1: twice the energy G t gamma^2 area.
TEST(ShearPanel, ResistsShearAloneAsARectangle) {
  const PanelNodes nodes = quadrilateral(0, 0, 3, 0, 3, 2, 0, 2);
  const PanelMatrix K = shear_panel_stiffness(nodes, 0.3);
  const Motion sheared = linear(nodes, 0.0, 0.06, 0.04, 0.0);
  EXPECT_NEAR(sheared.dot(K * sheared), 0.01 * 6.0, 1e-15);
  EXPECT_LT((K * linear(nodes, 1.0, 0.0, 0.0, 2.0)).norm(), 1e-14);
}

// Edges along x and at 60 degrees. The motion of constant strain whose stress is that of the panel, sigma_xx = 2 tau
// cot(theta), sigma_yy = 0: twice the energy is tau^2 area (1 + 2 cot^2 / (1 + nu)) at G t = 1.
TEST(ShearPanel, HasTheClosedFormOfAParallelogram) {
  const double cotangent = 1.0 / std::sqrt(3.0), nu = 0.25, young = 2.0 * (1.0 + nu);
  const PanelNodes nodes = quadrilateral(0, 0, 3, 0, 3 + 2 * cotangent, 2, 2 * cotangent, 2);
  const PanelMatrix K = shear_panel_stiffness(nodes, nu);
  const double stretched = 2.0 * cotangent / young;
  const Motion motion = linear(nodes, stretched, 0.4, 0.6, -nu * stretched);  // tau = 1
  EXPECT_NEAR(motion.dot(K * motion), 6.0 * (1.0 + 2.0 * cotangent * cotangent / (1.0 + nu)), 1e-12);
}

// Garvey's trapezoid of height h between sides a and b, symmetric: flow q along the slanting sides' mean. The forces of
// the edges on a symmetric trapezoid: along the parallel sides F and -F b/a... found from equilibrium of moments about
// the point where the slanting sides meet: q a^2 = q' b^2, as each side's distance from it is in proportion to its
// length.
TEST(ShearPanel, HasFlowsThatFallWithTheSquareOfTheLengthInATrapezoid) {
  const PanelNodes nodes = quadrilateral(-3, 0, 3, 0, 1, 2, -1, 2);
  const PanelMatrix K = shear_panel_stiffness(nodes, 0.3);
  // The only state of forces is a column of K; those of an edge are equal at both ends.
  const Motion forces = K.col(0);
  const auto at = [&](int n) { return Vector3d(forces.segment<3>(3 * n)); };
  // The edges from node 3 to node 4 and 1 to 2 are along x; the slanting ones along (-1, 1) and (1, 1).
  // Force along x at node 2: half of edge 12 and half of edge 23, the latter with equal x and y parts.
  const double below = 2.0 * (at(1).x() + at(1).y()), above = 2.0 * (at(2).x() + at(2).y());
  EXPECT_NEAR(std::abs(below / above), 1.0 / 3.0, 1e-12) << "q a^2 is equal: forces q a as 1 / a";
  EXPECT_NEAR(forces.dot(linear(nodes, 0.0, 1.0, -1.0, 0.0)), 0.0, 1e-14) << "in equilibrium";
}

TEST(ShearPanel, DoesNotResistRigidMotionThoughItIsWarped) {
  PanelNodes nodes = quadrilateral(0, 0, 3, 0.2, 3.4, 2, 0.3, 2.2);
  nodes.row(2) << 0.2, -0.1, 0.3, -0.2;
  const PanelMatrix K = shear_panel_stiffness(nodes, 0.3);
  const Vector3d spin(0.3, -0.5, 0.7);
  Motion motion;
  for (int n = 0; n < 4; ++n) motion.segment<3>(3 * n) = spin.cross(Vector3d(nodes.col(n))) + Vector3d(1.0, 2.0, -1.0);
  EXPECT_LT((K * motion).norm(), 1e-14 * K.norm() * motion.norm());
}

TEST(ShearPanel, DoesNotDependOnTheNodeWhereItBegins) {
  PanelNodes nodes = quadrilateral(0, 0, 3, 0.2, 3.4, 2, 0.3, 2.2);
  const PanelMatrix K = shear_panel_stiffness(nodes, 0.3);
  const PanelNodes turned = nodes(Eigen::all, std::vector<int>{1, 2, 3, 0});
  const std::vector<int> rows = {3, 4, 5, 6, 7, 8, 9, 10, 11, 0, 1, 2};
  EXPECT_LT((shear_panel_stiffness(turned, 0.3) - K(rows, rows)).norm(), 1e-13 * K.norm());
}

TEST(ShearPanel, RefusesOutlinesThatAreNotConvex) {
  EXPECT_THAT(
      test::message_of<InvalidInput>([] { shear_panel_stiffness(quadrilateral(0, 0, 3, 0, 1, 0.5, 0, 3), 0.3); }),
      ::testing::HasSubstr("the angle at node 3 is 180 degrees or more"));
  EXPECT_THROW(shear_panel_stiffness(quadrilateral(0, 0, 3, 0, 3, 0, 0, 0), 0.3), InvalidInput);
}

/// One panel of 3 x 2, E = 2.5, G = 1, t = 0.1.
FiniteElementModel panel(double f1, double f2) {
  test::ModelMaker maker;
  const int metal = maker.material(1, 2.5, 0.25, 8.0);
  const FieldIndex thickness = maker.field("PSHEAR", 1, "T", 0.1), extra = maker.field("PSHEAR", 1, "NSM", 0.2);
  const double places[4][2] = {{0, 0}, {3, 0}, {3, 2}, {0, 2}};
  for (int k = 0; k < 4; ++k) maker.node(k + 1, {places[k][0], places[k][1], 0.0});
  maker.model.elements<ShearPanelElement>().push_back({.id = 1,
                                                       .nodes = {0, 1, 2, 3},
                                                       .material = metal,
                                                       .thickness = thickness,
                                                       .nonstructural_mass = extra,
                                                       .effectiveness = {f1, f2}});
  maker.model.settings.automatic_constraints = AutomaticConstraints::none;
  return maker.model;
}

double energy(const FiniteElementModel& model, double u_x, double v_y) {
  const Eigen::MatrixXd K = test::dense(assemble(model, {}).stiffness.at(Eigen::VectorXd()));
  Eigen::VectorXd motion = Eigen::VectorXd::Zero(24);
  for (int n = 0; n < 4; ++n) {
    motion(6 * n) = u_x * model.nodes[static_cast<std::size_t>(n)].position.x();
    motion(6 * n + 1) = v_y * model.nodes[static_cast<std::size_t>(n)].position.y();
  }
  return motion.dot(K * motion);
}

// F = 1: E t area strain^2 along that direction. F = 30: two rods of 15 t^2.
TEST(ShearPanelElement, StretchesAsFarAsItIsEffective) {
  EXPECT_NEAR(energy(panel(1.0, 0.0), 0.1, 0.2), 2.5 * 0.1 * 6.0 * 0.01, 1e-15);
  EXPECT_NEAR(energy(panel(0.0, 0.5), 0.1, 0.2), 0.5 * 2.5 * 0.1 * 6.0 * 0.04, 1e-15);
  EXPECT_NEAR(energy(panel(30.0, 0.0), 0.1, 0.2), 2.0 * 2.5 * 15.0 * 0.01 * 3.0 * 0.01, 1e-15);
}

TEST(ShearPanelElement, HasTheMassOfItsAreaOnBothSettings) {
  for (const bool coupled : {false, true}) {
    FiniteElementModel model = panel(0.0, 0.0);
    model.settings.coupled_mass = coupled;
    const Eigen::MatrixXd M = test::dense(assemble(model, {}).mass.at(Eigen::VectorXd()));
    EXPECT_NEAR(M.sum(), 3.0 * 6.0 * (8.0 * 0.1 + 0.2), 1e-13);
  }
}

// F1 up to 1.01: by T; above: by T^2.
TEST(ShearPanelElement, IsSeparableInModulusAndThickness) {
  FiniteElementModel model = panel(1.0, 20.0);
  const FieldParameter young = {.fields = {model.materials[0].young}, .is_factor = true};
  const FieldParameter thickness = {.fields = {model.elements<ShearPanelElement>()[0].thickness}, .is_factor = true};
  const AssembledModel separable = assemble(model, {young, thickness});
  EXPECT_TRUE(separable.is_separable[0]);
  EXPECT_TRUE(separable.is_separable[1]);
  const Eigen::MatrixXd K = test::dense(separable.stiffness.at(Eigen::Vector2d(1.3, 1.7)));
  model.fields[static_cast<std::size_t>(model.materials[0].young)].value *= 1.3;
  model.fields[static_cast<std::size_t>(thickness.fields[0])].value *= 1.7;
  const Eigen::MatrixXd expected = test::dense(assemble(model, {}).stiffness.at(Eigen::VectorXd()));
  EXPECT_LT((K - expected).norm(), 1e-14 * K.norm());
}

}  // namespace
}  // namespace mottle::fem
