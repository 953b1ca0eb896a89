#include "mottle/model/quantity.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cctype>
#include <string_view>

namespace mottle::model {

std::string Quantity::name() const {
  if (kind == QuantityKind::other) return location;
  const QuantityTraits traits = traits_of(kind);
  return fmt::format("{}{}{}{}{}{}", traits.stem, number, traits.has_location ? ":" : "", location,
                     denominator.empty() ? "" : "/", denominator);
}

bool is_rotation(const std::string& degree_of_freedom) {
  const std::size_t colon = degree_of_freedom.rfind(':');
  return colon != std::string::npos && degree_of_freedom.size() == colon + 4 && degree_of_freedom[colon + 2] == 'R';
}

Quantity natural_frequency(int mode, const std::string& unit) {
  return {.kind = QuantityKind::frequency, .number = mode, .unit = unit};
}

Quantity shape_component(int mode, const std::string& location, QuantityKind kind, const std::string& unit) {
  return {.kind = kind, .number = mode, .location = location, .unit = unit};
}

Quantity damping_ratio(int mode) {
  return {.kind = QuantityKind::damping_ratio, .number = mode};
}

Quantity natural_eigenvalue(int mode, const std::string& unit) {
  return {.kind = QuantityKind::eigenvalue, .number = mode, .unit = unit};
}

Quantity shape_ratio(int mode, const std::string& numerator, const std::string& denominator,
                     const std::string& length) {
  std::string unit = "-";
  if (is_rotation(numerator) && !is_rotation(denominator)) unit = "1/" + length;
  if (!is_rotation(numerator) && is_rotation(denominator)) unit = length;
  return {.kind = QuantityKind::shape_ratio,
          .number = mode,
          .location = numerator,
          .unit = unit,
          .denominator = denominator};
}

Quantity named_quantity(const std::string& name, const std::string& unit) {
  return {.location = name, .unit = unit};
}

bool may_name_quantity(const std::string& name) {
  return std::ranges::any_of(k_quantity_traits, [&](const QuantityTraits& traits) {
    const std::size_t digits = std::string_view(traits.stem).size();
    if (!name.starts_with(traits.stem)) return false;
    std::size_t end = digits;
    while (end < name.size() && std::isdigit(static_cast<unsigned char>(name[end])) != 0) ++end;
    return end > digits && (end == name.size() || (traits.has_location && name[end] == ':'));
  });
}

}  // namespace mottle::model
