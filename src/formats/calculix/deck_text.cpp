// A CalculixDeck written with other numbers.
#include <algorithm>
#include <optional>

#include "formats/calculix/abaqus.hpp"
#include "formats/calculix/steps.hpp"
#include "formats/matrices/matrix_text.hpp"
#include "mottle/core/text.hpp"
#include "mottle/formats/calculix/deck.hpp"

namespace mottle::formats {
namespace {

/// The deck's lines with texts in place of numbers.
std::vector<std::string> replaced_lines(const CalculixDeck& deck, std::vector<CalculixReplacement> replacements) {
  std::vector<std::string> lines;
  for (const CalculixDeck::Line& line : deck.lines) lines.push_back(line.text);
  std::sort(replacements.begin(), replacements.end(), [](const CalculixReplacement& a, const CalculixReplacement& b) {
    return a.number.line != b.number.line ? a.number.line < b.number.line : a.number.begin > b.number.begin;
  });
  for (const auto& [number, text] : replacements) lines[number.line].replace(number.begin, number.length, text);
  return lines;
}

/// Put in place of lines that are not used, so that the others keep their numbers.
constexpr const char* k_left_out = "**";

/// The lines of the model and of the steps that are used.
std::vector<std::string> used_lines(const CalculixDeck& deck, std::vector<CalculixReplacement> replacements) {
  std::vector<std::string> lines = replaced_lines(deck, std::move(replacements));
  const KeptLines kept(deck);
  for (std::size_t i = 0; i < lines.size(); ++i) {
    if (is_comment(lines[i]) || !kept.contains(i)) lines[i] = k_left_out;
  }
  return lines;
}

std::string text_of(const CalculixDeck& deck, const std::vector<std::string>& lines) {
  std::string text;
  for (const std::string& line : is_abaqus_deck(deck) ? flatten(deck, lines).lines : lines) text += line + '\n';
  return text;
}

/// The deck with one step, whose procedure and data lines are these.
std::string one_step_deck(const CalculixDeck& deck, const std::vector<CalculixChange>& changes,
                          const std::string& procedure) {
  std::vector<CalculixReplacement> replacements;
  for (const CalculixChange& change : changes)
    replacements.push_back({change.number, fmt::format("{:.13e}", change.value)});
  const std::optional<Step> step = find_step(deck);
  std::vector<std::string> lines = used_lines(deck, std::move(replacements));
  for (std::size_t i = 0; i < lines.size(); ++i) {
    const std::size_t open = lines[i].find("{{");
    if (open == std::string::npos) continue;
    refuse(deck, i,
           fmt::format("no parameter fills '{}'", lines[i].substr(open, lines[i].find("}}", open) + 2 - open)));
  }
  if (!step) return text_of(deck, lines) + fmt::format("*STEP\n{}\n*END STEP\n", procedure);
  for (const std::size_t line : data_lines(deck, step->procedure)) lines[line] = k_left_out;
  lines[step->procedure] = procedure;
  return text_of(deck, lines);
}

}  // namespace

std::string matrix_storage_deck(const CalculixDeck& deck, const std::vector<CalculixChange>& changes) {
  return one_step_deck(deck, changes, "*FREQUENCY, SOLVER=MATRIXSTORAGE");
}

std::string modes_deck(const CalculixDeck& deck, const std::vector<CalculixChange>& changes, int modes) {
  return one_step_deck(deck, changes, fmt::format("*FREQUENCY\n{}", modes));
}

std::string deck_without_steps(const CalculixDeck& deck) {
  std::vector<std::string> lines = used_lines(deck, {});
  for (const Step& step : find_steps(deck)) {
    std::fill(lines.begin() + static_cast<std::ptrdiff_t>(step.begin),
              lines.begin() + static_cast<std::ptrdiff_t>(step.end), k_left_out);
  }
  return text_of(deck, lines) + "*STEP\n*NO ANALYSIS\n*END STEP\n";
}

std::string deck_with_replacements(const CalculixDeck& deck, const std::vector<CalculixReplacement>& replacements) {
  const std::optional<Step> step = find_step(deck);
  if (!step) throw FormatError(deck.files.front(), 0, "has no step; modes come from a *FREQUENCY step");
  std::vector<std::string> lines = used_lines(deck, replacements);
  for (const std::size_t line : data_lines(deck, step->procedure)) lines[line].resize(end_of_count(lines[line]));
  return text_of(deck, lines);
}

std::string with_decimal_point(std::string number) {
  if (number.empty() || number.find('.') != std::string::npos) return number;
  return number.insert(std::min(number.find_first_of("eEdD"), number.size()), ".");
}

bool writes_displacements(const CalculixDeck& deck) {
  if (is_abaqus_deck(deck)) return true;  // flatten() asks for them
  const KeptLines kept(deck);
  for (std::size_t i = 0; i < deck.lines.size(); ++i) {
    if (!kept.contains(i)) continue;
    const std::optional<Keyword> keyword = keyword_of(deck.lines[i].text);
    if (!keyword || (keyword->name != "NODE FILE" && keyword->name != "NODE OUTPUT")) continue;
    for (const std::size_t line : data_lines(deck, i)) {
      const std::string text = capitals(deck.lines[line].text);
      for (std::size_t begin = 0; begin <= text.size();) {
        const std::size_t comma = std::min(text.find(',', begin), text.size());
        if (trim_blanks(std::string_view(text).substr(begin, comma - begin)) == "U") return true;
        begin = comma + 1;
      }
    }
  }
  return false;
}

}  // namespace mottle::formats
