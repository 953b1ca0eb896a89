#include "mottle/fem/elements/laminate.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <Eigen/Dense>
#include <cmath>
#include <numbers>
#include <vector>

#include "core/message_of.hpp"
#include "mottle/core/error.hpp"

namespace mottle::fem {
namespace {

constexpr double k_degree = std::numbers::pi / 180.0;

LaminatePly graphite_epoxy(double degrees) {
  return {.elasticity = orthotropic_plane_stress(181e9, 10.3e9, 0.28, 7.17e9),
          .shear_flexibility = Eigen::Vector2d(1.0 / 7.17e9, 1.0 / 4e9).asDiagonal(),
          .thickness = 0.005,
          .angle = degrees * k_degree};
}

LaminatePly metal(double thickness, double angle = 0.0) {
  return {.elasticity = orthotropic_plane_stress(70.0, 70.0, 0.3, 70.0 / 2.6),
          .shear_flexibility = Eigen::Matrix2d::Identity() * (2.6 / 70.0),
          .thickness = thickness,
          .angle = angle};
}

double relative_error(const Eigen::Matrix3d& found, const Eigen::Matrix3d& expected) {
  return (found - expected).cwiseAbs().maxCoeff() / expected.cwiseAbs().maxCoeff();
}

// [Kaw2006], example 4.2: graphite/epoxy [0/30/-45] of 5 mm plies.
TEST(Laminate, HasThePublishedStiffnessOfThreePlies) {
  const std::vector<LaminatePly> plies = {graphite_epoxy(0.0), graphite_epoxy(30.0), graphite_epoxy(-45.0)};
  const ShellSection section = laminate_section(plies, -0.0075);
  const Eigen::Matrix3d A{{1.739e9, 3.884e8, 5.663e7}, {3.884e8, 4.533e8, -1.141e8}, {5.663e7, -1.141e8, 4.525e8}};
  const Eigen::Matrix3d B{{-3.129e6, 9.855e5, -1.072e6}, {9.855e5, 1.158e6, -1.072e6}, {-1.072e6, -1.072e6, 9.855e5}};
  const Eigen::Matrix3d D{{3.343e4, 6.461e3, -5.240e3}, {6.461e3, 9.320e3, -5.596e3}, {-5.240e3, -5.596e3, 7.663e3}};
  // 1e-3: the publication has four digits.
  EXPECT_LT(relative_error(section.membrane, A), 1e-3);
  EXPECT_LT(relative_error(section.coupling, B), 1e-3);
  EXPECT_LT(relative_error(section.bending, D), 1e-3);
}

TEST(Laminate, IsThePlateWithIsotropicPlies) {
  const double t = 0.4, plate = 70.0 * t * t * t / (12.0 * 0.91);
  const std::vector<LaminatePly> plies = {metal(0.1, 0.3), metal(0.25, 1.2), metal(0.05)};
  const ShellSection section = laminate_section(plies, -0.5 * t);
  // 1e-13: a dozen roundings.
  EXPECT_NEAR(section.membrane(0, 0), 70.0 * t / 0.91, 1e-13 * 30.0);
  EXPECT_NEAR(section.membrane(2, 2), 70.0 * t / 2.6, 1e-13 * 30.0);
  EXPECT_NEAR(section.bending(0, 0), plate, 1e-13);
  EXPECT_NEAR(section.bending(0, 1), 0.3 * plate, 1e-13);
  EXPECT_TRUE(section.coupling.isZero(0.0));
  EXPECT_TRUE(section.shear.isApprox(5.0 / 6.0 * 70.0 / 2.6 * t * Eigen::Matrix2d::Identity(), 1e-13));
}

TEST(Laminate, WithAnOffsetObeysTheParallelAxisTheorem) {
  const std::vector<LaminatePly> plies = {graphite_epoxy(20.0), graphite_epoxy(70.0), graphite_epoxy(-10.0)};
  const double e = 0.03;
  const ShellSection middle = laminate_section(plies, -0.0075), moved = laminate_section(plies, -0.0075 + e);
  EXPECT_LT(relative_error(moved.membrane, middle.membrane), 1e-14);
  EXPECT_LT(relative_error(moved.coupling, middle.coupling + e * middle.membrane), 1e-13);
  EXPECT_LT(relative_error(moved.bending, middle.bending + 2.0 * e * middle.coupling + e * e * middle.membrane), 1e-13);
  EXPECT_LT((moved.shear - middle.shear).norm(), 1e-12 * middle.shear.norm());  // z_x of numbers four times as large
}

TEST(Laminate, ThatIsSymmetricHasNoCoupling) {
  const std::vector<LaminatePly> plies = {graphite_epoxy(30.0), graphite_epoxy(-45.0), graphite_epoxy(-45.0),
                                          graphite_epoxy(30.0)};
  EXPECT_TRUE(laminate_section(plies, -0.01).coupling.isZero(0.0));
}

// Soft core between faces that are rigid in shear: the core's stress is E t d / 2 over the bending stiffness
// E (t d^2 / 2 + t^3 / 6) of both faces, d from the middle of one to that of the other, and constant.
TEST(Laminate, ShearsInTheCoreOfASandwich) {
  const double t = 0.1, core = 2.0, d = t + core, modulus = 3.0;
  LaminatePly face{.elasticity = orthotropic_plane_stress(70.0, 40.0, 0.1, 5.0), .thickness = t};
  LaminatePly soft{.elasticity = 1e-12 * Eigen::Matrix3d::Identity(),
                   .shear_flexibility = Eigen::Vector2d(1.0 / modulus, 0.5 / modulus).asDiagonal(),
                   .thickness = core};
  const ShellSection section = laminate_section(std::vector{face, soft, face}, -0.5 * (core + 2.0 * t));
  const double stress = 0.5 * t * d / (t * d * d / 2.0 + t * t * t / 6.0);
  const double expected = modulus / (core * stress * stress);
  EXPECT_NEAR(section.shear(0, 0), expected, 1e-10 * expected);  // the core's own bending: 1e-12 of the faces'
  EXPECT_NEAR(section.shear(1, 1), 2.0 * expected, 1e-10 * expected);
}

// Two layers of equal G and moduli E and r E: tau = V q(z), q of each layer a parabola from its free face; integrated
// by Simpson's rule on 2000 parts.
TEST(Laminate, HasTheShearOfABeamOfTwoMaterials) {
  const double ratio = 5.0, g = 2.0;
  const auto layer = [&](double young) {
    return LaminatePly{.elasticity = orthotropic_plane_stress(young, young, 0.0, 0.5 * young),
                       .shear_flexibility = Eigen::Matrix2d::Identity() / g,
                       .thickness = 1.0};
  };
  const double found = laminate_section(std::vector{layer(1.0), layer(ratio)}, 0.0).shear(0, 0);
  const double neutral = (0.5 + 1.5 * ratio) / (1.0 + ratio);
  const auto moment = [&](double z) { return 0.5 * z * z - neutral * z; };
  const double stiffness = 1.0 / 3.0 + 7.0 / 3.0 * ratio - neutral * neutral * (1.0 + ratio);
  const auto flow = [&](double z) { return z <= 1.0 ? moment(z) : moment(1.0) + ratio * (moment(z) - moment(1.0)); };
  double flexibility = 0.0;
  for (int i = 0; i <= 2000; ++i) {
    const double weight = i % 1000 == 0 && i != 1000 ? 1.0 : i % 2 == 1 ? 4.0 : 2.0, q = flow(0.001 * i) / stiffness;
    flexibility += weight * 0.001 / 3.0 * q * q / g;
  }
  EXPECT_NEAR(found * flexibility, 1.0, 1e-10);
}

TEST(Laminate, RefusesNumbersWithoutMeaning) {
  using test::message_of;
  using ::testing::HasSubstr;
  const auto refusal = [](const std::vector<LaminatePly>& plies) {
    return message_of<InvalidInput>([&] { laminate_section(plies, 0.0); });
  };
  EXPECT_THAT(refusal({}), HasSubstr("no ply"));
  EXPECT_THAT(refusal({metal(0.1), metal(0.0)}), HasSubstr("ply 2 has a thickness of 0, it must be positive"));
  LaminatePly one_sided = metal(0.1);
  one_sided.shear_flexibility(1, 1) = 0.0;
  EXPECT_THAT(refusal({one_sided}), HasSubstr("rigid in transverse shear in one direction only"));
  EXPECT_THROW(orthotropic_plane_stress(0.0, 1.0, 0.3, 1.0), InvalidInput);
  EXPECT_THROW(orthotropic_plane_stress(1.0, 4.0, 0.5, 1.0), InvalidInput);
  EXPECT_THROW(orthotropic_plane_stress(1.0, 1.0, 0.3, -1.0), InvalidInput);
}

}  // namespace
}  // namespace mottle::fem
