#include "formats/gmsh/words.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <limits>

#include "mottle/core/error.hpp"
#include "mottle/formats/text_lines.hpp"

namespace mottle::formats::gmsh {
namespace {

bool is_blank(char letter) {
  return letter == ' ' || letter == '\n' || letter == '\t' || letter == '\r';
}

/// Text for messages, without what cannot be printed.
std::string shown(std::string_view text) {
  std::string result(text.substr(0, 24));
  std::ranges::replace_if(
      result, [](char letter) { return letter < ' ' || letter > '~'; }, '?');
  return result;
}

}  // namespace

void Words::fail(const std::string& message) const {
  throw FormatError(file_, line_, message);
}

std::string_view Words::next() {
  for (; at_ < bytes_.size() && is_blank(bytes_[at_]); ++at_) line_ += bytes_[at_] == '\n' ? 1 : 0;
  const std::size_t begin = at_;
  while (at_ < bytes_.size() && !is_blank(bytes_[at_])) ++at_;
  return bytes_.substr(begin, at_ - begin);
}

std::string_view Words::need(const char* what) {
  const std::string_view word = next();
  if (word.empty()) fail(fmt::format("the file ends where {} is expected", what));
  return word;
}

int Words::whole(const char* what, int lowest, int highest) {
  const std::string_view word = need(what);
  int value = 0;
  if (!parse_whole_number(word, value) || value < lowest || value > highest) {
    fail(fmt::format("'{}' stands where {} is expected, a whole number from {}", shown(word), what, lowest));
  }
  return value;
}

int Words::tag(const char* what) {
  return whole(what, 1, std::numeric_limits<int>::max());
}

std::size_t Words::count(const char* what) {
  const int value = whole(what, 0, std::numeric_limits<int>::max());
  if (static_cast<std::size_t>(value) > (bytes_.size() - at_) / 2 + 1) {
    fail(fmt::format("{} is {}, more than the file holds", what, value));
  }
  return static_cast<std::size_t>(value);
}

double Words::real(const char* what) {
  const std::string_view word = need(what);
  double value = 0.0;
  if (!parse_printed_number(word, value)) {
    fail(fmt::format("'{}' stands where {} is expected, a number", shown(word), what));
  }
  return value;
}

std::string Words::quoted(const char* what) {
  const std::string_view word = need(what);
  const std::size_t begin = at_ - word.size();
  const std::size_t end = word.front() == '"' ? bytes_.find('"', begin + 1) : std::string_view::npos;
  if (end == std::string_view::npos || bytes_.substr(begin, end - begin).find('\n') != std::string_view::npos) {
    fail(fmt::format("'{}' stands where {} in quotes is expected", shown(word), what));
  }
  at_ = end + 1;
  return std::string(bytes_.substr(begin + 1, end - begin - 1));
}

void Words::skip(std::size_t words, const char* what) {
  for (std::size_t k = 0; k < words; ++k) need(what);
}

void Words::skip_section(std::string_view name) {
  const std::string end = fmt::format("$End{}", name);
  for (std::string_view word = next(); word != end; word = next()) {
    if (word.empty()) fail(fmt::format("${} has no {}", shown(name), shown(end)));
  }
}

void Words::end_section(std::string_view name) {
  const std::string end = fmt::format("$End{}", name);
  const std::string_view word = need(end.c_str());
  if (word != end) fail(fmt::format("'{}' stands where {} is expected", shown(word), end));
}

}  // namespace mottle::formats::gmsh
