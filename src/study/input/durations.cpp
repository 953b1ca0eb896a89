#include "study/input/durations.hpp"

#include <algorithm>
#include <cmath>
#include <map>

#include "mottle/core/text.hpp"

namespace mottle::study {

std::chrono::milliseconds read_duration(TomlReader& reader, const std::string& key,
                                        std::chrono::milliseconds fallback) {
  const std::string allowed = "a time > 0 like \"30 s\", \"10 min\" or \"2 h\", or a number of seconds";
  const toml::node* node = reader.raw(key);
  if (node == nullptr) return fallback;
  double seconds = node->value<double>().value_or(0.0);
  if (const auto text = node->value_exact<std::string>()) {
    const std::size_t unit_at = std::min(text->find_first_not_of("0123456789.eE+-"), text->size());
    std::string unit = text->substr(unit_at);
    unit.erase(0, std::min(unit.find_first_not_of(' '), unit.size()));
    const std::map<std::string, double> units{{"s", 1.0}, {"min", 60.0}, {"h", 3600.0}};
    if (!units.contains(unit) || !parse_number(text->substr(0, unit_at), seconds)) reader.fail_value(key, allowed);
    seconds *= units.at(unit);
  }
  if (!(seconds >= 0.001 && seconds <= 1e8)) reader.fail_value(key, allowed);
  return std::chrono::milliseconds(std::llround(1000.0 * seconds));
}

}  // namespace mottle::study
