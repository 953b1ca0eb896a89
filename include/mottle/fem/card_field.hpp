// Numbers on cards, which parameters act on, and sets of degrees of freedom.
#pragma once

#include <cstdint>
#include <string>

#include "mottle/layers.hpp"

namespace mottle::fem {

/// A number on a card that a parameter may act on: "MAT1:2:E". A card's number is read from here at every assembly.
struct CardField {
  std::string card;  ///< "MAT1", "PELAS", "CONM2": in capitals
  int id = 0;
  std::string name;  ///< "E", "RHO", "K1": in capitals, as in the format's documentation
  double value = 0.0;
};

/// Index into FiniteElementModel::fields; k_no_field where the card leaves the number out (zero, or as documented).
using FieldIndex = int;
inline constexpr FieldIndex k_no_field = -1;

/// Degrees of freedom 1..6 of a grid point as bits 0..5.
using Components = std::uint8_t;
inline constexpr Components k_all_components = 0x3f;

}  // namespace mottle::fem
