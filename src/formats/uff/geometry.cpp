// Datasets 15, 18, 82, 151, 164, 2411, 2412, 2420: header, units, nodes, coordinate systems, lines, elements.
#include <fmt/format.h>

#include <Eigen/Geometry>
#include <algorithm>
#include <cmath>
#include <set>

#include "formats/uff/datasets.hpp"

namespace mottle::formats {
namespace {

Eigen::Vector3d vector(const std::vector<double>& numbers, std::size_t start = 0) {
  return {numbers[start], numbers[start + 1], numbers[start + 2]};
}

CoordinateSystem::Kind kind_of(const UffCursor& cursor, int type) {
  if (type < 0 || type > 2) {
    cursor.fail(fmt::format("coordinate system type {}: 0 cartesian, 1 cylindrical, 2 spherical are known", type));
  }
  return static_cast<CoordinateSystem::Kind>(type);
}

/// Axes from the origin, a point on +x and a point of the xz plane on the side of +z.
Eigen::Matrix3d axes_from_points(const UffCursor& cursor, const Eigen::Vector3d& origin, const Eigen::Vector3d& on_x,
                                 const Eigen::Vector3d& on_xz) {
  constexpr double k_min_sine = 1e-6;
  const Eigen::Vector3d x = on_x - origin;
  const Eigen::Vector3d in_plane = on_xz - origin;
  const Eigen::Vector3d y = in_plane.cross(x);
  const bool is_degenerate = !(y.norm() > k_min_sine * x.norm() * in_plane.norm());
  if (is_degenerate) cursor.fail("the coordinate system's three points lie on one line");
  Eigen::Matrix3d axes;
  axes << x.normalized(), y.normalized(), x.cross(y).normalized();
  return axes;
}

}  // namespace

void read_uff_header(UffCursor& cursor, UffFile& out) {
  UffHeader header;
  for (std::string& line : header.lines) {
    if (cursor.at_mark()) break;
    line = cursor.text("a line of the header");
  }
  if (!out.header) out.header = header;
}

void read_uff_units(UffCursor& cursor, UffFile& out) {
  UffUnits units;
  const std::string_view first = cursor.line("the units' code");
  const std::string code = uff_columns(first, 0, 10);
  units.code = std::atoi(code.c_str());
  units.description = uff_columns(first, 10, 20);
  units.temperature_mode = std::atoi(uff_columns(first, 30, 10).c_str());
  const std::vector<double> factors = cursor.numbers("factors of length, force and temperature", {25}, 3);
  units.length = factors[0];
  units.force = factors[1];
  units.temperature = factors[2];
  if (!(units.length > 0.0 && units.force > 0.0)) {
    cursor.fail(fmt::format("factors of length {} and force {}: each must be > 0", units.length, units.force));
  }
  if (factors.size() > 3) {
    units.temperature_offset = factors[3];
  } else if (!cursor.at_mark()) {
    units.temperature_offset = cursor.numbers("the temperature's offset", {25}, 1)[0];
  }
  if (out.units && (out.units->length != units.length || out.units->force != units.force)) {
    cursor.fail("a second dataset 164 with other factors: which data are in which units cannot be told");
  }
  out.units = units;
}

namespace {

void add_node(const UffCursor& cursor, UffNode node, UffFile& out) {
  if (node.id <= 0) cursor.fail(fmt::format("node {}: labels start from 1", node.id));
  node.line = cursor.line_number();
  out.nodes.push_back(node);
}

}  // namespace

void read_uff_nodes_15(UffCursor& cursor, UffFile& out) {
  while (!cursor.at_mark()) {
    const std::vector<double> record = cursor.numbers("a node and its position", {10, 10, 10, 10, 13, 13, 13}, 7);
    const auto whole = [&](std::size_t field) {
      const double number = record[field];
      if (number != std::round(number) || std::abs(number) > 999999999.0) {
        cursor.fail(fmt::format("{} stands where a whole number should be (a node)", number));
      }
      return static_cast<int>(number);
    };
    add_node(cursor,
             {.id = whole(0),
              .definition_system = whole(1),
              .displacement_system = whole(2),
              .color = whole(3),
              .position = vector(record, 4),
              .is_local = true},
             out);
  }
}

void read_uff_nodes_2411(UffCursor& cursor, UffFile& out) {
  while (!cursor.at_mark()) {
    const std::vector<int> record = cursor.integers("a node", {10}, 4);
    const std::vector<double> position = cursor.values("a node's position", {25, 25, 25}, 3);
    add_node(cursor,
             {.id = record[0],
              .definition_system = record[1],
              .displacement_system = record[2],
              .color = record[3],
              .position = vector(position)},
             out);
  }
}

/// A system of this record, and its name in the next line.
UffCoordinateSystem begin_system(UffCursor& cursor, const std::vector<int>& record, int color) {
  UffCoordinateSystem system;
  system.line = cursor.line_number();
  system.system.id = record[0];
  system.system.kind = kind_of(cursor, record[1]);
  system.color = color;
  system.name = cursor.text("a coordinate system's name");
  return system;
}

void read_uff_systems_18(UffCursor& cursor, UffFile& out) {
  while (!cursor.at_mark()) {
    const std::vector<int> record = cursor.integers("a coordinate system", {10}, 5);
    UffCoordinateSystem system = begin_system(cursor, record, record[3]);
    system.reference = record[2];
    const std::vector<double> points = cursor.values("points of a coordinate system", {13, 13, 13, 13, 13, 13}, 6);
    const std::vector<double> last = cursor.values("the third point of a coordinate system", {13, 13, 13}, 3);
    system.system.origin = vector(points);
    system.system.axes = axes_from_points(cursor, vector(points), vector(points, 3), vector(last));
    out.systems.push_back(std::move(system));
  }
}

void read_uff_systems_2420(UffCursor& cursor, UffFile& out) {
  constexpr double k_rounding = 1e-4;  // of matrices that were written with six digits
  cursor.integers("a part's number", {10}, 1);
  cursor.text("a part's name");
  while (!cursor.at_mark()) {
    const std::vector<int> record = cursor.integers("a coordinate system", {10}, 3);
    UffCoordinateSystem system = begin_system(cursor, record, record[2]);
    Eigen::Matrix3d& axes = system.system.axes;
    for (int axis = 0; axis < 3; ++axis) {
      axes.col(axis) = vector(cursor.values("a row of a coordinate system's matrix", {25, 25, 25}, 3));
    }
    const bool is_rotation = (axes.transpose() * axes).isIdentity(k_rounding) && axes.determinant() > 0.0;
    if (!is_rotation) cursor.fail(fmt::format("coordinate system {}: its matrix is no rotation", record[0]));
    system.system.origin = vector(cursor.values("a coordinate system's origin", {25, 25, 25}, 3));
    out.systems.push_back(std::move(system));
  }
}

void read_uff_trace_line(UffCursor& cursor, UffFile& out) {
  while (!cursor.at_mark()) {
    const std::vector<int> record = cursor.integers("a trace line", {10}, 3);
    UffTraceLine trace;
    trace.id = record[0];
    trace.color = record[2];
    if (record[1] < 0) cursor.fail(fmt::format("a trace line of {} nodes", record[1]));
    const auto count = static_cast<std::size_t>(record[1]);
    trace.name = cursor.text("a trace line's name");
    while (trace.nodes.size() < count) {
      const std::vector<int> nodes = cursor.integers("nodes of a trace line", {10}, 1);
      trace.nodes.insert(trace.nodes.end(), nodes.begin(), nodes.end());
    }
    trace.nodes.resize(count);  // lines are filled up with zeros
    out.trace_lines.push_back(std::move(trace));
  }
}

bool is_uff_line(int descriptor) {
  static const std::set<int> k_lines = {11, 21, 22, 23, 24};
  return k_lines.contains(descriptor);
}

void read_uff_elements(UffCursor& cursor, UffFile& out) {
  while (!cursor.at_mark()) {
    const std::vector<int> record = cursor.integers("an element", {10}, 6);
    UffElement element{.id = record[0],
                       .descriptor = record[1],
                       .physical_property = record[2],
                       .material_property = record[3],
                       .color = record[4]};
    if (record[5] < 1) cursor.fail(fmt::format("element {} has {} nodes", record[0], record[5]));
    const auto count = static_cast<std::size_t>(record[5]);
    if (is_uff_line(element.descriptor)) {
      const std::vector<int> beam = cursor.integers("a beam's orientation", {10}, 3);
      std::copy_n(beam.begin(), 3, element.beam.begin());
    }
    while (element.nodes.size() < count) {
      const std::vector<int> nodes = cursor.integers("nodes of an element", {10}, 1);
      element.nodes.insert(element.nodes.end(), nodes.begin(), nodes.end());
    }
    if (element.nodes.size() > count) cursor.fail(fmt::format("element {} has more than {} nodes", element.id, count));
    out.elements.push_back(std::move(element));
  }
}

}  // namespace mottle::formats
