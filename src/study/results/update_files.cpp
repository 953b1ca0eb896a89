// The files of an update.
#include <fmt/chrono.h>

#include <ctime>
#include <limits>
#include <optional>

#include "mottle/core/clock.hpp"
#include "mottle/core/error.hpp"
#include "mottle/dynamics/modes/mode_set.hpp"
#include "mottle/formats/tables/csv.hpp"
#include "mottle/study/jobs/update.hpp"
#include "mottle/study/results/run_folder.hpp"
#include "study/jobs/job_files.hpp"
#include "study/jobs/study_reach.hpp"
#include "study/jobs/update_workings.hpp"
#include "study/results/abc_json.hpp"
#include "study/results/agreement.hpp"
#include "study/results/could_hide_json.hpp"
#include "study/results/interval_json.hpp"
#include "study/results/mixture_json.hpp"
#include "study/results/modes_json.hpp"
#include "study/results/parameter_findings.hpp"
#include "study/results/posterior_files.hpp"
#include "study/results/prediction_files.hpp"
#include "study/results/result_json.hpp"
#include "study/results/run_files.hpp"
#include "study/results/shape_correlation.hpp"
#include "study/results/solver_use.hpp"
#include "study/results/surrogate_section.hpp"
#include "study/results/update_text.hpp"

