#include "fem/elements/element_pieces.hpp"

#include "fem/assembly/constraint_equations.hpp"
#include "fem/elements/line_pieces.hpp"
#include "fem/elements/material_coefficients.hpp"
#include "fem/elements/point_pieces.hpp"
#include "mottle/core/error.hpp"
#include "mottle/fem/elements/shell.hpp"
#include "mottle/fem/elements/solid.hpp"

namespace mottle {
namespace {

MassKind mass_kind(const FiniteElementModel& model) {
  return model.settings.coupled_mass ? MassKind::consistent : MassKind::lumped;
}

const char* card_of(SolidShape shape) {
  switch (shape) {
    case SolidShape::hexahedron8:
      return "CHEXA";
    case SolidShape::wedge6:
      return "CPENTA";
    default:
      return "CTETRA";
  }
}

void add_solid(const FiniteElementModel& model, const SolidElement& element, PieceSelection selection,
               ElementPieces& result) {
  const int count = node_count(element.shape);
  Eigen::Matrix3Xd nodes(3, count);
  for (int k = 0; k < count; ++k) {
    const int node = element.nodes[static_cast<std::size_t>(k)];
    nodes.col(k) = model.nodes[static_cast<std::size_t>(node)].position;
    for (int c = 0; c < 3; ++c) result.degrees_of_freedom.push_back(degree_of_freedom(node, c));
  }
  const Material& material = model.materials[static_cast<std::size_t>(element.material)];
  if (material.density != k_no_field) {
    result.pieces.push_back({ElementPiece::Kind::mass,
                             model.settings.mass_factor,
                             {{material.density, 1}},
                             {},
                             solid_mass(element.shape, nodes, mass_kind(model))});
  }
  if (selection == PieceSelection::mass) return;
  Coefficient young = young_coefficient(model, material);
  for (const FieldIndex field : poisson_fields(material)) young.held.push_back(field);
  const double poisson = poisson_ratio(model, material);
  result.pieces.push_back({ElementPiece::Kind::stiffness, young.factor, young.fields, young.held,
                           solid_stiffness(element.shape, nodes, isotropic_elasticity(1.0, poisson))});
}

ShellInput shell_input(const FiniteElementModel& model, const ShellElement& element, ElementPieces& result) {
  ShellInput input;
  input.node_count = element.node_count;
  input.offset = element.offset;
  for (int k = 0; k < element.node_count; ++k) {
    const int node = element.nodes[static_cast<std::size_t>(k)];
    input.nodes.col(k) = model.nodes[static_cast<std::size_t>(node)].position;
    for (int c = 0; c < 6; ++c) result.degrees_of_freedom.push_back(degree_of_freedom(node, c));
  }
  return input;
}

void add_shell_stiffness(const FiniteElementModel& model, const ShellProperty& property, FieldIndex thickness,
                         ShellInput input, ElementPieces& result) {
  const auto size = static_cast<Eigen::Index>(6 * input.node_count);
  const auto material = [&](int index) -> const Material* {
    return index < 0 ? nullptr : &model.materials[static_cast<std::size_t>(index)];
  };
  const Material* membrane = material(property.membrane_material);
  const Material* bending = material(property.bending_material);
  const Material* shear = material(property.shear_material);
  if (membrane != nullptr) input.poisson_membrane = poisson_ratio(model, *membrane);
  if (bending != nullptr) input.poisson_bending = poisson_ratio(model, *bending);
  // How a triangle's bending shares with shear follows from t^2 E / G: its two pieces hold at the card's values only.
  std::vector<FieldIndex> plate_held = bending == nullptr ? std::vector<FieldIndex>{} : poisson_fields(*bending);
  if (input.node_count == 3 && bending != nullptr && shear != nullptr) {
    plate_held.push_back(thickness);
    if (bending != shear || (shear->shear != k_no_field && shear->young != k_no_field)) {
      for (const Material* one : {bending, shear}) {
        for (const FieldIndex field : {one->young, one->shear, one->poisson}) plate_held.push_back(field);
      }
    }
  }
  if (bending != nullptr && shear != nullptr) {
    const Coefficient young = young_coefficient(model, *bending);
    const Coefficient modulus = shear_coefficient(model, *shear);
    const double t = model.value(thickness);
    const double nu = input.poisson_bending;
    input.shear_flexibility = value_of(model, young) * property.bending_ratio * t * t /
                              (12.0 * (1.0 - nu * nu) * value_of(model, modulus) * property.shear_ratio);
  }
  const ShellPieces pieces = shell_stiffness(input);
  const auto add = [&](Coefficient coefficient, double factor, const std::vector<FieldIndex>& held,
                       const ShellMatrix& matrix) {
    for (const FieldIndex field : held) coefficient.held.push_back(field);
    result.pieces.push_back({ElementPiece::Kind::stiffness, factor * coefficient.factor, coefficient.fields,
                             coefficient.held, matrix.topLeftCorner(size, size)});
  };
  if (membrane != nullptr) {
    const std::vector<FieldIndex> held = poisson_fields(*membrane);
    add(times(young_coefficient(model, *membrane), thickness), 1.0, held, pieces.membrane);
    add(times(shear_coefficient(model, *membrane), thickness), model.settings.drilling, held, pieces.drilling);
  }
  if (bending != nullptr) {
    add(times(young_coefficient(model, *bending), thickness, 3), property.bending_ratio, plate_held, pieces.bending);
  }
  if (bending != nullptr && shear != nullptr) {
    add(times(shear_coefficient(model, *shear), thickness), property.shear_ratio, plate_held, pieces.shear);
  }
}

void add_shell(const FiniteElementModel& model, const ShellElement& element, PieceSelection selection,
               ElementPieces& result) {
  const ShellProperty& property = model.shell_properties[static_cast<std::size_t>(element.property)];
  const FieldIndex thickness = element.thickness != k_no_field ? element.thickness : property.thickness;
  const ShellInput input = shell_input(model, element, result);
  const auto size = static_cast<Eigen::Index>(6 * element.node_count);
  const Eigen::MatrixXd mass = shell_mass(input, mass_kind(model)).topLeftCorner(size, size);
  if (property.membrane_material >= 0) {
    const FieldIndex density = model.materials[static_cast<std::size_t>(property.membrane_material)].density;
    if (density != k_no_field) {
      result.pieces.push_back(
          {ElementPiece::Kind::mass, model.settings.mass_factor, {{density, 1}, {thickness, 1}}, {}, mass});
    }
  }
  if (property.nonstructural_mass != k_no_field) {
    result.pieces.push_back(
        {ElementPiece::Kind::mass, model.settings.mass_factor, {{property.nonstructural_mass, 1}}, {}, mass});
  }
  if (selection == PieceSelection::all) add_shell_stiffness(model, property, thickness, input, result);
}

}  // namespace

void visit_elements(const FiniteElementModel& model, PieceSelection selection,
                    const std::function<void(ElementPieces&)>& visit) {
  const auto each = [&](const auto& elements, const auto& name_of, const auto& add) {
    for (const auto& element : elements) {
      ElementPieces result;
      result.element = name_of(element);
      try {
        add(element, result);
      } catch (const InvalidInput& error) {
        throw InvalidInput(fmt::format("{}: {}", result.element, error.what()));
      }
      visit(result);
    }
  };
  each(
      model.solids, [](const SolidElement& e) { return fmt::format("{} {}", card_of(e.shape), e.id); },
      [&](const SolidElement& e, ElementPieces& result) { add_solid(model, e, selection, result); });
  each(
      model.shells,
      [](const ShellElement& e) { return fmt::format("{} {}", e.node_count == 3 ? "CTRIA3" : "CQUAD4", e.id); },
      [&](const ShellElement& e, ElementPieces& result) { add_shell(model, e, selection, result); });
  each(
      model.beams, [](const BeamElement& e) { return fmt::format("{} {}", e.card, e.id); },
      [&](const BeamElement& e, ElementPieces& result) { add_beam(model, e, mass_kind(model), selection, result); });
  each(
      model.rods, [](const RodElement& e) { return fmt::format("CROD {}", e.id); },
      [&](const RodElement& e, ElementPieces& result) { add_rod(model, e, mass_kind(model), selection, result); });
  each(
      model.scalars, [](const ScalarElement& e) { return scalar_name(e); },
      [&](const ScalarElement& e, ElementPieces& result) { add_scalar(model, e, selection, result); });
  each(
      model.bushes, [](const BushElement& e) { return fmt::format("CBUSH {}", e.id); },
      [&](const BushElement& e, ElementPieces& result) { add_bush(model, e, selection, result); });
  each(
      model.point_masses, [](const PointMassElement& e) { return fmt::format("{} {}", e.card, e.id); },
      [&](const PointMassElement& e, ElementPieces& result) { add_point_mass(model, e, result); });
}

}  // namespace mottle
