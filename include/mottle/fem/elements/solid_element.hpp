// Solid elements as their cards describe them; their matrices are in solid.hpp.
#pragma once

#include <array>

#include "mottle/fem/elements/element_traits.hpp"
#include "mottle/fem/elements/solid.hpp"
#include "mottle/layers.hpp"

namespace mottle::fem {

/// CHEXA, CPENTA, CPYRAM, CTETRA with PSOLID.
struct SolidElement {
  int id = 0, property_id = 0;
  SolidShape shape = SolidShape::hexahedron8;
  std::array<int, 20> nodes = {};  ///< indices into nodes; -1: a mid-edge node that the card leaves out
  int material = -1;               ///< index into materials
  int material_system = -1;        ///< CORDM, index into coordinate_systems: axes of a MAT9; -1: basic

  static const ElementTraits<SolidElement> k_traits;
};

}  // namespace mottle::fem
