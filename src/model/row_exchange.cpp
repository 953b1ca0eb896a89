#include "model/row_exchange.hpp"

#include <algorithm>
#include <vector>

#include "mottle/core/error.hpp"
#include "mottle/core/gather_alike.hpp"

namespace mottle::model {

std::string& RowRecords::begin(Eigen::Index row) {
  append_value(bytes_, std::int64_t{row});
  return bytes_;
}

void RowRecords::exchange(Ranks& ranks, const Digest& state, const char* what, Eigen::Index rows,
                          const std::function<bool(Eigen::Index, ByteReader&)>& read) const {
  const std::vector<std::string> all = gather_alike(ranks, {{state, what}}, bytes_);
  std::vector<bool> is_there(static_cast<std::size_t>(rows));
  for (const std::string& theirs : all) {
    ByteReader reader(theirs);
    while (reader.left() > 0) {
      std::int64_t row = 0;
      const bool is_whole = reader.read(row) && 0 <= row && row < rows && read(row, reader);
      if (!is_whole) throw SystemFailure("a rank's message is torn");
      is_there[static_cast<std::size_t>(row)] = true;
    }
  }
  if (std::find(is_there.begin(), is_there.end(), false) != is_there.end()) {
    throw SystemFailure("no rank has evaluated some samples of a batch");
  }
}

void append_matrix(std::string& bytes, const Eigen::MatrixXd& matrix) {
  append_value(bytes, std::int64_t{matrix.rows()});
  append_value(bytes, std::int64_t{matrix.cols()});
  append_bytes(bytes, matrix.data(), static_cast<std::size_t>(matrix.size()) * sizeof(double));
}

bool read_matrix(ByteReader& reader, Eigen::MatrixXd& matrix) {
  std::int64_t rows = 0;
  std::int64_t columns = 0;
  if (!reader.read(rows) || !reader.read(columns) || rows < 0 || columns < 0) return false;
  const auto most = static_cast<std::int64_t>(reader.left() / sizeof(double));
  if (columns > 0 && rows > most / columns) return false;
  matrix.resize(rows, columns);
  return reader.copy(matrix.data(), static_cast<std::size_t>(matrix.size()) * sizeof(double));
}

Digest digest_of_matrices(const std::vector<Eigen::MatrixXd>& matrices) {
  Checksum sum;
  for (const Eigen::MatrixXd& matrix : matrices) {
    sum.add(std::to_string(matrix.rows()));
    sum.add(matrix.data(), static_cast<std::size_t>(matrix.size()) * sizeof(double));
  }
  return sum.digest();
}

}  // namespace mottle::model
