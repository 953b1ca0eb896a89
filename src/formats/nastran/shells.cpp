// PSHELL, CQUAD4, CTRIA3, CQUADR, CTRIAR, CQUAD8, CTRIA6.
#include <algorithm>
#include <array>
#include <cmath>
#include <span>

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
  ShellProperty property;
  property.id = id;
  if (!card.is_blank(2)) property.membrane_material = builder.material(card, 2, "MID1", shell_materials());
  if (!card.is_blank(4)) property.bending_material = builder.material(card, 4, "MID2", shell_materials());
  if (!card.is_blank(6)) property.shear_material = builder.material(card, 6, "MID3", shell_materials());
  if (property.shear_material >= 0 && property.bending_material < 0) card.fail("MID3 is given without MID2");
  if (!card.is_blank(11)) {
    property.coupling_material = builder.material(card, 11, "MID4", shell_materials());
    if (property.membrane_material < 0 || property.bending_material < 0)
      card.fail("MID4 couples membrane and bending; it needs MID1 and MID2");
  }
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

/// Where a shell card has its fields.
struct ShellLayout {
  const char* card = nullptr;
  int nodes = 4;         ///< in all
  int corners = 4;       ///< the first of them
  int direction = 7;     ///< THETA or MCID; ZOFFS stands after it
  int thicknesses = 11;  ///< T1...
  int relative = 10;     ///< TFLAG
};

