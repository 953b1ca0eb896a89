#include "formats/calculix/steps.hpp"

#include <algorithm>
#include <set>

#include "formats/calculix/abaqus.hpp"
#include "formats/matrices/matrix_text.hpp"
#include "mottle/core/text.hpp"

namespace mottle::formats {

bool is_comment(std::string_view line) {
  return line.starts_with("**");
}

std::optional<Keyword> keyword_of(std::string_view line) {
  if (!line.starts_with('*') || is_comment(line)) return std::nullopt;
  const std::string text = capitals(line.substr(1, line.find('\n') - 1));
  Keyword keyword;
  for (std::size_t begin = 0; begin <= text.size();) {
    const std::size_t comma = std::min(text.find(',', begin), text.size());
    const std::string_view part = std::string_view(text).substr(begin, comma - begin);
    const std::size_t equals = part.find('=');
    if (begin == 0) {
      keyword.name = std::string(trim_blanks(part));
    } else if (!trim_blanks(part).empty()) {
      keyword.parameters[std::string(trim_blanks(part.substr(0, equals)))] =
          equals == std::string_view::npos ? "" : std::string(trim_blanks(part.substr(equals + 1)));
    }
    begin = comma + 1;
  }
  return keyword;
}

void refuse(const CalculixDeck& deck, std::size_t line, const std::string& message) {
  const CalculixDeck::Line& at = deck.lines[line];
  throw FormatError(deck.files[static_cast<std::size_t>(at.file)], at.number, message);
}

std::vector<std::size_t> data_lines(const CalculixDeck& deck, std::size_t line) {
  std::vector<std::size_t> lines;
  for (std::size_t i = line + 1; i < deck.lines.size(); ++i) {
    const std::string_view text = deck.lines[i].text;
    if (is_comment(text)) continue;
    if (text.starts_with('*')) break;
    if (!trim_blanks(text).empty()) lines.push_back(i);
  }
  return lines;
}

bool is_nonlinear(const Keyword& step) {
  const auto found = step.parameters.find("NLGEOM");
  return found != step.parameters.end() && found->second != "NO";
}

std::vector<Step> find_steps(const CalculixDeck& deck) {
  static const std::set<std::string> k_procedures = {"FREQUENCY",        "STATIC",
                                                     "BUCKLE",           "DYNAMIC",
                                                     "MODAL DYNAMIC",    "STEADY STATE DYNAMICS",
                                                     "HEAT TRANSFER",    "COUPLED TEMPERATURE-DISPLACEMENT",
                                                     "COMPLEX FREQUENCY"};
  std::vector<Step> steps;
  for (std::size_t i = 0; i < deck.lines.size(); ++i) {
    const std::optional<Keyword> keyword = keyword_of(deck.lines[i].text);
    if (!keyword) continue;
    if (keyword->name == "STEP") {
      if (!steps.empty() && steps.back().end == 0) steps.back().end = i;
      steps.push_back({.begin = i,
                       .is_perturbation = keyword->parameters.contains("PERTURBATION"),
                       .is_nonlinear = is_nonlinear(*keyword)});
    }
    if (steps.empty() || steps.back().end != 0) continue;
    Step& step = steps.back();
    if (keyword->name == "BOUNDARY") step.has_boundary = true;
    if (keyword->name == "END STEP") step.end = i + 1;
    if (!k_procedures.contains(keyword->name)) continue;
    step.name = keyword->name;
    step.procedure = i;
  }
  if (!steps.empty() && steps.back().end == 0) steps.back().end = deck.lines.size();
  return steps;
}

namespace {

/// A sector has waves around the axis, a pair of equal modes for each of their numbers: its matrices are twice as
/// large, and modes have no numbers of their own.
void refuse_cyclic_symmetry(const CalculixDeck& deck) {
  for (std::size_t i = 0; i < deck.lines.size(); ++i) {
    const std::optional<Keyword> keyword = keyword_of(deck.lines[i].text);
    if (!keyword || keyword->name != "CYCLIC SYMMETRY MODEL") continue;
    refuse(deck, i,
           "*CYCLIC SYMMETRY MODEL: the modes of a sector are not read; give the whole structure, or run the deck by "
           "[model] kind = \"command\" with a script that picks the modes of each nodal diameter");
  }
}

}  // namespace

std::optional<Step> find_step(const CalculixDeck& deck) {
  refuse_cyclic_symmetry(deck);
  const std::vector<Step> steps = find_steps(deck);
  if (steps.empty()) return std::nullopt;
  const auto found = std::ranges::find(steps, "FREQUENCY", &Step::name);
  if (found == steps.end()) {
    const Step& first = steps.front();
    if (first.name.empty()) refuse(deck, first.begin, "the step has no *FREQUENCY");
    refuse(deck, first.procedure,
           fmt::format("*{} instead of *FREQUENCY; matrices for modes come from a *FREQUENCY step", first.name));
  }
  return *found;
}

std::string needs_earlier_steps(const CalculixDeck& deck) {
  const std::vector<Step> steps = find_steps(deck);
  const auto found = std::ranges::find(steps, "FREQUENCY", &Step::name);
  if (found == steps.end() || found == steps.begin()) return "";
  const bool is_abaqus = is_abaqus_deck(deck);
  if (is_abaqus ? std::any_of(steps.begin(), found, [](const Step& step) { return step.is_nonlinear; })
                : found->is_perturbation) {
    return fmt::format(
        "its *FREQUENCY step is a PERTURBATION of the state after *{}: the preload changes the stiffness",
        steps.front().name.empty() ? "STEP" : steps.front().name);
  }
  const bool has_boundary = std::any_of(steps.begin(), found, [](const Step& step) { return step.has_boundary; });
  return has_boundary ? "a step before *FREQUENCY has a *BOUNDARY, which holds in later steps too" : "";
}

std::size_t end_of_count(const std::string& line) {
  const std::size_t comma = line.find(',');
  const bool has_limits = comma != std::string::npos && line.find_first_of("0123456789", comma) != std::string::npos;
  return has_limits ? comma : line.size();
}

/// Whether the *FREQUENCY step has limits of frequency behind the number of modes.
bool has_limits(const CalculixDeck& deck) {
  const std::optional<Step> step = find_step(deck);
  if (!step) return false;
  return std::ranges::any_of(data_lines(deck, step->procedure), [&](std::size_t line) {
    const std::string& text = deck.lines[line].text;
    return end_of_count(text) < text.size();
  });
}

std::string left_out_steps(const CalculixDeck& deck) {
  const KeptLines kept(deck);
  const std::vector<std::string> names = kept.left_out();
  std::vector<std::string> notes;
  if (!names.empty()) {
    notes.push_back(fmt::format("Of the deck's steps the first *FREQUENCY is used{}; left out: {}.",
                                needs_earlier_steps(deck).empty() ? "" : " with those before it", join(names)));
  }
  if (has_limits(deck)) {
    notes.emplace_back("The limits of frequency of *FREQUENCY are left out: modes are counted from the lowest.");
  }
  return join(notes, " ");
}

}  // namespace mottle::formats
