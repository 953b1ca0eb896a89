// The fields of one card as numbers, with errors that name the file, the line, the card and the field.
#pragma once

#include <fmt/format.h>

#include <string>
#include <string_view>

#include "mottle/fem/finite_element_model.hpp"
#include "mottle/formats/nastran/deck.hpp"
#include "mottle/layers.hpp"

namespace mottle::formats::nastran {

/// Reads Nastran's reals: "1.5", ".5", "1.+7", "7.D-3", "1E5" and integers. False where `text` is none or not finite.
bool parse_real(std::string_view text, double& value);
/// Reads an integer without a decimal point.
bool parse_integer(std::string_view text, int& value);
/// Reads "1246", also written "12 4 6", as bits; false where a character is not 1..6 or stands twice. Blank and "0" are
/// no component.
bool parse_components(std::string_view text, Components& value);

/// One card. Fields are counted from 1 over all its lines, eight a line, the name left out.
class Card {
 public:
  Card(const NastranDeck& deck, const BulkCard& card) : deck_(&deck), card_(&card) {}

  std::string_view name() const { return card_->name; }
  const BulkCard& bulk() const { return *card_; }
  int size() const { return static_cast<int>(card_->fields.size()); }
  std::string_view at(int n) const {
    return n <= size() ? card_->fields[static_cast<std::size_t>(n) - 1] : std::string_view{};
  }
  bool is_blank(int n) const { return at(n).empty(); }
  bool is_integer(int n) const;
  /// Whether anything stands in fields first..last.
  bool has_any(int first, int last) const;

  /// Each throws FormatError where the field is missing or of the wrong kind.
  int integer(int n, std::string_view what) const;
  int integer_or(int n, std::string_view what, int otherwise) const;
  /// An integer from 1.
  int id(int n, std::string_view what) const;
  double real(int n, std::string_view what) const;
  double real_or(int n, std::string_view what, double otherwise) const;
  /// Several components ("123"); blank or 0: none.
  Components components(int n, std::string_view what) const;
  /// Refuses a field that holds something else than blank or zero.
  void require_absent(int n, std::string_view what, std::string_view reason) const;

  /// "deck.bdf:12: CBAR 3: message".
  [[noreturn]] void fail(const std::string& message) const;
  std::string location() const { return deck_->location_of(*card_); }

 private:
  const NastranDeck* deck_;
  const BulkCard* card_;
};

}  // namespace mottle::formats::nastran
