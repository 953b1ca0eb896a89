// libFuzzer target for the matrix formats: whatever the bytes, the readers either throw InvalidInput or give a lower
// triangle that keeps its promises.
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <cstdlib>
#include <string_view>

#include "mottle/core/error.hpp"
#include "mottle/formats/matrices/matrix_file.hpp"

namespace {

void expect(bool claim) {
  if (!claim) std::abort();
}

void check(const mottle::formats::SymmetricMatrix& matrix) {
  const mottle::linalg::SparseMatrix& lower = matrix.lower;
  expect(lower.rows() > 0 && lower.rows() == lower.cols());
  expect(matrix.names.empty() || matrix.names.size() == static_cast<std::size_t>(lower.rows()));
  for (int j = 0; j < lower.outerSize(); ++j) {
    Eigen::Index last = j - 1;
    for (mottle::linalg::SparseMatrix::InnerIterator entry(lower, j); entry; ++entry) {
      expect(entry.row() > last && entry.row() < lower.rows() && std::isfinite(entry.value()));
      last = entry.row();
    }
  }
  for (const int row : matrix.fixed_rows) expect(row >= 0 && row < lower.rows());
}

}  // namespace

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  const std::string_view bytes(reinterpret_cast<const char*>(data), size);
  try {
    check(mottle::formats::parse_symmetric_matrix(bytes, "fuzz.mtx", ""));
  } catch (const mottle::InvalidInput& error) {
    expect(std::string_view(error.what()).size() < 8192);
  }
  try {
    mottle::formats::parse_row_names(bytes, "fuzz.dof");
  } catch (const mottle::InvalidInput&) {
    return 0;
  }
  return 0;
}
