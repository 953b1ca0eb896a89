// What is known of the samples of a batch while it is evaluated by threads and ranks.
#pragma once

#include <cstdint>
#include <string>
#include <vector>

#include "mottle/core/rank_share.hpp"
#include "mottle/layers.hpp"
#include "mottle/model/model.hpp"

namespace mottle::model {

/// Each sample is set by one thread of one rank.
struct BatchRecord {
  BatchRecord(Eigen::Index samples, Eigen::Index outputs);

  /// Completes it with what other ranks have set. All ranks call it.
  ///
  /// @param state  as RowRecords::exchange()
  void put_together(Ranks& ranks, const Digest& state);
  Evaluation evaluation() &&;

  Eigen::MatrixXd values;            ///< [sample x output], nan at first
  std::vector<std::string> reasons;  ///< why a sample failed; empty: it did not
  std::vector<std::string> notes;
  std::vector<std::uint8_t> is_own;  ///< set by this rank
};

}  // namespace mottle::model
