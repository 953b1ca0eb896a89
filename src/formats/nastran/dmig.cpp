// DMIG cards of a punch file. Source: [MSC2014], DMIG.
#include <algorithm>
#include <map>

#include "formats/matrices/matrix_readers.hpp"
#include "mottle/core/text.hpp"

namespace mottle::formats {
namespace {

/// Grid point (or scalar point) and component.
using Row = std::pair<long long, int>;

struct Entry {
  Row row, column;
  double value = 0.0;
  int line = 0;
};

struct Matrix {
  std::string name;
  std::vector<Entry> entries;
};

class PunchReader {
 public:
  PunchReader(std::string_view bytes, const std::string& file) : text_(bytes, file) {}

  std::vector<Matrix> read() {
    while (text_.next()) {
      if (trim_blanks(text_.line()).empty() || text_.line().starts_with('$')) continue;
      read_line();
    }
    return std::move(matrices_);
  }

 private:
  /// Field 1 has 8 columns, the others 8 or, on a line with a '*' in field 1, 16.
  std::string_view field(int number) const {
    const std::size_t width = is_wide_ ? 16 : 8;
    const std::size_t begin = 8 + width * static_cast<std::size_t>(number - 2);
    return begin < text_.line().size() ? trim_blanks(text_.line().substr(begin, width)) : std::string_view();
  }

  long long whole(int number, const char* what) const {
    long long value = 0;
    if (!parse_whole(field(number), value)) {
      text_.fail(fmt::format("field {}, the {}: '{}' is not a whole number", number, what, field(number)));
    }
    return value;
  }

  Row row(int first) const {
    constexpr long long k_last = 6;
    const long long node = whole(first, "grid point");
    const long long component = field(first + 1).empty() ? 0 : whole(first + 1, "component");
    if (node < 1 || component < 0 || component > k_last) {
      text_.fail(fmt::format("grid point {}, component {}: components are 0 to 6", node, component));
    }
    return {node, static_cast<int>(component)};
  }

  void read_line() {
    const std::string head = capitals(trim_blanks(text_.line().substr(0, 8)));
    is_wide_ = head.find('*') != std::string::npos;
    if (head.starts_with("DMIG")) {
      read_head();
    } else if (head.starts_with('*')) {
      add_entry(2, 4, 5);
    } else {
      text_.fail(fmt::format("'{}' is not a DMIG card or its continuation", head));
    }
  }

  void read_head() {
    const std::string name = capitals(field(2));
    if (!is_wide_ && field(3) == "0") {
      start_matrix(name);
      return;
    }
    if (matrices_.empty() || matrices_.back().name != name) {
      text_.fail(fmt::format("a column of '{}' stands before its header, the card with 0 in field 3", name));
    }
    if (is_wide_) {
      column_ = row(3);
      return;
    }
    // Small field: up to two rows behind the column on the card itself.
    column_ = row(3);
    for (const int first : {6, 9}) {
      if (!field(first).empty()) add_entry(first, first + 2, first + 3);
    }
  }

  void start_matrix(const std::string& name) {
    constexpr long long k_square = 1;
    constexpr long long k_symmetric = 6;
    constexpr long long k_double = 2;
    const long long form = whole(4, "form");
    const long long type = whole(5, "type");
    if (form != k_symmetric && form != k_square) {
      text_.fail(fmt::format("matrix '{}' has form {}; 6 (symmetric) or 1 (square) is read here", name, form));
    }
    if (type < 1 || type > k_double) {
      text_.fail(fmt::format("matrix '{}' has type {}; 1 or 2 (real) is read here", name, type));
    }
    for (const Matrix& other : matrices_) {
      if (other.name == name) text_.fail(fmt::format("matrix '{}' is given twice", name));
    }
    matrices_.push_back({name, {}});
    column_ = {};
  }

  void add_entry(int first, int real, int imaginary) {
    if (column_.first == 0) text_.fail("a row stands before any column");
    double value = 0.0;
    if (!parse_fortran(field(real), value)) text_.fail(fmt::format("'{}' is not a finite number", field(real)));
    if (!field(imaginary).empty() && imaginary == 5) text_.fail("has an imaginary part; a real matrix is read here");
    matrices_.back().entries.push_back({row(first), column_, value, text_.number()});
  }

  MatrixLines text_;
  std::vector<Matrix> matrices_;
  Row column_;
  bool is_wide_ = false;
};

}  // namespace

SymmetricMatrix parse_dmig(std::string_view bytes, const std::string& file, const std::string& name) {
  const std::vector<Matrix> matrices = PunchReader(bytes, file).read();
  std::vector<std::string> known;
  for (const Matrix& matrix : matrices) known.push_back(matrix.name);
  const std::vector<Entry>& entries = matrices[choose_matrix(file, name, known)].entries;
  std::map<Row, int> numbers;
  for (const Entry& entry : entries) {
    numbers.emplace(entry.row, 0);
    numbers.emplace(entry.column, 0);
  }
  SymmetricMatrix result;
  for (auto& [row, number] : numbers) {
    result.names.push_back(row_name(row.first, row.second));
    number = static_cast<int>(result.names.size());
  }
  SymmetricBuilder builder(file);
  builder.grow();
  for (const Entry& entry : entries) {
    builder.add(entry.line, numbers.at(entry.row), numbers.at(entry.column), entry.value);
  }
  result.lower = builder.finish(SymmetricBuilder::Stored::pairs);
  return result;
}

}  // namespace mottle::formats
