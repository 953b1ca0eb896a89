#include "mottle/core/options.hpp"

#include <cmath>

namespace mottle {

std::string option_text(const OptionValue& value) {
  if (const auto* flag = std::get_if<bool>(&value)) return *flag ? "true" : "false";
  if (const auto* integer = std::get_if<std::int64_t>(&value)) return fmt::format("{}", *integer);
  if (const auto* real = std::get_if<double>(&value)) return number_text(*real);
  std::string quoted = "\"";
  for (const char c : std::get<std::string>(value)) {
    if (c == '"' || c == '\\') quoted += '\\';
    const bool is_control = static_cast<unsigned char>(c) < 0x20 || c == 0x7f;
    quoted += is_control ? fmt::format("\\u{:04X}", static_cast<unsigned char>(c)) : std::string(1, c);
  }
  return quoted + '"';
}

std::string refused_text(const OptionValue& value, const std::string& allowed) {
  std::string text = option_text(value);
  const bool looks_whole =
      std::holds_alternative<double>(value) && text.find_first_not_of("-0123456789") == std::string::npos;
  if (looks_whole && allowed.find("whole number") != std::string::npos) text += ".0";
  return text;
}

std::string OptionRange::text() const {
  std::string low = fmt::format("{} {}", excludes_lower ? ">" : ">=", number_text(lower));
  if (std::isinf(lower) && std::isinf(upper)) return "any number";
  if (std::isinf(upper)) return low;
  if (std::isinf(lower)) return fmt::format("<= {}", number_text(upper));
  return fmt::format("{} and <= {}", low, number_text(upper));
}

bool OptionRange::contains(double value) const {
  return std::isfinite(value) && value <= upper && (excludes_lower ? value > lower : value >= lower);
}

}  // namespace mottle
