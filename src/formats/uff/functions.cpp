// Datasets 58 and 58b: functions at degrees of freedom.
#include <fmt/format.h>

#include <algorithm>
#include <bit>
#include <cmath>
#include <cstring>

#include "formats/uff/datasets.hpp"
#include "mottle/core/error.hpp"

namespace mottle::formats {
namespace {

constexpr UffWidths k_single = {13, 13, 13, 13, 13, 13};

int whole(const UffCursor& cursor, std::string_view line, std::size_t start, std::size_t width, const char* what) {
  const std::string field = uff_columns(line, start, width);
  if (field.empty()) return 0;
  char* end = nullptr;
  errno = 0;
  const long number = std::strtol(field.c_str(), &end, 10);
  if (*end != '\0' || errno != 0 || std::abs(number) > 2'000'000'000L) {
    cursor.fail(fmt::format("columns {} to {} hold no whole number ({})", start + 1, start + width, what));
  }
  return static_cast<int>(number);
}

void read_identification(UffCursor& cursor, UffFunction& function) {
  const std::string_view line = cursor.line("the function's degrees of freedom");
  function.type = whole(cursor, line, 0, 5, "function type");
  function.id = whole(cursor, line, 5, 10, "function number");
  function.version = whole(cursor, line, 15, 5, "version");
  function.load_case = whole(cursor, line, 20, 10, "load case");
  function.response_name = uff_columns(line, 31, 10);
  function.response_node = whole(cursor, line, 41, 10, "response node");
  function.response_direction = whole(cursor, line, 51, 4, "response direction");
  function.reference_name = uff_columns(line, 56, 10);
  function.reference_node = whole(cursor, line, 66, 10, "reference node");
  function.reference_direction = whole(cursor, line, 76, 4, "reference direction");
  for (const int direction : {function.response_direction, function.reference_direction}) {
    if (std::abs(direction) > 6) cursor.fail(fmt::format("direction {}: 0 and +-1 to +-6 are known", direction));
  }
}

std::size_t read_form(UffCursor& cursor, UffFunction& function) {
  const std::vector<double> form =
      cursor.numbers("data type, number of points, spacing, start, step, z", {10, 10, 10, 13, 13, 13}, 6);
  const double type = form[0];
  if (type != 2.0 && type != 4.0 && type != 5.0 && type != 6.0) {
    cursor.fail(fmt::format("data type {}: 2, 4 (real), 5, 6 (complex, single and double precision) are known", type));
  }
  function.is_complex = type >= 5.0;
  function.is_double = type == 4.0 || type == 6.0;
  const double points = form[1];
  if (points < 1.0 || points != std::round(points) || points > 2e9) {
    cursor.fail(fmt::format("{} points: a whole number >= 1 is needed", points));
  }
  function.is_even = form[2] != 0.0;
  function.start = form[3];
  function.step = form[4];
  function.z = form[5];
  return static_cast<std::size_t>(points);
}

UffAxis read_axis(UffCursor& cursor, const char* what) {
  const std::string_view line = cursor.line(what);
  UffAxis axis;
  axis.quantity = whole(cursor, line, 0, 10, what);
  for (std::size_t k = 0; k < 3; ++k) axis.units[k] = whole(cursor, line, 10 + 5 * k, 5, what);
  for (const int exponent : axis.units) {
    constexpr int k_max = 20;
    if (std::abs(exponent) > k_max) cursor.fail(fmt::format("a unit to the power of {} ({})", exponent, what));
  }
  axis.label = uff_columns(line, 26, 20);
  axis.unit = uff_columns(line, 47, 20);
  return axis;
}

std::vector<double> read_text_numbers(UffCursor& cursor, const UffFunction& function, std::size_t count) {
  constexpr const char* k_what = "the function's values";
  if (!function.is_double) return cursor.values(k_what, k_single, count);
  if (function.is_even) return cursor.values(k_what, {20, 20, 20, 20}, count);
  if (function.is_complex) return cursor.values(k_what, {13, 20, 20}, count);
  return cursor.values(k_what, {13, 20, 13, 20}, count);
}

/// Layout of the bytes that follow the line of a 58b.
struct Layout {
  bool is_big_endian = false;
  std::size_t titles = 11, bytes = 0;
};

Layout read_layout(const UffCursor& cursor, const std::string& text) {
  // Behind the b: order, format, lines, bytes in columns of 6, 6, 12, 12.
  const int order = whole(cursor, text, 0, 6, "byte order");
  const int format = whole(cursor, text, 6, 6, "floating-point format");
  const int lines = whole(cursor, text, 12, 12, "number of lines of text");
  const int bytes = whole(cursor, text, 24, 12, "number of bytes");
  if (order != 1 && order != 2) {
    cursor.fail(fmt::format("byte order {}: 1 (little-endian) and 2 (big-endian) are known", order));
  }
  if (format != 2) cursor.fail(fmt::format("floating-point format {}: 2 (IEEE 754) alone is read", format));
  if (lines != 11) cursor.fail(fmt::format("{} lines of text in front of the bytes: a function has 11", lines));
  if (bytes < 0) cursor.fail(fmt::format("{} bytes of binary data", bytes));
  return {order == 2, 11, static_cast<std::size_t>(bytes)};
}

double number_at(std::string_view bytes, std::size_t at, bool is_double, bool is_big_endian) {
  std::array<char, 8> buffer = {};
  const std::size_t size = is_double ? 8 : 4;
  std::copy_n(bytes.data() + at, size, buffer.data());
  const bool is_foreign = is_big_endian != (std::endian::native == std::endian::big);
  if (is_foreign) std::reverse(buffer.data(), buffer.data() + size);
  if (is_double) return std::bit_cast<double>(buffer);
  float number = 0.0F;
  std::memcpy(&number, buffer.data(), sizeof number);
  return static_cast<double>(number);
}

/// Whether a mark follows so many bytes, behind blanks and line ends.
bool ends_after(std::string_view rest, std::size_t size) {
  if (size > rest.size()) return false;
  const std::string_view behind = rest.substr(size);
  const std::size_t mark = behind.find_first_not_of(" \r\n");
  if (mark == std::string_view::npos || !behind.substr(mark).starts_with("-1")) return false;
  const std::string_view after = behind.substr(mark + 2);
  const std::string_view line = after.substr(0, after.find('\n'));
  return line.find_first_not_of(" \r\t") == std::string_view::npos;
}

std::vector<double> read_binary_numbers(UffCursor& cursor, const UffFunction& function, const Layout& layout,
                                        std::size_t points) {
  const std::size_t per_point = (function.is_complex ? 2 : 1) + (function.is_even ? 0 : 1);
  const std::size_t width = function.is_double ? 8 : 4;
  // The abscissa is single precision by the format, double in the files of some programs.
  const std::size_t by_format = points * (per_point * width - (!function.is_even && function.is_double ? 4 : 0));
  const std::size_t all_alike = points * per_point * width;
  const bool is_alike =
      by_format == all_alike || (!ends_after(cursor.rest(), by_format) && ends_after(cursor.rest(), all_alike));
  const std::size_t size = is_alike ? all_alike : by_format;
  const std::size_t start = cursor.position();
  if (!ends_after(cursor.rest(), size)) {
    cursor.fail(fmt::format(
        "at byte {}: {} points take {} bytes with '    -1' behind them; {} bytes are left and the header announces {}",
        start, points, size, cursor.left(), layout.bytes));
  }
  const std::string_view bytes = cursor.take(size);
  std::vector<double> numbers;
  for (std::size_t at = 0; at < size;) {
    const bool is_abscissa = !function.is_even && numbers.size() % per_point == 0;
    const bool is_double = function.is_double && (is_alike || !is_abscissa);
    numbers.push_back(number_at(bytes, at, is_double, layout.is_big_endian));
    if (!std::isfinite(numbers.back())) {
      cursor.fail(fmt::format("at byte {}: {} stands where a finite number should be", start + at, numbers.back()));
    }
    at += is_double ? 8 : 4;
  }
  if (!cursor.at_mark()) cursor.any_line();  // what is left of the line that the bytes ended
  return numbers;
}

void store_numbers(const std::vector<double>& numbers, std::size_t points, UffFunction& function) {
  const std::size_t per_point = numbers.size() / points;
  const auto count = static_cast<Eigen::Index>(points);
  function.values.resize(count);
  function.abscissa.resize(count);
  for (std::size_t k = 0; k < points; ++k) {
    const auto row = static_cast<Eigen::Index>(k);
    const double* at = numbers.data() + k * per_point;
    function.abscissa(row) = function.is_even ? function.start + static_cast<double>(k) * function.step : *at++;
    function.values(row) = {at[0], function.is_complex ? at[1] : 0.0};
  }
}

}  // namespace

void read_uff_function(UffCursor& cursor, UffFile& out, const std::optional<std::string>& binary) {
  UffFunction function;
  function.line = cursor.line_number();
  function.is_binary = binary.has_value();
  Layout layout;
  if (binary) layout = read_layout(cursor, *binary);
  function.titles = read_uff_titles(cursor);
  read_identification(cursor, function);
  const std::size_t points = read_form(cursor, function);
  function.abscissa_axis = read_axis(cursor, "the abscissa");
  function.ordinate_axis = read_axis(cursor, "the ordinate");
  function.denominator_axis = read_axis(cursor, "the ordinate's denominator");
  function.z_axis = read_axis(cursor, "the z axis");
  const std::size_t per_point = (function.is_complex ? 2 : 1) + (function.is_even ? 0 : 1);
  store_numbers(binary ? read_binary_numbers(cursor, function, layout, points)
                       : read_text_numbers(cursor, function, points * per_point),
                points, function);
  out.functions.push_back(std::move(function));
}

}  // namespace mottle::formats
