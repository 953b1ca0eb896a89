#include "mottle/fem/elements/beam_element.hpp"

#include "fem/elements/element_pieces.hpp"
#include "fem/elements/line_element.hpp"
#include "fem/elements/material_coefficients.hpp"
#include "fem/elements/tapered_beam_element.hpp"
#include "mottle/fem/elements/beam.hpp"
#include "mottle/fem/elements/beam_section.hpp"
#include "mottle/fem/finite_element_model.hpp"

namespace mottle::fem {
namespace {

constexpr FieldIndex k_section_number = -2;  // a number that follows from the dimensions, not from a field of its own

/// The section's numbers and where each comes from.
struct SectionFields {
  BeamSection numbers;
  FieldIndex area = k_no_field, inertia_1 = k_no_field, inertia_2 = k_no_field, inertia_12 = k_no_field,
             torsion = k_no_field;
};

SectionFields section_of(const FiniteElementModel& model, const BeamProperty& property) {
  if (!property.section.empty()) {
    std::vector<double> dimensions;
    for (const FieldIndex field : property.dimensions) dimensions.push_back(model.value(field));
    return {beam_section(property.section, dimensions),
            k_section_number,
            k_section_number,
            k_section_number,
            k_section_number,
            k_section_number};
  }
  SectionFields result{
      {}, property.area, property.inertia_1, property.inertia_2, property.inertia_12, property.torsion};
  result.numbers.area = model.value(property.area);
  result.numbers.inertia_1 = model.value(property.inertia_1);
  result.numbers.inertia_2 = model.value(property.inertia_2);
  result.numbers.inertia_12 = model.value(property.inertia_12);
  result.numbers.torsion = model.value(property.torsion);
  result.numbers.shear_1 = property.shear_1;
  result.numbers.shear_2 = property.shear_2;
  result.numbers.neutral_axis = property.neutral_axis;
  return result;
}

/// modulus * (a number of the section), which is a field or follows from the dimensions.
Coefficient section_coefficient(Coefficient modulus, const BeamProperty& property, FieldIndex field, double number) {
  if (field != k_section_number) return times(std::move(modulus), field);
  modulus.factor *= number;
  modulus.matrix_fields.insert(modulus.matrix_fields.end(), property.dimensions.begin(), property.dimensions.end());
  return modulus;
}

void add_matrix_fields(Coefficient& coefficient, std::initializer_list<FieldIndex> fields) {
  for (const FieldIndex field : fields) {
    if (field >= 0) coefficient.matrix_fields.push_back(field);
  }
}

/// A bending piece is a rational function of these once the section is flexible in shear.
void add_shear_ratio_fields(Coefficient& coefficient, const SectionFields& section, const Material& material) {
  add_matrix_fields(coefficient, {section.area, section.inertia_1, section.inertia_2, section.inertia_12});
  if (material.shear != k_no_field && material.young != k_no_field)
    add_matrix_fields(coefficient, {material.young, material.shear});
  if (material.poisson != k_no_field) add_matrix_fields(coefficient, {material.poisson});
}

Coefficient beam_coefficient(const FiniteElementModel& model, const BeamProperty& property,
                             const SectionFields& section, BeamCoefficient kind) {
  const Material& material = model.materials[static_cast<std::size_t>(property.material)];
  const Coefficient young = young_coefficient(model, material);
  const BeamSection& numbers = section.numbers;
  const bool is_soft_in_shear = numbers.shear_1 > 0.0 || numbers.shear_2 > 0.0;
  Coefficient result;
  switch (kind) {
    case BeamCoefficient::EA:
      return section_coefficient(young, property, section.area, numbers.area);
    case BeamCoefficient::GJ:
      return section_coefficient(shear_coefficient(model, material), property, section.torsion, numbers.torsion);
    case BeamCoefficient::EI1:
      result = section_coefficient(young, property, section.inertia_1, numbers.inertia_1);
      if (numbers.inertia_12 == 0.0) add_matrix_fields(result, {section.inertia_12});  // there is no piece of it now
      break;
    case BeamCoefficient::EI2:
      result = section_coefficient(young, property, section.inertia_2, numbers.inertia_2);
      break;
    case BeamCoefficient::EI12:
      result = section_coefficient(young, property, section.inertia_12, numbers.inertia_12);
      break;
    case BeamCoefficient::G:  // of tapered beams alone
      break;
    case BeamCoefficient::E:
      result = young;
      add_matrix_fields(result, {section.area, section.inertia_1, section.inertia_2, section.inertia_12});
      result.matrix_fields.insert(result.matrix_fields.end(), property.dimensions.begin(), property.dimensions.end());
      break;
  }
  if (is_soft_in_shear) add_shear_ratio_fields(result, section, material);
  return result;
}

void add_beam(const FiniteElementModel& model, const BeamElement& element, PieceSelection selection,
              ElementPieces& result) {
  for (const int node : element.nodes) add_six_degrees_of_freedom(node, result);
  const BeamProperty& property = model.beam_properties[static_cast<std::size_t>(element.property)];
  if (!property.stations.empty()) return add_tapered_beam(model, element, selection, result);
  const Material& material = model.materials[static_cast<std::size_t>(property.material)];
  const SectionFields section = section_of(model, property);
  const BeamGeometry geometry{ends_of(model, element.nodes), element.offsets, element.orientation, element.pins};
  const MassKind kind = mass_kind(model);
  const BeamMass unit = beam_mass(geometry, kind, property.neutral_axis);
  const double weigh = model.settings.mass_factor;
  if (material.density != k_no_field) {
    const Coefficient density{1.0, {{material.density, 1}}, {}};
    const auto add = [&](FieldIndex field, double number, const BeamMatrix& matrix) {
      add_piece(result, ElementPiece::Kind::mass, weigh, section_coefficient(density, property, field, number), matrix);
    };
    add(section.area, section.numbers.area, unit.line);
    if (element.has_torsional_inertia) {
      add(section.inertia_1, section.numbers.inertia_1, unit.torsional);
      add(section.inertia_2, section.numbers.inertia_2, unit.torsional);
    }
  }
  add_piece(result, ElementPiece::Kind::mass, weigh, times({}, property.nonstructural_mass),
            property.nonstructural_center == property.neutral_axis
                ? unit.line
                : beam_mass(geometry, kind, property.nonstructural_center).line);
  if (selection == PieceSelection::mass) return;
  const double shear = value_of(model, shear_coefficient(model, material));
  const double young = value_of(model, young_coefficient(model, material));
  for (const BeamPiece& piece : beam_stiffness(geometry, section.numbers, shear > 0.0 ? young / shear : 2.0)) {
    add_piece(result, ElementPiece::Kind::stiffness, 1.0, beam_coefficient(model, property, section, piece.coefficient),
              piece.matrix);
  }
}

double& geometry_number(BeamElement& element, int number) {
  if (number < 3) return element.orientation(number);
  return element.offsets[number < 6 ? 0 : 1](number % 3);
}

}  // namespace

const ElementTraits<BeamElement> BeamElement::k_traits = {
    .card = [](const BeamElement& element) -> std::string_view { return element.card; },
    .nodes = nodes_of<BeamElement>,
    .topology = line_topology<BeamElement>,
    .add_pieces = add_beam,
    .geometry = {.cards = {"CBAR", "CBEAM"},
                 .names = {"X1", "X2", "X3", "W1A", "W2A", "W3A", "W1B", "W2B", "W3B"},
                 .at = geometry_number}};

}  // namespace mottle::fem