/// The element's own thickness, the mean of those at its corners. A blank one is the PSHELL's, a zero is a zero: the
/// guides of MSC and NX allow it as long as not all are.
FieldIndex read_thickness(ModelBuilder& builder, const Card& card, const ShellLayout& layout,
                          const ShellElement& element) {
  const ShellProperty& property = builder.model.shell_properties[static_cast<std::size_t>(element.property)];
  const FieldIndex of_property = property.thickness;
  const int first_field = layout.thicknesses, last_field = first_field + layout.corners - 1;
  if (!property.laminate.plies.empty()) {
    if (card.has_any(first_field, last_field))
      card.fail("T1... is given, but the plies of a PCOMP have thicknesses of their own; leave it blank");
    return k_no_field;
  }
  if (!card.has_any(first_field, last_field)) {
    if (of_property == k_no_field) card.fail("neither T1... nor its PSHELL's T is given; a thickness is needed");
    return k_no_field;
  }
  const bool is_relative = card.integer_or(layout.relative, "TFLAG", 0) == 1;
  const double base = builder.model.value(of_property);
  double mean = 0.0;
  bool is_uniform = true;
  double first = 0.0;
  for (int i = 0; i < layout.corners; ++i) {
    const int n = first_field + i;
    if (card.is_blank(n) && of_property == k_no_field)
      card.fail(fmt::format("T{} and its PSHELL's T are blank", i + 1));
    const double given = builder.real(card, n, fmt::format("T{}", i + 1), is_relative ? 1.0 : base);
    const double thickness = is_relative ? given * base : given;
    if (!(thickness >= 0.0) || !std::isfinite(thickness))
      card.fail(fmt::format("the thickness at corner {} is {}, it must not be negative", i + 1, thickness));
    if (i == 0) first = thickness;
    is_uniform = is_uniform && thickness == first;
    mean += thickness / layout.corners;
  }
  if (!(mean > 0.0)) card.fail("the thickness is 0 at all corners; leave T1... blank for that of the PSHELL");
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

void add_shell(ModelBuilder& builder, const Card& card, const ShellLayout& layout) {
  const int id = card.id(1, "EID");
  if (!builder.is_first(card, id)) return;
  ShellElement element;
  element.id = id;
  element.card = layout.card;
  const int property = card.is_blank(2) ? id : card.id(2, "PID");
  element.property = builder.property<int>(card, property, k_shell_properties);
  builder.read_corners(card, 3, layout.corners, element.nodes.data());
  builder.read_middles(card, 3, layout.corners, layout.nodes, element.nodes.data());
  const auto middles = std::span(element.nodes).subspan(static_cast<std::size_t>(layout.corners));
  const bool has_middles = std::ranges::any_of(middles.first(static_cast<std::size_t>(layout.nodes - layout.corners)),
                                               [](int node) { return node >= 0; });
  element.node_count = has_middles ? layout.nodes : layout.corners;
  if (layout.nodes > layout.corners && !has_middles)
    builder.count("{} CQUAD8 and CTRIA6 have no midside nodes; they were taken as CQUAD4 and CTRIA3");
  read_material_axes(builder, card, layout.direction, element);
  element.offset = builder.real(card, layout.direction + 1, "ZOFFS", 0.0);
  element.thickness = read_thickness(builder, card, layout, element);
  try {
    if (element.node_count != 3) hold_ratios(builder.model, element);
  } catch (const InvalidInput& error) {
    card.fail(error.what());
  }
  builder.add_element(card, element);
}

/// EID PID G1 G2 G3 G4 THETA ZOFFS / - TFLAG T1 T2 T3 T4.
void read_cquad4(ModelBuilder& builder, const Card& card) {
  add_shell(builder, card,
            {.card = "CQUAD4", .nodes = 4, .corners = 4, .direction = 7, .thicknesses = 11, .relative = 10});
}

/// EID PID G1 G2 G3 THETA ZOFFS - / - TFLAG T1 T2 T3.
void read_ctria3(ModelBuilder& builder, const Card& card) {
  add_shell(builder, card,
            {.card = "CTRIA3", .nodes = 3, .corners = 3, .direction = 6, .thicknesses = 11, .relative = 10});
}

constexpr const char* k_drilling_note =
    "{} CQUADR and CTRIAR were taken as CQUAD4 and CTRIA3: the rotation about the normal has the stiffness of K6ROT "
    "and "
    "does not bend the membrane";

void read_cquadr(ModelBuilder& builder, const Card& card) {
  add_shell(builder, card,
            {.card = "CQUADR", .nodes = 4, .corners = 4, .direction = 7, .thicknesses = 11, .relative = 10});
  builder.count(k_drilling_note);
}

void read_ctriar(ModelBuilder& builder, const Card& card) {
  add_shell(builder, card,
            {.card = "CTRIAR", .nodes = 3, .corners = 3, .direction = 6, .thicknesses = 11, .relative = 10});
  builder.count(k_drilling_note);
}

/// EID PID G1 ... G6 / G7 G8 T1 T2 T3 T4 THETA ZOFFS / TFLAG.
void read_cquad8(ModelBuilder& builder, const Card& card) {
  add_shell(builder, card,
            {.card = "CQUAD8", .nodes = 8, .corners = 4, .direction = 15, .thicknesses = 11, .relative = 17});
}

/// EID PID G1 ... G6 / THETA ZOFFS T1 T2 T3 TFLAG.
void read_ctria6(ModelBuilder& builder, const Card& card) {
  add_shell(builder, card,
            {.card = "CTRIA6", .nodes = 6, .corners = 3, .direction = 9, .thicknesses = 11, .relative = 14});
}

constexpr std::array<CardRule, 7> k_shell_rules = {{
    {"PSHELL", Phase::properties, read_pshell, 11, "T"},
    {"CQUAD4", Phase::elements, read_cquad4, 14},
    {"CTRIA3", Phase::elements, read_ctria3, 13},
    {"CQUADR", Phase::elements, read_cquadr, 14},
    {"CTRIAR", Phase::elements, read_ctriar, 13},
    {"CQUAD8", Phase::elements, read_cquad8, 17},
    {"CTRIA6", Phase::elements, read_ctria6, 14},
}};

}  // namespace

CardFamily shell_cards() {
  return {"CQUAD4, CTRIA3, CQUADR, CTRIAR, CQUAD8, CTRIA6", k_shell_rules};
}

}  // namespace mottle::formats::nastran
