#include "mottle/fem/elements/shell.hpp"

#include <gtest/gtest.h>

#include <Eigen/Dense>
#include <Eigen/Geometry>
#include <array>
#include <cmath>
#include <functional>
#include <limits>
#include <vector>

#include "fem/shell_mesh.hpp"
#include "mottle/core/error.hpp"

namespace mottle::fem {
namespace {

using test::ShellMaterial;
using test::ShellMesh;

const ShellMaterial k_material = {.young = 70.0, .poisson = 0.3, .thickness = 0.2};

/// Distorted, somewhere in space; of four nodes warped, unless flattened.
ShellInput element(int node_count, double warp = 0.15, double offset = 0.1) {
  ShellInput input{.node_count = node_count, .offset = offset, .shear_flexibility = 0.01};
  input.nodes << 0.1, 1.3, 1.1, -0.1, 0.0, 0.2, 1.2, 0.9, 0.0, warp, 0.0, warp;
  const Eigen::Matrix3d turned = Eigen::AngleAxisd(0.8, Eigen::Vector3d(1.0, 2.0, -1.0).normalized()).matrix();
  input.nodes = (turned * input.nodes).colwise() + Eigen::Vector3d(2.0, -1.0, 0.5);
  return input;
}

/// A flat quadrilateral, a warped one, a triangle, and all of them rigid in shear.
std::vector<ShellInput> elements() {
  std::vector<ShellInput> inputs = {element(4, 0.0), element(4), element(3)};
  for (int i = 0; i < 3; ++i) {
    inputs.push_back(inputs[static_cast<std::size_t>(i)]);
    inputs.back().shear_flexibility = 0.0;
  }
  return inputs;
}

std::array<ShellMatrix, 4> matrices(const ShellInput& input) {
  const ShellPieces pieces = shell_stiffness(input);
  return {pieces.membrane, pieces.bending, pieces.shear, pieces.drilling};
}

Eigen::MatrixXd rigid_motions(const ShellInput& input) {
  Eigen::MatrixXd motions = Eigen::MatrixXd::Zero(24, 6);
  for (int node = 0; node < input.node_count; ++node) {
    motions.block<6, 6>(6 * node, 0).setIdentity();
    for (int axis = 0; axis < 3; ++axis) {
      motions.block<3, 1>(6 * node, 3 + axis) =
          Eigen::Vector3d::Unit(axis).cross(Eigen::Vector3d(input.nodes.col(node)));
    }
  }
  return motions;
}

int rank(const ShellMatrix& matrix) {
  const Eigen::VectorXd values = Eigen::SelfAdjointEigenSolver<ShellMatrix>(matrix).eigenvalues();
  return static_cast<int>((values.array() > 1e-10 * values.maxCoeff()).count());
}

TEST(Shell, PiecesAreSymmetricToTheLastBit) {
  for (const ShellInput& input : elements()) {
    for (const ShellMatrix& matrix : matrices(input)) EXPECT_EQ(matrix, matrix.transpose());
    EXPECT_EQ(shell_mass(input, MassKind::consistent), shell_mass(input, MassKind::consistent).transpose());
  }
}

TEST(Shell, ResistsNoRigidMotion) {
  for (const ShellInput& input : elements()) {
    // 1e-13: a dozen roundings over coordinates near 2.
    for (const ShellMatrix& matrix : matrices(input)) {
      EXPECT_LE((matrix * rigid_motions(input)).norm(), 1e-13 * std::max(matrix.norm(), 1e-300) * 10.0);
    }
  }
}

// Of 24 or 18 degrees of freedom all but six; a quadrilateral's membrane 8 - 3, a triangle's 6 - 3; drilling one a
// node.
TEST(Shell, ResistsEveryMotionThatIsNotRigid) {
  for (const ShellInput& input : elements()) {
    const int nodes = input.node_count;
    const auto [membrane, bending, shear, drilling] = matrices(input);
    EXPECT_EQ(rank(membrane), 2 * nodes - 3);
    EXPECT_EQ(rank(drilling), nodes);
    const double bending_scale = 1.0 / bending.norm(), shear_scale = shear.norm() > 0.0 ? 1.0 / shear.norm() : 0.0;
    EXPECT_EQ(rank(bending_scale * bending + shear_scale * shear), 3 * nodes - 3);
    EXPECT_EQ(
        rank(membrane / membrane.norm() + drilling / drilling.norm() + bending_scale * bending + shear_scale * shear),
        6 * nodes - 6);
  }
}

TEST(Shell, DoesNotDependOnTheFrame) {
  const Eigen::Matrix3d turned = Eigen::AngleAxisd(1.1, Eigen::Vector3d(0.3, -1.0, 0.5).normalized()).matrix();
  ShellMatrix turn = ShellMatrix::Zero();
  for (int block = 0; block < 8; ++block) turn.block<3, 3>(3 * block, 3 * block) = turned;
  for (const ShellInput& input : elements()) {
    ShellInput moved = input;
    moved.nodes = (turned * input.nodes).colwise() + Eigen::Vector3d(0.5, 0.2, -0.3);
    const std::array<ShellMatrix, 4> before = matrices(input), after = matrices(moved);
    // 1e-13: a dozen roundings.
    for (int i = 0; i < 4; ++i) {
      EXPECT_LE((turn * before[i] * turn.transpose() - after[i]).norm(), 1e-13 * before[i].norm()) << i;
    }
  }
}

TEST(Shell, DoesNotDependOnTheNodeCountedFirst) {
  for (const ShellInput& input : elements()) {
    const int nodes = input.node_count;
    ShellInput shifted = input;
    ShellMatrix move = ShellMatrix::Zero();
    for (int i = 0; i < nodes; ++i) {
      shifted.nodes.col(i) = input.nodes.col((i + 1) % nodes);
      move.block<6, 6>(6 * i, 6 * ((i + 1) % nodes)).setIdentity();
    }
    const std::array<ShellMatrix, 4> before = matrices(input), after = matrices(shifted);
    // 1e-13: a dozen roundings.
    for (int i = 0; i < 4; ++i) {
      EXPECT_LE((move.transpose() * after[i] * move - before[i]).norm(), 1e-13 * before[i].norm()) << i;
    }
  }
}

// A strip of one cell, clamped but for the rotation of one end: 4 E I / L, which linear rotations alone would exceed by
// (L / t)^2. nu = 0; t / L = 0.01, so that shear takes away 3 (E I / L^2) / (5/6 G t) = 6e-4 of it.
TEST(Shell, BendsAsAStripWithOneCell) {
  const ShellMaterial material = {.young = 12.0, .poisson = 0.0, .thickness = 0.01};
  const ShellMesh mesh = test::grid(1, 1, 4, [](double u, double v) { return Eigen::Vector3d(u, 0.5 * v, 0.0); });
  const Eigen::MatrixXd K = test::stiffness(mesh, material);
  Eigen::VectorXd turned = Eigen::VectorXd::Zero(K.rows());
  turned(4) = turned(2 * 6 + 4) = 1.0;  // rotation y of the nodes at u = 0
  const double flexural = 12.0 * 0.5 * 1e-6 / 12.0;
  EXPECT_NEAR(turned.dot(K * turned) / flexural, 4.0, 4e-3);
}

TEST(Shell, StandsBehindRigidLinksWithAnOffset) {
  for (const int nodes : {3, 4}) {
    const ShellInput input = element(nodes, 0.0, 0.25);
    ShellInput moved = input;
    const Eigen::Vector3d side = input.nodes.col(1) - input.nodes.col(0),
                          other = input.nodes.col(2) - input.nodes.col(0);
    const Eigen::Vector3d arm = 0.25 * side.cross(other).normalized();
    moved.nodes.colwise() += arm;
    moved.offset = 0.0;
    ShellMatrix links = ShellMatrix::Identity();
    for (int node = 0; node < 4; ++node) {
      for (int axis = 0; axis < 3; ++axis)
        links.block<3, 1>(6 * node, 6 * node + 3 + axis) = Eigen::Vector3d::Unit(axis).cross(arm);
    }
    const ShellMatrix expected = links.transpose() * shell_matrix(moved, k_material) * links;
    EXPECT_LT((shell_matrix(input, k_material) - expected).norm(), 1e-13 * expected.norm());
    const ShellMatrix mass = links.transpose() * shell_mass(moved, MassKind::consistent) * links;
    EXPECT_LT((shell_mass(input, MassKind::consistent) - mass).norm(), 1e-13 * mass.norm());
  }
}

using Field = std::function<Eigen::Matrix<double, 6, 1>(double, double)>;

/// Largest deviation of the inner nodes from a field that is prescribed at the outer ones, relative to the field.
double patch_error(const ShellMesh& mesh, const ShellMaterial& material, const Field& field) {
  Eigen::VectorXd exact(48);
  for (int i = 0; i < 8; ++i) exact.segment<6>(6 * i) = field(mesh.nodes[i].x(), mesh.nodes[i].y());
  Eigen::VectorXd outer = exact;
  outer.tail(24).setZero();
  const test::Sparse K = test::stiffness(mesh, material);
  const Eigen::VectorXd found = outer + test::solve(mesh, K, -(K * outer));
  return (found - exact).cwiseAbs().maxCoeff() / exact.cwiseAbs().maxCoeff();
}

// 1e-10: roundings times the condition of a plate of t / a = 1/240.
TEST(Shell, PassesTheMembranePatchTest) {
  const Field stretched = [](double x, double y) {
    return (Eigen::Matrix<double, 6, 1>() << x + y / 2.0, y + x / 2.0, 0.0, 0.0, 0.0, 0.0).finished();
  };
  const Field sheared = [](double x, double y) {
    return (Eigen::Matrix<double, 6, 1>() << 0.2 * x - y, 0.4 * x, 0.0, 0.0, 0.0, 0.7).finished();
  };
  for (const int nodes : {3, 4}) {
    EXPECT_LT(patch_error(test::patch(nodes), {.young = 1e6, .poisson = 0.25, .thickness = 0.001}, stretched), 1e-10);
    EXPECT_LT(patch_error(test::patch(nodes), {.young = 1e6, .poisson = 0.25, .thickness = 0.001}, sheared), 1e-10);
  }
}

TEST(Shell, PassesTheBendingPatchTest) {
  const Field bent = [](double x, double y) {
    return (Eigen::Matrix<double, 6, 1>() << 0.0, 0.0, (x * x + x * y + y * y) / 2.0, y + x / 2.0, -x - y / 2.0, 0.0)
        .finished();
  };
  for (const int nodes : {3, 4}) {
    for (const bool is_rigid_in_shear : {false, true}) {
      const ShellMaterial material = {
          .young = 1e6, .poisson = 0.25, .thickness = 0.001, .is_rigid_in_shear = is_rigid_in_shear};
      EXPECT_LT(patch_error(test::patch(nodes), material, bent), 1e-10) << nodes << is_rigid_in_shear;
    }
  }
}

TEST(ShellMass, IsTheAreaInEachDirectionAtTheOffset) {
  for (const ShellInput& input : elements()) {
    for (const MassKind kind : {MassKind::lumped, MassKind::consistent}) {
      const Eigen::MatrixXd total = rigid_motions(input).transpose() * shell_mass(input, kind) * rigid_motions(input);
      const double area = shell_area(input);
      EXPECT_LT((total.topLeftCorner<3, 3>() - area * Eigen::Matrix3d::Identity()).norm(), 1e-13 * area);
    }
  }
}

// By hand: a rectangle of 3 by 2, a quarter of it at each corner; consistent 1/9 and 1/36 along a diagonal.
TEST(ShellMass, AgreesWithHandCalculationForARectangle) {
  ShellInput input;
  input.nodes << 0, 3, 3, 0, 0, 0, 2, 2, 0, 0, 0, 0;
  EXPECT_DOUBLE_EQ(shell_area(input), 6.0);
  EXPECT_DOUBLE_EQ(shell_mass(input, MassKind::lumped)(0, 0), 1.5);
  EXPECT_EQ(shell_mass(input, MassKind::lumped)(0, 6), 0.0);
  EXPECT_DOUBLE_EQ(shell_mass(input, MassKind::consistent)(2, 2), 6.0 / 9.0);
  EXPECT_DOUBLE_EQ(shell_mass(input, MassKind::consistent)(2, 14), 6.0 / 36.0);
  EXPECT_EQ(shell_mass(input, MassKind::consistent)(3, 3), 0.0);
}

TEST(ShellQuality, IsIdealForASquare) {
  ShellInput input;
  input.nodes << 0, 2, 2, 0, 0, 0, 2, 2, 1, 1, 1, 1;
  const ShellQuality quality = shell_quality(input);
  EXPECT_DOUBLE_EQ(quality.warp, 0.0);
  EXPECT_DOUBLE_EQ(quality.aspect, 1.0);
  EXPECT_DOUBLE_EQ(quality.skew, 90.0);
  EXPECT_DOUBLE_EQ(quality.jacobian_ratio, 1.0);
}

// By hand: a parallelogram of 45 degrees; a trapezium with parallel sides 2 and 1; a square with corners up and down.
TEST(ShellQuality, AgreesWithHandCalculationForDistortedElements) {
  ShellInput input;
  input.nodes << 0, 2, 3, 1, 0, 0, 1, 1, 0, 0, 0, 0;
  EXPECT_NEAR(shell_quality(input).skew, 45.0, 1e-12);
  EXPECT_NEAR(shell_quality(input).aspect, std::sqrt(2.0), 1e-12);
  input.nodes << 0, 2, 1, 0, 0, 0, 1, 1, 0, 0, 0, 0;
  EXPECT_NEAR(shell_quality(input).jacobian_ratio, 0.5, 1e-12);
  input.nodes << 0, 1, 1, 0, 0, 0, 1, 1, 0.1, -0.1, 0.1, -0.1;
  EXPECT_NEAR(shell_quality(input).warp, 0.1 / std::sqrt(0.5), 1e-12);
  input.nodes << 0, 1, 1, 0.4, 0, 0, 1, 0.4, 0, 0, 0, 0;  // turns inwards at the fourth node
  EXPECT_LT(shell_quality(input).jacobian_ratio, 0.0 + 1e-12);
  input.node_count = 3;
  EXPECT_NEAR(shell_quality(input).skew, 45.0, 1e-12);
}

TEST(Shell, RefusesNodesThatEncloseNoConvexArea) {
  ShellInput input;
  EXPECT_THROW(shell_stiffness(input), InvalidInput);
  input.nodes << 0, 1, 2, 3, 0, 1, 2, 3, 0, 0, 0, 0;
  EXPECT_THROW(shell_stiffness(input), InvalidInput);
  EXPECT_THROW(shell_quality(input), InvalidInput);
  input.nodes << 0, 1, 1, 0.9, 0, 0, 1, 0.1, 0, 0, 0, 0;
  EXPECT_THROW(shell_mass(input, MassKind::lumped), InvalidInput);
  input.nodes << 0, 1, 0, 1, 0, 0, 1, 1, 0, 0, 0, 0;  // sides that cross
  EXPECT_THROW(shell_area(input), InvalidInput);
}

TEST(Shell, RefusesNumbersWithoutMeaning) {
  ShellInput input = element(4);
  input.node_count = 5;
  EXPECT_THROW(shell_stiffness(input), InvalidInput);
  input = element(4);
  input.poisson_bending = 0.6;
  EXPECT_THROW(shell_stiffness(input), InvalidInput);
  input = element(4);
  input.shear_flexibility = -1.0;
  EXPECT_THROW(shell_stiffness(input), InvalidInput);
  input = element(4);
  input.nodes(0, 2) = std::numeric_limits<double>::quiet_NaN();
  EXPECT_THROW(shell_stiffness(input), InvalidInput);
}

}  // namespace
}  // namespace mottle::fem
