// Rods as their cards describe them; their matrices are in beam.hpp.
#pragma once

#include <array>

#include "mottle/fem/card_field.hpp"
#include "mottle/fem/elements/element_traits.hpp"
#include "mottle/layers.hpp"

namespace mottle::fem {

/// CROD with PROD, CONROD.
struct RodElement {
  int id = 0;
  std::array<int, 2> nodes = {};
  int material = -1;
  FieldIndex area = k_no_field, torsion = k_no_field, nonstructural_mass = k_no_field;

  static const ElementTraits<RodElement> k_traits;
};

}  // namespace mottle::fem
