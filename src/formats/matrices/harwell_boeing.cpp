// Harwell-Boeing format, as ANSYS's HBMAT writes it. Source: [Duff1992].
#include <algorithm>
#include <limits>

#include "formats/matrices/matrix_readers.hpp"
#include "mottle/core/text.hpp"

namespace mottle::formats {
namespace {

/// A Fortran edit descriptor of numbers, "(10I8)" or "(1P,4D25.16)".
struct FieldFormat {
  std::size_t count = 1;  ///< a line
  std::size_t width = 0;
};

FieldFormat parse_format(const MatrixLines& text, std::string_view format, std::string_view letters) {
  const std::string descriptor = capitals(format);
  FieldFormat result;
  std::size_t i = descriptor.find_first_of(letters);
  std::size_t begin = i;
  while (begin != std::string::npos && begin > 0 && descriptor[begin - 1] >= '0' && descriptor[begin - 1] <= '9') {
    --begin;
  }
  long long count = 1;
  long long width = 0;
  bool is_read = i != std::string::npos && (begin == i || parse_whole(descriptor.substr(begin, i - begin), count));
  if (is_read) {
    const std::size_t end = descriptor.find_first_not_of("0123456789", i + 1);
    is_read = parse_whole(descriptor.substr(i + 1, end - i - 1), width);
  }
  constexpr long long k_max = 1000;
  if (!is_read || count < 1 || count > k_max || width < 1 || width > k_max) {
    text.fail(fmt::format("'{}' is not a Fortran format like (10I8) or (4D25.16)", trim_blanks(format)));
  }
  result.count = static_cast<std::size_t>(count);
  result.width = static_cast<std::size_t>(width);
  return result;
}

/// Numbers in columns of fixed width, line by line.
class Fields {
 public:
  Fields(MatrixLines& text, FieldFormat format, std::string what)
      : text_(text), format_(format), what_(std::move(what)) {}

  std::string_view take() {
    if (next_ >= count_) start_line();
    return is_split_ ? words_[next_++] : column(next_++);
  }
  long long whole() {
    const std::string_view field = take();
    long long value = 0;
    if (!parse_whole(field, value)) text_.fail(fmt::format("{}: '{}' is not a whole number", what_, field));
    return value;
  }
  double real() {
    const std::string_view field = take();
    double value = 0.0;
    if (!parse_fortran(field, value)) text_.fail(fmt::format("{}: '{}' is not a finite number", what_, field));
    return value;
  }

 private:
  /// By columns where numbers touch; by blanks where they do not: SciPy writes them a column narrower than it says.
  void start_line() {
    text_.need(what_);
    next_ = 0;
    words_.clear();
    const std::string_view rest = text_.line();
    for (std::size_t begin = rest.find_first_not_of(' '); begin != std::string_view::npos;) {
      const std::size_t end = std::min(rest.find(' ', begin), rest.size());
      words_.push_back(rest.substr(begin, end - begin));
      begin = rest.find_first_not_of(' ', end);
    }
    double value = 0.0;
    is_split_ = words_.size() <= format_.count && std::all_of(words_.begin(), words_.end(), [&](std::string_view word) {
                  return parse_fortran(word, value);
                });
    count_ = is_split_ ? words_.size() : format_.count;
    if (count_ == 0) text_.fail(fmt::format("the line is empty; expected {}", what_));
  }
  std::string_view column(std::size_t number) const {
    const std::size_t begin = format_.width * number;
    if (begin >= text_.line().size()) text_.fail(fmt::format("the line ends before all {} stand", what_));
    return text_.line().substr(begin, format_.width);
  }

  MatrixLines& text_;
  FieldFormat format_;
  std::string what_;
  std::vector<std::string_view> words_;  // of the line
  bool is_split_ = false;
  std::size_t next_ = 0, count_ = 0;
};

void check_type(const MatrixLines& text, const std::string& type) {
  if (type.size() != 3 || type[0] != 'R' || (type[1] != 'S' && type[1] != 'U') || type[2] != 'A') {
    text.fail(fmt::format("type '{}' is not read here; RSA or RUA (real, assembled) is", type));
  }
}

}  // namespace

SymmetricMatrix parse_harwell_boeing(std::string_view bytes, const std::string& file) {
  MatrixLines text(bytes, file);
  Words words;
  text.need("a title");
  text.need("numbers of lines");
  const std::size_t lines = split_words(text.line(), words);
  long long right_sides = 0;
  if (lines == 5 && !parse_whole(words[4], right_sides)) text.fail("expected five whole numbers");
  text.need("type and size");
  const std::size_t count = split_words(text.line(), words);
  long long rows = 0;
  long long columns = 0;
  long long entries = 0;
  if (count < 4 || !parse_whole(words[1], rows) || !parse_whole(words[2], columns) || !parse_whole(words[3], entries)) {
    text.fail("expected a type like RSA and rows, columns and number of entries");
  }
  check_type(text, capitals(words[0]));
  SymmetricBuilder builder(file);
  builder.set_size(text.number(), rows, columns);
  if (entries < 0 || entries > static_cast<long long>(bytes.size())) {
    text.fail(fmt::format("{} entries, more than the file can hold", entries));
  }
  text.need("formats");
  const std::string formats(text.line());
  constexpr std::size_t k_wide = 16;
  const auto part = [&](std::size_t begin, std::size_t size) {
    return begin < formats.size() ? std::string_view(formats).substr(begin, size) : std::string_view();
  };
  const FieldFormat pointer_format = parse_format(text, part(0, k_wide), "I");
  const FieldFormat index_format = parse_format(text, part(k_wide, k_wide), "I");
  const FieldFormat value_format = parse_format(text, part(2 * k_wide, 20), "EDFG");
  if (right_sides > 0) text.need("the format of right-hand sides");

  std::vector<long long> starts;
  std::vector<int> indices;
  Fields pointers(text, pointer_format, "column pointers");
  for (long long j = 0; j <= columns; ++j) {
    starts.push_back(pointers.whole());
    const bool is_sound = j == 0 ? starts[0] == 1 : starts.back() >= starts[starts.size() - 2];
    if (!is_sound || starts.back() > entries + 1) text.fail(fmt::format("column pointer {} is wrong", starts.back()));
  }
  if (starts.back() != entries + 1) {
    text.fail(fmt::format("the last column pointer is {}, not entries + 1 = {}", starts.back(), entries + 1));
  }
  Fields row_indices(text, index_format, "row indices");
  for (long long k = 0; k < entries; ++k) {
    const long long row = row_indices.whole();
    if (row < 1 || row > rows) text.fail(fmt::format("row {} is outside of the {} x {} matrix", row, rows, columns));
    indices.push_back(static_cast<int>(row));
  }
  Fields values(text, value_format, "values");
  std::size_t k = 0;
  for (long long j = 1; j <= columns; ++j) {
    for (; static_cast<long long>(k) + 1 < starts[static_cast<std::size_t>(j)]; ++k) {
      const double value = values.real();
      builder.add(text.number(), indices[k], j, value);
    }
  }
  return {.lower = builder.finish()};
}

}  // namespace mottle::formats
