// Matrices with one entry a line: CalculiX's .sti and .mas, and both text formats of Abaqus's *MATRIX GENERATE.
#include <map>

#include "formats/matrices/matrix_readers.hpp"

namespace mottle::formats {
namespace {

[[noreturn]] void refuse_entry(const MatrixLines& text, std::string_view form) {
  constexpr std::size_t k_shown = 60;
  text.fail(fmt::format("'{}' is not '{}'", text.line().substr(0, k_shown), form));
}

}  // namespace

std::vector<int> rows_with_penalty(const SparseMatrix& lower) {
  constexpr double k_penalty = 0.99e36;
  std::vector<int> rows;
  for (int j = 0; j < lower.outerSize(); ++j) {
    const SparseMatrix::InnerIterator first(lower, j);
    if (first && first.row() == j && first.value() >= k_penalty) rows.push_back(j);
  }
  return rows;
}

SymmetricMatrix parse_triples(std::string_view bytes, const std::string& file) {
  MatrixLines text(bytes, file);
  SymmetricBuilder builder(file);
  builder.grow();
  Words words;
  while (text.next()) {
    const std::size_t count = split_words(text.line(), words);
    if (count == 0) continue;
    long long row = 0;
    long long column = 0;
    double value = 0.0;
    if (count != 3 || !parse_whole(words[0], row) || !parse_whole(words[1], column) ||
        !parse_fortran(words[2], value)) {
      refuse_entry(text, "row column value");
    }
    builder.add(text.number(), row, column, value);
  }
  SymmetricMatrix matrix{.lower = builder.finish()};
  matrix.fixed_rows = rows_with_penalty(matrix.lower);
  return matrix;
}

SymmetricMatrix parse_abaqus_matrix(std::string_view bytes, const std::string& file) {
  MatrixLines text(bytes, file);
  SymmetricBuilder builder(file);
  builder.grow();
  std::map<std::pair<long long, long long>, long long> numbers;
  SymmetricMatrix matrix;
  const auto number_of = [&](long long node, long long component) {
    const auto [entry, is_new] = numbers.try_emplace({node, component}, static_cast<long long>(numbers.size()) + 1);
    constexpr long long k_last_rotation = 6;
    const int named = component <= k_last_rotation ? static_cast<int>(component) : 0;
    if (is_new) {
      // Internal nodes are negative, and other variables than displacements (11: temperature) have no direction.
      matrix.names.push_back(named > 0 ? row_name(node, named) : fmt::format("{}:{}", node, component));
    }
    return entry->second;
  };
  Words words;
  while (text.next()) {
    if (text.line().starts_with('*')) continue;
    const std::size_t count = split_words(text.line(), words, ',');
    if (count == 0) continue;
    long long parts[4] = {};
    double value = 0.0;
    bool is_entry = count == 5 && parse_fortran(words[4], value);
    for (std::size_t k = 0; is_entry && k < 4; ++k) is_entry = parse_whole(words[k], parts[k]);
    if (!is_entry || parts[1] < 1 || parts[3] < 1) refuse_entry(text, "node, component, node, component, value");
    const long long row = number_of(parts[0], parts[1]);
    builder.add(text.number(), row, number_of(parts[2], parts[3]), value);
  }
  matrix.lower = builder.finish(SymmetricBuilder::Stored::pairs);
  matrix.fixed_rows = rows_with_penalty(matrix.lower);
  return matrix;
}

}  // namespace mottle::formats
