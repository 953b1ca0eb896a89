// mottle check: reads everything, says what would run, and refuses whatever an update would refuse.
#include "mottle/study/jobs/check.hpp"

#include <algorithm>
#include <cmath>
#include <numbers>

#include "mottle/core/clock.hpp"
#include "mottle/core/error.hpp"
#include "mottle/core/folders.hpp"
#include "mottle/drivers/command/run_folders.hpp"
#include "mottle/dynamics/modes/mode_set.hpp"
#include "mottle/model/reference_sizes.hpp"
#include "mottle/study/models/model_source.hpp"
#include "mottle/study/results/run_folder.hpp"
#include "study/jobs/checked_study.hpp"
#include "study/jobs/expected_runs.hpp"
#include "study/jobs/study_reach.hpp"

namespace mottle::study {
namespace {

constexpr Eigen::Index k_listed_modes = 10;

/// The lowest modes at the parameters' means, in Hz, 0 of what rounding leaves of a rigid-body motion; none of a study
/// without outputs of modes, whose model may have no mass.
Eigen::VectorXd frequencies_of(const StudyModel& made) {
  constexpr double k_soft = 1e-6;  // of the highest eigenvalue: others are no rounding
  if (made.model->highest_mode() == 0) return {};
  const Eigen::VectorXd mean = made.space->prior().mean();
  const Eigen::Index wanted = std::min(k_listed_modes, made.model->structure().mode_count());
  const ModeSet modes = made.model->solver().modes_at(mean, static_cast<int>(wanted));
  const Eigen::Index listed = std::min(k_listed_modes, modes.eigenvalues.size());
  // An unstable model was refused: what is negative here is a rigid-body mode.
  Eigen::VectorXd frequencies = natural_frequencies_hz(modes.eigenvalues.head(listed).cwiseMax(0.0));
  const double soft = k_soft * modes.eigenvalues.cwiseAbs().maxCoeff();
  for (Eigen::Index r = 0; r < std::min(listed, modes.shapes.cols()) && modes.eigenvalues(r) <= soft; ++r) {
    const ModeSet mode{modes.eigenvalues.segment(r, 1), modes.shapes.col(r)};
    if (modes.eigenvalues(r) <= made.model->solver().eigenvalue_rounding(mean, mode)) frequencies(r) = 0.0;
  }
  return frequencies;
}

/// Changes of the outputs by one prior standard deviation of each parameter, relative [output x parameter]; by central
/// differences where outputs have no derivative, as modes of one frequency have none.
Eigen::MatrixXd relative_changes(const StudyModel& made, const Eigen::VectorXd& outputs, const RunContext& context) {
  const StructureModel& model = *made.model;
  const Eigen::VectorXd mean = made.space->prior().mean();
  const Eigen::VectorXd deviation = made.space->prior().covariance().diagonal().cwiseSqrt();
  Eigen::MatrixXd changes = model.jacobian(mean) * deviation.asDiagonal();
  if (!changes.allFinite()) {
    const double step = model.difference_step();
    const Eigen::MatrixXd steps = (step * deviation).asDiagonal();
    Eigen::MatrixXd points(2 * mean.size(), mean.size());
    points << steps, -steps;
    points.rowwise() += mean.transpose();
    const Eigen::MatrixXd moved = model.evaluate(points, context).outputs;
    const Eigen::MatrixXd differences =
        (moved.topRows(mean.size()) - moved.bottomRows(mean.size())).transpose() / (2.0 * step);
    changes = changes.array().isFinite().select(changes, differences);
  }
  constexpr double k_rounding = 1e-12;
  const Eigen::ArrayXXd relative = reference_sizes(model.outputs(), outputs).cwiseInverse().asDiagonal() * changes;
  return (relative.abs() < k_rounding).select(0.0, relative);
}

/// Outputs at the parameters' means, the time that they take and what the parameters change in them. A solver by
/// command has run once already and is not run again: of it the listed frequencies are known.
void try_model(const Study& study, const StudyModel& made, const RunContext& context, CheckOutcome& outcome) {
  const StructureModel& model = *made.model;
  const Eigen::VectorXd mean = made.space->prior().mean();
  if (study.model->keeps_runs()) {
    outcome.solution_seconds = made.program ? made.program->seconds_at_means : 0.0;
    outcome.outputs = Eigen::VectorXd::Constant(static_cast<Eigen::Index>(model.outputs().size()), std::nan(""));
    for (std::size_t k = 0; k < model.outputs().size(); ++k) {
      const Quantity& output = model.outputs()[k];
      const bool is_frequency = output.kind == QuantityKind::frequency;
      const bool is_known =
          (is_frequency || output.kind == QuantityKind::eigenvalue) && output.number <= outcome.frequencies.size();
      if (!is_known) continue;
      const double frequency = outcome.frequencies(output.number - 1);
      outcome.outputs(static_cast<Eigen::Index>(k)) =
          is_frequency ? frequency : std::pow(2.0 * std::numbers::pi * frequency, 2);
    }
    return;
  }
  const double begin = steady_seconds();
  outcome.outputs = model.evaluate(mean.transpose(), context).outputs.row(0).transpose();
  outcome.solution_seconds = steady_seconds() - begin;
  constexpr double k_patience = 10.0;  // seconds; a derivative costs at most two assemblies and solutions
  if (model.derivatives() == nullptr || outcome.solution_seconds * static_cast<double>(mean.size()) > k_patience)
    return;
  outcome.changes = relative_changes(made, outcome.outputs, context);
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
  try_model(study, made, {.seed = study.seed, .threads = settings.threads, .stop = settings.stop}, outcome);
  outcome.total_mass = made.model->structure().total_mass(made.space->prior().mean());
  if (checked->plan) {
    const RunContext context{.seed = study.seed, .threads = settings.threads, .stop = settings.stop};
    refuse_what_methods_refuse(study, *checked->plan, context);
    if (made.program && !study.surrogate) outcome.expected_runs = count_expected_runs(study, *checked->plan, context);
  }
  outcome.reach = reach_of(study, made.files);
  return outcome;
}

}  // namespace mottle::study
