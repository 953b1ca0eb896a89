// The main job: a study's method run over its model and tests, its results put into a folder.
#include <cmath>
#include <limits>

#include "mottle/core/error.hpp"
#include "mottle/dynamics/modes/mode_set.hpp"
#include "mottle/formats/tables/csv.hpp"
#include "mottle/model/journal.hpp"
#include "mottle/model/structures/finite_element_structure.hpp"
#include "mottle/study/jobs/run.hpp"
#include "mottle/study/results/run_folder.hpp"
#include "mottle/updating/verdict/verdict.hpp"
#include "study/jobs/could_hide.hpp"
#include "study/jobs/update_plan.hpp"
#include "study/results/modes_json.hpp"
#include "study/results/result_json.hpp"
#include "study/results/run_files.hpp"
#include "study/results/solver_use.hpp"
#include "study/results/surrogate_section.hpp"
#include "study/tests/rank_numbering.hpp"

namespace mottle {
namespace {

std::string history_csv(const UpdatingProblem& problem, const UpdatingResult& result) {
  std::vector<std::string> header{"iteration", "distance_euclidean", "distance_mahalanobis"};
  for (const std::string& name : problem.space.names()) header.push_back(name + "_mean");
  for (const std::string& name : problem.space.names()) header.push_back(name + "_std");
  for (const Output& output : problem.model.outputs()) header.push_back(output.name + "_mean");
  for (const Output& output : problem.model.outputs()) header.push_back(output.name + "_std");
  Eigen::MatrixXd rows(static_cast<Eigen::Index>(result.history.size()), static_cast<Eigen::Index>(header.size()));
  for (Eigen::Index i = 0; i < rows.rows(); ++i) {
    const IterationRecord& state = result.history[static_cast<std::size_t>(i)];
    rows.row(i) << static_cast<double>(i), state.distance_euclidean, state.distance_mahalanobis,
        state.parameter_mean.transpose(), state.parameter_covariance.diagonal().cwiseSqrt().transpose(),
        state.output_mean.transpose(), state.output_covariance.diagonal().cwiseSqrt().transpose();
  }
  return format_csv(header, rows);
}

void note_what_happened(const UpdatingResult& result, const JournalledModel& model, const RunContext& context) {
  std::size_t failed = 0;
  for (const IterationRecord& state : result.history) failed += state.failures.size();
  std::size_t noted = 0;
  for (const SampleNote& note : result.history.back().notes) noted += note.text.empty() ? 0 : 1;
  if (noted > 0) {
    context.note(fmt::format(
        "in {} samples of the last cloud modes crossed or mixed; the status column of cloud-final.csv says which",
        noted));
  }
  if (failed > 0) {
    context.warning(
        fmt::format("{} of {} model runs failed and were left out; if failures are not a matter of chance, "
                    "the clouds are biased",
                    failed, result.model_evaluations));
  }
  if (model.reused() > 0)
    context.note(fmt::format("{} model runs of the interrupted run were used again", model.reused()));
  context.note(fmt::format("{}: {}", status_text(result.status), result.message));
}

std::string interval_text(const Eigen::Ref<const Eigen::RowVectorXd>& ends) {
  return ends.allFinite() ? fmt::format("[{:.5g}, {:.5g}]", ends(0), ends(1)) : "not determined";
}

std::vector<std::string> verdict_lines(const Verdict& verdict, const CouldHide& hidden) {
  std::vector<std::string> lines{fmt::format("verdict: {}", conclusion_text(verdict.conclusion))};
  for (const std::string& reason : verdict.reasons) lines.push_back("  " + reason);
  if (!verdict.not_tested.empty()) lines.emplace_back("not tested:");
  for (const std::string& sentence : verdict.not_tested) lines.push_back("  " + sentence);
  if (verdict.conclusion == Conclusion::adequate && !hidden.summary.empty()) lines.push_back("  " + hidden.summary);
  return lines;
}

std::vector<std::string> summary_lines(const UpdatingProblem& problem, const UpdatingResult& result,
                                       const Verdict& verdict, const CouldHide& hidden) {
  std::vector<std::string> lines;
  lines.push_back(fmt::format("{}: {}", status_text(result.status), result.message));
  const std::string ends = result.intervals ? fmt::format("  {:>23} {:>23}", "mean, 95 %", "std, 95 %") : "";
  // What a method that does not estimate the scatter prints here must not be taken for it.
  lines.push_back(fmt::format("{:<14} {:>13} {:>13} {:>13} {:>13}{}", "parameter", "prior mean", "prior std", "mean",
                              result.is_population ? "std" : "std (mean's)", ends));
  const Eigen::VectorXd prior_mean = problem.space.prior().mean();
  const Eigen::VectorXd prior_std = problem.space.prior().covariance().diagonal().cwiseSqrt();
  const Eigen::VectorXi active = problem.space.active_bounds(result.mean);
  for (Eigen::Index i = 0; i < result.mean.size(); ++i) {
    const std::string intervals = result.intervals
                                      ? fmt::format("  {:>23} {:>23}", interval_text(result.intervals->mean.row(i)),
                                                    interval_text(result.intervals->std.row(i)))
                                      : "";
    lines.push_back(
        fmt::format("{:<14} {:>13.6g} {:>13.6g} {:>13.6g} {:>13.6g}{}{}",
                    problem.space.parameters()[static_cast<std::size_t>(i)].name, prior_mean(i), prior_std(i),
                    result.mean(i), std::sqrt(result.covariance(i, i)), intervals,
                    active(i) == 0 ? "" : (active(i) < 0 ? "  at its lower bound" : "  at its upper bound")));
  }
  for (std::string& line : verdict_lines(verdict, hidden)) lines.push_back(std::move(line));
  const std::optional<Identifiability> seen = identify(problem, result);
  if (seen && !seen->unseen_directions.empty()) {
    lines.emplace_back("what the tests do not tell:");
    for (const Eigen::VectorXd& direction : seen->unseen_directions) {
      lines.push_back("  " + unseen_text(direction, problem.space.names()));
    }
  }
  return lines;
}

/// The modes of the updated model for the report's drawing, numbered and followed as the outputs are.
void write_shapes(const RunFolder& folder, const ModalModel& model, const Eigen::VectorXd& mean) {
  const auto* structure = dynamic_cast<const FiniteElementStructure*>(&model.structure());
  if (structure == nullptr) return;
  const ModalModel::FollowedModes followed = model.follow(mean);
  const double scale = followed.modes.eigenvalues.cwiseAbs().maxCoeff();
  std::vector<ShownMode> shown;
  for (int k = 0; k < model.highest_mode(); ++k) {
    if (!model.is_output(k)) continue;
    const auto place = static_cast<std::size_t>(k);
    const int rank = followed.rank[place] + 1;
    std::string note = fmt::format("MAC {:.3f} with the model as read", followed.mac[place]);
    if (rank != k + 1) note += fmt::format(", number {} by frequency now", rank);
    shown.push_back({k + 1, natural_frequency_hz(followed.modes.eigenvalues(k), scale),
                     std::numeric_limits<double>::quiet_NaN(), std::move(note), followed.modes.shapes.col(k)});
  }
  const Json json = {{"modes", drawing_json(*structure, shown, model.selection().frequency_unit)}};
  folder.write("modes.json", json.dump(-1, ' ', false, Json::error_handler_t::replace));
}

Json summary_json(const Json& result, const RunFolder& folder) {
  return {{"command", "update"},
          {"status", result["status"]},
          {"message", result["message"]},
          {"conclusion", result["verdict"]["conclusion"]},
          {"adequate", result["verdict"]["adequate"]},
          {"parameters", result["parameters"]},
          {"model_evaluations", result["model_evaluations"]},
          {"folder", folder.path().string()},
          {"result", folder.file("result.json").string()},
          {"report", folder.file("report.html").string()}};
}

/// [predict]: into result.json, its notes, and prediction.csv.
void add_prediction(const Study& study, const PredictionPlan& plan, const UpdatingProblem& problem,
                    const UpdatingResult& result, const RunContext& context, const RunFolder& folder, Json& json) {
  const PredictionReport report = run_prediction(study, plan, problem, result, context);
  json["prediction"] = report.json;
  for (const std::string& note : report.notes) json["notes"].push_back(note);
  folder.write("prediction.csv", report.csv);
}

}  // namespace

RunSummary run_update(const Study& study, const RunSettings& settings) {
  const double start = steady_seconds();
  const UpdatePlan plan = plan_update(study, settings);
  const StudyModel& made = plan.made;
  const StudyTests& tests = plan.tests;
  const RunFolder folder(settings.folder);
  LogObserver log(folder.file("mottle.log"), settings.observer, settings.resume);
  const JournalledModel model(*made.model, folder.journal(), study_fingerprint(study, made), settings.resume);
  const UpdatingProblem given = problem_of(study, plan, model);
  const RunContext context{.seed = study.seed, .threads = settings.threads, .observer = &log, .stop = settings.stop};
  for (const std::string& note : made.notes) context.note(note);
  for (const std::string& note : tests.notes) context.note(note);
  if (!given.covariance_groups.empty() && !find_method(study.update.method).estimates_population) {
    context.warning(fmt::format("update.covariance is not used: method '{}' does not estimate the scatter of specimens",
                                study.update.method));
  }

  const double ready = steady_seconds();
  std::optional<SurrogateUpdate> surrogate;
  if (study.surrogate) surrogate.emplace(given, *study.surrogate);
  const UpdatingProblem& problem = surrogate ? surrogate->problem() : given;
  UpdatingResult result = compute_or_discard(study, folder, result_names(), [&] {
    return surrogate ? surrogate->run(*plan.method, context) : plan.method->update(given, context);
  });
  if (result.status == UpdatingStatus::stopped) throw Stopped(result.message);
  const double updated = steady_seconds();
  note_what_happened(result, model, context);
  const CouldHide hidden = find_could_hide(study, made, problem, result, judge(problem, result).conclusion, context);
  result.not_tested.insert(result.not_tested.end(), hidden.sentences.begin(), hidden.sentences.end());
  result.notes.insert(result.notes.end(), hidden.notes.begin(), hidden.notes.end());

  std::optional<std::string> numbering;
  if (tests.is_by_rank) numbering = rank_warning(made.model->selection(), tests.data.values, result.history);
  if (!numbering && !result.history.empty()) numbering = bend_warning(made.model->selection(), result.history.back());
  if (numbering) context.warning(*numbering);
  Json json = update_result_json(study, tests, problem, *plan.method, result);
  json["verdict"]["could_hide"] = hidden.list;
  if (numbering) json["notes"].push_back(*numbering + '.');
  json["surrogate"] = surrogate ? surrogate_json(*study.surrogate, *surrogate) : Json(nullptr);
  if (plan.prediction) add_prediction(study, *plan.prediction, problem, result, context, folder, json);
  std::vector<Cloud> clouds;
  for (const IterationRecord& state : result.history) clouds.push_back(state.cloud);
  folder.write("study.toml", study_text_for(study, folder.path()));
  folder.write("history.csv", history_csv(problem, result));
  folder.write("cloud-initial.csv", cloud_csv(result.history.front().cloud, *made.space, model.outputs()));
  folder.write("cloud-final.csv", cloud_csv(result.history.back().cloud, *made.space, model.outputs()));
  folder.write("clouds.csv", clouds_csv(clouds, *made.space, model.outputs()));
  folder.write("tests.csv", tests_csv(tests, model.outputs()));
  if (!tests.pairing.empty()) folder.write("pairing.csv", tests.pairing);
  json["timings_s"] = {{"reading", ready - start},
                       {"updating", updated - ready},
                       {"writing", steady_seconds() - updated},
                       {"total", steady_seconds() - start}};
  write_shapes(folder, *made.model, result.mean);
  tell_solver_use(model.use(), json, context);
  folder.write("result.json", pretty(json));

  RunSummary summary;
  summary.status = status_text(result.status);
  summary.message = result.message;
  const Verdict verdict = judge(problem, result);
  for (const std::string& line : verdict_lines(verdict, hidden)) context.note(line);
  summary.lines = summary_lines(problem, result, verdict, hidden);
  if (plan.prediction) {
    for (const auto& note : json["prediction"]["notes"]) summary.lines.push_back(note.get<std::string>());
  }
  summary.json = summary_json(json, folder).dump(-1, ' ', false, Json::error_handler_t::replace);
  return summary;
}

}  // namespace mottle
