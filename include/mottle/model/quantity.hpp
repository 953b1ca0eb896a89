// What a model predicts and a test measures: kind, mode and place, and the name that follows from them.
#pragma once

#include <string>

namespace mottle {

/// What an output is, whatever it is called and in whatever unit its numbers are.
enum class OutputKind {
  frequency,
  displacement,  ///< component of a mode shape
  rotation,      ///< the same of a rotational degree of freedom: another dimension
  damping_ratio,
  other,
};

/// Whether the measurement's noise of such outputs is a fraction of their value (frequencies); else it is one level for
/// all outputs of the kind.
inline constexpr bool has_relative_noise(OutputKind kind) {
  return kind == OutputKind::frequency;
}

/// One quantity that the model predicts and a test measures. Nothing is computed from its name or its unit.
struct Output {
  std::string name;  ///< as in the header of a test file
  std::string unit;  ///< "Hz", "1/sqrt(kg)", "-"
  OutputKind kind = OutputKind::other;
  int mode = 0;  ///< number of the mode that it belongs to; 0: none
};

/// "f1".
///
/// @param mode  from 1
Output frequency_output(int mode, const std::string& unit);

/// "phi1:m2".
///
/// @param place  degree of freedom as the structure names it
/// @param kind   displacement or rotation
Output shape_output(int mode, const std::string& place, OutputKind kind, const std::string& unit);

/// "zeta1", without unit.
Output damping_output(int mode);

/// Whether one of these could have this name: a column of a test file that the study does not use.
bool may_name_output(const std::string& name);

}  // namespace mottle
