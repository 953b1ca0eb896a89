// Version 4: matrices one behind the other, each behind five whole numbers and its name.
// Source: [MatFileFormat], appendix "Level 4 MAT-File Format".
#include <array>
#include <bit>
#include <cstring>

#include "formats/matrices/mat_readers.hpp"

namespace mottle::formats {
namespace {

static_assert(std::endian::native == std::endian::little);

struct Head {
  std::uint32_t type;  ///< digits MOPT: order of bytes, 0, precision, and numbers, text or sparse
  std::uint32_t rows, columns, is_complex, name_length;
};

constexpr std::string_view k_foreign = "is no MATLAB file (versions 4, 5 to 7 and 7.3 are read)";

}  // namespace

MatVariables parse_mat_level4(std::string_view bytes, MatBudget& budget) {
  constexpr std::array k_precisions = {MatNumber::double_precision,
                                       MatNumber::single_precision,
                                       MatNumber::int32,
                                       MatNumber::int16,
                                       MatNumber::uint16,
                                       MatNumber::uint8};
  constexpr std::uint32_t k_big_endian = 1000;
  constexpr std::size_t k_longest_name = 4096;
  MatVariables variables;
  while (!bytes.empty()) {
    Head head = {};
    if (bytes.size() < sizeof(head)) budget.fail(std::string(k_foreign));
    std::memcpy(&head, bytes.data(), sizeof(head));
    constexpr std::uint32_t k_largest_type = 4052;
    const bool is_swapped = head.type > k_largest_type;
    if (is_swapped) {
      for (std::uint32_t* word : {&head.type, &head.rows, &head.columns, &head.is_complex, &head.name_length}) {
        *word = __builtin_bswap32(*word);
      }
    }
    const std::uint32_t precision = head.type / 10 % 10;
    const std::uint32_t content = head.type % 10;
    const bool is_known = head.type / 1000 * 1000 == (is_swapped ? k_big_endian : 0) && head.type / 100 % 10 == 0 &&
                          precision < k_precisions.size() && content <= 2 && head.is_complex <= 1 &&
                          head.name_length >= 1 && head.name_length <= k_longest_name;
    if (!is_known) budget.fail(std::string(k_foreign));
    bytes.remove_prefix(sizeof(head));
    if (bytes.size() < head.name_length) budget.fail("ends within a name");
    const std::string name(bytes.substr(0, bytes.substr(0, head.name_length).find('\0')));
    bytes.remove_prefix(head.name_length);
    MatVariable variable{.sizes = {head.rows, head.columns}};
    const MatNumber type = k_precisions[precision];
    const std::uint64_t limit = bytes.size() / size_of(type);
    const std::uint64_t count = element_count(variable.sizes, limit);
    if (count * (head.is_complex + 1) > limit) {
      budget.fail(fmt::format("variable '{}' is {} x {}, and the file ends before that many numbers", name, head.rows,
                              head.columns));
    }
    const std::string_view data = bytes.substr(0, count * size_of(type));
    bytes.remove_prefix(data.size() * (head.is_complex + 1));
    if (content == 2 || head.is_complex != 0) continue;
    variable.numbers = mat_numbers(data, type, is_swapped, budget);
    if (content == 1) {
      budget.take(head.columns > 0 ? head.rows * sizeof(std::string) : 0);
      variable.texts = character_rows(variable.sizes, variable.numbers);
      variable.numbers.clear();
    }
    keep(variables, name, std::move(variable));
  }
  return variables;
}

}  // namespace mottle::formats
