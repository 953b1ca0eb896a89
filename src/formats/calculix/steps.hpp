// The keywords of a CalculixDeck and its steps, of which the first *FREQUENCY is used.
#pragma once

#include <algorithm>
#include <map>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "mottle/formats/calculix/deck.hpp"
#include "mottle/layers.hpp"

namespace mottle::formats {

/// A keyword line: "*SHELL SECTION, ELSET=PLATE" -> SHELL SECTION, {ELSET: PLATE}; all in capitals.
struct Keyword {
  std::string name;
  std::map<std::string, std::string> parameters;
};

bool is_comment(std::string_view line);
std::optional<Keyword> keyword_of(std::string_view line);

/// Throws FormatError with the line's file and number.
[[noreturn]] void refuse(const CalculixDeck& deck, std::size_t line, const std::string& message);

/// Whether a *STEP takes geometric nonlinearity into account.
bool is_nonlinear(const Keyword& step);

/// Data lines of the keyword on `line`.
std::vector<std::size_t> data_lines(const CalculixDeck& deck, std::size_t line);

/// Where the number of modes ends in a data line of *FREQUENCY; what follows are limits of frequency, between which
/// modes would be counted. The line's end where there are none.
std::size_t end_of_count(const std::string& line);

/// A step, from *STEP to its end.
struct Step {
  std::size_t begin = 0, end = 0;  ///< lines, the last one excluded
  std::size_t procedure = 0;       ///< its line
  std::string name = {};           ///< of the procedure, "FREQUENCY"; empty: none that is known
  bool is_perturbation = false;
  bool is_nonlinear = false;  ///< geometrically
  bool has_boundary = false;
};

std::vector<Step> find_steps(const CalculixDeck& deck);

/// The first step *FREQUENCY; none where there is no step.
///
/// @throws FormatError  there are only others
std::optional<Step> find_step(const CalculixDeck& deck);

/// Which lines stay: those of the model and of the first step *FREQUENCY, with the steps before it where it needs them;
/// all where there is none.
class KeptLines {
 public:
  explicit KeptLines(const CalculixDeck& deck) : others_(find_steps(deck)) {
    const auto chosen = std::ranges::find(others_, "FREQUENCY", &Step::name);
    if (chosen == others_.end()) {
      others_.clear();
      return;
    }
    others_.erase(needs_earlier_steps(deck).empty() ? chosen : others_.begin(), chosen + 1);
  }

  bool contains(std::size_t line) const {
    return std::ranges::none_of(others_, [&](const Step& step) { return line >= step.begin && line < step.end; });
  }
  std::vector<std::string> left_out() const {
    std::vector<std::string> names;
    for (const Step& step : others_) names.push_back("*" + (step.name.empty() ? "STEP" : step.name));
    return names;
  }

 private:
  std::vector<Step> others_;
};

}  // namespace mottle::formats
