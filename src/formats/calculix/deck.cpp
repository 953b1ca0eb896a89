#include "mottle/formats/calculix/deck.hpp"

#include <algorithm>
#include <limits>
#include <optional>
#include <set>

#include "formats/calculix/number_cards.hpp"
#include "formats/calculix/steps.hpp"
#include "formats/matrices/matrix_text.hpp"
#include "mottle/core/files.hpp"
#include "mottle/core/text.hpp"
#include "mottle/formats/text_lines.hpp"

namespace mottle::formats {
namespace {

/// INPUT=file of an *INCLUDE, in its own letters: a part of the line.
std::string_view included_file(std::string_view line) {
  const std::size_t equals = line.find('=');
  if (equals == std::string_view::npos) return {};
  std::string_view name = trim_blanks(line.substr(equals + 1));
  if (name.size() >= 2 && name.front() == '"' && name.back() == '"') name = name.substr(1, name.size() - 2);
  return name;
}

void read_into(CalculixDeck& deck, const std::filesystem::path& file, std::vector<std::string>& open) {
  constexpr std::size_t k_max_files = 100;
  const std::string bytes = read_file(file);
  const int index = static_cast<int>(deck.files.size());
  deck.files.push_back(file.string());
  open.push_back(file.string());
  MatrixLines text(bytes, file.string());
  while (text.next()) {
    const std::optional<Keyword> keyword = keyword_of(text.line());
    if (!keyword || keyword->name != "INCLUDE") {
      deck.lines.push_back({std::string(text.line()), index, text.number()});
      continue;
    }
    const std::string_view name = included_file(text.line());
    const std::filesystem::path included = file.parent_path() / name;
    if (std::count(open.begin(), open.end(), included.string()) > 0 || deck.files.size() >= k_max_files) {
      text.fail(fmt::format("includes {} in a circle, or more than {} files", included.string(), k_max_files));
    }
    deck.includes.push_back({{std::string(text.line()), index, text.number()},
                             name.empty() ? 0 : static_cast<std::size_t>(name.data() - text.line().data()),
                             name.size(),
                             static_cast<int>(deck.files.size())});
    read_into(deck, included, open);
  }
  open.pop_back();
}

struct Target {
  const Card* card = nullptr;  ///< one that has such a number; others of the same keyword may have it too
  std::string name = {};
  std::string field = {};  ///< "-": the number without a name
};

Target parse_target(const std::string& target) {
  const std::string text = capitals(target);
  const std::size_t first = text.find(':');
  const std::size_t second = first == std::string::npos ? first : text.find(':', first + 1);
  Target result{.field = second == std::string::npos ? "-" : text.substr(second + 1)};
  std::vector<std::string> examples;
  for (const Card& card : cards()) {
    if (examples.empty() || examples.back() != card.example) examples.emplace_back(card.example);
    if (first == std::string::npos || text.substr(0, first) != fmt::format("*{}", card.keyword)) continue;
    const std::vector<std::string_view> names = words_of(card.fields);
    if (std::ranges::find(names, result.field) == names.end()) continue;
    result.card = &card;
    result.name = text.substr(first + 1, second == std::string::npos ? second : second - first - 1);
  }
  require(result.card != nullptr, "target '{}' is none that is known; there are {} and {{{{name}}}}", target,
          join(examples));
  return result;
}

CalculixNumber number_on(const CalculixDeck& deck, std::size_t line, std::size_t field) {
  const std::string_view text = deck.lines[line].text;
  CalculixNumber number{.line = line};
  for (std::size_t k = 0; k < field && number.begin != std::string_view::npos; ++k) {
    const std::size_t comma = text.find(',', number.begin);
    number.begin = comma == std::string_view::npos ? comma : comma + 1;
  }
  if (number.begin == std::string_view::npos) refuse(deck, line, fmt::format("has no number in field {}", field + 1));
  const std::size_t comma = text.find(',', number.begin);
  number.length = (comma == std::string_view::npos ? text.size() : comma) - number.begin;
  const std::string_view digits = text.substr(number.begin, number.length);
  if (!parse_fortran(digits, number.value)) refuse(deck, line, fmt::format("'{}' is not a number", digits));
  return number;
}

/// The numbers that a target names on one card: one for each temperature.
std::vector<CalculixNumber> numbers_of_card(const CalculixDeck& deck, std::size_t line, const Keyword& keyword,
                                            const Target& target) {
  const std::vector<std::size_t> data = data_lines(deck, line);
  if (data.empty()) refuse(deck, line, fmt::format("*{} has no data line", keyword.name));
  if (keyword.parameters.contains("NONLINEAR")) refuse(deck, line, "a nonlinear spring has no single stiffness");
  const Card* card = card_of(keyword);
  if (card == nullptr) {
    refuse(
        deck, line,
        fmt::format("the numbers of *{} of type {} are not known here; write {{{{name}}}} in place of those that the "
                    "parameter sets",
                    keyword.name, keyword.parameters.at("TYPE")));
  }
  const std::vector<std::string_view> names = words_of(card->fields);
  const auto found = std::ranges::find(names, target.field);
  if (found == names.end()) {
    refuse(deck, line,
           fmt::format("this *{} is of type {}, whose numbers are {}, not {}", keyword.name, card->type,
                       fmt::join(names, " "), target.field));
  }
  const auto field = static_cast<std::size_t>(found - names.begin());
  if (!std::string_view(card->owner).empty()) {
    return {number_on(deck, card->stands_last ? data.back() : data.front(), field)};
  }
  const std::size_t lines = (names.size() + k_numbers_a_line - 1) / k_numbers_a_line;
  if (data.size() % lines != 0) {
    refuse(deck, line,
           fmt::format("*{} has {} data lines, {} for each temperature are needed", keyword.name, data.size(), lines));
  }
  std::vector<CalculixNumber> numbers;
  for (std::size_t first = 0; first < data.size(); first += lines) {
    numbers.push_back(number_on(deck, data[first + field / k_numbers_a_line], field % k_numbers_a_line));
    numbers.back().temperatures = static_cast<int>(data.size() / lines);
  }
  return numbers;
}

std::vector<CalculixNumber> find_placeholders(const CalculixDeck& deck, const std::string& mark) {
  std::vector<CalculixNumber> numbers;
  const KeptLines kept(deck);
  for (std::size_t i = 0; i < deck.lines.size(); ++i) {
    const std::string& text = deck.lines[i].text;
    if (is_comment(text) || !kept.contains(i)) continue;
    for (std::size_t at = text.find(mark); at != std::string::npos; at = text.find(mark, at + mark.size())) {
      numbers.push_back({i, at, mark.size(), std::numeric_limits<double>::quiet_NaN(), true});
    }
  }
  return numbers;
}

}  // namespace

std::string CalculixDeck::where(std::size_t line) const {
  return fmt::format("{}:{}", files[static_cast<std::size_t>(lines[line].file)], lines[line].number);
}

CalculixDeck read_calculix_deck(const std::filesystem::path& file) {
  CalculixDeck deck;
  std::vector<std::string> open;
  read_into(deck, file, open);
  return deck;
}

std::vector<CalculixNumber> find_calculix_numbers(const CalculixDeck& deck, const std::string& target) {
  if (target.starts_with("{{") && target.ends_with("}}")) {
    std::vector<CalculixNumber> numbers = find_placeholders(deck, target);
    require(!numbers.empty(), "target '{}' does not stand in {}", target, deck.files.front());
    return numbers;
  }
  const Target wanted = parse_target(target);
  const std::string owner = wanted.card->owner;
  std::vector<CalculixNumber> numbers;
  std::vector<std::string> known;
  std::set<std::string> found;
  CardNames names;
  const KeptLines kept(deck);
  for (std::size_t i = 0; i < deck.lines.size(); ++i) {
    const std::optional<Keyword> keyword = kept.contains(i) ? keyword_of(deck.lines[i].text) : std::nullopt;
    if (!keyword) continue;
    names.pass(*keyword);
    if (keyword->name != wanted.card->keyword) continue;
    known.push_back(names.name(*keyword, owner));
    if (!names.is_called(wanted.name, *keyword, owner)) continue;
    found.insert(known.back());
    for (const CalculixNumber& number : numbers_of_card(deck, i, *keyword, wanted)) numbers.push_back(number);
  }
  require(!numbers.empty(), "target '{}': {}", target,
          unknown_name_message(fmt::format("*{}", wanted.card->keyword), wanted.name, known));
  require(found.size() == 1, "target '{}': there are {}; name one", target, join({found.begin(), found.end()}));
  return numbers;
}

std::string calculix_field(const std::string& target) {
  const std::size_t last = target.rfind(':');
  return !target.starts_with('*') || last == target.find(':') ? "" : capitals(target.substr(last + 1));
}

}  // namespace mottle::formats
