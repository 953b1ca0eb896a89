#include "study/input/toml_reader.hpp"

#include <algorithm>

#include "mottle/core/text.hpp"
#include "study/input/toml_writer.hpp"

namespace mottle::study {
namespace {

/// Lines, escape sequences and the like, which would break the tables and the terminal that show them.
bool has_control_character(std::string_view text) {
  return std::any_of(text.begin(), text.end(),
                     [](char c) { return static_cast<unsigned char>(c) < 0x20 || c == 0x7f; });
}

}  // namespace

std::string toml_text(const toml::node& node) {
  constexpr std::size_t k_longest = 60;
  std::string text = toml_on_one_line(node);
  if (text.size() <= k_longest) return text;
  std::size_t end = k_longest;
  while (end > 0 && (static_cast<unsigned char>(text[end]) & 0xC0U) == 0x80U) --end;  // not within a character
  return text.substr(0, end) + "...";
}

std::string TomlReader::where() const {
  const auto line = table_.source().begin.line;
  return line > 0 && !path_.empty() ? fmt::format("{}:{}: [{}]", file_, line, path_)
                                    : fmt::format("{}:{}", file_, path_.empty() ? "" : " [" + path_ + "]");
}

std::string TomlReader::where(const std::string& key) const {
  const toml::node* node = table_.get(key);
  auto line = node != nullptr ? node->source().begin.line : table_.source().begin.line;
  if (node == nullptr && path_.empty()) line = 0;
  if (node != nullptr && line == 0) return "--set " + dotted(key);
  return line > 0 ? fmt::format("{}:{}: {}", file_, line, dotted(key)) : fmt::format("{}: {}", file_, dotted(key));
}

std::string TomlReader::where_of(const std::string& key) const {
  const toml::node* node = table_.get(key);
  const auto line = node != nullptr ? node->source().begin.line : 0;
  return line > 0 ? fmt::format("{}:{}: [{}]", file_, line, path_) : fmt::format("--set [{}]", path_);
}

void TomlReader::fail(const std::string& key, const std::string& message) const {
  throw InvalidInput(fmt::format("{}: {}", where(key), message));
}

void TomlReader::fail_value(const std::string& key, const std::string& allowed) const {
  const toml::node* node = table_.get(key);
  const std::string found = node != nullptr ? toml_text(*node) : "nothing";
  fail(key, fmt::format("found {}, allowed is {}", found, allowed));
}

const toml::node* TomlReader::find(const std::string& key) {
  asked_.push_back(key);
  return table_.get(key);
}

const toml::node& TomlReader::need(const std::string& key) {
  const toml::node* node = find(key);
  if (node != nullptr) return *node;
  for (const auto& [name, value] : table_) {
    const std::string present(name.str());
    const bool is_known = std::find(asked_.begin(), asked_.end(), present) != asked_.end();
    if (!is_known && nearest_name(present, {key}) == key) {
      fail(present, fmt::format("is not known here; did you mean '{}', which is missing?", key));
    }
  }
  fail(key, "is missing");
}

const toml::node* TomlReader::raw(const std::string& key) {
  return find(key);
}

std::string TomlReader::text(const std::string& key) {
  const auto value = need(key).value_exact<std::string>();
  if (!value) fail_value(key, "a text in quotes");
  return *value;
}

std::string TomlReader::name(const std::string& key) {
  std::string value = text(key);
  if (has_control_character(value)) fail_value(key, "a name without control characters");
  return value;
}

std::string TomlReader::text_or(const std::string& key, const std::string& fallback) {
  return find(key) != nullptr ? text(key) : fallback;
}

std::vector<std::string> TomlReader::texts(const std::string& key) {
  const toml::node& node = need(key);
  if (const auto single = node.value_exact<std::string>()) return {*single};
  std::vector<std::string> result;
  const toml::array* list = node.as_array();
  if (list == nullptr || list->empty()) fail_value(key, "a text in quotes or a list of them");
  for (const toml::node& entry : *list) {
    const auto value = entry.value_exact<std::string>();
    if (!value) fail_value(key, "a text in quotes or a list of them");
    result.push_back(*value);
  }
  return result;
}

double TomlReader::number(const std::string& key, const OptionRange& range) {
  const toml::node& node = need(key);
  const auto value = node.is_number() ? node.value<double>() : std::nullopt;
  if (!value || !range.contains(*value)) {
    fail_value(key, range.text() == "any number" ? "a finite number" : "a number " + range.text());
  }
  return *value;
}

double TomlReader::number_or(const std::string& key, double fallback, const OptionRange& range) {
  return find(key) != nullptr ? number(key, range) : fallback;
}

std::int64_t TomlReader::integer_or(const std::string& key, std::int64_t fallback, const OptionRange& range) {
  const toml::node* node = find(key);
  if (node == nullptr) return fallback;
  const auto value = node->value_exact<std::int64_t>();
  if (!value || !range.contains(static_cast<double>(*value))) fail_value(key, "a whole number " + range.text());
  return *value;
}

bool TomlReader::flag_or(const std::string& key, bool fallback) {
  const toml::node* node = find(key);
  if (node == nullptr) return fallback;
  const auto value = node->value_exact<bool>();
  if (!value) fail_value(key, "true or false");
  return *value;
}

std::vector<double> TomlReader::numbers(const std::string& key) {
  const toml::node& node = need(key);
  const toml::array* list = node.as_array();
  if (list == nullptr) fail_value(key, "a list of numbers");
  std::vector<double> result;
  for (const toml::node& entry : *list) {
    const auto value = entry.is_number() ? entry.value<double>() : std::nullopt;
    if (!value || std::isnan(*value)) fail_value(key, "a list of numbers");
    result.push_back(*value);
  }
  return result;
}

std::vector<int> TomlReader::mode_numbers(const std::string& key, std::string_view what) {
  const toml::node* node = find(key);
  if (node == nullptr) return {};
  const toml::array* list = node->as_array();
  if (list == nullptr) fail_value(key, fmt::format("a list of {} numbers, like [1, 2, 3]", what));
  std::vector<int> result;
  for (const toml::node& entry : *list) {
    const auto value = entry.value_exact<std::int64_t>();
    if (!value || *value < 1 || *value > 1000000) {
      fail_value(key, fmt::format("a list of {} numbers >= 1, like [1, 2, 3]", what));
    }
    result.push_back(static_cast<int>(*value));
  }
  return result;
}

std::size_t TomlReader::choice(const std::string& key, const std::vector<std::string>& choices, std::size_t fallback) {
  const toml::node* node = find(key);
  if (node == nullptr) return fallback;
  const auto value = node->value_exact<std::string>();
  const auto found = value ? std::find(choices.begin(), choices.end(), *value) : choices.end();
  if (found != choices.end()) return static_cast<std::size_t>(std::distance(choices.begin(), found));
  const std::string nearest = value ? nearest_name(*value, choices) : "";
  fail_value(key, fmt::format("\"{}\"{}", join(choices, "\" | \""),
                              nearest.empty() ? "" : fmt::format("; did you mean \"{}\"?", nearest)));
}

std::map<std::string, double> TomlReader::number_map(const std::string& key, const OptionRange& range) {
  std::map<std::string, double> result;
  if (find(key) == nullptr) return result;
  TomlReader entries = table(key);
  for (const auto& [name, node] : entries.table_) {
    if (has_control_character(name.str())) fail_value(key, "names without control characters");
    result[std::string(name.str())] = entries.number(std::string(name.str()), range);
  }
  return result;
}

OptionValues TomlReader::option_values() {
  OptionValues values;
  for (const auto& [name, node] : table_) {
    const std::string key(name.str());
    if (const auto flag = node.value_exact<bool>()) {
      values[key] = *flag;
    } else if (const auto integer = node.value_exact<std::int64_t>()) {
      values[key] = *integer;
    } else if (const auto real = node.value_exact<double>()) {
      values[key] = *real;
    } else if (const auto text = node.value_exact<std::string>()) {
      values[key] = *text;
    } else {
      fail_value(key, "a single number, text, true or false");
    }
  }
  return values;
}

TomlReader TomlReader::table(const std::string& key) {
  const toml::node& node = need(key);
  if (!node.is_table()) fail_value(key, fmt::format("a table: [{}] or {} = {{ ... }}", dotted(key), key));
  return {*node.as_table(), file_, dotted(key)};
}

std::vector<TomlReader> TomlReader::tables(const std::string& key) {
  const toml::node* node = find(key);
  if (node == nullptr) return {};
  const toml::array* list = node->as_array();
  if (list == nullptr) fail_value(key, fmt::format("a list of tables: [[{}]] or {} = [ {{ ... }} ]", dotted(key), key));
  std::vector<TomlReader> readers;
  for (std::size_t i = 0; i < list->size(); ++i) {
    const toml::table* entry = list->get(i)->as_table();
    if (entry == nullptr)
      fail_value(key, fmt::format("a list of tables: [[{}]] or {} = [ {{ ... }} ]", dotted(key), key));
    readers.emplace_back(*entry, file_, fmt::format("{}.{}", dotted(key), i + 1));
  }
  return readers;
}

TomlReader TomlReader::table_in(const std::string& key, std::size_t entry) const {
  return {*table_.get(key)->as_array()->get(entry)->as_table(), file_, fmt::format("{}.{}", dotted(key), entry + 1)};
}

std::vector<std::string> TomlReader::sub_table_names() const {
  std::vector<std::string> names;
  for (const auto& [name, node] : table_) {
    if (node.is_table()) names.emplace_back(name.str());
  }
  return names;
}

std::vector<std::string> TomlReader::keys() const {
  std::vector<std::string> names;
  for (const auto& entry : table_) names.emplace_back(entry.first.str());
  return names;
}

void TomlReader::finish() const {
  for (const auto& [name, node] : table_) {
    const std::string key(name.str());
    if (std::find(asked_.begin(), asked_.end(), key) != asked_.end()) continue;
    std::vector<std::string> known = asked_;
    std::sort(known.begin(), known.end());
    known.erase(std::unique(known.begin(), known.end()), known.end());
    const std::string nearest = nearest_name(key, known);
    fail(key, fmt::format("is not known here{} Known: {}",
                          nearest.empty() ? "." : fmt::format("; did you mean '{}'?", nearest), join(known)));
  }
}

}  // namespace mottle::study
