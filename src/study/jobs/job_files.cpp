#include "study/jobs/job_files.hpp"

#include <algorithm>

#include "mottle/core/ranks.hpp"
#include "mottle/study/models/model_source.hpp"
#include "mottle/study/results/own_results.hpp"

namespace mottle::study {

namespace {

/// Whether a file is one of these, by whatever name.
bool is_among(const std::filesystem::path& file, const std::vector<std::filesystem::path>& files) {
  return std::any_of(files.begin(), files.end(), [&](const std::filesystem::path& other) {
    std::error_code ignored;  // what is not there is not the same
    return std::filesystem::equivalent(file, other, ignored);
  });
}

}  // namespace

std::vector<std::string> results_not_read(const std::filesystem::path& folder, std::vector<std::string> names,
                                          const std::vector<std::filesystem::path>& read) {
  std::erase_if(names, [&](const std::string& name) { return is_among(folder / name, read); });
  return names;
}

std::vector<std::string> files_of_jobs() {
  std::vector<std::string> names = result_names();
  names.insert(names.end(), {"study.toml", k_log, k_journal});
  return names;
}

void require_none_is_read(const std::filesystem::path& folder, const std::vector<std::string>& names,
                          const std::vector<std::filesystem::path>& read) {
  if (folder.empty()) return;
  for (const std::string& name : names) {
    require(!is_among(folder / name, read),
            "{}: the study reads this file, and results would be written over it; choose another folder with --out",
            (folder / name).string());
  }
}

void require_own(const std::filesystem::path& folder, std::vector<std::string> names,
                 const std::vector<std::filesystem::path>& read) {
  if (folder.empty()) return;
  for (const std::string& name : results_not_read(folder, std::move(names), read)) {
    require_own_result(folder / name);
  }
}

int rank_count(const RunSettings& settings) {
  return settings.ranks == nullptr ? 1 : settings.ranks->count();
}

void require_ranks(const Study& study, const RunSettings& settings) {
  if (!study.model->needs_ranks() || settings.ranks != nullptr) return;
  throw InvalidInput(located(study, "model.launch",
                             "\"mpi\" lets several ranks share the runs, and Mottle was started alone; start it by "
                             "mpirun or srun, or choose launch = \"local\""));
}

void note_ranks(const RunSettings& settings, const RunContext& context) {
  if (settings.ranks == nullptr) return;
  const int nodes = count_nodes(*settings.ranks);
  context.note(fmt::format("{} ranks on {} node{} share the model runs, this one with {} thread{}",
                           rank_count(settings), nodes, nodes == 1 ? "" : "s", settings.threads,
                           settings.threads == 1 ? "" : "s"));
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

void JobFiles::discard() const {
  if (!folder_) return;
  folder_->remove(journal_);
  folder_->remove(log_name_);
}

}  // namespace mottle::study
