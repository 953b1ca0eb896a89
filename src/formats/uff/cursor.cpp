#include "formats/uff/cursor.hpp"

#include <algorithm>
#include <cmath>
#include <limits>

#include "mottle/core/error.hpp"
#include "mottle/core/text.hpp"

namespace mottle::formats {
namespace {

constexpr std::string_view k_blanks = " \t\r\v\f";

std::string_view trimmed(std::string_view text) {
  const std::size_t first = text.find_first_not_of(k_blanks);
  return first == std::string_view::npos ? std::string_view()
                                         : text.substr(first, text.find_last_not_of(k_blanks) - first + 1);
}

/// A number as Fortran writes it: 1.5D+03, 1.5-103.
bool read_number(std::string_view text, double& value) {
  constexpr std::size_t k_longest = 64;
  if (text.size() > k_longest) return false;
  std::string number(text);
  for (char& letter : number) {
    if (letter == 'D' || letter == 'd') letter = 'E';
  }
  const std::size_t sign = number.find_last_of("+-");
  const bool lacks_exponent_letter = sign != std::string::npos && sign > 0 && number.size() - sign == 4 &&
                                     number.find_first_of("Ee") == std::string::npos;
  if (lacks_exponent_letter) number.insert(number.begin() + static_cast<std::ptrdiff_t>(sign), 'E');
  return parse_number(number, value) && std::isfinite(value);
}

std::string shown(std::string_view text) {
  constexpr std::size_t k_shown = 40;
  std::string result;
  for (const char letter : text.substr(0, k_shown)) result += letter >= ' ' && letter <= '~' ? letter : '?';
  return result;
}

}  // namespace

std::string uff_columns(std::string_view line, std::size_t start, std::size_t width) {
  return start < line.size() ? std::string(trimmed(line.substr(start, width))) : std::string();
}

void UffCursor::fail(const std::string& message) const {
  throw FormatError(file_, std::max(line_, 1), message);
}

std::string_view UffCursor::peek() const {
  std::string_view next = rest().substr(0, rest().find('\n'));
  if (next.ends_with('\r')) next.remove_suffix(1);
  return next;
}

bool UffCursor::at_end() {
  while (left() > 0 && trimmed(peek()).find_first_not_of('\x1a') == std::string_view::npos) any_line();
  return left() == 0;
}

bool UffCursor::at_mark() const {
  constexpr std::size_t k_mark_columns = 6;
  const std::string_view next = peek();
  return trimmed(next) == "-1" && next.find('1') < k_mark_columns;
}

std::string_view UffCursor::any_line() {
  const std::string_view next = peek();
  const std::size_t end = rest().find('\n');
  position_ += end == std::string_view::npos ? left() : end + 1;
  ++line_;
  return next;
}

std::string_view UffCursor::line(std::string_view what) {
  if (left() == 0) fail(fmt::format("the file ends where {} should be", what));
  if (at_mark()) {
    any_line();
    fail(fmt::format("the dataset ends where {} should be", what));
  }
  return any_line();
}

std::string UffCursor::text(std::string_view what) {
  std::string_view next = line(what);
  next = next.substr(0, next.find_last_not_of(k_blanks) + 1);
  return std::string(next);
}

std::vector<double> UffCursor::split(std::string_view line, std::string_view what, UffWidths widths,
                                     std::size_t needed) const {
  line = line.substr(0, line.find_last_not_of(k_blanks) + 1);
  std::vector<double> numbers;
  double number = 0.0;
  bool are_numbers = true;
  std::string_view word;
  for (std::size_t at = line.find_first_not_of(k_blanks); at != std::string_view::npos && are_numbers;) {
    const std::size_t end = std::min(line.find_first_of(k_blanks, at), line.size());
    word = line.substr(at, end - at);
    are_numbers = read_number(word, number);
    numbers.push_back(number);
    at = line.find_first_not_of(k_blanks, end);
  }
  if (are_numbers && numbers.size() >= needed) return numbers;
  std::vector<double> in_columns;
  const auto* width = widths.begin();
  for (std::size_t at = 0; at < line.size();) {
    const auto columns = static_cast<std::size_t>(*width);
    const std::string_view field = trimmed(line.substr(at, columns));
    number = 0.0;
    if (!field.empty() && !read_number(field, number)) {
      if (are_numbers) return numbers;              // too few, but each of them a number
      const bool is_word = word.size() <= columns;  // else numbers touch, and the columns tell them apart
      fail(fmt::format("'{}' stands where a number should be ({})", shown(is_word ? word : field), what));
    }
    in_columns.push_back(number);
    at += columns;
    if (++width == widths.end()) width = widths.begin();
  }
  return in_columns;
}

std::vector<double> UffCursor::numbers(std::string_view what, UffWidths widths, std::size_t needed) {
  std::vector<double> numbers = split(line(what), what, widths, needed);
  if (numbers.empty()) fail(fmt::format("the line is blank where {} should be", what));
  if (numbers.size() < needed) numbers.resize(needed, 0.0);
  return numbers;
}

std::vector<int> UffCursor::integers(std::string_view what, UffWidths widths, std::size_t needed) {
  std::vector<int> result;
  for (const double number : numbers(what, widths, needed)) {
    constexpr double k_min = -999'999'999.0;  // ten columns
    const bool is_whole = number == std::round(number) && number >= k_min && number <= std::numeric_limits<int>::max();
    if (!is_whole) fail(fmt::format("{} stands where a whole number should be ({})", number, what));
    result.push_back(static_cast<int>(number));
  }
  return result;
}

std::vector<double> UffCursor::values(std::string_view what, UffWidths widths, std::size_t count) {
  std::vector<double> result;
  std::size_t on_first_line = 0;
  while (result.size() < count) {
    const std::size_t missing = count - result.size();
    const std::size_t needed = std::min(missing, on_first_line > 0 ? on_first_line : std::min(missing, widths.size()));
    const std::vector<double> next = split(line(what), what, widths, needed);
    // Some programs write fewer on a line than the format says; then they do so on every line.
    const bool is_narrower = on_first_line == 0 && next.size() > 1 && missing >= 2 * next.size();
    const bool is_full = next.size() >= needed || is_narrower;
    if (!is_full) fail(fmt::format("{} numbers stand where {} are needed ({})", next.size(), needed, what));
    if (next.size() > missing && std::any_of(next.begin() + static_cast<std::ptrdiff_t>(missing), next.end(),
                                             [](double value) { return value != 0.0; })) {
      fail(fmt::format("{} numbers stand where {} are left ({})", next.size(), missing, what));
    }
    result.insert(result.end(), next.begin(),
                  next.begin() + static_cast<std::ptrdiff_t>(std::min(missing, next.size())));
    if (on_first_line == 0) on_first_line = next.size();
  }
  return result;
}

std::string_view UffCursor::take(std::size_t count) {
  if (count > left()) fail(fmt::format("at byte {}: {} bytes are left where {} should be", position_, left(), count));
  const std::string_view taken = rest().substr(0, count);
  position_ += count;
  line_ += static_cast<int>(std::count(taken.begin(), taken.end(), '\n'));
  return taken;
}

}  // namespace mottle::formats
