// mottle methods
#include <fmt/format.h>

#include <memory>
#include <nlohmann/json.hpp>

#include "common_options.hpp"
#include "mottle/updating/methods/updater.hpp"

namespace mottle::app {
namespace {

void print_as_text() {
  for (const MethodEntry& method : updating_methods()) {
    fmt::print("{}\n  {}\n", method.name, method.summary);
    for (const OptionDescription& option : method.options) {
      fmt::print("  [update.{}] {} = {}   ({}; unit: {})\n      {}\n", method.name, option.name, option.default_value,
                 option.allowed, option.unit, option.meaning);
    }
  }
}

void print_as_markdown() {
  for (const MethodEntry& method : updating_methods()) {
    fmt::print("## `{}`\n\n{}\n\n| option | default | allowed | unit | meaning |\n|---|---|---|---|---|\n", method.name,
               method.summary);
    for (const OptionDescription& option : method.options) {
      std::string allowed;
      for (const char c : option.allowed) allowed += c == '|' ? "\\|" : std::string(1, c);
      fmt::print("| `{}` | `{}` | {} | {} | {} |\n", option.name, option.default_value, allowed, option.unit,
                 option.meaning);
    }
    fmt::print("\n");
  }
}

void print_as_json() {
  nlohmann::ordered_json methods = nlohmann::ordered_json::array();
  for (const MethodEntry& method : updating_methods()) {
    nlohmann::ordered_json options = nlohmann::ordered_json::array();
    for (const OptionDescription& option : method.options) {
      options.push_back({{"name", option.name},
                         {"unit", option.unit},
                         {"allowed", option.allowed},
                         {"default", option.default_value},
                         {"meaning", option.meaning}});
    }
    methods.push_back({{"name", method.name}, {"summary", method.summary}, {"options", options}});
  }
  fmt::print("{}\n", methods.dump());
}

}  // namespace

void add_methods(CLI::App& app) {
  CLI::App* verb = app.add_subcommand("methods", "list every updating method and its options");
  const auto is_json = std::make_shared<bool>(false);
  const auto is_markdown = std::make_shared<bool>(false);
  verb->add_flag("--json", *is_json, "print as one line of JSON");
  verb->add_flag("--markdown", *is_markdown, "print as the reference page");
  verb->callback([is_json, is_markdown] {
    if (*is_json) {
      print_as_json();
    } else if (*is_markdown) {
      print_as_markdown();
    } else {
      print_as_text();
    }
  });
}

}  // namespace mottle::app
