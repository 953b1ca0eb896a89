#include "mottle/core/rounding.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <cstdlib>
#include <string>

namespace mottle {

int digits_of_range(double range, double largest) {
  constexpr int k_digits = 6;
  constexpr int k_max_digits = 17;
  const double leading = range > 0.0 && std::isfinite(range) ? std::ceil(std::log10(largest / range)) : k_max_digits;
  return static_cast<int>(std::clamp<double>(k_digits + leading, k_digits, k_max_digits));
}

double rounded(double value, int digits) {
  if (!std::isfinite(value)) return value;
  const std::string text = fmt::format("{:.{}g}", value, digits);
  return std::strtod(text.c_str(), nullptr);
}

}  // namespace mottle
