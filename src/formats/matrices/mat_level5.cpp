// Versions 5 to 7: elements one behind the other, each behind a tag with its type and size.
// Source: [MatFileFormat], "Level 5 MAT-File Format".
#include <zlib.h>

#include <algorithm>
#include <cstring>
#include <optional>

#include "formats/matrices/mat_readers.hpp"

namespace mottle::formats {
namespace {

enum DataType : std::uint32_t { k_matrix = 14, k_compressed = 15, k_utf8 = 16, k_utf16 = 17 };
enum ArrayClass : std::uint32_t { k_cell = 1, k_character = 4, k_double = 6, k_uint64 = 15 };

/// How an element's numbers lie; none where it holds something else.
std::optional<MatNumber> number_type(std::uint32_t type) {
  switch (type) {
    case 1:
      return MatNumber::int8;
    case 2:
    case k_utf8:
      return MatNumber::uint8;
    case 3:
      return MatNumber::int16;
    case 4:
    case k_utf16:
      return MatNumber::uint16;
    case 5:
      return MatNumber::int32;
    case 6:
      return MatNumber::uint32;
    case 7:
      return MatNumber::single_precision;
    case 9:
      return MatNumber::double_precision;
    case 12:
      return MatNumber::int64;
    case 13:
      return MatNumber::uint64;
    default:
      return std::nullopt;
  }
}

struct Element {
  std::uint32_t type = 0;
  std::string_view data = {};
};

/// Takes elements off the front of some bytes.
class Elements {
 public:
  Elements(std::string_view bytes, bool is_swapped, MatBudget& budget)
      : bytes_(bytes), is_swapped_(is_swapped), budget_(budget) {}

  bool is_at_end() const { return bytes_.empty(); }

  Element next() {
    constexpr std::size_t k_tag = 8;
    if (bytes_.size() < k_tag) budget_.fail("ends within a variable");
    Element element{.type = word(0)};
    std::size_t size = word(4);
    std::size_t begin = k_tag;
    if (element.type >> 16U != 0) {  // up to four bytes that lie in the tag itself
      size = element.type >> 16U;
      element.type &= 0xffffU;
      begin = 4;
      if (size > 4) budget_.fail("a small element has more than 4 bytes");
    }
    if (size > bytes_.size() - begin) {
      budget_.fail(fmt::format("an element has {} bytes, and {} are left", size, bytes_.size() - begin));
    }
    element.data = bytes_.substr(begin, size);
    const std::size_t padded = element.type == k_compressed ? begin + size : (begin + size + 7) / 8 * 8;
    bytes_.remove_prefix(std::min(padded, bytes_.size()));
    return element;
  }

 private:
  std::uint32_t word(std::size_t at) const {
    std::uint32_t value = 0;
    std::memcpy(&value, bytes_.data() + at, sizeof(value));
    return is_swapped_ ? __builtin_bswap32(value) : value;
  }

  std::string_view bytes_;
  bool is_swapped_;
  MatBudget& budget_;
};

/// A stream of zlib's, ended where it goes out of use.
class Inflation {
 public:
  Inflation(std::string_view packed, MatBudget& budget) : budget_(budget) {
    stream_.next_in = reinterpret_cast<Bytef*>(const_cast<char*>(packed.data()));  // NOLINT: zlib only reads it
    stream_.avail_in = static_cast<uInt>(packed.size());
    if (inflateInit(&stream_) != Z_OK) throw std::bad_alloc();
  }
  Inflation(const Inflation&) = delete;
  Inflation& operator=(const Inflation&) = delete;
  ~Inflation() { inflateEnd(&stream_); }

  void read(char* bytes, std::size_t size) {
    stream_.next_out = reinterpret_cast<Bytef*>(bytes);
    stream_.avail_out = static_cast<uInt>(size);
    while (stream_.avail_out > 0) {
      const int status = inflate(&stream_, Z_NO_FLUSH);
      const bool is_short = status == Z_STREAM_END || status == Z_BUF_ERROR || status == Z_OK;
      if (!is_short) budget_.fail("a packed variable cannot be unpacked");
      if (status != Z_OK && stream_.avail_out > 0) budget_.fail("a packed variable is shorter than it says");
    }
  }

  /// Throws FormatError where there is more than was read, or where zlib's checksum at the end is missing or does not
  /// agree with the unpacked bytes: the numbers may then be wrong.
  void finish() {
    char more = 0;
    stream_.next_out = reinterpret_cast<Bytef*>(&more);
    stream_.avail_out = 1;
    if (inflate(&stream_, Z_FINISH) != Z_STREAM_END || stream_.avail_out == 0) {
      budget_.fail("a packed variable is damaged");
    }
  }

 private:
  z_stream stream_ = {};
  MatBudget& budget_;
};

/// The element that lies packed in another. Its size is known, and paid for, before it is unpacked.
std::string unpacked(std::string_view packed, bool is_swapped, MatBudget& budget) {
  Inflation inflation(packed, budget);
  std::string bytes(8, '\0');
  inflation.read(bytes.data(), bytes.size());
  std::uint32_t size = 0;
  std::memcpy(&size, bytes.data() + 4, sizeof(size));
  if (is_swapped) size = __builtin_bswap32(size);
  constexpr std::uint64_t k_largest_ratio = 1032;  // of deflate
  if (size > k_largest_ratio * packed.size()) budget.fail("a packed variable claims more than it can hold");
  budget.take(size);
  bytes.resize(8 + std::size_t{size});
  inflation.read(bytes.data() + 8, size);
  inflation.finish();
  return bytes;
}

/// What stands in front of every array.
struct ArrayHead {
  std::uint32_t array_class = 0;
  bool is_complex = false;
  std::vector<std::size_t> sizes = {};
  std::string name = {};
};

class Level5Reader {
 public:
  Level5Reader(bool is_swapped, MatBudget& budget) : is_swapped_(is_swapped), budget_(budget) {}

