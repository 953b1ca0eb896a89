// mottle check: reads everything, says what would run, and refuses whatever an update would refuse.
#include "mottle/study/jobs/check.hpp"

#include <unistd.h>

#include <algorithm>

#include "mottle/core/error.hpp"
#include "mottle/drivers/command/run_folders.hpp"
#include "mottle/dynamics/modes/mode_set.hpp"
#include "mottle/study/models/model_source.hpp"
#include "study/jobs/checked_study.hpp"
#include "study/jobs/study_reach.hpp"

namespace mottle::study {
namespace {

constexpr Eigen::Index k_listed_modes = 10;

/// Throws InvalidInput where an update could not put its results: a file, or a folder that may not be written.
void require_writable_folder(const std::filesystem::path& folder) {
  if (folder.empty()) return;
  std::error_code ignored;
  std::filesystem::path existing = std::filesystem::absolute(folder);
  while (existing.has_relative_path() && !std::filesystem::exists(existing, ignored)) existing = existing.parent_path();
  require(std::filesystem::is_directory(existing, ignored), "{}: this folder cannot be made: Not a directory",
          folder.string());
  require(::access(existing.c_str(), W_OK | X_OK) == 0,
          "{}: nothing can be written there; name another place with --out", folder.string());
}

/// The lowest modes at the parameters' means, in Hz.
Eigen::VectorXd frequencies_of(const StudyModel& made) {
  const Eigen::VectorXd mean = made.space->prior().mean();
  const Eigen::Index wanted = std::min(k_listed_modes, made.model->structure().mode_count());
  const ModeSet modes = made.model->solver().modes_at(mean, static_cast<int>(wanted));
  return natural_frequencies_hz(modes.eigenvalues).head(std::min(k_listed_modes, modes.eigenvalues.size()));
}

}  // namespace

CheckOutcome check(const Study& study, const RunSettings& settings) {
  require_writable_folder(settings.folder);
  require_place_of_update(study, settings.folder);
  if (study.model->keeps_runs()) require_no_linked_runs(settings.folder);
  if (!settings.may_run_programs && settings.observer != nullptr) {  // before the study may be refused for it
    for (const std::string& line : reach_lines(reach_of(study))) settings.observer->warning(line);
  }
  RunSettings without_results = settings;
  without_results.folder.clear();
  const auto checked = std::make_shared<CheckedStudy>();
  if (study.test && !study.parameters.list.empty()) {
    checked->plan = plan_update(study, without_results);
  } else {
    checked->alone = make_model(study, parameters_of(study), without_results);
  }
  const StudyModel& made = checked->made();
  CheckOutcome outcome{.study = study, .checked = checked};
  outcome.frequencies = frequencies_of(made);
  outcome.total_mass = made.model->structure().total_mass(made.space->prior().mean());
  if (checked->plan) {
    refuse_what_methods_refuse(study, *checked->plan,
                               {.seed = study.seed, .threads = settings.threads, .stop = settings.stop});
  }
  outcome.reach = reach_of(study, made.files);
  return outcome;
}

}  // namespace mottle::study
