// Lines that repeat the card above with changes: '=' in the first field.
#include <charconv>
#include <limits>

#include "formats/nastran/fields.hpp"
#include "formats/nastran/rows.hpp"

namespace mottle::formats::nastran {
namespace {

constexpr int k_max_copies = 1'000'000;

/// "*(0.2)" and "*0.2" as "0.2", "=(4)" and "=4" as "4".
std::string_view number_behind_sign(std::string_view field) {
  field = trim(field.substr(1));
  if (field.starts_with('(') && field.ends_with(')')) field = trim(field.substr(1, field.size() - 2));
  return field;
}

/// The sum of a field and an increment: an integer where both are, else a real number with its point.
std::string incremented(std::string_view field, std::string_view increment, const SourceLocation& location) {
  int integer = 0;
  int step = 0;
  if (parse_integer(field, integer) && parse_integer(increment, step)) {
    const std::int64_t sum = std::int64_t{integer} + step;
    if (std::abs(sum) <= std::numeric_limits<int>::max()) return fmt::format("{}", sum);
  }
  double real = 0.0;
  double real_step = 0.0;
  if (parse_integer(field, integer) || !parse_real(field, real) || !parse_real(increment, real_step)) {
    fail(location, fmt::format("'*{}' cannot be added to '{}' of the card above", shown(increment), shown(field)));
  }
  return fmt::format("{:#}", real + real_step);
}

}  // namespace

void Replication::read(const BulkRow& line, const SourceLocation& location, std::vector<BulkRow>& rows) {
  int copies = 1;
  if (line.name.size() > 1) {
    if (!pattern_)
      fail(location, fmt::format("'{}' repeats a line above that begins with '='; there is none", line.name));
    if (!parse_integer(number_behind_sign(line.name), copies) || copies < 1) {
      fail(location, fmt::format("'{}': the number of cards behind '=' must be an integer from 1", shown(line.name)));
    }
  } else {
    if (rows.empty()) fail(location, "'=' repeats the card above; there is none");
    pattern_ = line;
  }
  if (copies > k_max_copies - copies_) fail(location, fmt::format("'=' lines make more than {} cards", k_max_copies));
  copies_ += copies;
  for (int copy = 0; copy < copies; ++copy) {
    BulkRow row = next(rows.back(), location);
    row.file = line.file;
    row.line = line.line;
    rows.push_back(row);
  }
}

BulkRow Replication::next(const BulkRow& above, const SourceLocation& location) {
  if (above.kind != BulkRow::Kind::card || above.is_large || above.is_continued_by_mark || above.ends_with_comma) {
    fail(location, "'=' repeats the card above; this is not supported for cards of several lines, write the cards out");
  }
  BulkRow row;
  row.name = above.name;
  row.first_field = text_.fields.size();
  for (int n = 0; n < pattern_->field_count; ++n) {
    const std::string_view change = text_.fields[pattern_->first_field + static_cast<std::size_t>(n)];
    if (change == "==") {
      for (; n < above.field_count; ++n) text_.fields.push_back(field_of(above, n));
      break;
    }
    text_.fields.push_back(changed(field_of(above, n), change, location));
  }
  row.field_count = static_cast<int>(text_.fields.size() - row.first_field);
  return row;
}

std::string_view Replication::field_of(const BulkRow& row, int n) const {
  return n < row.field_count ? text_.fields[row.first_field + static_cast<std::size_t>(n)] : std::string_view{};
}

std::string_view Replication::changed(std::string_view field, std::string_view change, const SourceLocation& location) {
  if (change == "=") return field;
  if (!change.starts_with('*')) return change;
  return text_.bytes.emplace_back(incremented(field, number_behind_sign(change), location));
}

}  // namespace mottle::formats::nastran