  void read_into(MatVariables& variables, Elements elements) {
    while (!elements.is_at_end()) {
      Element element = elements.next();
      std::string bytes;
      if (element.type == k_compressed) {
        bytes = unpacked(element.data, is_swapped_, budget_);
        element = elements_of(bytes).next();
      }
      if (element.type != k_matrix) budget_.fail(fmt::format("holds an element of type {}", element.type));
      if (element.data.empty()) continue;
      Elements parts = elements_of(element.data);
      ArrayHead head = read_head(parts);
      MatVariable variable = read_content(head, parts);
      keep(variables, head.name, std::move(variable));
    }
  }

  Elements elements_of(std::string_view bytes) const { return {bytes, is_swapped_, budget_}; }

 private:
  ArrayHead read_head(Elements& parts) const {
    constexpr std::uint32_t k_complex = 0x800;
    constexpr std::size_t k_max_dimensions = 32;
    const Element flags = parts.next();
    const Element sizes = parts.next();
    const Element name = parts.next();
    const bool is_sound = flags.type == 6 && flags.data.size() == 8 && sizes.type == 5 && sizes.data.size() % 4 == 0 &&
                          sizes.data.size() >= 8 && sizes.data.size() <= 4 * k_max_dimensions && name.type <= 2;
    if (!is_sound) budget_.fail("the head of a variable has parts that it should not have");
    ArrayHead head{.name = std::string(name.data.substr(0, name.data.find('\0')))};
    const std::vector<double> words = mat_numbers(flags.data, MatNumber::uint32, is_swapped_, budget_);
    const auto word = static_cast<std::uint32_t>(words[0]);
    head.array_class = word & 0xffU;
    head.is_complex = (word & k_complex) != 0;
    for (const double size : mat_numbers(sizes.data, MatNumber::int32, is_swapped_, budget_)) {
      if (size < 0.0) budget_.fail(fmt::format("variable '{}' has a negative size", head.name));
      head.sizes.push_back(static_cast<std::size_t>(size));
    }
    return head;
  }

  /// Nothing where the variable is of another kind. Nested arrays are passed over, not descended into.
  MatVariable read_content(const ArrayHead& head, Elements& parts) const {
    MatVariable variable{.sizes = head.sizes};
    if (head.array_class == k_cell) {
      variable.texts = read_cells(head, parts);
    } else if (head.array_class == k_character) {
      variable.texts = read_characters(head, parts);
    } else if (head.array_class >= k_double && head.array_class <= k_uint64 && !head.is_complex) {
      variable.numbers = read_numbers(head, parts);
    }
    return variable;
  }

  std::vector<double> read_numbers(const ArrayHead& head, Elements& parts) const {
    if (element_count(head.sizes, 0) == 0) return {};
    const Element data = parts.next();
    const std::optional<MatNumber> type = number_type(data.type);
    if (!type) budget_.fail(fmt::format("variable '{}' holds data of type {}", head.name, data.type));
    const std::size_t count = data.data.size() / size_of(*type);
    if (element_count(head.sizes, count) != count) {
      budget_.fail(fmt::format("variable '{}' holds {} numbers, and its sizes say another count", head.name, count));
    }
    return mat_numbers(data.data, *type, is_swapped_, budget_);
  }

  std::vector<std::string> read_characters(const ArrayHead& head, Elements& parts) const {
    const std::vector<double> codes = read_numbers(head, parts);
    budget_.take(codes.empty() ? 0 : head.sizes[0] * sizeof(std::string));
    return character_rows(head.sizes, codes);
  }

  /// The first row of each cell; none at all where a cell is no text.
  std::vector<std::string> read_cells(const ArrayHead& head, Elements& parts) const {
    std::vector<std::string> texts;
    const std::uint64_t count = element_count(head.sizes, k_max_mat_bytes / sizeof(std::string));
    for (std::uint64_t k = 0; k < count; ++k) {
      const Element cell = parts.next();
      if (cell.type != k_matrix) budget_.fail(fmt::format("a cell of '{}' is no array", head.name));
      if (cell.data.empty()) return {};
      Elements inside = elements_of(cell.data);
      const ArrayHead its_head = read_head(inside);
      if (its_head.array_class != k_character) return {};
      const std::vector<std::string> rows = read_characters(its_head, inside);
      budget_.take(sizeof(std::string));
      texts.push_back(rows.empty() ? "" : rows.front());
    }
    return texts;
  }

  bool is_swapped_;
  MatBudget& budget_;
};

}  // namespace

MatVariables parse_mat_level5(std::string_view bytes, MatBudget& budget) {
  constexpr std::size_t k_head = 128;
  Level5Reader reader(bytes.substr(k_head - 2, 2) == "MI", budget);
  MatVariables variables;
  reader.read_into(variables, reader.elements_of(bytes.substr(k_head)));
  return variables;
}

}  // namespace mottle::formats
