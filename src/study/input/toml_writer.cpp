#include "study/input/toml_writer.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <sstream>
#include <tuple>

namespace mottle::study {
namespace {

std::string quoted(const std::string& text) {
  std::string result = "\"";
  for (const char c : text) {
    if (c == '"' || c == '\\') {
      result += '\\';
      result += c;
    } else if (static_cast<unsigned char>(c) < 0x20 || c == 0x7f) {
      result += fmt::format("\\u{:04X}", static_cast<unsigned char>(c));
    } else {
      result += c;
    }
  }
  return result + '"';
}

std::string key_text(const std::string& key) {
  const bool is_bare = !key.empty() && key.find_first_not_of(
                                           "abcdefghijklmnopqrstuvwxyzABCDEFGHIJKLMNOPQRSTUVWXYZ"
                                           "0123456789_-") == std::string::npos;
  return is_bare ? key : quoted(key);
}

std::string real_text(double value) {
  if (std::isnan(value)) return "nan";
  if (std::isinf(value)) return value > 0.0 ? "inf" : "-inf";
  std::string text = fmt::format("{}", value);
  if (text.find_first_of(".e") == std::string::npos) text += ".0";
  return text;
}

bool is_list_of_sections(const toml::node& node) {
  const toml::array* list = node.as_array();
  if (list == nullptr || list->empty()) return false;
  return std::all_of(list->begin(), list->end(),
                     [](const toml::node& entry) { return entry.is_table() && !entry.as_table()->is_inline(); });
}

bool is_section(const toml::node& node) {
  return node.is_table() && !node.as_table()->is_inline();
}

/// A list of tables takes one line an entry.
std::string value_text(const toml::node& node) {
  const toml::array* list = node.as_array();
  const bool has_tables = list != nullptr && !list->empty() && list->front().is_table();
  if (!has_tables) return toml_on_one_line(node);
  std::string text = "[\n";
  for (const toml::node& entry : *list) text += fmt::format("  {},\n", toml_on_one_line(entry));
  return text + "]";
}

void write_section(const toml::table& table, const std::string& path, std::string& text) {
  const std::vector<std::string> keys = keys_in_file_order(table);
  for (const std::string& key : keys) {
    const toml::node& node = *table.get(key);
    if (!is_section(node) && !is_list_of_sections(node)) {
      text += fmt::format("{} = {}\n", key_text(key), value_text(node));
    }
  }
  for (const std::string& key : keys) {
    const toml::node& node = *table.get(key);
    const std::string inner = path.empty() ? key_text(key) : path + '.' + key_text(key);
    if (is_section(node)) {
      text += fmt::format("\n[{}]\n", inner);
      write_section(*node.as_table(), inner, text);
    } else if (is_list_of_sections(node)) {
      for (const toml::node& entry : *node.as_array()) {
        text += fmt::format("\n[[{}]]\n", inner);
        write_section(*entry.as_table(), inner, text);
      }
    }
  }
}

}  // namespace

std::vector<std::string> keys_in_file_order(const toml::table& table) {
  std::vector<std::tuple<toml::source_index, toml::source_index, std::string>> places;
  for (const auto& [key, node] : table) {
    const toml::source_position begin = node.source().begin;
    places.emplace_back(begin.line, begin.column, std::string(key.str()));
  }
  std::sort(places.begin(), places.end());
  std::vector<std::string> keys;
  for (const auto& [line, column, key] : places) keys.push_back(key);
  return keys;
}

std::string toml_on_one_line(const toml::node& node) {
  std::string text;
  if (const toml::table* table = node.as_table()) {
    for (const std::string& key : keys_in_file_order(*table)) {
      text += fmt::format("{}{} = {}", text.empty() ? "" : ", ", key_text(key), toml_on_one_line(*table->get(key)));
    }
    return text.empty() ? "{}" : fmt::format("{{ {} }}", text);
  }
  if (const toml::array* list = node.as_array()) {
    for (const toml::node& entry : *list) {
      text += fmt::format("{}{}", text.empty() ? "" : ", ", toml_on_one_line(entry));
    }
    return fmt::format("[{}]", text);
  }
  if (const auto string = node.value_exact<std::string>()) return quoted(*string);
  if (const auto integer = node.value_exact<std::int64_t>()) return fmt::format("{}", *integer);
  if (const auto real = node.value_exact<double>()) return real_text(*real);
  std::ostringstream stream;  // true, false, dates and times
  node.visit([&stream](const auto& value) { stream << value; });
  return stream.str();
}

std::string toml_document(const toml::table& root) {
  std::string text;
  write_section(root, "", text);
  return text;
}

}  // namespace mottle::study
