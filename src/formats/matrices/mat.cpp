#include "mottle/formats/matrices/mat.hpp"

#include <cstring>

#include "formats/matrices/mat_readers.hpp"
#include "mottle/core/error.hpp"
#include "mottle/core/files.hpp"

namespace mottle::formats {
namespace {

template <typename Number>
void append(std::string_view bytes, bool is_swapped, std::vector<double>& numbers) {
  char raw[sizeof(Number)];
  for (; bytes.size() >= sizeof(Number); bytes.remove_prefix(sizeof(Number))) {
    for (std::size_t k = 0; k < sizeof(Number); ++k) raw[is_swapped ? sizeof(Number) - 1 - k : k] = bytes[k];
    Number number;
    std::memcpy(&number, raw, sizeof(Number));
    numbers.push_back(static_cast<double>(number));
  }
}

struct NumberType {
  std::size_t size;
  void (*append)(std::string_view, bool, std::vector<double>&);
};

template <typename Number>
constexpr NumberType number_type() {
  return {sizeof(Number), append<Number>};
}

const NumberType& type_of(MatNumber type) {
  static constexpr NumberType k_types[] = {number_type<std::int8_t>(),  number_type<std::uint8_t>(),
                                           number_type<std::int16_t>(), number_type<std::uint16_t>(),
                                           number_type<std::int32_t>(), number_type<std::uint32_t>(),
                                           number_type<std::int64_t>(), number_type<std::uint64_t>(),
                                           number_type<float>(),        number_type<double>()};
  return k_types[static_cast<int>(type)];
}

}  // namespace

void MatBudget::fail(const std::string& message) const {
  throw FormatError(file_, 0, message);
}

void MatBudget::take(std::uint64_t bytes) {
  if (bytes > left_)
    fail(fmt::format("its variables take more than {} bytes; save those of the tests alone", k_max_mat_bytes));
  left_ -= bytes;
}

std::size_t size_of(MatNumber type) {
  return type_of(type).size;
}

std::vector<double> mat_numbers(std::string_view bytes, MatNumber type, bool is_swapped, MatBudget& budget) {
  const std::size_t count = bytes.size() / size_of(type);
  budget.take(count * sizeof(double));
  std::vector<double> numbers;
  numbers.reserve(count);
  type_of(type).append(bytes, is_swapped, numbers);
  return numbers;
}

std::uint64_t element_count(const std::vector<std::size_t>& sizes, std::uint64_t limit) {
  std::uint64_t product = 1;
  for (const std::size_t size : sizes) {
    if (size == 0) return 0;
  }
  for (const std::size_t size : sizes) {
    if (size > limit / product) return limit + 1;
    product *= size;
  }
  return product;
}

std::vector<std::string> character_rows(const std::vector<std::size_t>& sizes, const std::vector<double>& codes) {
  std::vector<std::string> rows;
  if (sizes.size() != 2 || codes.empty() || element_count(sizes, codes.size()) != codes.size()) return rows;
  const std::size_t height = sizes[0];
  for (std::size_t row = 0; row < height; ++row) {
    std::string text;
    for (std::size_t k = row; k < codes.size(); k += height) {  // names are ASCII: the low byte is the letter
      const bool is_code = codes[k] >= 0.0 && codes[k] <= 65535.0;
      text += is_code ? static_cast<char>(static_cast<unsigned>(codes[k]) & 0xffU) : '?';
    }
    rows.push_back(text.substr(0, text.find_last_not_of(std::string_view(" \0", 2)) + 1));
  }
  return rows;
}

void keep(MatVariables& variables, const std::string& name, MatVariable variable) {
  const bool is_empty = variable.numbers.empty() && variable.texts.empty();
  if (!name.empty() && !is_empty) variables.emplace(name, std::move(variable));
}

MatVariables parse_mat(std::string_view bytes, const std::string& file) {
  constexpr std::size_t k_head = 128;
  const std::string_view order = bytes.size() >= k_head ? bytes.substr(k_head - 2, 2) : "";
  const char version = order == "IM" ? bytes[k_head - 3] : order == "MI" ? bytes[k_head - 4] : '\0';
  MatBudget budget(file);
  const auto parse = version == 1 ? parse_mat_level5 : version == 2 ? parse_mat_hdf5 : parse_mat_level4;
  MatVariables variables = parse(bytes, budget);
  if (variables.empty()) budget.fail("holds no variable that is an array of numbers or texts");
  return variables;
}

MatVariables read_mat(const std::string& file) {
  return parse_mat(read_file(file, k_max_mat_bytes), file);
}

}  // namespace mottle::formats
