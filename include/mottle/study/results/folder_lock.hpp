// One process at a time fills a folder of results.
#pragma once

#include <filesystem>
#include <vector>

#include "mottle/layers.hpp"

namespace mottle::study {

/// Holds a folder of results for this process as long as the object lives: other processes that would write there are
/// refused. The lock is the kernel's (flock on the file `.mottle.lock`): it ends with the process however that ends.
class FolderLock {
 public:
  /// Makes the folder where it is missing.
  ///
  /// @throws InvalidInput  nothing can be written there, or another process holds it
  explicit FolderLock(const std::filesystem::path& folder);
  /// Takes the lock file away, and the folders that were made, where they are empty.
  ~FolderLock();
  FolderLock(const FolderLock&) = delete;
  FolderLock& operator=(const FolderLock&) = delete;

 private:
  std::filesystem::path file_;
  int descriptor_ = -1;
  std::vector<std::filesystem::path> made_;  ///< folders that were not there before, the innermost first
};

}  // namespace mottle::study
