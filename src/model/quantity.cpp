#include "mottle/model/quantity.hpp"

#include <fmt/format.h>

#include <cctype>

namespace mottle {
namespace {

constexpr const char* k_frequency = "f";
constexpr const char* k_shape = "phi";
constexpr const char* k_damping = "zeta";

}  // namespace

Output frequency_output(int mode, const std::string& unit) {
  return {fmt::format("{}{}", k_frequency, mode), unit, OutputKind::frequency, mode};
}

Output shape_output(int mode, const std::string& place, OutputKind kind, const std::string& unit) {
  return {fmt::format("{}{}:{}", k_shape, mode, place), unit, kind, mode};
}

Output damping_output(int mode) {
  return {fmt::format("{}{}", k_damping, mode), "-", OutputKind::damping_ratio, mode};
}

bool may_name_output(const std::string& name) {
  for (const std::string stem : {k_damping, k_shape, k_frequency}) {
    if (!name.starts_with(stem)) continue;
    std::size_t end = stem.size();
    while (end < name.size() && std::isdigit(static_cast<unsigned char>(name[end])) != 0) ++end;
    return end > stem.size() && (end == name.size() || (stem == k_shape && name[end] == ':'));
  }
  return false;
}

}  // namespace mottle
