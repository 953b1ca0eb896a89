// Files of a running job in its folder: the log, and the journal from which a killed job is resumed.
#pragma once

#include <filesystem>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "mottle/core/error.hpp"
#include "mottle/layers.hpp"
#include "mottle/study/jobs/run.hpp"
#include "mottle/study/results/run_folder.hpp"

namespace mottle::study {

/// Results of an earlier job in a folder, without those that are read by this one.
std::vector<std::string> results_not_read(const std::filesystem::path& folder, std::vector<std::string> names,
                                          const std::vector<std::filesystem::path>& read);

/// What an update or a cloud writes into its folder.
std::vector<std::string> files_of_jobs();

/// Throws InvalidInput where a job that writes `names` into the folder would write over a file that it reads.
void require_none_is_read(const std::filesystem::path& folder, const std::vector<std::string>& names,
                          const std::vector<std::filesystem::path>& read);

/// Throws InvalidInput where one of `names`, but for those that are read, is in the folder and is not as an
/// earlier job left it: it is the user's own.
void require_own(const std::filesystem::path& folder, std::vector<std::string> names,
                 const std::vector<std::filesystem::path>& read);

/// Processes that do a job together.
int rank_count(const RunSettings& settings);
/// Throws InvalidInput where the study is to be done by several ranks, and this process is alone.
void require_ranks(const Study& study, const RunSettings& settings);
/// Says how many they are, where it is more than one. All ranks call it.
void note_ranks(const RunSettings& settings, const RunContext& context);

/// What the whole of a job, `work`, returns. Results of an earlier one, files `names`, are set aside before anything is
/// run, as RunFolder::without_earlier() does; a folder that is not there is not made.
template <typename Work>
auto without_earlier(const std::filesystem::path& folder, const std::vector<std::string>& names, const Work& work) {
  std::error_code ignored;
  if (folder.empty() || !std::filesystem::is_directory(folder, ignored)) return work();
  return RunFolder(folder).without_earlier(names, work);
}

/// The files of a running job; none where the settings name no folder.
class JobFiles {
 public:
  /// @param log, journal  names of the files
  /// Throws InvalidInput where nothing can be written into the folder.
  JobFiles(const RunSettings& settings, const char* log, const char* journal);

  /// Empty where there is no folder.
  std::filesystem::path journal() const { return folder_ ? folder_->file(journal_) : std::filesystem::path(); }

  /// Seed, threads and stop of the job, with the log as its observer.
  RunContext context(const Study& study, const RunSettings& settings) const;

  /// What `work` returns. Where it finds the input wrong, the message gets its key and line in the study, and log and
  /// journal are removed.
  template <typename Work>
  auto compute(const Study& study, const Work& work) const {
    try {
      return work();
    } catch (const InvalidInput& error) {
      discard();
      throw InvalidInput(located(study, error));
    }
  }

 private:
  void discard() const;

  std::optional<RunFolder> folder_;
  std::string log_name_, journal_;
  std::unique_ptr<LogObserver> log_;
};

}  // namespace mottle::study
