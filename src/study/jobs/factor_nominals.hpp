// What relative parameters multiply.
#pragma once

#include <optional>
#include <string>
#include <vector>

#include "mottle/layers.hpp"
#include "mottle/study/input/study.hpp"

namespace mottle::study {

/// The number of the model that a factor multiplies.
struct FactorNominal {
  double value = 0.0;
  std::string unit;
};

/// Nothing of a parameter that is no factor, or that multiplies different numbers or one without a unit [parameter].
/// Reads the model's files where there is a factor.
std::vector<std::optional<FactorNominal>> factor_nominals(const Study& study);

}  // namespace mottle::study
