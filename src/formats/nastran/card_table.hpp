// The table of cards: every family that a deck may hold. A family is added by declaring it and by naming it here.
#pragma once

#include <vector>

#include "formats/nastran/builder.hpp"
#include "mottle/layers.hpp"

namespace mottle::formats::nastran {

/// Cards that one source reads.
struct CardFamily {
  std::string_view names;  ///< card names for messages, as users know them; may be empty
  std::span<const CardRule> rules;
};

CardFamily point_cards();
CardFamily coordinate_cards();
CardFamily solid_cards();
CardFamily shell_cards();
CardFamily laminate_cards();
CardFamily shear_panel_cards();
CardFamily beam_cards();
CardFamily beam_property_cards();
CardFamily curved_beam_cards();
CardFamily rod_cards();
CardFamily bush_cards();
CardFamily gap_cards();
CardFamily scalar_cards();
CardFamily general_element_cards();
CardFamily point_mass_cards();
CardFamily rigid_cards();
CardFamily constraint_cards();
CardFamily reduction_cards();
CardFamily material_cards();
CardFamily settings_cards();

inline std::vector<CardFamily> card_families() {
  return {point_cards(),       coordinate_cards(), solid_cards(),         shell_cards(),           laminate_cards(),
          shear_panel_cards(), beam_cards(),       beam_property_cards(), curved_beam_cards(),     rod_cards(),
          bush_cards(),        gap_cards(),        scalar_cards(),        general_element_cards(), point_mass_cards(),
          rigid_cards(),       constraint_cards(), reduction_cards(),     material_cards(),        settings_cards()};
}

}  // namespace mottle::formats::nastran
