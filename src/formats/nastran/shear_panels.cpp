// PSHEAR, CSHEAR.
#include <array>

#include "formats/nastran/builder.hpp"
#include "formats/nastran/card_table.hpp"

namespace mottle::formats::nastran {
namespace {

/// PID MID T NSM F1 F2.
void read_pshear(ModelBuilder& builder, const Card& card) {
  const int id = card.id(1, "PID");
  if (!builder.is_first(card, id)) return;
  ShearPanelElement property;
  property.material = builder.material(card, 2, "MID");
  if (!(builder.real(card, 3, "T", 0.0) > 0.0)) card.fail("T must be positive");
  property.thickness = builder.read_field(card, 3, "T", id);
  property.nonstructural_mass = builder.read_field(card, 4, "NSM", id);
  property.effectiveness = {builder.real(card, 5, "F1", 0.0), builder.real(card, 6, "F2", 0.0)};
  for (const double factor : property.effectiveness) {
    if (factor < 0.0) card.fail("F1 and F2 must be 0 or positive");
  }
  builder.properties<ShearPanelElement>("PSHEAR")[id] = property;
}

/// EID PID G1 G2 G3 G4.
void read_cshear(ModelBuilder& builder, const Card& card) {
  const int id = card.id(1, "EID");
  if (!builder.is_first(card, id)) return;
  ShearPanelElement panel =
      builder.property<ShearPanelElement>(card, card.is_blank(2) ? id : card.id(2, "PID"), "PSHEAR");
  panel.id = id;
  builder.read_corners(card, 3, 4, panel.nodes.data());
  builder.add_element(card, panel);
}

constexpr std::array<CardRule, 2> k_shear_panel_rules = {{
    {"PSHEAR", Phase::properties, read_pshear, 6, "T"},
    {"CSHEAR", Phase::elements, read_cshear, 6},
}};

}  // namespace

CardFamily shear_panel_cards() {
  return {"CSHEAR", k_shear_panel_rules};
}

}  // namespace mottle::formats::nastran
