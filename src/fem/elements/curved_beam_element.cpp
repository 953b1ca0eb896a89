#include "mottle/fem/elements/curved_beam_element.hpp"

#include "fem/elements/element_pieces.hpp"
#include "fem/elements/line_element.hpp"
#include "fem/elements/material_coefficients.hpp"
#include "mottle/core/error.hpp"
#include "mottle/fem/finite_element_model.hpp"

namespace mottle::fem {
namespace {

/// Arc of the centroids.
Arc arc_of(const FiniteElementModel& model, const CurvedBeamElement& element) {
  const double number = element.rule == ArcRule::radius ? element.radius - element.radial_offset : element.angle;
  Arc arc = arc_between(ends_of(model, element.nodes), element.orientation, element.rule, number);
  arc.radius += element.radial_offset;
  arc.center += element.normal_offset * arc.normal;
  require(arc.radius > 0.0, "curved beam: RC = {:g} moves the centroids beyond the centre", element.radial_offset);
  return arc;
}

CurvedBeamSection section_of(const FiniteElementModel& model, const CurvedBeamElement& element, double radius) {
  CurvedBeamSection section{model.value(element.area),
                            model.value(element.inertia_1),
                            model.value(element.inertia_2),
                            model.value(element.torsion),
                            element.shear_1,
                            element.shear_2};
  if (element.neutral_offset) section.inertia_1 = section.area * radius * *element.neutral_offset;
  require(section.inertia_1 < section.area * radius * radius,
          "curved beam: the neutral axis lies {:g} from the centroids, beyond the centre at {:g}",
          section.inertia_1 / (section.area * radius), radius);
  return section;
}

void add_curved_beam(const FiniteElementModel& model, const CurvedBeamElement& element, PieceSelection selection,
                     ElementPieces& result) {
  for (const int node : element.nodes) add_six_degrees_of_freedom(node, result);
  const Material& material = model.materials[static_cast<std::size_t>(element.material)];
  Coefficient young = young_coefficient(model, material);
  const double shear = value_of(model, shear_coefficient(model, material));
  require(shear > 0.0, "curved beam: its material has no shear modulus G");
  const Arc arc = arc_of(model, element);
  const CurvedBeamMatrices unit =
      curved_beam(arc, ends_of(model, element.nodes), section_of(model, element, arc.radius),
                  value_of(model, young) / shear, mass_kind(model));
  // The deflections depend on the section's and the material's ratios, and so does the consistent mass.
  std::vector<FieldIndex> ratios = {element.area, element.inertia_1, element.inertia_2, element.torsion};
  if (material.poisson != k_no_field) ratios.push_back(material.poisson);
  if (material.young != k_no_field && material.shear != k_no_field)
    ratios.insert(ratios.end(), {material.young, material.shear});
  const auto add = [&](ElementPiece::Kind kind, double factor, Coefficient coefficient, const BeamMatrix& matrix) {
    if (kind == ElementPiece::Kind::stiffness || model.settings.coupled_mass)
      coefficient.matrix_fields.insert(coefficient.matrix_fields.end(), ratios.begin(), ratios.end());
    add_piece(result, kind, factor, coefficient, matrix);
  };
  const double weigh = model.settings.mass_factor;
  add(ElementPiece::Kind::mass, weigh, times({}, element.nonstructural_mass), unit.line);
  if (material.density != k_no_field) {
    const Coefficient density{1.0, {{material.density, 1}}, {}};
    add(ElementPiece::Kind::mass, weigh, times(density, element.area), unit.line);
    add(ElementPiece::Kind::mass, weigh, times(density, element.inertia_1), unit.torsional);
    add(ElementPiece::Kind::mass, weigh, times(density, element.inertia_2), unit.torsional);
  }
  if (selection == PieceSelection::all) add(ElementPiece::Kind::stiffness, 1.0, young, unit.stiffness);
}

}  // namespace

const ElementTraits<CurvedBeamElement> CurvedBeamElement::k_traits = {
    .card = [](const CurvedBeamElement&) -> std::string_view { return "CBEND"; },
    .nodes = nodes_of<CurvedBeamElement>,
    .topology = line_topology<CurvedBeamElement>,
    .add_pieces = add_curved_beam};

}  // namespace mottle::fem
