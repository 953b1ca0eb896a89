// What is written is read again: every bit that the format's digits hold.
#include <fmt/format.h>
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>
#include <limits>

#include "mottle/core/text.hpp"
#include "mottle/formats/uff/uff.hpp"

namespace mottle::formats {
namespace {

/// `value` to so many significant digits.
double rounded(double value, int digits) {
  double result = 0.0;
  EXPECT_TRUE(parse_number(fmt::format("{:.{}e}", value, digits - 1), result));
  return result;
}

/// Numbers of many sizes and both signs.
double wild(int k) {
  return (k % 2 == 0 ? 1.0 : -1.0) * std::exp(7.3 * std::sin(12.9898 * k)) / 3.0;
}

UffShape shape_of(bool is_complex, int components, int digits) {
  UffShape shape{.analysis_type = is_complex ? 3 : 2, .is_complex = is_complex, .load_case = 1, .mode = 4};
  if (is_complex) {
    shape.eigenvalue = {rounded(wild(1), digits), rounded(wild(2), digits)};
    shape.modal_a = {rounded(wild(3), digits), rounded(wild(4), digits)};
  } else {
    shape.frequency = rounded(wild(2), digits);
    shape.modal_mass = rounded(wild(4), digits);
    shape.viscous_damping = rounded(wild(6), digits);
  }
  shape.nodes = {7, 101, 2000000000};
  shape.values.resize(3, components);
  for (int k = 0; k < 3 * components; ++k) {
    shape.values(k % 3, k / 3) = {rounded(wild(k + 9), digits), is_complex ? rounded(wild(k + 50), digits) : 0.0};
  }
  return shape;
}

class UffShapes : public ::testing::TestWithParam<int> {};

TEST_P(UffShapes, ComeBackBitByBitFromSixDigits) {
  UffFile file;
  for (const bool is_complex : {false, true}) {
    for (const int components : {3, 6}) file.shapes.push_back(shape_of(is_complex, components, 6));
  }
  const UffFile again = parse_uff(format_uff(file, {.shapes = GetParam()}), "again.uff");
  ASSERT_EQ(again.shapes.size(), file.shapes.size());
  for (std::size_t k = 0; k < file.shapes.size(); ++k) {
    const UffShape& was = file.shapes[k];
    const UffShape& is = again.shapes[k];
    EXPECT_EQ(is.values, was.values);
    EXPECT_EQ(is.nodes, was.nodes);
    EXPECT_EQ(is.frequency, was.frequency);
    EXPECT_EQ(is.modal_mass, was.modal_mass);
    EXPECT_EQ(is.viscous_damping, was.viscous_damping);
    EXPECT_EQ(is.eigenvalue, was.eigenvalue);
    EXPECT_EQ(is.modal_a, was.modal_a);
    EXPECT_EQ(is.mode, was.mode);
  }
}

INSTANTIATE_TEST_SUITE_P(Datasets, UffShapes, ::testing::Values(55, 2414));

TEST(FormatUff, KeepsEveryBitOfNodesSystemsAndUnits) {
  UffFile file;
  file.header = UffHeader{{"model", "with \xE9", "", "a", "b", "c", "d"}};
  file.units = UffUnits{.code = 9, .description = "USER_DEFINED", .length = 1.0 / 0.3, .force = 1.0 / 0.7};
  file.nodes = {{.id = 5, .displacement_system = 3, .color = 11, .position = {1.0 / 3.0, -1e-17, 1e300}}};
  const double turn = 0.7;
  Eigen::Matrix3d axes = Eigen::Matrix3d::Identity();
  axes.topLeftCorner<2, 2>() << std::cos(turn), -std::sin(turn), std::sin(turn), std::cos(turn);
  file.systems = {
      {.system = {.id = 3, .kind = CoordinateSystem::Kind::spherical, .origin = {0.1, 0.2, 0.3}, .axes = axes},
       .name = "tip"}};
  const UffFile again = parse_uff(format_uff(file), "again.uff");
  EXPECT_EQ(again.header->lines, file.header->lines);
  EXPECT_EQ(again.units->length, file.units->length);
  EXPECT_EQ(again.units->force, file.units->force);
  EXPECT_EQ(again.units->description, "USER_DEFINED");
  EXPECT_EQ(again.nodes[0].position, file.nodes[0].position);
  EXPECT_EQ(again.nodes[0].displacement_system, 3);
  EXPECT_EQ(again.systems[0].system.axes, axes);
  EXPECT_EQ(again.systems[0].system.origin, file.systems[0].system.origin);
  EXPECT_EQ(again.systems[0].system.kind, CoordinateSystem::Kind::spherical);
  EXPECT_EQ(parse_uff(format_uff(file, {.nodes = 15}), "again.uff").nodes[0].position(0), rounded(1.0 / 3.0, 6));
}

TEST(UffWriter, TraceLinesAndElementsComeBack) {
  UffFile file;
  file.trace_lines = {{.id = 1, .color = 8, .name = "wing", .nodes = {1, 2, 3, 0, 4, 5, 6, 7, 8, 9}},
                      {.id = 2, .name = "tail", .nodes = {9, 8, 7, 6, 5, 4, 3, 2}}};
  file.elements = {{.id = 5, .descriptor = 21, .color = 7, .beam = {0, 2, 3}, .nodes = {1, 2}},
                   {.id = 6, .descriptor = 94, .physical_property = 3, .material_property = 4, .nodes = {1, 2, 3, 4}},
                   {.id = 7, .descriptor = 116, .nodes = {1, 2, 3, 4, 5, 6, 7, 8, 9, 10, 11, 12}}};
  const UffFile again = parse_uff(format_uff(file), "again.uff");
  ASSERT_EQ(again.trace_lines.size(), 2U);
  ASSERT_EQ(again.elements.size(), 3U);
  for (std::size_t k = 0; k < 2; ++k) {
    EXPECT_EQ(again.trace_lines[k].nodes, file.trace_lines[k].nodes);
    EXPECT_EQ(again.trace_lines[k].name, file.trace_lines[k].name);
    EXPECT_EQ(again.trace_lines[k].color, file.trace_lines[k].color);
  }
  for (std::size_t k = 0; k < 3; ++k) {
    EXPECT_EQ(again.elements[k].nodes, file.elements[k].nodes);
    EXPECT_EQ(again.elements[k].beam, file.elements[k].beam);
    EXPECT_EQ(again.elements[k].descriptor, file.elements[k].descriptor);
    EXPECT_EQ(again.elements[k].material_property, file.elements[k].material_property);
  }
}

struct Form {
  bool is_complex, is_double, is_even, is_binary, is_big_endian;
};

class UffFunctions : public ::testing::TestWithParam<int> {};

TEST_P(UffFunctions, ComeBackBitByBit) {
  const int bits = GetParam();
  const Form form{(bits & 1) != 0, (bits & 2) != 0, (bits & 4) != 0, (bits & 8) != 0, (bits & 16) != 0};
  const auto as_held = [&](double value, bool is_abscissa) {
    if (form.is_binary && form.is_double && !is_abscissa) return value;
    if (form.is_binary) return static_cast<double>(static_cast<float>(value));
    return rounded(value, form.is_double && !is_abscissa ? 12 : 6);
  };
  UffFunction function{.type = 4, .is_complex = form.is_complex, .is_double = form.is_double};
  function.is_even = form.is_even;
  function.is_binary = form.is_binary;
  function.response_node = 101;
  function.response_direction = -3;
  function.start = 1.0;
  function.step = 0.25;
  function.abscissa_axis = {.quantity = 18, .units = {1, -2, 3}, .label = "Frequency", .unit = "Hz"};
  constexpr int k_points = 7;
  function.abscissa.resize(k_points);
  function.values.resize(k_points);
  for (int k = 0; k < k_points; ++k) {
    function.abscissa(k) = form.is_even ? 1.0 + 0.25 * k : as_held(wild(k + 100), true);
    function.values(k) = {as_held(wild(k), false), form.is_complex ? as_held(wild(k + 30), false) : 0.0};
  }
  UffFile file;
  file.functions = {function, function};
  const UffFile again = parse_uff(format_uff(file, {.is_big_endian = form.is_big_endian}), "again.uff");
  ASSERT_EQ(again.functions.size(), 2U);
  EXPECT_EQ(again.functions[1].abscissa, function.abscissa);
  EXPECT_EQ(again.functions[1].values, function.values);
  EXPECT_EQ(again.functions[1].response_direction, -3);
  EXPECT_EQ(again.functions[1].abscissa_axis.units, function.abscissa_axis.units);
  EXPECT_EQ(again.functions[1].abscissa_axis.unit, "Hz");
  EXPECT_EQ(again.functions[1].is_binary, form.is_binary);
}

INSTANTIATE_TEST_SUITE_P(EveryForm, UffFunctions, ::testing::Range(0, 32));

}  // namespace
}  // namespace mottle::formats
