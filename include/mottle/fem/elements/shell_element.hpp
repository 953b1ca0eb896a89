// Shell elements and their properties as the cards describe them; their matrices are in shell.hpp.
#pragma once

#include <array>

#include "mottle/fem/card_field.hpp"
#include "mottle/fem/elements/element_traits.hpp"
#include "mottle/layers.hpp"

namespace mottle::fem {

/// PSHELL. A material of -1 leaves that stiffness out (MID2 blank: no bending; MID3 blank: no shear flexibility).
struct ShellProperty {
  int id = 0;
  int membrane_material = -1, bending_material = -1, shear_material = -1;
  FieldIndex thickness = k_no_field;
  double bending_ratio = 1.0;      ///< 12 I / T^3
  double shear_ratio = 5.0 / 6.0;  ///< TS / T
  FieldIndex nonstructural_mass = k_no_field;
};

/// CQUAD4 (4 nodes) and CTRIA3 (3).
struct ShellElement {
  int id = 0;
  int node_count = 4;
  std::array<int, 4> nodes = {};
  int property = -1;
  double offset = 0.0;                ///< ZOFFS, along the element's normal
  FieldIndex thickness = k_no_field;  ///< own thickness (mean of T1..T4 where given), else the property's

  static const ElementTraits<ShellElement> k_traits;
};

}  // namespace mottle::fem
