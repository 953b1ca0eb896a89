#include "mottle/formats/uff/frames.hpp"

#include <fmt/format.h>

#include <cmath>

#include "mottle/core/error.hpp"

namespace mottle::formats {
namespace {

/// Exponents of length and force of a quantity, by its number in the format.
std::array<int, 2> exponents(const UffAxis& axis) {
  switch (axis.quantity) {
    case 1:
      return {axis.units[0], axis.units[1]};
    case 2:  // stress
    case 15:
      return {-2, 1};  // pressure
    case 8:
    case 11:
    case 12:
      return {1, 0};  // displacement, velocity, acceleration
    case 9:
    case 13:
      return {0, 1};  // reaction and excitation force
    case 16:
      return {-1, 1};  // mass
    default:
      return {0, 0};
  }
}

double factor_of(const UffUnits& units, const UffAxis& axis) {
  const auto [length, force] = exponents(axis);
  return std::pow(units.length, length) * std::pow(units.force, force);
}

bool is_same(const CoordinateSystem& a, const CoordinateSystem& b) {
  return a.kind == b.kind && a.origin == b.origin && a.axes == b.axes;
}

}  // namespace

std::string convert_to_si(UffFile& contents) {
  if (!contents.units) return {};
  const UffUnits units = *contents.units;
  const double mass = units.force / units.length;
  using Kind = CoordinateSystem::Kind;
  std::map<int, Kind> kinds;
  for (UffCoordinateSystem& system : contents.systems) {
    system.system.origin /= units.length;
    kinds.emplace(system.system.id, system.system.kind);
  }
  for (UffNode& node : contents.nodes) {
    const auto within = node.is_local ? kinds.find(node.definition_system) : kinds.end();
    const Kind kind = within == kinds.end() ? Kind::rectangular : within->second;
    node.position(0) /= units.length;  // the others may be angles
    if (kind == Kind::rectangular) node.position(1) /= units.length;
    if (kind != Kind::spherical) node.position(2) /= units.length;
  }
  for (UffShape& shape : contents.shapes) {
    shape.modal_mass /= mass;
    shape.modal_a /= mass;
    shape.modal_b /= mass;
    if (shape.values.cols() == 6) shape.values.rightCols(3) *= units.length;
  }
  for (UffFunction& function : contents.functions) {
    function.values *= factor_of(units, function.denominator_axis) / factor_of(units, function.ordinate_axis);
    const double abscissa = factor_of(units, function.abscissa_axis);
    function.abscissa /= abscissa;
    function.start /= abscissa;
    function.step /= abscissa;
  }
  contents.units = UffUnits{};
  if (units.length == 1.0 && units.force == 1.0) return {};
  return fmt::format("converted to SI: lengths divided by {:g}, forces by {:g}", units.length, units.force);
}

UffFrames::UffFrames(const UffFile& contents) {
  for (const UffCoordinateSystem& system : contents.systems) {
    const auto [known, is_new] = given_.emplace(system.system.id, &system);
    const bool repeats = known->second->reference == system.reference && is_same(known->second->system, system.system);
    if (!is_new && !repeats) {
      throw FormatError(contents.file, system.line,
                        fmt::format("coordinate system {} is given already in line {}, with other content",
                                    system.system.id, known->second->line));
    }
  }
  std::map<int, const UffNode*> nodes;
  for (const UffNode& node : contents.nodes) {
    const auto [known, is_new] = nodes.emplace(node.id, &node);
    const UffNode& first = *known->second;
    const bool repeats =
        first.displacement_system == node.displacement_system && first.position.isApprox(node.position, 1e-4);
    if (!is_new && !repeats) {
      throw FormatError(contents.file, node.line,
                        fmt::format("node {} is given already in line {}, with other content", node.id, first.line));
    }
    if (!is_new || node.displacement_system == 0) continue;
    Eigen::Vector3d position = node.position;
    if (node.is_local && node.definition_system != 0) {
      position = resolve(contents, node.definition_system, node.line, 0).to_basic(position);
    }
    directions_[node.id] = resolve(contents, node.displacement_system, node.line, 0).directions_at(position);
  }
}

const CoordinateSystem& UffFrames::resolve(const UffFile& contents, int id, int line, int depth) {
  constexpr int k_deepest = 50;
  const auto resolved = resolved_.find(id);
  if (resolved != resolved_.end()) return resolved->second;
  const auto given = given_.find(id);
  constexpr int k_global = 1;  // as programs number it that write no systems
  if (given == given_.end() && id == k_global) return resolved_[id];
  if (given == given_.end()) {
    throw FormatError(contents.file, line,
                      fmt::format("coordinate system {} is not in the file (datasets 18 and 2420)", id));
  }
  if (depth > k_deepest) {
    throw FormatError(contents.file, given->second->line, fmt::format("coordinate system {} rests on itself", id));
  }
  CoordinateSystem system = given->second->system;
  if (given->second->reference != 0) {
    const CoordinateSystem& outer = resolve(contents, given->second->reference, given->second->line, depth + 1);
    if (outer.kind != CoordinateSystem::Kind::rectangular) {
      throw FormatError(contents.file, given->second->line,
                        fmt::format("coordinate system {} is defined within a curvilinear one, which is not read", id));
    }
    system.origin = outer.to_basic(system.origin);
    system.axes = outer.axes * system.axes;
  }
  return resolved_.emplace(id, std::move(system)).first->second;
}

Eigen::Matrix3d UffFrames::directions_at(int node) const {
  const auto found = directions_.find(node);
  return found == directions_.end() ? Eigen::Matrix3d(Eigen::Matrix3d::Identity()) : found->second;
}

}  // namespace mottle::formats
