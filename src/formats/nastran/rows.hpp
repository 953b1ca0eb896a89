// Lines of the bulk data section: from bytes to rows of fields, from rows to cards.
#pragma once

#include <deque>
#include <optional>
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
    overflow,    ///< goes on behind a comma at a line's end
    replication  ///< repeats the card above; `name` is its first field, "=" or "=4"
  };

  Kind kind = Kind::card;
  bool is_large = false;
  bool ends_with_comma = false;
  std::string_view name;
  std::string_view label_in;          ///< "+A1" in front, without the '+'
  std::string_view label_out;         ///< the same in the last field
  bool is_continued_by_mark = false;  ///< the last field begins with '+' or '*'
  std::size_t first_field = 0;
  int field_count = 0;
  int file = 0;
  int line = 0;
  int next = -1;  ///< row that continues this one
};

/// Cuts a line without its comment, in capitals and not blank, into fields that are put at the end of `text.fields`.
BulkRow cut_row(std::string_view line, const SourceLocation& location, NastranDeck::Text& text);

/// Writes out the cards that lines with '=' in the first field ask for: the card above, in which "=" keeps a field,
/// "==" keeps it and all that follow, "*x" adds x and anything else takes its place. "=n" does the same n times again.
class Replication {
 public:
  explicit Replication(NastranDeck::Text& text) : text_(text) {}

  /// Adds the cards of one such line to `rows`.
  void read(const BulkRow& line, const SourceLocation& location, std::vector<BulkRow>& rows);
  /// Another line followed: "=n" has nothing to do again.
  void forget() { pattern_.reset(); }

 private:
  BulkRow next(const BulkRow& above, const SourceLocation& location);
  std::string_view field_of(const BulkRow& row, int n) const;
  std::string_view changed(std::string_view field, std::string_view change, const SourceLocation& location);

  NastranDeck::Text& text_;
  std::optional<BulkRow> pattern_;
  int copies_ = 0;
};

/// Finds for every continuation the row that it continues and makes cards of the chains.
void join_rows(std::vector<BulkRow>& rows, NastranDeck& deck, NastranDeck::Text& text);

}  // namespace nastran
}  // namespace mottle::formats
