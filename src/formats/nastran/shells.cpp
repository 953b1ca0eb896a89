// PSHELL, CQUAD4, CTRIA3.
#include <array>
#include <cmath>

#include "formats/nastran/builder.hpp"
#include "formats/nastran/card_table.hpp"
#include "formats/nastran/rows.hpp"
#include "mottle/core/error.hpp"

namespace mottle::formats::nastran {
namespace {

/// PID MID1 T MID2 12I/T3 MID3 TS/T NSM / Z1 Z2 MID4.
void read_pshell(ModelBuilder& builder, const Card& card) {
  const int id = card.id(1, "PID");
  if (!builder.is_first(card, id, IdSpace::shell_property)) return;
  if (card.at(4) == "-1") card.fail("MID2 is -1 (plane strain), which is not supported");
  if (!card.is_blank(11)) card.fail("MID4 (coupling of membrane and bending) is not supported");
  ShellProperty property;
  property.id = id;
  if (!card.is_blank(2)) property.membrane_material = builder.material(card, 2, "MID1", shell_materials());
  if (!card.is_blank(4)) property.bending_material = builder.material(card, 4, "MID2", shell_materials());
  if (!card.is_blank(6)) property.shear_material = builder.material(card, 6, "MID3", shell_materials());
  if (property.shear_material >= 0 && property.bending_material < 0) card.fail("MID3 is given without MID2");
  property.thickness = builder.read_field(card, 3, "T", id);
  if (property.thickness != k_no_field && builder.model.value(property.thickness) <= 0.0)
    card.fail("T must be positive");
  property.bending_ratio = builder.real(card, 5, "12I/T3", property.bending_ratio);
  property.shear_ratio = builder.real(card, 7, "TS/T", property.shear_ratio);
  if (property.bending_ratio <= 0.0) card.fail("12I/T3 must be positive");
  if (property.shear_ratio <= 0.0) card.fail("TS/T must be positive");
  property.nonstructural_mass = builder.read_field(card, 8, "NSM", id);
  builder.properties<int>(k_shell_properties)[id] = static_cast<int>(builder.model.shell_properties.size());
  builder.model.shell_properties.push_back(property);
}

/// The element's own thickness, the mean of those at its corners: TFLAG in field 10, T1.. in 11...
FieldIndex read_thickness(ModelBuilder& builder, const Card& card, const ShellElement& element) {
  const ShellProperty& property = builder.model.shell_properties[static_cast<std::size_t>(element.property)];
  const FieldIndex of_property = property.thickness;
  if (!property.laminate.plies.empty()) {
    if (card.has_any(11, 10 + element.node_count))
      card.fail("T1... is given, but the plies of a PCOMP have thicknesses of their own; leave it blank");
    return k_no_field;
  }
  if (!card.has_any(11, 10 + element.node_count)) {
    if (of_property == k_no_field) card.fail("neither T1... nor its PSHELL's T is given; a thickness is needed");
    return k_no_field;
  }
  const bool is_relative = card.integer_or(10, "TFLAG", 0) == 1;
  const double base = builder.model.value(of_property);
  double mean = 0.0;
  bool is_uniform = true;
  double first = 0.0;
  for (int i = 0; i < element.node_count; ++i) {
    const int n = 11 + i;
    if (card.is_blank(n) && of_property == k_no_field)
      card.fail(fmt::format("T{} and its PSHELL's T are blank", i + 1));
    const double given = builder.real(card, n, fmt::format("T{}", i + 1), is_relative ? 1.0 : base);
    const double thickness = is_relative ? given * base : given;
    if (!(thickness > 0.0) || !std::isfinite(thickness))
      card.fail(fmt::format("the thickness at corner {} is {}, it must be positive", i + 1, thickness));
    if (i == 0) first = thickness;
    is_uniform = is_uniform && thickness == first;
    mean += thickness / element.node_count;
  }
  if (!is_uniform) builder.count("{} shells have different thicknesses at their corners; the mean was taken");
  if (is_relative)
    builder.count("{} shells give their thickness relative to PSHELL (TFLAG 1); it does not follow PSHELL:T");
  return builder.add_field(card.name(), element.id, "T", is_uniform ? first : mean);
}

/// THETA, an angle, or MCID, an integer: the coordinate system whose x axis is projected on the element.
void read_material_axes(ModelBuilder& builder, const Card& card, int n, ShellElement& element) {
  if (card.is_integer(n)) {
    element.material_system = builder.system(card, n, "MCID");
  } else {
    element.material_angle = builder.real(card, n, "THETA", 0.0);
  }
}

/// @param offset_field  where ZOFFS stands; THETA or MCID stands before it
void add_shell(ModelBuilder& builder, const Card& card, int corners, int offset_field) {
  const int id = card.id(1, "EID");
  if (!builder.is_first(card, id)) return;
  ShellElement element;
  element.id = id;
  element.node_count = corners;
  const int property = card.is_blank(2) ? id : card.id(2, "PID");
  element.property = builder.property<int>(card, property, k_shell_properties);
  builder.read_corners(card, 3, corners, element.nodes.data());
  read_material_axes(builder, card, offset_field - 1, element);
  element.offset = builder.real(card, offset_field, "ZOFFS", 0.0);
  element.thickness = read_thickness(builder, card, element);
  try {
    if (corners == 4) element.bending_over_shear = bending_over_shear(builder.model, element);
  } catch (const InvalidInput& error) {
    card.fail(error.what());
  }
  builder.add_element(card, element);
}

void read_cquad4(ModelBuilder& builder, const Card& card) {
  add_shell(builder, card, 4, 8);
}

void read_ctria3(ModelBuilder& builder, const Card& card) {
  add_shell(builder, card, 3, 7);
}

constexpr std::array<CardRule, 3> k_shell_rules = {{
    {"PSHELL", Phase::properties, read_pshell, 11, "T"},
    {"CQUAD4", Phase::elements, read_cquad4, 14},
    {"CTRIA3", Phase::elements, read_ctria3, 13},
}};

}  // namespace

CardFamily shell_cards() {
  return {"CQUAD4, CTRIA3", k_shell_rules};
}

}  // namespace mottle::formats::nastran
