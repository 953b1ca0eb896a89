#include "formats/nastran/case.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <charconv>

#include "formats/nastran/rows.hpp"
#include "mottle/core/text.hpp"

namespace mottle::formats {
namespace nastran {
namespace {

constexpr std::array<std::string_view, 5> k_subcase_names = {"SUBCASE", "SUBCOM", "SYM", "SYMCOM", "REPCASE"};

std::string_view leading_word(std::string_view line) {
  const std::size_t end = line.find_first_of(" \t=(,");
  return line.substr(0, end);
}

/// What follows "(...)" and '=' or blanks.
std::string_view value_behind(std::string_view rest) {
  rest = trim(rest);
  if (rest.starts_with('(')) {
    const std::size_t end = rest.find(')');
    rest = end == std::string_view::npos ? std::string_view{} : trim(rest.substr(end + 1));
  }
  if (rest.starts_with('=') || rest.starts_with(',')) rest = trim(rest.substr(1));
  return rest;
}

/// "K6ROT = 100." and "K6ROT 100." as "K6ROT,100.".
std::string parameter_text(std::string_view value) {
  const std::size_t end = value.find_first_of(" \t=,");
  if (end == std::string_view::npos) return capitals(value);
  const std::size_t start = value.find_first_not_of(" \t=,", end);
  const std::string_view number = start == std::string_view::npos ? std::string_view{} : trim(value.substr(start));
  return capitals(value.substr(0, end)) + ',' + capitals(number);
}

bool is_meant_by(std::string_view written, std::string_view name) {
  return written == name || (written.size() >= 4 && name.starts_with(written));
}

}  // namespace

void read_case_command(std::string_view line, int file, int line_number, NastranDeck& deck) {
  line = trim(line);
  const std::string_view word = leading_word(line);
  CaseCommand command;
  command.name = capitals(word);
  command.file = file;
  command.line = line_number;
  const std::string_view rest = trim(line.substr(word.size()));
  const std::string_view value = value_behind(rest);
  // Modes of a fluid, beside those of the structure.
  if (is_meant_by(command.name, "METHOD") && capitals(rest.substr(0, 4)) == "(FLU") return;
  if (std::find(k_subcase_names.begin(), k_subcase_names.end(), command.name) != k_subcase_names.end()) {
    int id = 0;
    const auto [end, error] = std::from_chars(value.data(), value.data() + value.size(), id);
    if (error != std::errc{} || id < 1) {
      fail({deck.files[static_cast<std::size_t>(file)], line_number},
           fmt::format("{} '{}': a number from 1 is needed", command.name, shown(value)));
    }
    deck.subcases.push_back(id);
    return;
  }
  command.value = command.name == "PARAM" ? parameter_text(value) : std::string(value);
  command.subcase = static_cast<int>(deck.subcases.size()) - 1;
  if (!command.name.empty()) deck.case_control.push_back(std::move(command));
}

}  // namespace nastran

const CaseCommand* NastranDeck::find_command(std::string_view name, int subcase) const {
  if (subcase < 0 && !subcases.empty()) subcase = 0;
  const CaseCommand* above = nullptr;
  const CaseCommand* own = nullptr;
  for (const CaseCommand& command : case_control) {
    if (!nastran::is_meant_by(command.name, name)) continue;
    if (command.subcase < 0) above = &command;
    if (command.subcase >= 0 && command.subcase == subcase) own = &command;
  }
  return own != nullptr ? own : above;
}

std::string NastranDeck::location_of(const BulkCard& card) const {
  return files[static_cast<std::size_t>(card.file)] + ':' + std::to_string(card.line);
}

}  // namespace mottle::formats
