// What is known of the samples of a batch while it is evaluated by threads and ranks.
#pragma once

#include <cstdint>
#include <memory>
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

  /// Of the few samples that have any.
  struct Words {
    std::string reason = {};  ///< why it failed; empty: it did not
    std::string note = {};
  };
  void say(Eigen::Index sample, std::string reason, std::string note);

  Eigen::MatrixXd values;                     ///< [sample x output], nan at first
  std::vector<std::unique_ptr<Words>> words;  ///< [sample]
  std::vector<std::uint8_t> is_own;           ///< set by this rank
};

}  // namespace mottle::model
