// What the ranks of a job found for the rows of a batch, each for some of them, put together.
#pragma once

#include <Eigen/Core>
#include <functional>
#include <string>
#include <vector>

#include "mottle/core/bytes.hpp"
#include "mottle/core/rank_share.hpp"
#include "mottle/layers.hpp"

namespace mottle::model {

/// Records of some rows of a batch, to be given to all ranks.
class RowRecords {
 public:
  /// Begins the record of a row; its values are appended to what is returned.
  std::string& begin(Eigen::Index row);

  /// Reads the records of all ranks; that of a row may come several times, always the same. All ranks call it.
  ///
  /// @param state  of what the rows were computed with, the same on all ranks
  /// @param what   for messages where it is not: "the model's modes at the parameters' means"
  /// @param read   takes one record off the reader; false: it ends too early
  /// @throws SystemFailure  the states differ, or a row between 0 and `rows` has no record
  void exchange(Ranks& ranks, const Digest& state, const char* what, Eigen::Index rows,
                const std::function<bool(Eigen::Index row, ByteReader& reader)>& read) const;

 private:
  std::string bytes_;
};

/// A matrix with its sizes.
void append_matrix(std::string& bytes, const Eigen::MatrixXd& matrix);
bool read_matrix(ByteReader& reader, Eigen::MatrixXd& matrix);

Digest digest_of_matrices(const std::vector<Eigen::MatrixXd>& matrices);

}  // namespace mottle::model
