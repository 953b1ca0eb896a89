// Store of the results of finished solver runs, each under a digest of all its inputs, written as soon as a run ends.
#pragma once

#include <filesystem>
#include <functional>
#include <limits>
#include <mutex>
#include <optional>
#include <string>
#include <string_view>
#include <unordered_map>
#include <vector>

#include "mottle/core/checksum.hpp"
#include "mottle/drivers/command/extraction.hpp"
#include "mottle/layers.hpp"

namespace mottle::drivers {

/// What one run gave: modes, or why there are none.
struct RunRecord {
  std::string failure = {};
  ExtractedModes modes = {};
};

std::string encode(const RunRecord& record);
/// @throws SystemFailure  the bytes are not those of a record
RunRecord decode_run(std::string_view bytes);

/// Goes through the whole records of a file of runs that another process may still be writing.
///
/// @param from   where to go on: 0, or what an earlier call returned
/// @param visit  key and body of each record, for decode_run()
/// @return       the end of the last whole record; 0: the file is not there, or has no head yet
/// @throws SystemFailure  it is something else
std::uint64_t read_run_records(const std::filesystem::path& file, std::uint64_t from,
                               const std::function<void(const Digest& key, std::string_view body)>& visit);

/// Whether another process has the store open to fill it, on another node too where the file system tells its locks
/// there. Not for a store of this process, which would lose its lock.
bool is_store_held(const std::filesystem::path& file);

/// An append-only file of runs. Each record has a checksum: what a kill has torn is cut off when the file is opened,
/// and a full disk leaves the file as it was before the record. One process at a time writes it; of files that other
/// ranks write it reads what is whole.
class RunStore {
 public:
  /// @param others  files of other ranks, of this job or an earlier one; those that are not there yet may come
  /// @throws InvalidInput   the file is something else, or another Mottle has it open
  /// @throws SystemFailure  it cannot be read or written
  explicit RunStore(std::filesystem::path file, const std::vector<std::filesystem::path>& others = {});
  ~RunStore();
  RunStore(const RunStore&) = delete;
  RunStore& operator=(const RunStore&) = delete;

  /// Reads what other ranks have kept since the last call: before a batch, not for each of its runs.
  void look_at_others() const;
  /// The run with this digest; the last one where it was kept again, and one that another rank kept where that one
  /// failed. Of other ranks' those that the last look has found.
  std::optional<RunRecord> find(const Digest& key) const;
  /// Whether a run was kept, here or by another rank, since this object was made.
  bool is_new(const Digest& key) const;
  /// Hands the run to the system at once: a kill of Mottle does not take it away. The disk is waited for once a second,
  /// which a power failure may take away of runs that are shorter: such runs are done again.
  /// Throws NoRoom where the disk is full, SystemFailure where the file cannot be written.
  void keep(const Digest& key, const RunRecord& record);
  /// Waits until all that was kept is on the disk, as the destructor does. Throws as keep().
  void flush();

  std::size_t size() const { return own_.spans.size(); }

 private:
  struct Span {
    std::uint64_t offset = 0;
    std::uint64_t size = 0;
    bool is_new = false;
  };
  struct HashDigest {
    std::size_t operator()(const Digest& digest) const { return digest[0]; }
  };
  /// A file and what of it is known.
  struct File {
    std::filesystem::path path = {};
    int descriptor = -1;
    std::uint64_t end = 0;  ///< of the records that are known
    std::unordered_map<Digest, Span, HashDigest> spans = {};
  };
  void open_own();
  static void read_spans(File& file, bool is_new);
  static std::optional<RunRecord> find_in(const File& file, const Digest& key);
  void read_others(bool is_new) const;
  [[noreturn]] void refuse(int error) const;

  File own_;
  mutable std::vector<File> others_;                              // which grow
  mutable std::mutex mutex_;                                      // of all here
  double flushed_at_ = -std::numeric_limits<double>::infinity();  // on the steady clock
  bool is_unflushed_ = false;
};

}  // namespace mottle::drivers
