#include "study/jobs/job_files.hpp"

namespace mottle::study {

void set_aside_in(const std::filesystem::path& folder, const std::vector<std::string>& names) {
  std::error_code ignored;
  if (!std::filesystem::is_directory(folder, ignored)) return;
  try {
    RunFolder(folder).set_aside(names);
  } catch (const std::exception&) {  // the error reported is the one that ended the job
  }
}

JobFiles::JobFiles(const RunSettings& settings, const char* log, const char* journal)
    : log_name_(log), journal_(journal) {
  if (settings.folder.empty()) return;
  folder_.emplace(settings.folder);
  log_ = std::make_unique<LogObserver>(folder_->file(log_name_), settings.observer, settings.resume);
}

RunContext JobFiles::context(const Study& study, const RunSettings& settings) const {
  return {.seed = study.seed,
          .threads = settings.threads,
          .observer = log_ ? log_.get() : settings.observer,
          .stop = settings.stop};
}

void JobFiles::discard(const std::vector<std::string>& aside) const {
  if (!folder_) return;
  folder_->restore(aside);
  folder_->remove(journal_);
  folder_->remove(log_name_);
}

}  // namespace mottle::study
