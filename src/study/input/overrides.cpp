#include "study/input/overrides.hpp"

#include <sstream>
#include <vector>

#include "mottle/core/error.hpp"
#include "mottle/core/text.hpp"
#include "mottle/core/utf8.hpp"

namespace mottle::study {
namespace {

std::vector<std::string> split_key(const std::string& key, const std::string& assignment) {
  std::vector<std::string> steps;
  std::istringstream stream(key);
  for (std::string step; std::getline(stream, step, '.');) {
    require(!step.empty(), "--set {}: the key '{}' has an empty step", assignment, key);
    steps.push_back(step);
  }
  require(!steps.empty() && key.back() != '.', "--set {}: a key is missing; write --set dotted.key=value", assignment);
  return steps;
}

toml::node* entry_of(toml::array& list, const std::string& step, std::vector<std::string>& known) {
  for (std::size_t i = 0; i < list.size(); ++i) {
    toml::table* entry = list[i].as_table();
    const bool is_named =
        entry != nullptr && entry->get("name") != nullptr && entry->get("name")->value<std::string>() == step;
    if (is_named || std::to_string(i + 1) == step) return &list[i];
    known.push_back(std::to_string(i + 1));
    if (entry != nullptr && entry->get("name") != nullptr) known.back() = entry->get("name")->value_or(known.back());
  }
  return nullptr;
}

/// The value as TOML, or as bare text where it is a word that cannot be a TOML value.
toml::table parse_value(const std::string& value, const std::string& given) {
  const std::string assignment = printable(given);
  try {
    toml::table parsed = toml::parse("value = " + value);
    require(parsed.size() == 1, "--set {}: give one TOML value", assignment);
    return parsed;
  } catch (const toml::parse_error&) {
    const bool is_word = !value.empty() && value.find_first_not_of(
                                               "abcdefghijklmnopqrstuvwxyzABCDEFGHIJKLMNOPQRSTUVWXYZ"
                                               "0123456789_-./") == std::string::npos;
    require(is_word, "--set {}: '{}' is not a TOML value; quote texts: key='\"text\"'", assignment, printable(value));
    return toml::table{{"value", value}};
  }
}

}  // namespace

void apply_override(toml::table& root, const std::string& assignment) {
  const std::size_t equals = assignment.find('=');
  require(equals != std::string::npos && equals > 0, "--set {}: write --set dotted.key=value", assignment);
  const std::vector<std::string> steps = split_key(assignment.substr(0, equals), assignment);
  const toml::table value = parse_value(assignment.substr(equals + 1), assignment);

  toml::table* table = &root;
  for (std::size_t i = 0; i + 1 < steps.size(); ++i) {
    toml::node* next = table->get(steps[i]);
    if (next == nullptr) {
      table->insert(steps[i], toml::table{});
      next = table->get(steps[i]);
    }
    if (toml::array* list = next->as_array(); list != nullptr && i + 2 < steps.size()) {
      std::vector<std::string> known;
      next = entry_of(*list, steps[++i], known);
      require(next != nullptr, "--set {}: '{}' has no entry named or numbered '{}'; it has {}", assignment,
              steps[i - 1], steps[i], known.empty() ? "none" : join(known));
    }
    table = next->as_table();
    require(table != nullptr, "--set {}: '{}' is not a table", assignment, steps[i]);
  }
  table->insert_or_assign(steps.back(), *value.get("value"));
}

}  // namespace mottle::study
