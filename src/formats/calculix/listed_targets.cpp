// The numbers of a CalculixDeck that a parameter may set, by their targets.
#include <algorithm>
#include <array>
#include <optional>

#include "formats/calculix/number_cards.hpp"
#include "formats/calculix/steps.hpp"
#include "mottle/core/error.hpp"
#include "mottle/formats/calculix/deck.hpp"

namespace mottle::formats {
namespace {

/// A keyword whose cards hold a number to list.
struct ListedCard {
  const char* keyword;
  const char* owner;  ///< the parameter that names it; empty: the material that it belongs to
  const char* field;  ///< ":E" behind the name
};

constexpr std::array k_listed = {ListedCard{"ELASTIC", "", ":E"}, ListedCard{"DENSITY", "", ""},
                                 ListedCard{"SPRING", "ELSET", ""}, ListedCard{"MASS", "ELSET", ""},
                                 ListedCard{"SHELL SECTION", "ELSET", ":T"}};

/// Whether a parameter can set it: one number, or several that are the same, other than 0.
bool can_be_set(const CalculixDeck& deck, const std::string& target) {
  try {
    const std::vector<CalculixNumber> numbers = find_calculix_numbers(deck, target);
    return std::ranges::all_of(numbers, [](const CalculixNumber& number) { return number.value != 0.0; });
  } catch (const InvalidInput&) {  // it depends on temperature, is not isotropic, ...
    return false;
  }
}

}  // namespace

std::vector<std::string> list_calculix_targets(const CalculixDeck& deck) {
  std::vector<std::string> targets;
  CardNames names;
  const KeptLines kept(deck);
  for (std::size_t i = 0; i < deck.lines.size(); ++i) {
    const std::optional<Keyword> keyword = kept.contains(i) ? keyword_of(deck.lines[i].text) : std::nullopt;
    if (!keyword) continue;
    names.pass(*keyword);
    const auto card = std::ranges::find(k_listed, keyword->name, &ListedCard::keyword);
    if (card == k_listed.end()) continue;
    const std::string name = names.name(*keyword, card->owner);
    const std::string target = fmt::format("*{}:{}{}", card->keyword, name, card->field);
    if (std::ranges::count(targets, target) == 0 && can_be_set(deck, target)) targets.push_back(target);
  }
  return targets;
}

}  // namespace mottle::formats
