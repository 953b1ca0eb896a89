// Plates of laminates against exact solutions: patches of constant strain and curvature, Navier's series, published
// frequencies.
#include <gtest/gtest.h>

#include <Eigen/Eigenvalues>
#include <Eigen/Geometry>
#include <cmath>
#include <numbers>

#include "core/message_of.hpp"
#include "fem/shell_mesh.hpp"
#include "mottle/core/error.hpp"
#include "mottle/fem/elements/laminate.hpp"

namespace mottle::fem {
namespace {

using test::ShellMesh;

/// The material of the published examples: E1 / E2 = 40, G12 = G1z = 0.6 E2, G2z = 0.5 E2, nu = 0.25.
LaminatePly ply(double thickness, double degrees) {
  return {.elasticity = orthotropic_plane_stress(40.0, 1.0, 0.25, 0.6),
          .shear_flexibility = Eigen::Vector2d(1.0 / 0.6, 1.0 / 0.5).asDiagonal(),
          .thickness = thickness,
          .angle = degrees * std::numbers::pi / 180.0};
}

ShellSection laminate(double thickness, const std::vector<double>& degrees) {
  std::vector<LaminatePly> plies;
  for (const double angle : degrees) plies.push_back(ply(thickness / static_cast<double>(degrees.size()), angle));
  return laminate_section(plies, -0.5 * thickness);
}

ShellInput input_of(const ShellMesh& mesh, const std::vector<int>& element) {
  ShellInput input = test::shell_input(mesh, element, {});
  input.material_direction = Eigen::Vector3d::UnitX();
  return input;
}

test::Sparse stiffness(const ShellMesh& mesh, const ShellSection& section) {
  return test::assembled(mesh, [&](const auto& element) {
    const LaminatePieces pieces = laminate_stiffness(input_of(mesh, element), section);
    return ShellMatrix(pieces.section + 1e-4 * section.membrane(2, 2) * pieces.drilling);
  });
}

// A field of constant strains and curvatures prescribed at the edges of distorted cells: the inside must follow it, for
// the forces and moments are constant whatever A, B, D couple. 1e-10: roundings times the condition.
TEST(Laminate, PassesThePatchTestWithCouplingOfAllKinds) {
  const ShellSection section = laminate(0.01, {0.0, 30.0, -50.0});
  ASSERT_GT(std::abs(section.coupling(0, 2)), 1e-3 * section.coupling.norm());
  for (const int nodes : {3, 4}) {
    const ShellMesh mesh = test::patch(nodes);
    Eigen::VectorXd exact(48);
    for (int i = 0; i < 8; ++i) {
      const double x = mesh.nodes[i].x(), y = mesh.nodes[i].y();
      exact.segment<6>(6 * i) << 0.2 * x + 0.1 * y, 0.1 * x - 0.3 * y, (x * x + x * y - 2.0 * y * y) / 2.0,
          x / 2.0 - 2.0 * y, -x - y / 2.0, 0.0;
    }
    Eigen::VectorXd outer = exact;
    outer.tail(24).setZero();
    const test::Sparse K = stiffness(mesh, section);
    const Eigen::VectorXd found = outer + test::solve(mesh, K, -(K * outer));
    EXPECT_LT((found - exact).cwiseAbs().maxCoeff() / exact.cwiseAbs().maxCoeff(), 1e-10) << nodes;
  }
}

TEST(Laminate, IsTheShellOfItsMaterialWithOneIsotropicPly) {
  const test::ShellMaterial material = {.young = 70.0, .poisson = 0.3, .thickness = 0.05};
  const LaminatePly only{.elasticity = orthotropic_plane_stress(70.0, 70.0, 0.3, material.shear()),
                         .shear_flexibility = Eigen::Matrix2d::Identity() / material.shear(),
                         .thickness = 0.05,
                         .angle = 0.7};
  const ShellSection section = laminate_section(std::vector{only}, -0.025);
  for (const int nodes : {3, 4}) {
    const ShellMesh mesh = test::patch(nodes);
    for (const auto& element : mesh.elements) {
      const ShellInput input = test::shell_input(mesh, element, material);
      const LaminatePieces pieces = laminate_stiffness(input, section);
      const ShellMatrix found = pieces.section + 100.0 * section.membrane(2, 2) * pieces.drilling;
      const ShellMatrix expected = test::shell_matrix(input, material);
      EXPECT_LT((found - expected).norm(), 1e-12 * expected.norm());  // a hundred roundings
    }
  }
}

TEST(Laminate, MayHaveItsAxesByAngleOrByDirection) {
  ShellSection section = laminate(0.05, {0.0, 30.0, -50.0}), turned = laminate(0.05, {20.0, 50.0, -30.0});
  section.shear = turned.shear.setIdentity();  // that of cylindrical bending is another in other axes
  const ShellMesh mesh = test::patch(4);
  ShellInput by_direction = input_of(mesh, mesh.elements[0]), by_angle = by_direction;
  by_direction.material_angle = 20.0 * std::numbers::pi / 180.0;
  const ShellMatrix expected = laminate_stiffness(by_direction, section).section;
  // From the side between the first two nodes: (0.24, 0) of element 0.
  by_angle.material_direction.setZero();
  by_angle.material_angle = by_direction.material_angle;
  EXPECT_LT((laminate_stiffness(by_angle, section).section - expected).norm(), 1e-13 * expected.norm());
  const ShellMatrix plies = laminate_stiffness(input_of(mesh, mesh.elements[0]), turned).section;
  EXPECT_LT((plies - expected).norm(), 1e-12 * expected.norm());
  by_direction.material_direction = Eigen::Vector3d::UnitZ();
  EXPECT_THAT(test::message_of<InvalidInput>([&] { laminate_stiffness(by_direction, section); }),
              ::testing::HasSubstr("normal to the element"));
}

/// Lowest frequency of a simply supported unit square of cross-plies at unit mass per area, without rotary inertia: the
/// shapes cos(pi x) sin(pi y)... solve it exactly.
double navier(const ShellSection& section) {
  const double k = std::numbers::pi;
  const Eigen::Matrix<double, 3, 2> strain{{-k, 0.0}, {0.0, -k}, {k, k}};
  Eigen::Matrix<double, 5, 5> K = Eigen::Matrix<double, 5, 5>::Zero();  // u, v, w; slopes
  K.topLeftCorner<2, 2>() = strain.transpose() * section.membrane * strain;
  K.topRightCorner<2, 2>() = strain.transpose() * section.coupling * strain;
  K.bottomRightCorner<2, 2>() = strain.transpose() * section.bending * strain + section.shear;
  K(2, 2) = k * k * section.shear.trace();
  K.block<1, 2>(2, 3) = k * section.shear.diagonal().transpose();
  K.bottomLeftCorner<2, 3>() = K.topRightCorner<3, 2>().transpose();
  const Eigen::Matrix3d condensed = K.topLeftCorner<3, 3>() - K.topRightCorner<3, 2>() *
                                                                  K.bottomRightCorner<2, 2>().inverse() *
                                                                  K.bottomLeftCorner<2, 3>();
  return std::sqrt(Eigen::SelfAdjointEigenSolver<Eigen::Matrix3d>(condensed).eigenvalues()(0));
}

double simply_supported(const ShellSection& section, int node_count, int cells) {
  ShellMesh mesh = test::grid(cells, cells, node_count, [](double u, double v) { return Eigen::Vector3d(u, v, 0.0); });
  const auto is_end = [](double x) { return x < 1e-9 || x > 1.0 - 1e-9; };
  mesh.fix([](const Eigen::Vector3d&) { return true; }, "6");
  mesh.fix([&](const Eigen::Vector3d& r) { return is_end(r.x()); }, "234");
  mesh.fix([&](const Eigen::Vector3d& r) { return is_end(r.y()); }, "135");
  return test::frequencies(mesh, stiffness(mesh, section), MassKind::consistent, 1)(0);
}

// Antisymmetric cross-plies couple membrane and bending; thick and thin. Second order in the cells.
TEST(Laminate, ConvergesToNaviersFrequencyOfAnAntisymmetricPlate) {
  for (const double thickness : {0.1, 0.01}) {
    const ShellSection section = laminate(thickness, {0.0, 90.0});
    const double exact = navier(section);
    for (const int nodes : {3, 4}) {
      const double coarse = simply_supported(section, nodes, 8) / exact - 1.0;
      const double fine = simply_supported(section, nodes, 16) / exact - 1.0;
      EXPECT_LT(std::abs(fine), 0.012) << thickness << ' ' << nodes;
      EXPECT_NEAR(std::log2(coarse / fine), 2.0, 0.35) << thickness << ' ' << nodes << ' ' << coarse;
    }
  }
}

// [Reddy2004]: w a^2 / h sqrt(rho / E2) = 18.891 by classical theory, [0/90/90/0]. Mass per area is one here: rho =
// 1/h.
TEST(Laminate, HasThePublishedFrequencyOfASymmetricCrossPly) {
  const double h = 0.001;
  const ShellSection section = laminate(h, {0.0, 90.0, 90.0, 0.0});
  const double scale = 1.0 / h * std::sqrt(1.0 / h);
  // 0.5 %: second order in 16 cells; 1e-3 thick, so that shear is 1e-4.
  EXPECT_NEAR(simply_supported(section, 4, 16) * scale / 18.891, 1.0, 0.01);
  EXPECT_NEAR(navier(section) * scale, 18.891, 0.002);
}

}  // namespace
}  // namespace mottle::fem
