// [model] of kind "umbridge": a model behind UM-Bridge servers.
#include "study/models/umbridge/read_umbridge.hpp"

#include <cmath>
#include <nlohmann/json.hpp>
#include <set>

#include "study/input/durations.hpp"

namespace mottle::study {
namespace {

/// TOML has dates and times, nan and infinities; JSON has not.
nlohmann::json json_of(const toml::node& node, const TomlReader& reader) {
  if (const toml::table* table = node.as_table()) {
    nlohmann::json object = nlohmann::json::object();
    for (const auto& [key, value] : *table) object[std::string(key.str())] = json_of(value, reader);
    return object;
  }
  if (const toml::array* array = node.as_array()) {
    nlohmann::json list = nlohmann::json::array();
    for (const toml::node& value : *array) list.push_back(json_of(value, reader));
    return list;
  }
  if (const auto text = node.value_exact<std::string>()) return *text;
  if (const auto flag = node.value_exact<bool>()) return *flag;
  if (const auto whole = node.value_exact<std::int64_t>()) return *whole;
  const auto number = node.value_exact<double>();
  if (!number || !std::isfinite(*number)) {
    reader.fail("config",
                fmt::format("{} cannot be said in JSON, which has no dates, nan or infinities", toml_text(node)));
  }
  return *number;
}

std::string read_config(TomlReader& reader) {
  const toml::node* node = reader.raw("config");
  if (node == nullptr) return "{}";
  if (!node->is_table()) reader.fail_value("config", "a table, like { level = 1 }");
  return json_of(*node, reader).dump();
}

InputEntry read_entry(const toml::node& node, const TomlReader& reader) {
  if (const auto name = node.value_exact<std::string>(); name && !name->empty()) return {.parameter = *name};
  const auto number = node.value<double>();
  if (node.is_string() || node.is_boolean() || !number || !std::isfinite(*number)) {
    reader.fail("inputs", fmt::format("{} is neither a parameter's name nor a number", toml_text(node)));
  }
  return {.constant = *number};
}

/// One list, or a list of lists: one a vector.
std::vector<std::vector<InputEntry>> read_inputs(TomlReader& reader) {
  const toml::node* node = reader.raw("inputs");
  if (node == nullptr) return {};
  const toml::array* list = node->as_array();
  const std::string allowed =
      "parameters' names and numbers, like [\"k1\", 2.5, \"k2\"], or a list of such lists, one for each input vector";
  if (list == nullptr || list->empty()) reader.fail_value("inputs", allowed);
  std::vector<std::vector<InputEntry>> inputs;
  const bool is_nested = list->front().is_array();
  if (!is_nested) inputs.emplace_back();
  for (const toml::node& part : *list) {
    if (part.is_array() != is_nested) reader.fail_value("inputs", allowed);
    if (!is_nested) {
      inputs.back().push_back(read_entry(part, reader));
      continue;
    }
    inputs.emplace_back();
    for (const toml::node& entry : *part.as_array()) inputs.back().push_back(read_entry(entry, reader));
  }
  return inputs;
}

std::vector<HttpAddress> read_addresses(TomlReader& reader) {
  std::vector<HttpAddress> addresses;
  std::set<std::string> seen;
  for (const std::string& url : reader.texts("urls")) {
    try {
      addresses.push_back(parse_http_address(url));
    } catch (const InvalidInput& error) {
      reader.fail("urls", error.what());
    }
    if (seen.insert(addresses.back().text()).second) continue;
    reader.fail("urls", fmt::format("names {} twice; name each server once, model.parallel says how many requests are "
                                    "under way at once",
                                    addresses.back().text()));
  }
  return addresses;
}

}  // namespace

UmbridgeServer read_umbridge(TomlReader& reader) {
  using Quantity = FrequencyRule::Quantity;
  UmbridgeServer server;
  server.urls = read_addresses(reader);
  server.name = reader.text_or("name", "");
  server.config = read_config(reader);
  server.inputs = read_inputs(reader);
  if (reader.raw("output") != nullptr) {
    server.output = static_cast<int>(reader.integer_or("output", 0, {.lower = 0.0, .upper = 1e6}));
  }
  server.quantity = std::vector{Quantity::hertz, Quantity::radians,
                                Quantity::eigenvalue}[reader.choice("quantity", {"Hz", "rad/s", "eigenvalue"}, 0)];
  server.uses_derivatives = reader.flag_or("derivatives", true);
  server.timeout = read_duration(reader, "timeout", server.timeout);
  server.retries = static_cast<int>(reader.integer_or("retries", server.retries, {.lower = 0.0, .upper = 100.0}));
  const auto count = static_cast<std::int64_t>(server.urls.size());
  server.parallel = static_cast<int>(reader.integer_or("parallel", count, {.lower = 1.0, .upper = 1000.0}));
  server.max_failed_fraction =
      reader.number_or("largest_failed_part", server.max_failed_fraction, {.lower = 0.0, .upper = 1.0});
  server.difference_step = reader.number_or("difference_step", server.difference_step, {.lower = 1e-6, .upper = 1.0});
  return server;
}

}  // namespace mottle::study