namespace mottle::study {
namespace {

std::string history_csv(const UpdatingProblem& problem, const UpdatingResult& result) {
  std::vector<std::string> header{"iteration", "distance_euclidean", "distance_mahalanobis"};
  for (const std::string& name : problem.space.names()) header.push_back(name + "_mean");
  for (const std::string& name : problem.space.names()) header.push_back(name + "_std");
  for (const Quantity& output : problem.model.outputs()) header.push_back(output.name() + "_mean");
  for (const Quantity& output : problem.model.outputs()) header.push_back(output.name() + "_std");
  Eigen::MatrixXd rows(static_cast<Eigen::Index>(result.history.size()), static_cast<Eigen::Index>(header.size()));
  for (Eigen::Index i = 0; i < rows.rows(); ++i) {
    const IterationRecord& state = result.history[static_cast<std::size_t>(i)];
    rows.row(i) << static_cast<double>(i), state.distance_euclidean, state.distance_mahalanobis,
        state.parameter_mean.transpose(), state.parameter_covariance.diagonal().cwiseSqrt().transpose(),
        state.output_mean.transpose(), state.output_covariance.diagonal().cwiseSqrt().transpose();
  }
  return format_csv(header, rows);
}

/// The modes of the updated model, numbered and followed as the outputs are; nothing where nobody looks at them, where
/// it would take another run of a program, and where one is lost.
std::optional<StructureModel::FollowedModes> modes_at_estimate(const UpdateOutcome& outcome) {
  if (outcome.workings->plan.given) return std::nullopt;
  const StructureModel& model = *outcome.workings->plan.made.model;
  const bool is_shown = model.structure().mesh() != nullptr || outcome.workings->plan.tests.specimens != nullptr;
  if (!is_shown || model.highest_mode() == 0 || !model.structure().has_stiffness()) return std::nullopt;
  try {
    return model.follow(outcome.result.mean);
  } catch (const InvalidInput&) {
    return std::nullopt;
  }
}

/// Those modes for the report's drawing.
void write_shapes(const RunFolder& folder, const StructureModel& model, const StructureModel::FollowedModes& followed,
                  const std::vector<PairedSpecimen>* specimens, const std::vector<std::string>& parameters) {
  if (model.structure().mesh() == nullptr) return;
  const double scale = followed.modes.eigenvalues.cwiseAbs().maxCoeff();
  std::vector<ShownMode> shown;
  for (int k = 0; k < model.highest_mode(); ++k) {
    if (!model.is_output(k)) continue;
    const auto index = static_cast<std::size_t>(k);
    const int rank = followed.rank[index] + 1;
    std::string note = fmt::format("MAC {:.3f} with the model as read", followed.mac[index]);
    if (rank != k + 1) note += fmt::format(", number {} by frequency now", rank);
    shown.push_back({k + 1, natural_frequency_hz(followed.modes.eigenvalues(k), scale),
                     std::numeric_limits<double>::quiet_NaN(), std::move(note), followed.modes.shapes.col(k)});
    if (specimens == nullptr) continue;
    MeasuredShape measured = measured_shape(model, followed.modes.shapes, *specimens, k);
    shown.back().measured_nodes = std::move(measured.nodes);
    shown.back().measured = std::move(measured.displacements);
  }
  Json json = {{"modes", drawing_json(model.structure(), shown, model.selection().units.frequency)}};
  json["modes"]["parameters"] = parameter_parts_json(model.structure(), parameters);
  folder.write("modes.json", one_line(json));
}

/// What a report shows first: how well the tests are reproduced, what was found of each parameter, and the conclusion.
void add_first_screen(const UpdateOutcome& outcome, const StructureModel::FollowedModes* followed, Json& json) {
  const UpdatingProblem& problem = outcome.problem();
  const UpdatingResult& result = outcome.result;
  const Agreement agreement = compare_with_tests(problem, result);
  const std::optional<Identifiability> seen = identify(problem, result);
  json["agreement"] = agreement_json(agreement, problem.model.outputs());
  json["parameters"]["findings"] =
      findings_json(find_parameters(problem, result, outcome.verdict.conclusion, seen ? &*seen : nullptr));
  const UpdatePlan& plan = outcome.workings->plan;
  json["shape_correlation"] = shape_correlation_json(
      plan.given ? std::nullopt : correlate_shapes(*plan.made.model, plan.tests, result, followed));
  add_summary(first_screen(outcome, agreement), json["verdict"]);
}

void add_factors(const std::vector<std::optional<FactorNominal>>& factors, Json& parameters) {
  parameters["factor_of"] = Json::array();
  parameters["factor_units"] = Json::array();
  for (const std::optional<FactorNominal>& factor : factors) {
    parameters["factor_of"].push_back(factor ? number_json(factor->value) : Json(nullptr));
    parameters["factor_units"].push_back(factor ? Json(factor->unit) : Json(nullptr));
  }
}

Json outcome_json(const UpdateOutcome& outcome, const StructureModel::FollowedModes* followed) {
  const UpdatePlan& plan = outcome.workings->plan;
  const SurrogateUpdate* const surrogate = outcome.workings->surrogate.get();
  Json json =
      update_result_json(outcome.study, plan.tests, outcome.problem(), *plan.method, outcome.result, outcome.verdict);
  add_posterior(outcome.result.posterior.get(), outcome.problem().tests, json);
  add_interval(outcome.problem(), outcome.result.interval.get(), json);
  add_mixture(outcome.result, outcome.problem().tests, json);
  add_abc(outcome.result.abc.get(), json);
  add_factors(outcome.workings->factors, json["parameters"]);
  json["verdict"]["could_hide"] = could_hide_json(outcome.could_hide, plan.made.space->names());
  add_first_screen(outcome, followed, json);
  if (outcome.numbering) json["notes"].push_back(*outcome.numbering + '.');
  json["model_files"] = model_files_json(outcome.workings->model_files);
  json["study_files"] = model_files_json(outcome.workings->study_files);
  json["surrogate"] = surrogate ? surrogate_json(*outcome.study.surrogate, *surrogate) : Json(nullptr);
  if (outcome.prediction) {
    json["prediction"] =
        prediction_json(*outcome.prediction, plan.prediction->made.model->outputs(), outcome.study.predict->overrides);
    for (const std::string& note : outcome.prediction->notes) json["notes"].push_back(note);
  }
  return json;
}

std::string date_and_time() {
  return fmt::format("{:%Y-%m-%dT%H:%M:%SZ}", fmt::gmtime(std::time(nullptr)));
}

/// @param written  seconds that the files have taken so far
std::string result_text(const UpdateOutcome& outcome, const std::optional<StructureModel::FollowedModes>& followed,
                        double written) {
  const double start = steady_seconds();
  Json json = outcome_json(outcome, followed ? &*followed : nullptr);
  const double writing = outcome.assessing_seconds + written + steady_seconds() - start;
  json["timings_s"] = {{"reading", outcome.reading_seconds},
                       {"updating", outcome.updating_seconds},
                       {"writing", writing},
                       {"finished", date_and_time()},
                       {"total", outcome.reading_seconds + outcome.updating_seconds + writing}};
  json["ranks"] = outcome.ranks;
  add_solver_use(outcome.solver_use, json);
  return pretty(json);
}

}  // namespace

void write_results(const UpdateOutcome& outcome, const std::filesystem::path& path) {
  const double start = steady_seconds();
  const RunFolder folder(path);
  folder.set_aside(
      results_not_read(path, result_names(), paths_of(outcome.study)));  // where the job ran without a folder
  const UpdatePlan& plan = outcome.workings->plan;
  const StudyModel& made = plan.made;
  const StudyTests& tests = plan.tests;
  const std::vector<Quantity>& outputs = plan.model().outputs();
  const std::vector<IterationRecord>& history = outcome.result.history;
  std::vector<Cloud> clouds;
  for (const IterationRecord& state : history) clouds.push_back(state.cloud);
  folder.write("study.toml", study_text_for(outcome.study, folder.path()));
  folder.write("history.csv", history_csv(outcome.problem(), outcome.result));
  folder.write("cloud-initial.csv", cloud_csv(history.front().cloud, *made.space, outputs));
  folder.write("cloud-final.csv", cloud_csv(history.back().cloud, *made.space, outputs));
  folder.write("clouds.csv", clouds_csv(clouds, *made.space, outputs));
  folder.write("tests.csv", tests_csv(tests, outputs));
  if (!tests.pairing.empty()) folder.write("pairing.csv", tests.pairing);
  if (outcome.prediction) {
    folder.write("prediction.csv", prediction_csv(*outcome.prediction, plan.prediction->made.model->outputs()));
  }
  if (outcome.result.posterior) {
    folder.write("posterior.csv", posterior_csv(*outcome.result.posterior));
    folder.write("posterior.json", posterior_arviz(*outcome.result.posterior, outcome.problem()));
  }
  if (outcome.result.abc) folder.write("posterior.csv", abc_csv(*outcome.result.abc));
  const std::optional<StructureModel::FollowedModes> followed = modes_at_estimate(outcome);
  if (followed) write_shapes(folder, *made.model, *followed, tests.specimens.get(), made.space->names());
  folder.write("result.json", result_text(outcome, followed, steady_seconds() - start));
}

std::string result_text(const UpdateOutcome& outcome) {
  return result_text(outcome, modes_at_estimate(outcome), 0.0);
}

}  // namespace mottle::study
