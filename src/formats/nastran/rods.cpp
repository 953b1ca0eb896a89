// PROD, PTUBE, CROD, CONROD, CTUBE.
#include <array>
#include <cmath>
#include <numbers>

#include "formats/nastran/builder.hpp"
#include "formats/nastran/card_table.hpp"

namespace mottle::formats::nastran {
namespace {

/// PROD, PTUBE.
struct RodProperty {
  int material = -1;
  FieldIndex area = k_no_field, torsion = k_no_field, nonstructural_mass = k_no_field;
};

void read_prod(ModelBuilder& builder, const Card& card) {
  const int id = card.id(1, "PID");
  if (!builder.is_first(card, id)) return;
  RodProperty property;
  property.material = builder.material(card, 2, "MID");
  property.area = builder.read_field(card, 3, "A", id);
  property.torsion = builder.read_field(card, 4, "J", id);
  property.nonstructural_mass = builder.read_field(card, 6, "NSM", id);
  builder.properties<RodProperty>("PROD")[id] = property;
}

/// A tube of outer diameter OD and wall T (blank or 0: solid).
///   A = pi (OD - T) T,   J = pi (OD^4 - (OD - 2 T)^4) / 32
void read_ptube(ModelBuilder& builder, const Card& card) {
  const int id = card.id(1, "PID");
  if (!builder.is_first(card, id)) return;
  const double outer = builder.real(card, 3, "OD", 0.0);
  if (outer <= 0.0) card.fail("OD must be positive");
  double wall = builder.real(card, 4, "T", 0.0);
  if (wall < 0.0 || wall > outer / 2.0) card.fail("T must lie in [0, OD / 2]");
  if (wall == 0.0) wall = outer / 2.0;
  if (!card.is_blank(6) && card.real(6, "OD2") != outer)
    card.fail("OD2 differs from OD; tapered tubes are not supported");
  const double inner = outer - 2.0 * wall;
  if (!std::isfinite(std::pow(outer, 4))) card.fail("OD is too large");
  RodProperty property;
  property.material = builder.material(card, 2, "MID");
  property.area = builder.add_field(card.name(), id, "A", std::numbers::pi * (outer - wall) * wall);
  property.torsion =
      builder.add_field(card.name(), id, "J", std::numbers::pi / 32.0 * (std::pow(outer, 4) - std::pow(inner, 4)));
  property.nonstructural_mass = builder.read_field(card, 5, "NSM", id);
  builder.properties<RodProperty>("PTUBE")[id] = property;
}

void add_rod(ModelBuilder& builder, const Card& card, int first_grid, const RodProperty& property) {
  RodElement rod;
  rod.id = card.id(1, "EID");
  builder.read_corners(card, first_grid, 2, rod.nodes.data());
  if (builder.position(rod.nodes[0]) == builder.position(rod.nodes[1])) card.fail("G1 and G2 lie at the same place");
  rod.material = property.material;
  rod.area = property.area;
  rod.torsion = property.torsion;
  rod.nonstructural_mass = property.nonstructural_mass;
  builder.add_element(card, rod);
}

void read_crod(ModelBuilder& builder, const Card& card) {
  const int id = card.id(1, "EID");
  if (!builder.is_first(card, id)) return;
  const int property = card.is_blank(2) ? id : card.id(2, "PID");
  add_rod(builder, card, 3, builder.property<RodProperty>(card, property, "PROD"));
}

void read_ctube(ModelBuilder& builder, const Card& card) {
  const int id = card.id(1, "EID");
  if (!builder.is_first(card, id)) return;
  const int property = card.is_blank(2) ? id : card.id(2, "PID");
  add_rod(builder, card, 3, builder.property<RodProperty>(card, property, "PTUBE"));
}

void read_conrod(ModelBuilder& builder, const Card& card) {
  const int id = card.id(1, "EID");
  if (!builder.is_first(card, id)) return;
  RodProperty property;
  property.material = builder.material(card, 4, "MID");
  property.area = builder.read_field(card, 5, "A", id);
  property.torsion = builder.read_field(card, 6, "J", id);
  property.nonstructural_mass = builder.read_field(card, 8, "NSM", id);
  add_rod(builder, card, 2, property);
}

constexpr std::array<CardRule, 5> k_rod_rules = {{
    {"PROD", Phase::properties, read_prod, 6, "A J"},
    {"PTUBE", Phase::properties, read_ptube, 6, "A J"},
    {"CROD", Phase::elements, read_crod, 4},
    {"CTUBE", Phase::elements, read_ctube, 4},
    {"CONROD", Phase::elements, read_conrod, 8, "A J"},
}};

}  // namespace

CardFamily rod_cards() {
  return {"CROD, CONROD, CTUBE", k_rod_rules};
}

}  // namespace mottle::formats::nastran
