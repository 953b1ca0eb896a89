// Lines of the bulk data section: from bytes to rows of fields, from rows to cards.
#pragma once

#include <deque>
#include <string>
#include <string_view>
#include <vector>

#include "mottle/formats/nastran/deck.hpp"
#include "mottle/layers.hpp"

namespace mottle::formats {

struct NastranDeck::Text {
  std::deque<std::string> bytes;         ///< whole files and expanded lines; a deque does not move its strings
  std::vector<std::string_view> fields;  ///< of single lines
  std::vector<std::string_view> joined;  ///< of cards with continuation lines
};

namespace nastran {

/// Where a line stands, for messages.
struct SourceLocation {
  const std::string& file;
  int line = 0;
};

[[noreturn]] void fail(const SourceLocation& location, const std::string& message);

/// Text for messages: cut to 24 characters, what cannot be printed as '?'.
std::string shown(std::string_view text);

std::string_view trim(std::string_view text);
/// Everything in front of a '$' that stands outside quotes.
std::string_view without_comment(std::string_view line);
/// Puts part of `bytes` into capitals; `part` is a view of `bytes`.
void make_capitals(std::string& bytes, std::string_view part);

/// One line of the bulk data section.
struct BulkRow {
  enum class Kind : std::uint8_t {
    card,
    continuation,
    overflow
  };  ///< overflow: goes on behind a comma at a line's end

  Kind kind = Kind::card;
  bool is_large = false;
  bool ends_with_comma = false;
  std::string_view name;
  std::string_view label_in;   ///< "+A1" in front, without the '+'
  std::string_view label_out;  ///< the same in the last field
  std::size_t first_field = 0;
  int field_count = 0;
  int file = 0;
  int line = 0;
  int next = -1;  ///< row that continues this one
};

/// Cuts a line without its comment, in capitals and not blank, into fields that are put at the end of `text.fields`.
BulkRow cut_row(std::string_view line, const SourceLocation& location, NastranDeck::Text& text);

/// Finds for every continuation the row that it continues and makes cards of the chains.
void join_rows(std::vector<BulkRow>& rows, NastranDeck& deck, NastranDeck::Text& text);

}  // namespace nastran
}  // namespace mottle::formats
