#include "mottle/model/quantity.hpp"

#include <fmt/format.h>

#include <cctype>

namespace mottle::model {
namespace {

constexpr const char* k_frequency = "f";
constexpr const char* k_shape = "phi";
constexpr const char* k_damping = "zeta";

}  // namespace

std::string Quantity::name() const {
  switch (kind) {
    case QuantityKind::frequency:
      return fmt::format("{}{}", k_frequency, mode);
    case QuantityKind::displacement:
    case QuantityKind::rotation:
      return fmt::format("{}{}:{}", k_shape, mode, location);
    case QuantityKind::damping_ratio:
      return fmt::format("{}{}", k_damping, mode);
    case QuantityKind::other:
      break;
  }
  return location;
}

Quantity natural_frequency(int mode, const std::string& unit) {
  return {.kind = QuantityKind::frequency, .mode = mode, .unit = unit};
}

Quantity shape_component(int mode, const std::string& location, QuantityKind kind, const std::string& unit) {
  return {.kind = kind, .mode = mode, .location = location, .unit = unit};
}

Quantity damping_ratio(int mode) {
  return {.kind = QuantityKind::damping_ratio, .mode = mode};
}

Quantity named_quantity(const std::string& name, const std::string& unit) {
  return {.location = name, .unit = unit};
}

bool may_name_quantity(const std::string& name) {
  for (const std::string stem : {k_damping, k_shape, k_frequency}) {
    if (!name.starts_with(stem)) continue;
    std::size_t end = stem.size();
    while (end < name.size() && std::isdigit(static_cast<unsigned char>(name[end])) != 0) ++end;
    return end > stem.size() && (end == name.size() || (stem == k_shape && name[end] == ':'));
  }
  return false;
}

}  // namespace mottle::model
