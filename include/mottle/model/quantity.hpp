// Quantities that a model predicts and a test measures: kind, mode and location, and the name that follows from them.
#pragma once

#include <string>

#include "mottle/layers.hpp"

namespace mottle::model {

/// Physical kind of a quantity, apart from its name and unit.
enum class QuantityKind {
  frequency,     ///< natural frequency
  displacement,  ///< component of a mode shape
  rotation,      ///< the same of a rotational degree of freedom: another dimension
  damping_ratio,
  other,
};

/// Whether the measurement's noise of such quantities is a fraction of their value (frequencies); else it is one level
/// for all quantities of the kind.
inline constexpr bool has_relative_noise(QuantityKind kind) {
  return kind == QuantityKind::frequency;
}

/// One number that the model predicts and a test measures.
struct Quantity {
  QuantityKind kind = QuantityKind::other;
  int mode = 0;  ///< number of the mode that it belongs to; 0: none
  std::string location =
      {};                  ///< degree of freedom of a shape's component as the structure names it; of `other` its name
  std::string unit = "-";  ///< for readers: nothing is computed from it

  /// As in the header of a test file: "f1", "phi1:m2", "zeta1".
  std::string name() const;

  bool operator==(const Quantity&) const = default;
};

/// "f1".
///
/// @param mode  from 1
Quantity natural_frequency(int mode, const std::string& unit);

/// "phi1:m2".
///
/// @param location  degree of freedom as the structure names it
/// @param kind   displacement or rotation
Quantity shape_component(int mode, const std::string& location, QuantityKind kind, const std::string& unit);

/// "zeta1", without unit.
Quantity damping_ratio(int mode);

/// A user's own quantity by its name.
Quantity named_quantity(const std::string& name, const std::string& unit);

/// Whether one of these could have this name: a column of a test file that the study does not use.
bool may_name_quantity(const std::string& name);

}  // namespace mottle::model
