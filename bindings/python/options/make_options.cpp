// Writes the module mottle.options from the methods' option tables: each method's options as a typed dictionary.
#include <fmt/format.h>

#include <algorithm>
#include <cctype>
#include <fstream>
#include <iostream>
#include <sstream>
#include <string>
#include <vector>

#include "mottle/core/text.hpp"
#include "mottle/updating/methods/updater.hpp"

namespace {

using mottle::OptionDescription;

/// "maximum-likelihood" -> "MaximumLikelihood".
std::string class_name(const std::string& method) {
  std::string name;
  bool is_first = true;
  for (const char letter : method) {
    if (letter != '-') name += is_first ? static_cast<char>(std::toupper(static_cast<unsigned char>(letter))) : letter;
    is_first = letter == '-';
  }
  return name;
}

/// The type of what OptionTable calls allowed: `"a" | "b"`, `true | false`, `whole number, >= 1`, `>= 0`.
std::string type_of(const OptionDescription& option) {
  std::vector<std::string> words;
  std::string rest = option.allowed;
  while (rest.starts_with('"')) {
    const std::size_t end = rest.find('"', 1) + 1;
    words.push_back(rest.substr(0, end));
    rest = rest.substr(std::min(rest.size(), end + std::string(" | ").size()));
  }
  std::vector<std::string> types;
  if (!words.empty()) types.push_back(fmt::format("Literal[{}]", mottle::join(words)));
  if (rest == "true | false") {
    types.emplace_back("bool");
  } else if (!rest.empty()) {
    types.emplace_back(rest.starts_with("whole number") ? "int" : "float");
  }
  return types.size() == 1 ? types.front() : fmt::format("Union[{}]", mottle::join(types));
}

/// Lines of at most 100 characters from the words of a text, the first after `begin`, the others indented.
std::string wrapped(const std::string& begin, const std::string& text, std::size_t indent) {
  constexpr std::size_t k_width = 100;
  std::string all, line = begin;
  std::istringstream words(text);
  for (std::string word; words >> word;) {
    if (line.size() + word.size() >= k_width) {
      all += line + '\n';
      line = std::string(indent, ' ') + word;
    } else {
      line += line == begin && begin.ends_with('"') ? word : ' ' + word;  // a docstring begins at its quotes
    }
  }
  return all + line + '\n';
}

void write(std::ostream& out, const mottle::updating::MethodEntry& method) {
  out << fmt::format("\n\nclass {}(TypedDict, total=False):\n", class_name(method.name));
  out << wrapped("    \"\"\"", method.summary, 4) << "\n    Attributes:\n";
  for (const OptionDescription& option : method.options) {
    const std::string unit = option.unit == "-" ? "" : fmt::format(" In: {}.", option.unit);
    out << wrapped(
        fmt::format("        {}:", option.name),
        fmt::format("{}{} Allowed: {}. Default: {}.", option.meaning, unit, option.allowed, option.default_value), 12);
  }
  out << "    \"\"\"\n\n";
  for (const OptionDescription& option : method.options)
    out << fmt::format("    {}: {}\n", option.name, type_of(option));
}

}  // namespace

int main(int count, char** arguments) {
  if (count != 2) {
    std::cerr << "usage: mottle_python_options FILE\n";
    return 2;
  }
  std::ofstream out(arguments[1]);
  out << "\"\"\"Options of each updating method, made from the tables that the engine reads them by.\n\n"
         "    mottle.update(..., method=\"bayes\", options=mottle.options.Bayes(particles=500))\n\n"
         "Each is a dictionary, which editors complete and type checkers check; `mottle.methods()` has the same as "
         "data.\n"
         "\"\"\"\n\nfrom typing import Literal, TypedDict, Union\n\n__all__ = [\n";
  for (const auto& method : mottle::updating::updating_methods())
    out << fmt::format("    \"{}\",\n", class_name(method.name));
  out << "]\n";
  for (const auto& method : mottle::updating::updating_methods()) write(out, method);
  out.close();
  if (!out) std::cerr << arguments[1] << ": cannot be written\n";
  return out ? 0 : 3;
}
