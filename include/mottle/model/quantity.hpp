// Quantities that a model predicts and a test measures: kind, mode and location, and the name that follows from them.
#pragma once

#include <array>
#include <string>

#include "mottle/layers.hpp"

namespace mottle::model {

/// Physical kind of a quantity, apart from its name and unit.
enum class QuantityKind {
  frequency,     ///< natural frequency
  displacement,  ///< component of a mode shape
  rotation,      ///< the same of a rotational degree of freedom: another dimension
  damping_ratio,
  static_displacement,  ///< under a load
  static_rotation,      ///< the same of a rotational degree of freedom
  eigenvalue,           ///< square of the natural angular frequency
  shape_ratio,          ///< of two components of one mode shape, whatever its size and sign
  other,
};

/// What all quantities of a kind have in common; `other` has names of the user's own.
struct QuantityTraits {
  QuantityKind kind;
  const char* stem;         ///< names begin with it, their number follows
  bool has_location;        ///< ":" and a degree of freedom follow the number
  bool has_relative_noise;  ///< the measurement's noise is a fraction of the value; else one level for the whole kind
  bool is_positive;         ///< as every natural frequency: a test that gives 0 or less is mistaken
};

inline constexpr std::array k_quantity_traits = {
    QuantityTraits{QuantityKind::frequency, "f", false, true, true},
    QuantityTraits{QuantityKind::displacement, "phi", true, false, false},
    QuantityTraits{QuantityKind::rotation, "phi", true, false, false},
    QuantityTraits{QuantityKind::damping_ratio, "zeta", false, false, false},
    QuantityTraits{QuantityKind::static_displacement, "u", true, false, false},
    QuantityTraits{QuantityKind::static_rotation, "u", true, false, false},
    QuantityTraits{QuantityKind::eigenvalue, "lambda", false, true, true},
    QuantityTraits{QuantityKind::shape_ratio, "ratio", true, false, false},
};

inline constexpr QuantityTraits traits_of(QuantityKind kind) {
  for (const QuantityTraits& traits : k_quantity_traits) {
    if (traits.kind == kind) return traits;
  }
  return {kind, "", false, false, false};
}

/// Whether a degree of freedom, by the names that all formats have in common, is a rotation: "101:+RX".
bool is_rotation(const std::string& degree_of_freedom);

/// One number that the model predicts and a test measures.
struct Quantity {
  QuantityKind kind = QuantityKind::other;
  int number = 0;                ///< of the mode or load that it belongs to; 0: none
  std::string location = {};     ///< degree of freedom as the structure names it; of `other` the name
  std::string unit = "-";        ///< for readers: nothing is computed from it
  std::string denominator = {};  ///< of a ratio: degree of freedom that it is divided by

  /// As in the header of a test file: "f1", "phi1:m2", "zeta1", "ratio1:m2/m1".
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

/// "lambda1".
Quantity natural_eigenvalue(int mode, const std::string& unit);

/// "ratio1:m2/m1", without unit where both are translations or both rotations.
///
/// @param length  unit of length
Quantity shape_ratio(int mode, const std::string& numerator, const std::string& denominator, const std::string& length);

/// A user's own quantity by its name.
Quantity named_quantity(const std::string& name, const std::string& unit);

/// Whether one of these could have this name: a column of a test file that the study does not use.
bool may_name_quantity(const std::string& name);

}  // namespace mottle::model
