// The file of a journal: evaluations and derivatives of a model, each a record with its own checksum.
#pragma once

#include <filesystem>
#include <map>
#include <mutex>
#include <optional>
#include <string>
#include <string_view>

#include "mottle/core/checksum.hpp"
#include "mottle/layers.hpp"
#include "mottle/model/model.hpp"

namespace mottle::model {

/// An evaluation with the question that it answers, as bytes.
std::string encode(const Digest& question, const Evaluation& evaluation);
/// False where the bytes are not the answer to this question.
bool decode(std::string_view body, const Digest& question, Eigen::Index rows, Eigen::Index outputs, Evaluation& result);

/// The open journal: what an earlier run left, and where to append. Several threads may use it.
class JournalFile {
 public:
  /// @param study  fingerprint of all that the results depend on
  /// @throws InvalidInput   `resume` with a journal of another fingerprint
  /// @throws SystemFailure  it cannot be written
  JournalFile(std::filesystem::path path, const Digest& study, bool resume);
  ~JournalFile();
  JournalFile(const JournalFile&) = delete;
  JournalFile& operator=(const JournalFile&) = delete;

  /// The answer that an earlier run left for this question, if it is the next one.
  bool find(const Digest& question, Eigen::Index rows, Eigen::Index outputs, Evaluation& result);
  void keep(const Digest& question, const Evaluation& answer);

  /// Derivatives at a point, whenever they were asked for.
  std::optional<Eigen::MatrixXd> find_derivatives(const Digest& point) const;
  void keep_derivatives(const Digest& point, const Eigen::MatrixXd& jacobian);

  /// Samples answered from an earlier run.
  std::int64_t reused() const { return reused_; }

 private:
  struct Record {
    std::string_view body;
    std::size_t end = 0;
  };
  /// The record of the earlier run that begins there, if it is whole.
  std::optional<Record> record_at(std::size_t position) const;
  /// Derivatives are asked for by several threads, in no order: they are known already.
  void pass_derivatives();
  /// Records behind this point may be invalid.
  void drop_rest();
  void append(std::string_view bytes);
  void cut() const;

  std::filesystem::path path_;
  mutable std::mutex mutex_;  // of all below
  std::map<Digest, Eigen::MatrixXd> derivatives_;
  std::string old_;
  std::size_t position_ = 0;
  int descriptor_ = -1;
  std::int64_t reused_ = 0;
};

}  // namespace mottle::model
