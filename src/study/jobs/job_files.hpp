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

/// Sets earlier results aside, if the folder is there and can be written.
void set_aside_in(const std::filesystem::path& folder, const std::vector<std::string>& names);

/// What `work` returns, which makes the job's model and runs it for the first time. Where that fails or is stopped,
/// results of an earlier job, files `names`, are set aside; where the input is wrong they stay.
template <typename Work>
auto prepare(const RunSettings& settings, const std::vector<std::string>& names, const Work& work) {
  try {
    return work();
  } catch (const InvalidInput&) {
    throw;
  } catch (const Error&) {
    if (!settings.folder.empty()) set_aside_in(settings.folder, names);
    throw;
  }
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

  /// What `work` returns. Results of an earlier job, files `names`, are set aside before. Where `work` finds the input
  /// wrong, the message gets its key and line in the study, log and journal are removed, and earlier results stay where
  /// they were.
  template <typename Work>
  auto compute(const Study& study, const std::vector<std::string>& names, const Work& work) const {
    const std::vector<std::string> aside = folder_ ? folder_->set_aside(names) : std::vector<std::string>();
    try {
      return work();
    } catch (const InvalidInput& error) {
      discard(aside);
      throw InvalidInput(located(study, error));
    }
  }

 private:
  void discard(const std::vector<std::string>& aside) const;

  std::optional<RunFolder> folder_;
  std::string log_name_, journal_;
  std::unique_ptr<LogObserver> log_;
};

}  // namespace mottle::study
