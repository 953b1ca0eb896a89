#include "fem/elements/shell_form.hpp"

#include <algorithm>
#include <array>
#include <numbers>
#include <vector>

#include "fem/elements/open_edges.hpp"
#include "mottle/fem/elements/curved_shell.hpp"

namespace mottle::fem {
namespace {

constexpr double k_radian = std::numbers::pi / 180.0;

bool depends_on_direction(const FiniteElementModel& model, const ShellProperty& property) {
  const auto does = [&](int material) {
    return material >= 0 && model.materials[static_cast<std::size_t>(material)].kind != Material::Kind::isotropic;
  };
  return does(property.membrane_material) || does(property.bending_material) || does(property.shear_material) ||
         std::ranges::any_of(property.laminate.plies, does, &ShellPly::material);
}

/// Sets nodes, offset and the material's direction.
template <typename Input>
Input input_of(const FiniteElementModel& model, const ShellElement& element, const Eigen::Matrix3Xd& nodes) {
  Input input{.node_count = element.node_count};
  input.offset = element.offset;
  input.nodes.leftCols(element.node_count) = nodes;
  // What is isotropic needs no direction, and must not fail for one that cannot be projected.
  if (!depends_on_direction(model, model.shell_properties[static_cast<std::size_t>(element.property)])) return input;
  input.material_angle = element.material_angle * k_radian;
  if (element.material_system == ShellElement::k_by_angle) return input;
  input.material_direction = Eigen::Vector3d::UnitX();
  if (element.material_system >= 0) {
    const Eigen::Vector3d centre = nodes.rowwise().mean();
    const auto system = static_cast<std::size_t>(element.material_system);
    input.material_direction = model.coordinate_systems[system].directions_at(centre).col(0);
  }
  return input;
}

std::vector<OpenEdge> open_edges_of(const ShellElement& element) {
  static constexpr std::array<std::array<int, 2>, 4> k_quadrilateral = {{{0, 1}, {1, 2}, {2, 3}, {3, 0}}};
  static constexpr std::array<std::array<int, 2>, 3> k_triangle = {{{0, 1}, {1, 2}, {2, 0}}};
  if (element.node_count == 8) return open_edges(shell_nodes(element), 4, k_quadrilateral);
  return open_edges(shell_nodes(element), 3, k_triangle);
}

ShellInput flat_input(const FiniteElementModel& model, const ShellElement& element) {
  return input_of<ShellInput>(model, element, positions(model, shell_nodes(element)));
}

CurvedShellInput curved_input(const FiniteElementModel& model, const ShellElement& element,
                              const std::vector<OpenEdge>& open) {
  return input_of<CurvedShellInput>(model, element, positions(model, shell_nodes(element), open));
}

/// The leading part of a flat shell's matrix.
Eigen::MatrixXd part(const ShellMatrix& matrix, const ShellElement& element) {
  return matrix.topLeftCorner(6 * element.node_count, 6 * element.node_count);
}

CurvedShellPieces curved_stiffness(const FiniteElementModel& model, const ShellElement& element,
                                   const ShellSection& section) {
  const std::vector<OpenEdge> open = open_edges_of(element);
  CurvedShellPieces pieces = curved_shell_stiffness(curved_input(model, element, open), section);
  for (Eigen::MatrixXd* each : {&pieces.membrane, &pieces.coupling, &pieces.bending, &pieces.shear, &pieces.drilling})
    *each = without_open_edges(*each, open, 6, false);
  return pieces;
}

}  // namespace

std::span<const int> shell_nodes(const ShellElement& element) {
  return std::span(element.nodes).first(static_cast<std::size_t>(element.node_count));
}

void add_degrees_of_freedom(const ShellElement& element, ElementPieces& result) {
  for (const int node : shell_nodes(element)) {
    if (node >= 0) add_six_degrees_of_freedom(node, result);
  }
}

bool is_curved(const ShellElement& element) {
  return element.node_count > 4;
}

ShellStiffness plate_stiffness(const FiniteElementModel& model, const ShellElement& element,
                               const ShellSection& section) {
  if (is_curved(element)) {
    const CurvedShellPieces pieces = curved_stiffness(model, element, section);
    return {pieces.membrane, pieces.bending, pieces.shear, pieces.drilling};
  }
  const ShellPieces pieces = shell_stiffness(flat_input(model, element), section);
  return {part(pieces.membrane, element), part(pieces.bending, element), part(pieces.shear, element),
          part(pieces.drilling, element)};
}

LaminateStiffness laminate_stiffness(const FiniteElementModel& model, const ShellElement& element,
                                     const ShellSection& section) {
  if (is_curved(element)) {
    const CurvedShellPieces pieces = curved_stiffness(model, element, section);
    return {pieces.membrane + pieces.coupling + pieces.bending + pieces.shear, pieces.drilling};
  }
  const LaminatePieces pieces = laminate_stiffness(flat_input(model, element), section);
  return {part(pieces.section, element), part(pieces.drilling, element)};
}

Eigen::MatrixXd unit_mass(const FiniteElementModel& model, const ShellElement& element) {
  const MassKind kind = mass_kind(model);
  if (!is_curved(element)) return part(shell_mass(flat_input(model, element), kind), element);
  const std::vector<OpenEdge> open = open_edges_of(element);
  return without_open_edges(curved_shell_mass(curved_input(model, element, open), kind), open, 6,
                            kind == MassKind::lumped);
}

ElementQuality shell_quality_of(const FiniteElementModel& model, const ShellElement& element) {
  const ShellQuality quality = is_curved(element)
                                   ? curved_shell_quality(curved_input(model, element, open_edges_of(element)))
                                   : shell_quality(flat_input(model, element));
  return {quality.jacobian_ratio, quality.aspect, quality.warp};
}

}  // namespace mottle::fem
