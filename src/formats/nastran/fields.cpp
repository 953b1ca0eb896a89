#include "formats/nastran/fields.hpp"

#include <array>
#include <charconv>
#include <cmath>

#include "formats/nastran/rows.hpp"
#include "mottle/core/error.hpp"

namespace mottle::formats::nastran {
namespace {

/// Nastran's number as from_chars wants it: E in front of the exponent. Empty where `text` has another form.
std::string_view standard_form(std::string_view text, std::array<char, 64>& buffer) {
  if (text.starts_with('+')) text.remove_prefix(1);
  std::size_t size = 0;
  bool has_point = false;
  bool has_digit = false;
  bool has_exponent = false;
  for (std::size_t i = 0; i < text.size() && size + 2 < buffer.size(); ++i) {
    const char c = text[i];
    if (c >= '0' && c <= '9') {
      has_digit = true;
      buffer[size++] = c;
    } else if (c == '.' && !has_point && !has_exponent) {
      has_point = true;
      buffer[size++] = c;
    } else if ((c == 'E' || c == 'D' || c == 'e' || c == 'd') && has_digit && !has_exponent) {
      has_exponent = true;
      buffer[size++] = 'e';
      if (i + 1 < text.size() && text[i + 1] == '+') ++i;
      if (i + 1 < text.size() && text[i + 1] == '-') buffer[size++] = text[++i];
    } else if ((c == '+' || c == '-') && has_point && has_digit && !has_exponent) {
      has_exponent = true;
      buffer[size++] = 'e';
      if (c == '-') buffer[size++] = c;
    } else if (c == '-' && i == 0) {
      buffer[size++] = c;
    } else {
      return {};
    }
  }
  const bool is_cut = size + 2 >= buffer.size();
  return is_cut || !has_digit ? std::string_view{} : std::string_view(buffer.data(), size);
}

}  // namespace

bool parse_real(std::string_view text, double& value) {
  std::array<char, 64> buffer;
  const std::string_view standard = standard_form(text, buffer);
  if (standard.empty()) return false;
  const auto [end, error] = std::from_chars(standard.data(), standard.data() + standard.size(), value);
  if (error == std::errc::result_out_of_range && end == standard.data() + standard.size()) {
    value = 0.0;  // too small; what is too large is refused
    return standard.find("e-") != std::string_view::npos;
  }
  return error == std::errc{} && end == standard.data() + standard.size() && std::isfinite(value);
}

bool parse_integer(std::string_view text, int& value) {
  if (text.size() > 1 && text.front() == '+' && text[1] != '-') text.remove_prefix(1);
  const auto [end, error] = std::from_chars(text.data(), text.data() + text.size(), value);
  return error == std::errc{} && end == text.data() + text.size();
}

bool parse_components(std::string_view text, Components& value) {
  value = 0;
  if (text.empty() || text == "0") return true;
  for (const char c : text) {
    if (c == ' ' || c == '\t') continue;
    if (c < '1' || c > '6') return false;
    const auto bit = static_cast<Components>(1U << (c - '1'));
    if ((value & bit) != 0) return false;
    value |= bit;
  }
  return true;
}

bool Card::is_integer(int n) const {
  int value = 0;
  return parse_integer(at(n), value);
}

bool Card::has_any(int first, int last) const {
  for (int n = first; n <= last && n <= size(); ++n) {
    if (!is_blank(n)) return true;
  }
  return false;
}

int Card::integer(int n, std::string_view what) const {
  int value = 0;
  if (is_blank(n)) fail(fmt::format("{} is blank, an integer is needed", what));
  if (!parse_integer(at(n), value)) fail(fmt::format("{} is '{}', an integer is needed", what, shown(at(n))));
  return value;
}

int Card::integer_or(int n, std::string_view what, int otherwise) const {
  return is_blank(n) ? otherwise : integer(n, what);
}

int Card::id(int n, std::string_view what) const {
  const int value = integer(n, what);
  if (value < 1) fail(fmt::format("{} is {}, an integer from 1 is needed", what, value));
  return value;
}

double Card::real(int n, std::string_view what) const {
  double value = 0.0;
  if (is_blank(n)) fail(fmt::format("{} is blank, a number is needed", what));
  if (!parse_real(at(n), value)) fail(fmt::format("{} is '{}', a number is needed", what, shown(at(n))));
  return value;
}

double Card::real_or(int n, std::string_view what, double otherwise) const {
  return is_blank(n) ? otherwise : real(n, what);
}

Components Card::components(int n, std::string_view what) const {
  Components value = 0;
  if (!parse_components(at(n), value)) {
    fail(fmt::format("{} is '{}', digits from 1 to 6 are allowed, each once", what, shown(at(n))));
  }
  return value;
}

void Card::require_absent(int n, std::string_view what, std::string_view reason) const {
  double value = 0.0;
  if (is_blank(n) || (parse_real(at(n), value) && value == 0.0)) return;
  fail(fmt::format("{} is '{}'; {}", what, shown(at(n)), reason));
}

void Card::fail(const std::string& message) const {
  const std::string id = is_blank(1) ? std::string() : ' ' + shown(at(1));
  nastran::fail({deck_->files[static_cast<std::size_t>(card_->file)], card_->line},
                fmt::format("{}{}: {}", name(), id, message));
}

}  // namespace mottle::formats::nastran
