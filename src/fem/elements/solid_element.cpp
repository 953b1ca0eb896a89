#include "mottle/fem/elements/solid_element.hpp"

#include <algorithm>
#include <span>
#include <utility>
#include <vector>

#include "fem/assembly/constraint_equations.hpp"
#include "fem/elements/element_pieces.hpp"
#include "fem/elements/material_coefficients.hpp"
#include "fem/elements/open_edges.hpp"
#include "mottle/fem/finite_element_model.hpp"

namespace mottle::fem {
namespace {

std::string_view card_of(const SolidElement& element) {
  switch (solid_edges(element.shape).size()) {
    case 12:
      return "CHEXA";
    case 9:
      return "CPENTA";
    case 8:
      return "CPYRAM";
    default:
      return "CTETRA";
  }
}

std::span<const int> solid_nodes(const SolidElement& element) {
  return std::span(element.nodes).first(static_cast<std::size_t>(node_count(element.shape)));
}

int corner_count(SolidShape shape) {
  switch (solid_edges(shape).size()) {
    case 12:
      return 8;
    case 9:
      return 6;
    case 8:
      return 5;
    default:
      return 4;
  }
}

Topology solid_topology(VtkCell cell, std::vector<int> cell_nodes, std::vector<std::vector<int>> faces) {
  return {.cell = cell, .cell_nodes = std::move(cell_nodes), .faces = std::move(faces), .is_solid = true};
}

/// The same element with other nodes.
Topology with_cell(Topology topology, VtkCell cell, std::vector<int> cell_nodes) {
  topology.cell = cell;
  topology.cell_nodes = std::move(cell_nodes);
  return topology;
}

/// The linear element and, of nodes that are all there, the quadratic one.
struct Topologies {
  Topology linear, quadratic;
};

const Topologies& topologies_of(SolidShape shape) {
  static const Topology k_hexahedron =
      solid_topology(VtkCell::hexahedron, {0, 1, 2, 3, 4, 5, 6, 7},
                     {{0, 3, 2, 1}, {4, 5, 6, 7}, {0, 1, 5, 4}, {1, 2, 6, 5}, {2, 3, 7, 6}, {3, 0, 4, 7}});
  // VTK's base is seen from outside, Nastran's from inside.
  static const Topology k_wedge = solid_topology(VtkCell::wedge, {0, 2, 1, 3, 5, 4},
                                                 {{0, 2, 1}, {3, 4, 5}, {0, 1, 4, 3}, {1, 2, 5, 4}, {2, 0, 3, 5}});
  static const Topology k_pyramid =
      solid_topology(VtkCell::pyramid, {0, 1, 2, 3, 4}, {{0, 3, 2, 1}, {0, 1, 4}, {1, 2, 4}, {2, 3, 4}, {3, 0, 4}});
  static const Topology k_tetrahedron =
      solid_topology(VtkCell::tetrahedron, {0, 1, 2, 3}, {{0, 2, 1}, {0, 1, 3}, {1, 2, 3}, {2, 0, 3}});
  // VTK numbers the upright edges last.
  static const Topologies k_hexahedra = {
      k_hexahedron, with_cell(k_hexahedron, VtkCell::quadratic_hexahedron,
                              {0, 1, 2, 3, 4, 5, 6, 7, 8, 9, 10, 11, 16, 17, 18, 19, 12, 13, 14, 15})};
  static const Topologies k_wedges = {
      k_wedge, with_cell(k_wedge, VtkCell::quadratic_wedge, {0, 2, 1, 3, 5, 4, 8, 7, 6, 14, 13, 12, 9, 11, 10})};
  static const Topologies k_pyramids = {
      k_pyramid, with_cell(k_pyramid, VtkCell::quadratic_pyramid, {0, 1, 2, 3, 4, 5, 6, 7, 8, 9, 10, 11, 12})};
  static const Topologies k_tetrahedra = {
      k_tetrahedron, with_cell(k_tetrahedron, VtkCell::quadratic_tetrahedron, {0, 1, 2, 3, 4, 5, 6, 7, 8, 9})};
  switch (corner_count(shape)) {
    case 8:
      return k_hexahedra;
    case 6:
      return k_wedges;
    case 5:
      return k_pyramids;
    default:
      return k_tetrahedra;
  }
}

const Topology& topology_of(const SolidElement& element) {
  const Topologies& topologies = topologies_of(element.shape);
  const std::span<const int> nodes = solid_nodes(element);
  const bool is_linear = std::ssize(nodes) == corner_count(element.shape);
  return is_linear || std::ranges::find(nodes, -1) != nodes.end() ? topologies.linear : topologies.quadratic;
}

std::vector<OpenEdge> open_edges_of(const SolidElement& element) {
  return open_edges(solid_nodes(element), corner_count(element.shape), solid_edges(element.shape));
}

ElementQuality quality_of(const FiniteElementModel& model, const SolidElement& element) {
  const SolidQuality quality =
      solid_quality(element.shape, positions(model, solid_nodes(element), open_edges_of(element)));
  return {quality.jacobian_ratio, quality.aspect_ratio};
}

/// Elasticity of a MAT9 in basic axes.
Eigen::Matrix<double, 6, 6> anisotropic_elasticity(const FiniteElementModel& model, const SolidElement& element,
                                                   const Eigen::Matrix3Xd& nodes) {
  Eigen::Matrix<double, 6, 6> moduli;
  auto next = model.materials[static_cast<std::size_t>(element.material)].moduli.begin();
  for (Eigen::Index i = 0; i < 6; ++i) {
    for (Eigen::Index j = i; j < 6; ++j) moduli(i, j) = moduli(j, i) = model.value(*next++);
  }
  if (element.material_system < 0) return moduli;
  const auto& system = model.coordinate_systems[static_cast<std::size_t>(element.material_system)];
  return turned_elasticity(moduli, system.directions_at(nodes.rowwise().mean()));
}

void add_solid(const FiniteElementModel& model, const SolidElement& element, PieceSelection selection,
               ElementPieces& result) {
  for (const int node : solid_nodes(element)) {
    for (int c = 0; node >= 0 && c < 3; ++c) result.degrees_of_freedom.push_back(degree_of_freedom(node, c));
  }
  const std::vector<OpenEdge> open = open_edges_of(element);
  const Eigen::Matrix3Xd nodes = positions(model, solid_nodes(element), open);
  const auto of_own_nodes = [&](const Eigen::MatrixXd& matrix, bool is_lumped = false) {
    return without_open_edges(matrix, open, 3, is_lumped);
  };
  const Material& material = model.materials[static_cast<std::size_t>(element.material)];
  if (material.density != k_no_field) {
    const MassKind kind = mass_kind(model);
    result.pieces.push_back({ElementPiece::Kind::mass,
                             model.settings.mass_factor,
                             {{material.density, 1}},
                             {},
                             of_own_nodes(solid_mass(element.shape, nodes, kind), kind == MassKind::lumped)});
  }
  if (selection == PieceSelection::mass) return;
  if (material.kind == Material::Kind::anisotropic_solid) {
    result.pieces.push_back(
        {ElementPiece::Kind::stiffness,
         1.0,
         {},
         material.moduli,
         of_own_nodes(solid_stiffness(element.shape, nodes, anisotropic_elasticity(model, element, nodes)))});
    return;
  }
  Coefficient young = young_coefficient(model, material);
  for (const FieldIndex field : poisson_fields(material)) young.matrix_fields.push_back(field);
  const double poisson = poisson_ratio(model, material);
  result.pieces.push_back({ElementPiece::Kind::stiffness, young.factor, young.fields, young.matrix_fields,
                           of_own_nodes(solid_stiffness(element.shape, nodes, isotropic_elasticity(1.0, poisson)))});
}

}  // namespace

const ElementTraits<SolidElement> SolidElement::k_traits = {.card = card_of,
                                                            .nodes = solid_nodes,
                                                            .topology = topology_of,
                                                            .add_pieces = add_solid,
                                                            .family = "solids",
                                                            .quality = quality_of};

}  // namespace mottle::fem
