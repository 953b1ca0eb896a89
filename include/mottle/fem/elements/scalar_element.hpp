// Springs, masses and dampers of single degrees of freedom.
#pragma once

#include <array>
#include <cstdint>

#include "mottle/fem/card_field.hpp"
#include "mottle/fem/elements/element_traits.hpp"
#include "mottle/layers.hpp"

namespace mottle::fem {

/// CELAS, CMASS, CDAMP: one number between two degrees of freedom, or one and ground (node -1).
struct ScalarElement {
  enum class Kind : std::uint8_t { spring, mass, damper };

  Kind kind = Kind::spring;
  int id = 0;
  std::array<int, 2> nodes = {-1, -1};
  std::array<int, 2> components = {0, 0};  ///< 0..5
  FieldIndex value = k_no_field;

  static const ElementTraits<ScalarElement> k_traits;
};

}  // namespace mottle::fem
