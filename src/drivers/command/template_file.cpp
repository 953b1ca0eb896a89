#include "mottle/drivers/command/template_file.hpp"

#include <re2/re2.h>

#include <algorithm>
#include <cmath>
#include <cstdio>

#include "mottle/core/error.hpp"
#include "mottle/core/text.hpp"

namespace mottle::drivers {
namespace {

constexpr std::size_t k_longest_placeholder = 200;

std::string_view trimmed(std::string_view text) {
  while (!text.empty() && (text.front() == ' ' || text.front() == '\t')) text.remove_prefix(1);
  while (!text.empty() && (text.back() == ' ' || text.back() == '\t')) text.remove_suffix(1);
  return text;
}

int lines_in(std::string_view text) {
  return static_cast<int>(std::count(text.begin(), text.end(), '\n'));
}

}  // namespace

std::vector<std::string> placeholder_names(std::string_view text, const std::string& file) {
  std::vector<std::string> names;
  int line = 1;
  for (std::size_t begin = text.find("{{"); begin != std::string_view::npos; begin = text.find("{{")) {
    line += lines_in(text.substr(0, begin));
    text.remove_prefix(begin + 2);
    const std::size_t end = text.find("}}");
    if (end > k_longest_placeholder || lines_in(text.substr(0, end)) > 0) {
      throw FormatError(file, line, "{{ without }} on the same line");
    }
    const std::string_view inside = text.substr(0, end);
    const std::size_t colon = inside.rfind(':', inside.find('%'));
    const std::string_view before = inside.find('%') == std::string_view::npos ? inside : inside.substr(0, colon);
    const std::string name(trimmed(before.substr(0, before.find('*'))));
    if (std::find(names.begin(), names.end(), name) == names.end()) names.push_back(name);
    text.remove_prefix(end + 2);
  }
  return names;
}

Template::Template(std::string_view text, std::string file, const std::vector<std::string>& names)
    : file_(std::move(file)) {
  int line = 1;
  std::string* target = &head_;
  for (;;) {
    const std::size_t begin = text.find("{{");
    *target = text.substr(0, begin);
    line += lines_in(*target);
    if (begin == std::string_view::npos) return;
    text.remove_prefix(begin + 2);
    const std::size_t end = text.find("}}");
    if (end > k_longest_placeholder || lines_in(text.substr(0, end)) > 0) {
      throw FormatError(file_, line, "{{ without }} on the same line");
    }
    placeholders_.push_back(read_placeholder(text.substr(0, end), line, names));
    target = &placeholders_.back().text_after;
    text.remove_prefix(end + 2);
  }
}

Template::Placeholder Template::read_placeholder(std::string_view inside, int line,
                                                 const std::vector<std::string>& names) const {
  static const re2::RE2 k_format(R"(%[-+ 0]*([1-9][0-9]?)?(?:\.[0-9][0-9]?)?[eEfFgGd])");
  const std::size_t percent = inside.find('%');
  // A name may hold a colon: a format begins with the one before its percent sign.
  const std::size_t colon = percent == std::string_view::npos ? percent : inside.rfind(':', percent);
  Placeholder placeholder{.line = line, .name = std::string(trimmed(inside.substr(0, colon)))};
  auto found = std::find(names.begin(), names.end(), placeholder.name);
  const std::size_t star = placeholder.name.rfind('*');
  if (found == names.end() && star != std::string::npos) {
    const std::string number(trimmed(std::string_view(placeholder.name).substr(star + 1)));
    if (!parse_number(number, placeholder.factor)) {
      throw FormatError(file_, line, fmt::format("'{}' in '{}' is not a number", number, placeholder.name));
    }
    placeholder.name = trimmed(std::string_view(placeholder.name).substr(0, star));
    found = std::find(names.begin(), names.end(), placeholder.name);
  }
  if (found == names.end()) throw FormatError(file_, line, unknown_name_message("parameter", placeholder.name, names));
  placeholder.parameter = static_cast<std::size_t>(found - names.begin());
  if (colon == std::string_view::npos) return placeholder;
  placeholder.format = trimmed(inside.substr(colon + 1));
  std::string width;
  if (!re2::RE2::FullMatch(placeholder.format, k_format, &width)) {
    throw FormatError(
        file_, line,
        fmt::format("'{}' is no format for {}; allowed are %e, %f, %g and %d with a width and a precision "
                    "of at most two digits, like %8.3e",
                    placeholder.format, placeholder.name));
  }
  if (!width.empty()) placeholder.width = static_cast<std::size_t>(std::stoi(width));
  return placeholder;
}

std::string Template::text_of(const Placeholder& placeholder, double value) const {
  if (placeholder.format.empty()) return number_text(value);
  char buffer[512];  // %99.99f of 1e308 fits
  const bool is_whole = placeholder.format.back() == 'd';
  if (is_whole && (value != std::round(value) || std::abs(value) > 9e15)) {
    throw FormatError(
        file_, placeholder.line,
        fmt::format("{} = {} is not a whole number, as {} needs", placeholder.name, value, placeholder.format));
  }
  const std::string format =
      is_whole ? fmt::format("{}lld", placeholder.format.substr(0, placeholder.format.size() - 1)) : placeholder.format;
  const int length = is_whole ? std::snprintf(buffer, sizeof(buffer), format.c_str(), static_cast<long long>(value))
                              : std::snprintf(buffer, sizeof(buffer), format.c_str(), value);
  std::string text(buffer, static_cast<std::size_t>(length));
  if (placeholder.width > 0 && text.size() > placeholder.width) {
    throw FormatError(file_, placeholder.line,
                      fmt::format("{} = {} becomes '{}', {} characters, and its place has {}; take a shorter format "
                                  "than {}",
                                  placeholder.name, value, text, text.size(), placeholder.width, placeholder.format));
  }
  return text;
}

std::string Template::fill(const Eigen::Ref<const Eigen::VectorXd>& values) const {
  std::string text = head_;
  for (const Placeholder& placeholder : placeholders_) {
    text += text_of(placeholder, placeholder.factor * values(static_cast<Eigen::Index>(placeholder.parameter)));
    text += placeholder.text_after;
  }
  return text;
}

std::vector<bool> Template::uses(std::size_t parameters) const {
  std::vector<bool> used(parameters);
  for (const Placeholder& placeholder : placeholders_) used[placeholder.parameter] = true;
  return used;
}

std::vector<std::string> Template::coarse_placeholders(const Eigen::Ref<const Eigen::VectorXd>& values,
                                                       const Eigen::Ref<const Eigen::VectorXd>& steps) const {
  constexpr double k_max_error = 0.01;  // of a step: a derivative's error from rounding the input
  std::vector<std::string> coarse;
  for (const Placeholder& placeholder : placeholders_) {
    const auto p = static_cast<Eigen::Index>(placeholder.parameter);
    double near = 0.0;
    double far = 0.0;
    const double value = placeholder.factor * values(p);
    const double step = placeholder.factor * steps(p);
    if (placeholder.format.empty() || step == 0.0) continue;
    if (!parse_number(text_of(placeholder, value), near) || !parse_number(text_of(placeholder, value + step), far))
      continue;
    if (std::abs(far - near - step) <= k_max_error * std::abs(step)) continue;
    coarse.push_back(fmt::format("{}:{}: {} as {}", file_, placeholder.line, placeholder.name, placeholder.format));
  }
  return coarse;
}

}  // namespace mottle::drivers
