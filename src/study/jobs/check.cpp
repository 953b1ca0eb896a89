// mottle check: reads everything, says what would run, and refuses whatever an update would refuse.
#include "mottle/study/jobs/check.hpp"

#include <algorithm>

#include "mottle/core/error.hpp"
#include "mottle/core/folders.hpp"
#include "mottle/drivers/command/run_folders.hpp"
#include "mottle/dynamics/modes/mode_set.hpp"
#include "mottle/study/models/model_source.hpp"
#include "study/jobs/checked_study.hpp"
#include "study/jobs/study_reach.hpp"

namespace mottle::study {
namespace {

constexpr Eigen::Index k_listed_modes = 10;

/// The lowest modes at the parameters' means, in Hz; none of a study without outputs of modes, whose model may have no
/// mass.
Eigen::VectorXd frequencies_of(const StudyModel& made) {
  if (made.model->highest_mode() == 0) return {};
  const Eigen::VectorXd mean = made.space->prior().mean();
  const Eigen::Index wanted = std::min(k_listed_modes, made.model->structure().mode_count());
  const ModeSet modes = made.model->solver().modes_at(mean, static_cast<int>(wanted));
  return natural_frequencies_hz(modes.eigenvalues).head(std::min(k_listed_modes, modes.eigenvalues.size()));
}

}  // namespace

CheckOutcome check(const Study& study, const RunSettings& settings) {
  if (!settings.folder.empty()) require_writable_folder(settings.folder);
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
  if (made.model->highest_mode() == 0) {
    outcome.outputs = made.model->evaluate(made.space->prior().mean().transpose(), {}).outputs.row(0).transpose();
  }
  outcome.total_mass = made.model->structure().total_mass(made.space->prior().mean());
  if (checked->plan) {
    refuse_what_methods_refuse(study, *checked->plan,
                               {.seed = study.seed, .threads = settings.threads, .stop = settings.stop});
  }
  outcome.reach = reach_of(study, made.files);
  return outcome;
}

}  // namespace mottle::study
