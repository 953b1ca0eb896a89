// Which row continues which: by position where a continuation has no label or the row above it has the same one, else
// by label anywhere in the deck.
#include <fmt/format.h>

#include <algorithm>
#include <cassert>
#include <unordered_map>

#include "formats/nastran/rows.hpp"

namespace mottle::formats::nastran {
namespace {

constexpr int k_max_rows_of_a_card = 1000000;

/// What of the last field a continuation line repeats behind its own first character where that field has no '+', or
/// has it behind a blank.
std::string_view unmarked_label(const BulkRow& row) {
  if (row.label_out.empty()) return {};
  const bool is_marked_within = row.label_out.front() == '+' || row.label_out.front() == '*';
  return row.is_continued_by_mark && !is_marked_within ? std::string_view{} : row.label_out.substr(1);
}

class RowJoiner {
 public:
  RowJoiner(std::vector<BulkRow>& rows, NastranDeck& deck, NastranDeck::Text& text)
      : rows_(rows), deck_(deck), text_(text) {}

  void join() {
    for (int row = 0; row < count(); ++row) link_by_position(row);
    if (!by_label_.empty()) link_by_label();
    refuse_rings();
    lay_out_cards();
    if (guessed_labels_ > 0) {
      deck_.notes.push_back(
          fmt::format("{} continuation lines with a label that no line asks for were taken to continue "
                      "the line above them",
                      guessed_labels_));
    }
  }

 private:
  int count() const { return static_cast<int>(rows_.size()); }
  SourceLocation location_of(const BulkRow& row) const {
    return {deck_.files[static_cast<std::size_t>(row.file)], row.line};
  }
  BulkRow& at(int row) { return rows_[static_cast<std::size_t>(row)]; }

  void link(int row, int continuation) {
    if (at(row).next >= 0) {
      fail(location_of(at(continuation)),
           fmt::format("continues line {}, which line {} continues already", at(row).line, at(at(row).next).line));
    }
    at(row).next = continuation;
  }

  void link_by_position(int row) {
    const BulkRow& current = at(row);
    if (current.kind == BulkRow::Kind::card) return;
    if (row == 0) fail(location_of(current), "a continuation line without a card above it");
    const BulkRow& above = at(row - 1);
    if (current.kind == BulkRow::Kind::overflow && !above.ends_with_comma) {
      fail(location_of(current),
           "a line that begins with a number continues one that ends with a comma; there is none");
    }
    if (current.label_in.empty() || current.label_in == above.label_out || current.label_in == unmarked_label(above)) {
      link(row - 1, row);
    } else {
      by_label_.push_back(row);
    }
  }

  void link_by_label() {
    std::unordered_map<std::string_view, std::vector<int>> open, unmarked;
    for (int row = 0; row < count(); ++row) {
      if (at(row).label_out.empty()) continue;
      std::vector<int>& rows = open[at(row).label_out];
      if (at(row).next < 0) rows.push_back(row);
      if (at(row).next < 0 && !unmarked_label(at(row)).empty()) unmarked[unmarked_label(at(row))].push_back(row);
    }
    for (const int row : by_label_) {
      const auto found = open.find(at(row).label_in);
      const auto found_unmarked = unmarked.find(at(row).label_in);
      if (found == open.end() && found_unmarked != unmarked.end()) {
        link_to_the_only(found_unmarked->second, row);
      } else if (found != open.end() && found->second.empty()) {
        fail(location_of(at(row)),
             fmt::format("continuation '+{}': the line with that label is continued already", shown(at(row).label_in)));
      } else if (found != open.end()) {
        link_to_the_only(found->second, row);
      } else if (at(row - 1).label_out.empty()) {
        link(row - 1, row);
        ++guessed_labels_;
      } else {
        fail(location_of(at(row)),
             fmt::format("continuation '+{}': no line ends with that label", shown(at(row).label_in)));
      }
    }
  }

  void link_to_the_only(const std::vector<int>& candidates, int row) {
    if (candidates.size() > 1) {
      fail(location_of(at(row)), fmt::format("continuation '+{}': lines {} and {} both end with that label",
                                             shown(at(row).label_in), at(candidates[0]).line, at(candidates[1]).line));
    }
    if (candidates.front() == row) {
      fail(location_of(at(row)), fmt::format("continuation '+{}' continues itself", shown(at(row).label_in)));
    }
    link(candidates.front(), row);
  }

