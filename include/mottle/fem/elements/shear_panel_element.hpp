// Shear panels as their cards describe them; their stiffness is in shear_panel.hpp.
#pragma once

#include <array>

#include "mottle/fem/card_field.hpp"
#include "mottle/fem/elements/element_traits.hpp"
#include "mottle/layers.hpp"

namespace mottle::fem {

/// CSHEAR with PSHEAR.
struct ShearPanelElement {
  int id = 0;
  std::array<int, 4> nodes = {};
  int material = -1;
  FieldIndex thickness = k_no_field, nonstructural_mass = k_no_field;
  /// F1 of edges 1-2 and 3-4, F2 of the others: rods that carry what the panel does along its edges. Up to 1.01 the
  /// fraction of the panel's width, above it the width of a rod in half thicknesses.
  std::array<double, 2> effectiveness = {0.0, 0.0};

  static const ElementTraits<ShearPanelElement> k_traits;
};

}  // namespace mottle::fem
