#include "mottle/fem/elements/solid_element.hpp"

#include "fem/assembly/constraint_equations.hpp"
#include "fem/elements/element_pieces.hpp"
#include "fem/elements/material_coefficients.hpp"
#include "mottle/fem/finite_element_model.hpp"

namespace mottle::fem {
namespace {

std::string_view card_of(const SolidElement& element) {
  switch (element.shape) {
    case SolidShape::hexahedron8:
      return "CHEXA";
    case SolidShape::wedge6:
      return "CPENTA";
    case SolidShape::pyramid5:
      return "CPYRAM";
    default:
      return "CTETRA";
  }
}

std::span<const int> solid_nodes(const SolidElement& element) {
  return std::span(element.nodes).first(static_cast<std::size_t>(node_count(element.shape)));
}

const Topology& topology_of(const SolidElement& element) {
  static const std::vector<std::vector<int>> k_tetrahedron_faces = {{0, 2, 1}, {0, 1, 3}, {1, 2, 3}, {2, 0, 3}};
  static const Topology k_hexahedron = {
      .cell = VtkCell::hexahedron,
      .cell_nodes = {0, 1, 2, 3, 4, 5, 6, 7},
      .faces = {{0, 3, 2, 1}, {4, 5, 6, 7}, {0, 1, 5, 4}, {1, 2, 6, 5}, {2, 3, 7, 6}, {3, 0, 4, 7}},
      .is_solid = true};
  static const Topology k_wedge = {.cell = VtkCell::wedge,
                                   // VTK's base is seen from outside, Nastran's from inside.
                                   .cell_nodes = {0, 2, 1, 3, 5, 4},
                                   .faces = {{0, 2, 1}, {3, 4, 5}, {0, 1, 4, 3}, {1, 2, 5, 4}, {2, 0, 3, 5}},
                                   .is_solid = true};
  static const Topology k_pyramid = {.cell = VtkCell::pyramid,
                                     .cell_nodes = {0, 1, 2, 3, 4},
                                     .faces = {{0, 3, 2, 1}, {0, 1, 4}, {1, 2, 4}, {2, 3, 4}, {3, 0, 4}},
                                     .is_solid = true};
  static const Topology k_tetrahedron = {
      .cell = VtkCell::tetrahedron, .cell_nodes = {0, 1, 2, 3}, .faces = k_tetrahedron_faces, .is_solid = true};
  static const Topology k_quadratic_tetrahedron = {.cell = VtkCell::quadratic_tetrahedron,
                                                   .cell_nodes = {0, 1, 2, 3, 4, 5, 6, 7, 8, 9},
                                                   .faces = k_tetrahedron_faces,
                                                   .is_solid = true};
  if (element.shape == SolidShape::hexahedron8) return k_hexahedron;
  if (element.shape == SolidShape::wedge6) return k_wedge;
  if (element.shape == SolidShape::pyramid5) return k_pyramid;
  return element.shape == SolidShape::tetrahedron4 ? k_tetrahedron : k_quadratic_tetrahedron;
}

ElementQuality quality_of(const FiniteElementModel& model, const SolidElement& element) {
  const SolidQuality quality = solid_quality(element.shape, positions(model, solid_nodes(element)));
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
    for (int c = 0; c < 3; ++c) result.degrees_of_freedom.push_back(degree_of_freedom(node, c));
  }
  const Eigen::Matrix3Xd nodes = positions(model, solid_nodes(element));
  const Material& material = model.materials[static_cast<std::size_t>(element.material)];
  if (material.density != k_no_field) {
    result.pieces.push_back({ElementPiece::Kind::mass,
                             model.settings.mass_factor,
                             {{material.density, 1}},
                             {},
                             solid_mass(element.shape, nodes, mass_kind(model))});
  }
  if (selection == PieceSelection::mass) return;
  if (material.kind == Material::Kind::anisotropic_solid) {
    result.pieces.push_back({ElementPiece::Kind::stiffness,
                             1.0,
                             {},
                             material.moduli,
                             solid_stiffness(element.shape, nodes, anisotropic_elasticity(model, element, nodes))});
    return;
  }
  Coefficient young = young_coefficient(model, material);
  for (const FieldIndex field : poisson_fields(material)) young.matrix_fields.push_back(field);
  const double poisson = poisson_ratio(model, material);
  result.pieces.push_back({ElementPiece::Kind::stiffness, young.factor, young.fields, young.matrix_fields,
                           solid_stiffness(element.shape, nodes, isotropic_elasticity(1.0, poisson))});
}

}  // namespace

const ElementTraits<SolidElement> SolidElement::k_traits = {.card = card_of,
                                                            .nodes = solid_nodes,
                                                            .topology = topology_of,
                                                            .add_pieces = add_solid,
                                                            .family = "solids",
                                                            .quality = quality_of};

}  // namespace mottle::fem