  /// Every row must be reached from a card; continuations that continue each other are not.
  void refuse_rings() {
    std::vector<bool> is_reached(rows_.size(), false);
    for (int first = 0; first < count(); ++first) {
      if (at(first).kind != BulkRow::Kind::card) continue;
      int length = 0;
      for (int row = first; row >= 0; row = at(row).next) {
        is_reached[static_cast<std::size_t>(row)] = true;
        if (++length > k_max_rows_of_a_card) {
          fail(location_of(at(first)), fmt::format("more than {} continuation lines", k_max_rows_of_a_card));
        }
      }
    }
    for (int row = 0; row < count(); ++row) {
      if (!is_reached[static_cast<std::size_t>(row)]) {
        fail(location_of(at(row)), "continuation lines that continue each other without a card");
      }
    }
  }

  /// Number of fields in front of and including a row, given those in front of it. A large row fills half a line of
  /// eight, a small one a whole line.
  static std::size_t start_of(const BulkRow& row, std::size_t filled) {
    if (row.kind == BulkRow::Kind::overflow) return filled;
    const std::size_t unit = row.is_large ? 4 : 8;
    return (filled + unit - 1) / unit * unit;
  }

  std::size_t end_of(const BulkRow& row, std::size_t start) const {
    const auto next_kind = row.next < 0 ? BulkRow::Kind::card : rows_[static_cast<std::size_t>(row.next)].kind;
    if (next_kind == BulkRow::Kind::overflow) return start + static_cast<std::size_t>(row.field_count);
    std::size_t used = static_cast<std::size_t>(row.field_count);
    while (used > 0 && text_.fields[row.first_field + used - 1].empty()) --used;
    if (row.kind == BulkRow::Kind::overflow || row.next < 0) return start + used;
    const std::size_t unit = row.is_large ? 4 : 8;
    return start + std::max<std::size_t>(1, (used + unit - 1) / unit) * unit;
  }

  void lay_out_cards() {
    std::size_t total = 0;
    for (const BulkRow& row : rows_) {
      if (row.kind == BulkRow::Kind::card && row.next >= 0) total += joined_size(row);
    }
    text_.joined.reserve(total);  // string views refer to it: it must not be reallocated
    deck_.cards.reserve(static_cast<std::size_t>(
        std::count_if(rows_.begin(), rows_.end(), [](const BulkRow& r) { return r.kind == BulkRow::Kind::card; })));
    for (const BulkRow& row : rows_) {
      if (row.kind == BulkRow::Kind::card) deck_.cards.push_back({row.name, fields_of(row), row.file, row.line});
    }
    assert(text_.joined.size() <= total);
  }

  std::size_t joined_size(const BulkRow& first) {
    std::size_t filled = 0;
    for (const BulkRow* row = &first; row != nullptr; row = row->next < 0 ? nullptr : &at(row->next)) {
      filled = end_of(*row, start_of(*row, filled));
    }
    return filled;
  }

  std::span<const std::string_view> fields_of(const BulkRow& first) {
    if (first.next < 0) {
      return {text_.fields.data() + first.first_field, end_of(first, 0)};
    }
    const std::size_t base = text_.joined.size();
    std::size_t filled = 0;
    for (const BulkRow* row = &first; row != nullptr; row = row->next < 0 ? nullptr : &at(row->next)) {
      const std::size_t start = start_of(*row, filled);
      filled = end_of(*row, start);
      text_.joined.resize(base + start);
      for (std::size_t i = 0; start + i < filled; ++i) {
        const bool is_given = i < static_cast<std::size_t>(row->field_count);
        text_.joined.push_back(is_given ? text_.fields[row->first_field + i] : std::string_view{});
      }
    }
    while (text_.joined.size() > base && text_.joined.back().empty()) text_.joined.pop_back();
    return {text_.joined.data() + base, text_.joined.size() - base};
  }

  std::vector<BulkRow>& rows_;
  NastranDeck& deck_;
  NastranDeck::Text& text_;
  std::vector<int> by_label_;
  int guessed_labels_ = 0;
};

}  // namespace

void join_rows(std::vector<BulkRow>& rows, NastranDeck& deck, NastranDeck::Text& text) {
  RowJoiner(rows, deck, text).join();
}

}  // namespace mottle::formats::nastran
