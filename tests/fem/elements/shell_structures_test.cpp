#include <gtest/gtest.h>

#include <array>
#include <cmath>
#include <numbers>

#include "fem/shell_mesh.hpp"

namespace mottle::fem {
namespace {

using test::grid;
using test::ShellMaterial;
using test::ShellMesh;

constexpr double k_pi = std::numbers::pi;
constexpr double k_near = 1e-9;

/// A quarter of a unit square plate, symmetric about x = 1/2 and y = 1/2, inner nodes moved by `distortion`.
ShellMesh quarter_plate(int cells, int node_count, bool is_clamped, double distortion = 0.0) {
  ShellMesh mesh = grid(cells, cells, node_count, [&](double u, double v) {
    const double move = distortion * std::sin(2.0 * k_pi * u) * std::sin(2.0 * k_pi * v);
    return Eigen::Vector3d(0.5 * (u + 0.7 * move), 0.5 * (v - move), 0.0);
  });
  mesh.fix([](const auto&) { return true; }, "126");
  mesh.fix([](const auto& r) { return r.x() < k_near; }, is_clamped ? "345" : "34");
  mesh.fix([](const auto& r) { return r.y() < k_near; }, is_clamped ? "345" : "35");
  mesh.fix([](const auto& r) { return r.x() > 0.5 - k_near; }, "5");
  mesh.fix([](const auto& r) { return r.y() > 0.5 - k_near; }, "4");
  return mesh;
}

/// Deflection of the middle under unit load times the plate's stiffness.
double middle_deflection(const ShellMesh& mesh, const ShellMaterial& material) {
  const Eigen::VectorXd moved = test::solve_uniform(mesh, material, 2, 1.0);
  return moved(moved.size() - 4) * material.plate();
}

/// Navier's series for the simply supported Mindlin plate.
double mindlin_deflection(const ShellMaterial& material) {
  const double softness = material.plate() / (5.0 / 6.0 * material.shear() * material.thickness);
  double sum = 0.0;
  for (int m = 1; m < 120; m += 2) {
    for (int n = 1; n < 120; n += 2) {
      const double k2 = k_pi * k_pi * (m * m + n * n);
      const double sign = ((m + n) / 2) % 2 == 1 ? 1.0 : -1.0;
      sum += sign * 16.0 / (k_pi * k_pi * m * n) * (1.0 + softness * k2) / (k2 * k2);
    }
  }
  return sum;
}

// 1 %: what 8 x 8 cells of a quarter leave in a distorted mesh (0.6 %), with room; locking leaves nothing of it.
TEST(ShellPlate, OnSimpleSupportsDeflectsAsMindlinAtAnyThickness) {
  for (const double thickness : {1e-1, 1e-2, 1e-3, 1e-4}) {
    const ShellMaterial material = {.thickness = thickness};
    for (const int nodes : {3, 4}) {
      for (const double distortion : {0.0, 0.1}) {
        const double found = middle_deflection(quarter_plate(8, nodes, false, distortion), material);
        EXPECT_NEAR(found / mindlin_deflection(material), 1.0, 0.01) << thickness << " " << nodes << " " << distortion;
      }
    }
  }
}

// [Timoshenko1959], table 35: 0.00126532 q a^4 / D for the thin plate. 2 %: as measured, 1.1 and 1.7 %.
TEST(ShellPlate, ClampedDeflectsAsKirchhoffHoweverThin) {
  for (const double thickness : {1e-3, 1e-4}) {
    for (const int nodes : {3, 4}) {
      const double found = middle_deflection(quarter_plate(8, nodes, true, 0.1), {.thickness = thickness});
      EXPECT_NEAR(found / 0.00126532, 1.0, 0.02) << thickness << " " << nodes;
    }
  }
}

TEST(ShellPlate, RigidInShearDeflectsAsKirchhoffHoweverThick) {
  for (const int nodes : {3, 4}) {
    const ShellMaterial material = {.thickness = 0.2, .is_rigid_in_shear = true};
    EXPECT_NEAR(middle_deflection(quarter_plate(8, nodes, false), material) / 0.00406235, 1.0, 0.005) << nodes;
  }
}

// A triangle's unit matrices are made for one thickness; they must serve others nearby. 3e-3: as documented, twice the
// error of a frequency.
TEST(ShellPlate, ServesThicknessesNearItsOwnForTriangles) {
  const ShellMesh mesh = quarter_plate(4, 3, false);
  for (const double thickness : {0.09, 0.11}) {
    const double own = middle_deflection(mesh, {.thickness = thickness});
    EXPECT_NEAR(middle_deflection(mesh, {.thickness = thickness, .reference_thickness = 0.1}) / own, 1.0, 3e-3);
  }
}

/// Simply supported Mindlin plate without rotary inertia.
double mindlin_frequency(const ShellMaterial& material, int m, int n) {
  const double k2 = k_pi * k_pi * (m * m + n * n);
  const double softness = material.plate() / (5.0 / 6.0 * material.shear() * material.thickness);
  return k2 * std::sqrt(material.plate() / (1.0 + softness * k2));
}

// The lowest mode of a quarter is (1, 1). The order of bilinear shapes is 2; 0.3: mixed in are terms of higher order.
TEST(ShellPlate, FrequenciesConvergeWithTheSecondPower) {
  for (const double thickness : {1e-1, 1e-3}) {
    const ShellMaterial material = {.thickness = thickness};
    const double exact = mindlin_frequency(material, 1, 1);
    for (const MassKind kind : {MassKind::lumped, MassKind::consistent}) {
      const double coarse = test::frequencies(quarter_plate(4, 4, false), material, kind, 1)(0) / exact - 1.0;
      const double fine = test::frequencies(quarter_plate(8, 4, false), material, kind, 1)(0) / exact - 1.0;
      EXPECT_NEAR(std::log2(coarse / fine), 2.0, 0.3) << thickness << " " << coarse << " " << fine;
      EXPECT_LT(std::abs(fine), 0.005) << thickness;  // measured
    }
  }
}

ShellMesh cantilever_plate(int cells, int node_count) {
  ShellMesh mesh = grid(cells, cells, node_count, [](double u, double v) { return Eigen::Vector3d(u, v, 0.0); });
  mesh.fix([](const auto&) { return true; }, "126");
  mesh.fix([](const auto& r) { return r.x() < k_near; }, "345");
  return mesh;
}

// [Leissa1969], nu = 0.3, by Ritz (a little high). 1.5 %: the mesh's 1 % in the fifth mode and Ritz's own.
TEST(ShellPlate, ClampedAtOneEdgeHasLeissasFrequencies) {
  const std::array<double, 5> published = {3.492, 8.525, 21.43, 27.33, 31.11};
  const ShellMaterial material = {.thickness = 1e-3};
  for (const int nodes : {3, 4}) {
    const Eigen::VectorXd found = test::frequencies(cantilever_plate(16, nodes), material, MassKind::consistent, 5);
    for (int i = 0; i < 5; ++i) {
      EXPECT_NEAR(found(i) / std::sqrt(material.plate()) / published[i], 1.0, 0.015) << nodes << " " << i;
    }
  }
}

// [MacNeal1985]: 0.3024 at the middle of the free edge. 2 %: 1 % of the mesh and the shear that the reference leaves
// out.
TEST(ShellStructure, ScordelisLoRoofSinksAsPublished) {
  ShellMesh mesh = grid(16, 16, 4, [](double u, double v) {
    const double angle = 40.0 * k_pi / 180.0 * u;
    return Eigen::Vector3d(25.0 * std::sin(angle), 25.0 * v, 25.0 * std::cos(angle));
  });
  mesh.fix([](const auto& r) { return r.y() < k_near; }, "13");
  mesh.fix([](const auto& r) { return r.y() > 25.0 - k_near; }, "246");
  mesh.fix([](const auto& r) { return r.x() < k_near; }, "156");
  const Eigen::VectorXd moved =
      test::solve_uniform(mesh, {.young = 4.32e8, .poisson = 0.0, .thickness = 0.25}, 2, -90.0);
  EXPECT_NEAR(-moved(moved.size() - 4) / 0.3024, 1.0, 0.02);
}

// [MacNeal1985]: 1.8248e-5 under a pair of unit forces. 7 % at 16 x 16, usual for MITC4; 2 % at 32 x 32.
TEST(ShellStructure, PinchedCylinderGivesWayAsPublished) {
  const auto error = [](int cells, int nodes) {
    ShellMesh mesh = grid(cells, cells, nodes, [](double u, double v) {
      return Eigen::Vector3d(300.0 * std::sin(k_pi / 2.0 * u), 300.0 * v, 300.0 * std::cos(k_pi / 2.0 * u));
    });
    mesh.fix([](const auto& r) { return r.y() < k_near; }, "13");
    mesh.fix([](const auto& r) { return r.y() > 300.0 - k_near; }, "246");
    mesh.fix([](const auto& r) { return r.x() < k_near; }, "156");
    mesh.fix([](const auto& r) { return r.z() < k_near; }, "345");
    Eigen::VectorXd loads = Eigen::VectorXd::Zero(6 * static_cast<int>(mesh.nodes.size()));
    const int top = 6 * cells * (cells + 1) + 2;
    loads(top) = -0.25;
    const ShellMaterial material = {.young = 3e6, .poisson = 0.3, .thickness = 3.0};
    return test::solve(mesh, test::stiffness(mesh, material), loads)(top) / -1.8248e-5 - 1.0;
  };
  EXPECT_LT(std::abs(error(16, 4)), 0.07);
  EXPECT_LT(std::abs(error(16, 3)), 0.02);
  EXPECT_LT(std::abs(error(32, 4)), 0.02);
}

// [MacNeal1985], corrected for the thin one by [Belytschko1989]: the published mesh of 12 x 2. 3 %: MacNeal's grade A
// is 2 %; the thin one, whose cells are warped by 40 times the thickness, has 2.4 %.
TEST(ShellStructure, TwistedBeamGivesWayAsPublishedThickAndThin) {
  const auto expect = [](double thickness, double across_thin_side, double across_wide_side) {
    ShellMesh mesh = grid(12, 2, 4, [](double u, double v) {
      const double angle = k_pi / 2.0 * u, side = 1.1 * (v - 0.5);
      return Eigen::Vector3d(12.0 * u, side * std::cos(angle), side * std::sin(angle));
    });
    mesh.fix([](const auto& r) { return r.x() < k_near; }, "123456");
    const test::Sparse K = test::stiffness(mesh, {.young = 29e6, .poisson = 0.22, .thickness = thickness});
    for (const int component : {1, 2}) {
      Eigen::VectorXd loads = Eigen::VectorXd::Zero(K.rows());
      for (int j = 0; j < 3; ++j) loads(6 * (13 * j + 12) + component) = j == 1 ? 0.5 : 0.25;
      const double moved = test::solve(mesh, K, loads)(6 * 25 + component);
      EXPECT_NEAR(moved / (component == 1 ? across_thin_side : across_wide_side), 1.0, 0.03) << thickness;
    }
  };
  expect(0.32, 1.754e-3, 5.424e-3);
  expect(0.0032, 1.294e3, 5.256e3);
}

// A strip of six rectangles bent in its plane; [MacNeal1985]: 0.1081. One per cent: the incompatible modes are exact
// but for the shear at the clamped end.
TEST(ShellStructure, StripBendsInItsPlaneWithoutLocking) {
  ShellMesh mesh = grid(6, 1, 4, [](double u, double v) { return Eigen::Vector3d(6.0 * u, 0.2 * v, 0.0); });
  mesh.fix([](const auto& r) { return r.x() < k_near; }, "123456");
  Eigen::VectorXd loads = Eigen::VectorXd::Zero(84);
  loads(6 * 6 + 1) = loads(6 * 13 + 1) = 0.5;
  const ShellMaterial material = {.young = 1e7, .poisson = 0.3, .thickness = 0.1};
  EXPECT_NEAR(test::solve(mesh, test::stiffness(mesh, material), loads)(6 * 6 + 1) / 0.1081, 1.0, 0.01);
}

}  // namespace
}  // namespace mottle::fem
