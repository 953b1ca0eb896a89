// Unchanged input files of a solver's runs, isolated so that no run sees another's changes to them.
#pragma once

#include <sys/stat.h>

#include <filesystem>
#include <mutex>
#include <vector>

#include "mottle/core/checksum.hpp"
#include "mottle/drivers/command/solver_command.hpp"
#include "mottle/layers.hpp"

namespace mottle::drivers {

/// Up to this size each run has a copy of its own. Above, it has one where the file system copies without moving bytes
/// (FICLONE), else a link to one copy that is checked after every run.
inline constexpr std::uintmax_t k_largest_private_copy = std::uintmax_t{16} << 20;

class InputFiles {
 public:
  /// Copies what all runs start from: a later change of the user's files harms nothing.
  ///
  /// @throws InvalidInput   a file that is missing
  /// @throws SystemFailure  disk full
  InputFiles(const std::vector<RunFile>& files, const std::filesystem::path& folder,
             std::uintmax_t largest_private = k_largest_private_copy);

  /// Of the contents, in the order of the files.
  const std::vector<Digest>& digests() const { return digests_; }

  /// Puts all files into a run's folder. Throws SystemFailure where that is not possible, or where a copy that runs are
  /// made from was changed.
  void put_into(const std::filesystem::path& folder) const;

  /// After each run. Throws SystemFailure where a file that runs share has other contents now: what this run and those
  /// beside it have computed is not known to be right.
  void require_unchanged();

  /// Before a run's folder is kept: links to copies that go with this object lead to the user's files.
  void relink(const std::filesystem::path& folder) const;

 private:
  struct Original {
    RunFile file;
    std::filesystem::path copy;
    bool is_large = false;
    struct stat seen {};  ///< of the copy, when its contents were last known to be right
  };
  void put(const Original& original, const Digest& digest, const std::filesystem::path& destination) const;

  std::vector<Original> originals_;
  std::vector<Digest> digests_;
  std::mutex mutex_;
};

}  // namespace mottle::drivers
