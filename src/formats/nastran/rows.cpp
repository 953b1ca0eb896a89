// One line of the bulk data section cut into fields: small (8 columns), large (16 columns) or free (commas).
#include "formats/nastran/rows.hpp"

#include <algorithm>

#include "mottle/core/error.hpp"

namespace mottle::formats::nastran {
namespace {

constexpr std::size_t k_columns_of_data = 72;
constexpr std::size_t k_columns = 80;

bool is_letter(char c) {
  return (c >= 'A' && c <= 'Z') || (c >= 'a' && c <= 'z');
}

bool is_digit(char c) {
  return c >= '0' && c <= '9';
}

std::string with_tabs_expanded(std::string_view line) {
  std::string expanded;
  for (const char c : line) {
    if (c == '\t') {
      expanded.append(8 - expanded.size() % 8, ' ');
    } else {
      expanded += c;
    }
  }
  return expanded;
}

std::string_view columns(std::string_view line, std::size_t first, std::size_t count) {
  return first < line.size() ? trim(line.substr(first, count)) : std::string_view{};
}

bool has_mark(std::string_view label) {
  return label.starts_with('+') || label.starts_with('*');
}

std::string_view without_mark(std::string_view label) {
  return has_mark(label) ? trim(label.substr(1)) : label;
}

/// Reads what stands in front: a card's name or the mark of a continuation line.
void read_first_field(std::string_view field, const SourceLocation& location, BulkRow& row) {
  if (field.starts_with('/'))
    fail(location, "'/' deletes cards of an earlier run; this is not supported, leave them out");
  if (field.starts_with('=')) {
    row.kind = BulkRow::Kind::replication;
    row.name = field;
    return;
  }
  if (field.empty() || field.front() == '+' || field.front() == '*') {
    row.kind = BulkRow::Kind::continuation;
    row.is_large = field.starts_with('*');
    row.label_in = without_mark(field);
    return;
  }
  row.is_large = field.ends_with('*');
  row.name = row.is_large ? trim(field.substr(0, field.size() - 1)) : field;
  const bool is_name = !row.name.empty() && is_letter(row.name.front()) &&
                       std::all_of(row.name.begin(), row.name.end(),
                                   [](char c) { return is_letter(c) || is_digit(c) || c == '_' || c == '-'; });
  if (!is_name) {
    fail(location,
         fmt::format("'{}' stands where a card's name must; a name begins with a letter, fills columns 1 to 8 "
                     "or ends at a comma",
                     shown(field)));
  }
}

bool is_mark(std::string_view token) {
  return token == "+" || token == "*" || (token.size() > 1 && token.front() == '+' && is_letter(token[1]));
}

std::string_view next_token(std::string_view& rest, bool& is_last) {
  const std::size_t comma = rest.find(',');
  is_last = comma == std::string_view::npos;
  const std::string_view token = trim(rest.substr(0, comma));
  rest.remove_prefix(is_last ? rest.size() : comma + 1);
  return token;
}

BulkRow cut_free_row(std::string_view line, const SourceLocation& location, NastranDeck::Text& text) {
  BulkRow row;
  row.first_field = text.fields.size();
  bool is_last = false;
  const std::string_view first = next_token(line, is_last);
  if (!first.empty() && is_digit(first.front())) {
    row.kind = BulkRow::Kind::overflow;
    text.fields.push_back(first);
  } else {
    read_first_field(first, location, row);
  }
  while (!is_last) text.fields.push_back(next_token(line, is_last));
  const std::size_t width = row.is_large ? 4 : 8;
  const std::size_t count = text.fields.size() - row.first_field;
  if (count > 0 && row.kind != BulkRow::Kind::overflow) {
    const std::string_view last = text.fields.back();
    const bool is_label = count == width + 1 && has_mark(last);
    if (is_label || is_mark(last)) {
      row.label_out = without_mark(last);
      row.is_continued_by_mark = true;
      text.fields.pop_back();
    }
  }
  row.ends_with_comma = text.fields.size() > row.first_field && text.fields.back().empty();
  if (row.ends_with_comma) text.fields.pop_back();
  row.field_count = static_cast<int>(text.fields.size() - row.first_field);
  return row;
}

BulkRow cut_fixed_row(std::string_view line, const SourceLocation& location, NastranDeck::Text& text) {
  BulkRow row;
  row.first_field = text.fields.size();
  read_first_field(columns(line, 0, 8), location, row);
  const std::size_t width = row.is_large ? 16 : 8;
  const std::size_t end = std::min(line.size(), k_columns_of_data);
  for (std::size_t at = 8; at < end; at += width) text.fields.push_back(columns(line.substr(0, end), at, width));
  const std::string_view label = columns(line, k_columns_of_data, k_columns - k_columns_of_data);
  // A '+' behind a blank is part of the label, as punched decks have it: " +000001" goes on at "++000001".
  row.label_out = has_mark(label) && line[k_columns_of_data] == label.front() ? without_mark(label) : label;
  row.is_continued_by_mark = has_mark(label);
  while (text.fields.size() > row.first_field && text.fields.back().empty()) text.fields.pop_back();
  row.field_count = static_cast<int>(text.fields.size() - row.first_field);
  return row;
}

}  // namespace

void fail(const SourceLocation& location, const std::string& message) {
  throw FormatError(location.file, location.line, message);
}

std::string shown(std::string_view text) {
  constexpr std::size_t k_longest = 24;
  std::string copy(text.substr(0, k_longest));
  for (char& c : copy) {
    if (c < ' ' || c > '~') c = '?';
  }
  return text.size() > k_longest ? copy + "..." : copy;
}

std::string_view trim(std::string_view text) {
  const auto is_blank = [](char c) { return c == ' ' || c == '\t'; };
  while (!text.empty() && is_blank(text.front())) text.remove_prefix(1);
  while (!text.empty() && is_blank(text.back())) text.remove_suffix(1);
  return text;
}

std::string_view without_comment(std::string_view line) {
  if (line.find('$') == std::string_view::npos) return line;
  char quote = '\0';
  for (std::size_t i = 0; i < line.size(); ++i) {
    const char c = line[i];
    if (quote != '\0') {
      if (c == quote) quote = '\0';
    } else if (c == '$') {
      return line.substr(0, i);
    } else if ((c == '\'' || c == '"') && line.find(c, i + 1) != std::string_view::npos) {
      quote = c;  // a lone apostrophe opens nothing
    }
  }
  return line;
}

void make_capitals(std::string& bytes, std::string_view part) {
  if (part.empty()) return;
  char* const first = bytes.data() + (part.data() - bytes.data());
  for (char* c = first; c != first + part.size(); ++c) {
    if (*c >= 'a' && *c <= 'z') *c = static_cast<char>(*c - 'a' + 'A');
  }
}

BulkRow cut_row(std::string_view line, const SourceLocation& location, NastranDeck::Text& text) {
  const std::size_t start = line.find_first_not_of(' ');
  const bool is_rest_of_a_list = start < 8 && is_digit(line[start]);
  const bool has_comma = line.substr(0, k_columns_of_data).find(',') != std::string_view::npos;
  if (has_comma || is_rest_of_a_list) return cut_free_row(line, location, text);
  if (line.find('\t') != std::string_view::npos) line = text.bytes.emplace_back(with_tabs_expanded(line));
  return cut_fixed_row(line, location, text);
}

}  // namespace mottle::formats::nastran
