// The cards of a CalculixDeck whose numbers a parameter may set: a table.
#pragma once

#include <cstddef>
#include <string>
#include <string_view>
#include <vector>

#include "formats/calculix/steps.hpp"
#include "mottle/core/error.hpp"
#include "mottle/layers.hpp"

namespace mottle::formats {

/// The cards that hold a number to move.
struct Card {
  const char* keyword;
  const char* owner;           ///< the parameter that names the card; empty: the material that it belongs to
  const char* example;         ///< for messages
  std::string_view fields;     ///< names of its numbers, eight a line; "-": one without a name
  std::string_view type = {};  ///< TYPE of the card whose numbers these are, in its first letters
  bool stands_last = false;    ///< the number stands on the last data line
};

inline constexpr std::size_t k_numbers_a_line = 8;

/// Numbers of *ELASTIC as the manual has them; those of ORTHO and ANISO enter the stress-strain matrix linearly.
inline const std::vector<Card>& cards() {
  static const std::vector<Card> k_cards = {
      {"ELASTIC", "", "*ELASTIC:STEEL:E", "E NU", "ISO"},
      {"ELASTIC", "", "*ELASTIC:CARBON:E1", "E1 E2 E3 NU12 NU13 NU23 G12 G13 G23", "ENG"},
      {"ELASTIC", "", "*ELASTIC:CARBON:D1111", "D1111 D1122 D2222 D1133 D2233 D3333 D1212 D1313 D2323", "ORTHO"},
      {"ELASTIC", "", "*ELASTIC:CARBON:D1111",
       "D1111 D1122 D2222 D1133 D2233 D3333 D1112 D2212 D3312 D1212 D1113 D2213 D3313 D1213 D1313 D1123 D2223 D3323 "
       "D1223 D1323 D2323",
       "ANISO"},
      {"DENSITY", "", "*DENSITY:STEEL", "-"},
      {"SPRING", "ELSET", "*SPRING:BOLTS", "-", "", true},
      {"MASS", "ELSET", "*MASS:TIPS", "-"},
      {"SHELL SECTION", "ELSET", "*SHELL SECTION:PLATE:T", "T"}};
  return k_cards;
}

/// What the cards of a deck are called, keyword after keyword.
class CardNames {
 public:
  void pass(const Keyword& keyword) {
    const auto named = keyword.parameters.find("NAME");
    const std::string name = named == keyword.parameters.end() ? "" : named->second;
    if (keyword.name == "MATERIAL") material_ = name;
    if (keyword.name == "PART" || keyword.name == "INSTANCE") part_ = name;
    if (keyword.name == "END PART" || keyword.name == "END INSTANCE") part_.clear();
  }

  /// The material; or the card's set, "PART.SET" inside of a part of an Abaqus deck.
  std::string name(const Keyword& keyword, std::string_view owner) const {
    if (owner.empty()) return material_;
    const auto found = keyword.parameters.find(std::string(owner));
    const std::string set = found == keyword.parameters.end() ? "" : found->second;
    return part_.empty() ? set : fmt::format("{}.{}", part_, set);
  }

  /// Whether the card's name is this one, which may leave out the part.
  bool is_called(const std::string& wanted, const Keyword& keyword, std::string_view owner) const {
    const std::string full = name(keyword, owner);
    return full == wanted || (!owner.empty() && !part_.empty() && full == fmt::format("{}.{}", part_, wanted));
  }

 private:
  std::string material_;
  std::string part_;
};

/// The card whose numbers stand on this keyword's data lines; null: none that is known.
inline const Card* card_of(const Keyword& keyword) {
  const auto found = keyword.parameters.find("TYPE");
  const std::string type = found == keyword.parameters.end() || keyword.name != "ELASTIC" ? "ISO" : found->second;
  for (const Card& card : cards()) {
    if (keyword.name == card.keyword && (card.type.empty() || type.starts_with(card.type))) return &card;
  }
  return nullptr;
}

}  // namespace mottle::formats
