// Working folders of a solver's runs: private and empty at the start, removed or kept at the end.
#pragma once

#include <filesystem>
#include <mutex>
#include <string>
#include <vector>

#include "mottle/core/error.hpp"
#include "mottle/layers.hpp"

namespace mottle::drivers {

/// A disk, or a user's part of it, was full: nothing is said of the runs that were at work.
class NoRoom : public SystemFailure {
 public:
  using SystemFailure::SystemFailure;
};

inline constexpr const char* k_run_store = "runs.store";        ///< finished runs, within the folder of results
inline constexpr const char* k_answer_store = "answers.store";  ///< evaluations by servers

/// Stores in a folder of results: rank 0, and a Mottle alone, write runs.store, other ranks runs-N.store.
struct RunStoreFiles {
  std::filesystem::path own = {};
  std::vector<std::filesystem::path> others = {};  ///< of this job's ranks, and of those of earlier jobs
};
RunStoreFiles run_store_files(const std::filesystem::path& results, int rank, int ranks,
                              const std::string& name = k_run_store);

/// Whether the process of this host that a folder's name tells of, as "PREFIX123-XXXXXX", is gone.
bool is_of_dead_process(const std::string& name, const std::string& prefix);

/// Throws InvalidInput where the run store or a folder for runs within the folder of results is a link.
void require_no_linked_runs(const std::filesystem::path& results);

/// Folders of runs within a folder of results, or within the system's folder of temporary files.
class RunFolders {
 public:
  /// @param results   empty: a temporary folder that goes again unless a run was kept there
  /// @param forgets   failed runs that an earlier Mottle kept there go
  /// Takes away what a killed Mottle has left in `results`: folders with its mark that no process holds, and empty ones
  /// that it had not marked yet, never others and never through a link. Throws InvalidInput where nothing can be
  /// written, or where a link is.
  RunFolders(const std::filesystem::path& results, bool forgets);
  ~RunFolders();
  RunFolders(const RunFolders&) = delete;
  RunFolders& operator=(const RunFolders&) = delete;

  const std::filesystem::path& results() const { return results_; }
  /// A folder that lives as long as this object, for what all runs share.
  const std::filesystem::path& shared() const { return shared_; }

  /// A new empty folder that nobody else can read.
  std::filesystem::path make();
  void remove(const std::filesystem::path& folder);
  /// After a run: makes its folder writable again, whatever the run has done to it; false where the run took it away.
  bool recover(const std::filesystem::path& folder) const;
  /// Moves a run's folder to RESULTS/failed-runs/`name`, at most 20, or RESULTS/kept-runs/`name`. Says where it is
  /// now; empty: it went.
  std::filesystem::path keep(const std::filesystem::path& folder, bool has_failed, const std::string& name);

  /// Throws NoRoom where the disk is full: what a run did or did not write there means nothing.
  void require_room(const std::filesystem::path& folder) const;

 private:
  std::filesystem::path results_;
  std::filesystem::path work_;
  std::filesystem::path shared_;
  int mark_ = -1;  ///< the open and locked mark of work_
  bool is_temporary_ = false;
  bool has_kept_ = false;
  int next_ = 0;
  int failed_ = 0;
  std::mutex mutex_;
};

/// Throws `NoRoom` for a full disk or a used-up quota, else SystemFailure.
///
/// @param error  errno
[[noreturn]] void refuse_write(int error, const std::string& text);

/// Writes a file without waiting for the disk. Throws NoRoom, SystemFailure.
void write_run_file(const std::filesystem::path& file, const std::string& bytes);

}  // namespace mottle::drivers
