#include "mottle/fem/elements/beam_section.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <array>
#include <cmath>
#include <numbers>
#include <vector>

#include "mottle/core/error.hpp"

namespace mottle::fem {
namespace {

constexpr double k_pi = std::numbers::pi;

BeamSection numbers_of(std::string_view name, const std::vector<double>& dimensions) {
  return beam_section(name, dimensions);
}

using Polygon = std::vector<std::array<double, 2>>;  // z to the right, y up, counter-clockwise; clockwise for a hole

/// Area and inertias about the centroid of an outline, by Green's theorem.
BeamSection integrated(const std::vector<Polygon>& outlines) {
  double area = 0.0, z = 0.0, y = 0.0, zz = 0.0, yy = 0.0, zy = 0.0;
  for (const Polygon& outline : outlines) {
    for (std::size_t i = 0; i < outline.size(); ++i) {
      const auto [z0, y0] = outline[i];
      const auto [z1, y1] = outline[(i + 1) % outline.size()];
      const double twice = z0 * y1 - z1 * y0;
      area += twice / 2.0;
      z += twice * (z0 + z1) / 6.0;
      y += twice * (y0 + y1) / 6.0;
      zz += twice * (z0 * z0 + z0 * z1 + z1 * z1) / 12.0;
      yy += twice * (y0 * y0 + y0 * y1 + y1 * y1) / 12.0;
      zy += twice * (2.0 * z0 * y0 + z0 * y1 + z1 * y0 + 2.0 * z1 * y1) / 24.0;
    }
  }
  z /= area;
  y /= area;
  return {
      .area = area, .inertia_1 = yy - area * y * y, .inertia_2 = zz - area * z * z, .inertia_12 = zy - area * z * y};
}

struct Drawn {
  std::string name;
  std::vector<double> dimensions;
  std::vector<Polygon> outlines;
};

/// Outlines read off the figures of PBARL, corner by corner.
std::vector<Drawn> drawn_sections() {
  return {
      {"BAR", {3, 5}, {{{0, 0}, {3, 0}, {3, 5}, {0, 5}}}},
      {"BOX", {6, 8, 1, 0.5}, {{{0, 0}, {6, 0}, {6, 8}, {0, 8}}, {{0.5, 1}, {0.5, 7}, {5.5, 7}, {5.5, 1}}}},
      {"CHAN", {5, 9, 0.5, 1}, {{{0, 0}, {5, 0}, {5, 1}, {0.5, 1}, {0.5, 8}, {5, 8}, {5, 9}, {0, 9}}}},
      {"CHAN1", {4.5, 0.5, 7, 9}, {{{0, 0}, {5, 0}, {5, 1}, {0.5, 1}, {0.5, 8}, {5, 8}, {5, 9}, {0, 9}}}},
      {"CROSS",
       {6, 1, 8, 2},
       {{{3, 0}, {4, 0}, {4, 3}, {7, 3}, {7, 5}, {4, 5}, {4, 8}, {3, 8}, {3, 5}, {0, 5}, {0, 3}, {3, 3}}}},
      {"H",
       {4, 2, 7, 1},
       {{{0, 0}, {1, 0}, {1, 3}, {5, 3}, {5, 0}, {6, 0}, {6, 7}, {5, 7}, {5, 4}, {1, 4}, {1, 7}, {0, 7}}}},
      {"HAT",
       {4, 0.5, 5, 2},
       {{{0, 0},
         {2.5, 0},
         {2.5, 3.5},
         {6.5, 3.5},
         {6.5, 0},
         {9, 0},
         {9, 0.5},
         {7, 0.5},
         {7, 4},
         {2, 4},
         {2, 0.5},
         {0, 0.5}}}},
      {"I",
       {10, 6, 4, 1, 1.5, 0.5},
       {{{0, 0},
         {6, 0},
         {6, 1.5},
         {3.5, 1.5},
         {3.5, 9.5},
         {5, 9.5},
         {5, 10},
         {1, 10},
         {1, 9.5},
         {2.5, 9.5},
         {2.5, 1.5},
         {0, 1.5}}}},
      {"I1",
       {5, 1, 8, 10},
       {{{0, 0}, {6, 0}, {6, 1}, {3.5, 1}, {3.5, 9}, {6, 9}, {6, 10}, {0, 10}, {0, 9}, {2.5, 9}, {2.5, 1}, {0, 1}}}},
      {"L", {4, 6, 0.5, 1}, {{{0, 0}, {4, 0}, {4, 0.5}, {1, 0.5}, {1, 6}, {0, 6}}}},
      {"T", {5, 7, 1, 0.5}, {{{0, 6}, {2.25, 6}, {2.25, 0}, {2.75, 0}, {2.75, 6}, {5, 6}, {5, 7}, {0, 7}}}},
      {"T2", {5, 7, 1, 0.5}, {{{0, 0}, {5, 0}, {5, 1}, {2.75, 1}, {2.75, 7}, {2.25, 7}, {2.25, 1}, {0, 1}}}},
  };
}

TEST(BeamSection, HasTheAreaAndInertiasOfItsOutline) {
  for (const Drawn& drawn : drawn_sections()) {
    const BeamSection section = numbers_of(drawn.name, drawn.dimensions), expected = integrated(drawn.outlines);
    const double rounding = 1e-12 * (expected.inertia_1 + expected.inertia_2);  // sums of a dozen terms
    EXPECT_NEAR(section.area, expected.area, 1e-12 * expected.area) << drawn.name;
    EXPECT_NEAR(section.inertia_1, expected.inertia_1, rounding) << drawn.name;
    EXPECT_NEAR(section.inertia_2, expected.inertia_2, rounding) << drawn.name;
    EXPECT_NEAR(section.inertia_12, expected.inertia_12, rounding) << drawn.name;
  }
}

TEST(BeamSection, HasNoProductOfInertiaForASymmetricOutline) {
  for (const Drawn& drawn : drawn_sections()) {
    if (drawn.name == "L") continue;
    EXPECT_EQ(numbers_of(drawn.name, drawn.dimensions).inertia_12, 0.0) << drawn.name;
  }
}

TEST(BeamSection, HasTheClosedFormsOfRoundBars) {
  const BeamSection rod = numbers_of("ROD", {2.0}), tube = numbers_of("TUBE", {2.0, 1.5});
  EXPECT_DOUBLE_EQ(rod.area, 4.0 * k_pi);
  EXPECT_DOUBLE_EQ(rod.inertia_1, 4.0 * k_pi);
  EXPECT_DOUBLE_EQ(rod.torsion, 8.0 * k_pi);
  EXPECT_DOUBLE_EQ(tube.area, k_pi * (4.0 - 2.25));
  EXPECT_DOUBLE_EQ(tube.inertia_2, k_pi / 4.0 * (16.0 - 5.0625));
  EXPECT_DOUBLE_EQ(tube.torsion, k_pi / 2.0 * (16.0 - 5.0625));
  EXPECT_DOUBLE_EQ(numbers_of("TUBE2", {2.0, 0.5}).inertia_1, tube.inertia_1);
  EXPECT_DOUBLE_EQ(numbers_of("TUBE", {2.0, 0.0}).inertia_1, rod.inertia_1);
}

/// Saint-Venant's series for a rectangle a >= b.
double rectangle_torsion(double a, double b) {
  double sum = 0.0;
  for (int n = 1; n < 40; n += 2) sum += std::tanh(n * k_pi * a / (2.0 * b)) / std::pow(n, 5);
  return a * b * b * b / 3.0 * (1.0 - 192.0 * b / (std::pow(k_pi, 5) * a) * sum);
}

TEST(BeamSection, HasTheTorsionConstantOfARectangleWithinHalfAPercent) {
  for (const double ratio : {1.0, 1.5, 2.0, 4.0, 20.0}) {
    const double exact = rectangle_torsion(3.0 * ratio, 3.0);
    EXPECT_NEAR(numbers_of("BAR", {3.0, 3.0 * ratio}).torsion, exact, 0.005 * exact) << ratio;  // as documented
    EXPECT_DOUBLE_EQ(numbers_of("BAR", {3.0 * ratio, 3.0}).torsion, numbers_of("BAR", {3.0, 3.0 * ratio}).torsion);
  }
}

// Bredt by hand: enclosed 5.5 x 7, 2 * 5.5 / 1 + 2 * 7 / 0.5 = 39.
TEST(BeamSection, TwistsByBredtAsABox) {
  EXPECT_DOUBLE_EQ(numbers_of("BOX", {6, 8, 1, 0.5}).torsion, 4.0 * 38.5 * 38.5 / 39.0);
}

// By hand, along the centre lines: two flanges of 4.75 x 1, a web of 8 x 0.5; and so on.
TEST(BeamSection, TwistsByItsStripsAsAnOpenOutline) {
  EXPECT_DOUBLE_EQ(numbers_of("CHAN", {5, 9, 0.5, 1}).torsion, (2.0 * 4.75 + 8.0 * 0.125) / 3.0);
  EXPECT_DOUBLE_EQ(numbers_of("I", {10, 6, 4, 1, 1.5, 0.5}).torsion, (6.0 * 3.375 + 4.0 * 0.125 + 9.0) / 3.0);
  EXPECT_DOUBLE_EQ(numbers_of("T", {5, 7, 1, 0.5}).torsion, (5.0 + 6.5 * 0.125) / 3.0);
  EXPECT_DOUBLE_EQ(numbers_of("L", {4, 6, 0.5, 1}).torsion, (3.5 * 0.125 + 5.75) / 3.0);
  EXPECT_DOUBLE_EQ(numbers_of("H", {4, 2, 7, 1}).torsion, (2.0 * 7.0 + 5.0) / 3.0);
  EXPECT_DOUBLE_EQ(numbers_of("HAT", {4, 0.5, 5, 2}).torsion, (4.5 + 2.0 * 3.5 + 2.0 * 2.25) * 0.125 / 3.0);
}

TEST(BeamSection, HasShearFactorsBetweenZeroAndOne) {
  for (const Drawn& drawn : drawn_sections()) {
    const BeamSection section = numbers_of(drawn.name, drawn.dimensions);
    EXPECT_GT(std::min(section.shear_1, section.shear_2), 0.0) << drawn.name;
    EXPECT_LT(section.shear_1 + section.shear_2, 5.0 / 3.0 + 1e-12) << drawn.name;  // that of a rectangle
  }
}

TEST(BeamSection, KnowsTheNumberOfDimensionsOfEachName) {
  for (const Drawn& drawn : drawn_sections()) {
    EXPECT_EQ(beam_section_dimensions(drawn.name), static_cast<int>(drawn.dimensions.size())) << drawn.name;
  }
  EXPECT_EQ(beam_section_dimensions("STAR"), 0);
}

TEST(BeamSection, RefusesAnUnknownNameWithTheKnownOnes) {
  try {
    numbers_of("STAR", {1.0});
    FAIL();
  } catch (const InvalidInput& error) {
    EXPECT_THAT(error.what(), ::testing::AllOf(::testing::HasSubstr("STAR"), ::testing::HasSubstr("TUBE2")));
  }
}

TEST(BeamSection, RefusesDimensionsThatDoNotFitTogether) {
  EXPECT_THROW(numbers_of("BAR", {1.0}), InvalidInput);
  EXPECT_THROW(numbers_of("BAR", {1.0, 0.0}), InvalidInput);
  EXPECT_THROW(numbers_of("BAR", {1.0, std::nan("")}), InvalidInput);
  EXPECT_THROW(numbers_of("TUBE", {1.0, 1.0}), InvalidInput);
  EXPECT_THROW(numbers_of("TUBE2", {1.0, 1.1}), InvalidInput);
  EXPECT_THROW(numbers_of("BOX", {1.0, 1.0, 0.5, 0.1}), InvalidInput);
  EXPECT_THROW(numbers_of("CHAN", {1.0, 1.0, 0.1, 0.5}), InvalidInput);
  EXPECT_THROW(numbers_of("CHAN1", {1.0, 0.1, 1.0, 1.0}), InvalidInput);
  EXPECT_THROW(numbers_of("CROSS", {1.0, 0.1, 1.0, 1.1}), InvalidInput);
  EXPECT_THROW(numbers_of("H", {1.0, 0.1, 1.0, 1.1}), InvalidInput);
  EXPECT_THROW(numbers_of("HAT", {1.0, 0.5, 2.0, 1.0}), InvalidInput);
  EXPECT_THROW(numbers_of("I", {1.0, 1.0, 1.0, 0.1, 0.5, 0.5}), InvalidInput);
  EXPECT_THROW(numbers_of("I", {1.0, 1.0, 1.0, 1.1, 0.1, 0.1}), InvalidInput);
  EXPECT_THROW(numbers_of("I1", {1.0, 0.1, 1.0, 1.0}), InvalidInput);
  EXPECT_THROW(numbers_of("L", {1.0, 1.0, 0.1, 1.0}), InvalidInput);
  EXPECT_THROW(numbers_of("T", {1.0, 1.0, 1.0, 0.1}), InvalidInput);
}

}  // namespace
}  // namespace mottle::fem
