// Store of the results of finished solver runs, each under a digest of all its inputs, written as soon as a run ends.
#pragma once

#include <filesystem>
#include <mutex>
#include <optional>
#include <string>
#include <unordered_map>

#include "mottle/core/checksum.hpp"
#include "mottle/drivers/command/extraction.hpp"
#include "mottle/layers.hpp"

namespace mottle::drivers {

/// What one run gave: modes, or why there are none.
struct RunRecord {
  std::string failure = {};
  ExtractedModes modes = {};
};

/// An append-only file of runs. Each record has a checksum: what a kill has torn is cut off when the file is opened,
/// and a full disk leaves the file as it was before the record. One process at a time.
class RunStore {
 public:
  /// @throws InvalidInput   the file is something else, or another Mottle has it open
  /// @throws SystemFailure  it cannot be read or written
  explicit RunStore(std::filesystem::path file);
  ~RunStore();
  RunStore(const RunStore&) = delete;
  RunStore& operator=(const RunStore&) = delete;

  /// The run with this digest; the last one where it was kept again.
  std::optional<RunRecord> find(const Digest& key) const;
  /// Throws SystemFailure where the disk is full or the file cannot be written.
  void keep(const Digest& key, const RunRecord& record);

  std::size_t size() const { return spans_.size(); }

 private:
  struct Span {
    std::uint64_t offset = 0;
    std::uint64_t size = 0;
  };
  struct HashDigest {
    std::size_t operator()(const Digest& digest) const { return digest[0]; }
  };
  void read_spans();

  std::filesystem::path file_;
  int descriptor_ = -1;
  std::unordered_map<Digest, Span, HashDigest> spans_;
  mutable std::mutex mutex_;
};

}  // namespace mottle::drivers
