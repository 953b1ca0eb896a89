// The summary of `mottle check`.
#include <cmath>
#include <string_view>

#include "mottle/core/clock.hpp"
#include "mottle/core/error.hpp"
#include "mottle/core/text.hpp"
#include "mottle/model/reference_sizes.hpp"
#include "mottle/study/jobs/check.hpp"
#include "mottle/study/models/model_source.hpp"
#include "study/jobs/checked_study.hpp"
#include "study/jobs/expected_runs.hpp"
#include "study/jobs/study_reach.hpp"
#include "study/results/relative_scatter.hpp"
#include "study/results/result_json.hpp"

namespace mottle::study {
namespace {

std::string transform_text(const ParameterTransform& transform) {
  if (transform.kind == ParameterTransform::Kind::log) return ", normal on its logarithm";
  return transform.kind == ParameterTransform::Kind::logit ? ", normal on its logit between the bounds" : "";
}

/// What the population's covariance may hold.
std::string covariance_line(const Study& study, const std::vector<std::string>& names) {
  const std::vector<int> groups = covariance_groups(study, names);
  if (!find_method(study.update.method).estimates_population) {
    return groups.empty() ? fmt::format("  {} does not estimate the scatter of the specimens", study.update.method)
                          : fmt::format("  covariance: not used, {} does not estimate the scatter of the specimens",
                                        study.update.method);
  }
  std::vector<std::string> together;
  for (std::size_t i = 0; i < names.size() && !groups.empty(); ++i) {
    std::vector<std::string> group;
    for (std::size_t j = 0; j < names.size(); ++j) {
      if (groups[j] == groups[i]) group.push_back(names[j]);
    }
    if (group.front() == names[i] && group.size() > 1) together.push_back(fmt::format("[{}]", join(group)));
  }
  if (groups.empty()) return "  covariance: full";
  return together.empty() ? "  covariance: diagonal" : fmt::format("  covariance: only within {}", join(together));
}

std::string bounds_text(const StudyParameter& parameter) {
  const bool has_lower = std::isfinite(parameter.lower_bound);
  const bool has_upper = std::isfinite(parameter.upper_bound);
  if (has_lower && has_upper) return fmt::format("[{}, {}]", parameter.lower_bound, parameter.upper_bound);
  if (has_lower) return fmt::format(">= {}", parameter.lower_bound);
  return has_upper ? fmt::format("<= {}", parameter.upper_bound) : "none";
}

void describe_parameters(const StudyParameters& parameters, const StudyModel& made, std::vector<std::string>& lines) {
  lines.push_back(fmt::format("{:<14} {:<24} {:<18} {:>12} {:>12}  bounds, how it enters", "parameter", "acts on",
                              "distribution", "mean", "std"));
  const Eigen::VectorXd mean = made.space->prior().mean();
  const Eigen::VectorXd standard_deviation = made.space->prior().covariance().diagonal().cwiseSqrt();
  for (std::size_t i = 0; i < parameters.list.size(); ++i) {
    const StudyParameter& parameter = parameters.list[i];
    const auto index = static_cast<Eigen::Index>(i);
    lines.push_back(fmt::format("{:<14} {:<24} {:<18} {:>12.6g} {:>12.6g}  {}, {} {}{}", parameter.name,
                                join(parameter.targets), distribution_kind_info(parameter.distribution.kind).name,
                                mean(index), standard_deviation(index), bounds_text(parameter),
                                parameter.is_factor ? "as a factor," : "in place of the value,",
                                made.model->structure().parameter_role(index), transform_text(parameter.transform)));
  }
}

/// Model, parameters and modes.
void describe_model(const CheckOutcome& outcome, std::vector<std::string>& lines) {
  const StudyModel& made = outcome.checked->made();
  const StructureModel& model = *made.model;
  for (std::string& line : model.structure().description(made.space->prior().mean())) lines.push_back(std::move(line));
  for (const std::string& note : made.notes) lines.push_back("note: " + note);
  describe_parameters(parameters_of(outcome.study), made, lines);
  for (Eigen::Index r = 0; r < outcome.frequencies.size(); ++r) {
    lines.push_back(fmt::format("mode {:<3} {:>12.6g} {} at the parameters' means", r + 1, outcome.frequencies(r),
                                model.selection().units.frequency));
  }
  std::vector<std::string> names;
  for (const Quantity& output : model.outputs()) names.push_back(fmt::format("{} [{}]", output.name(), output.unit));
  lines.push_back("outputs: " + join(names));
}

/// A note in lines of at most 110 letters where it has commas or ends of sentences to break at: what belongs together
/// stays on one line.
void add_wrapped(std::string note, std::vector<std::string>& lines) {
  constexpr std::size_t k_width = 110;
  while (note.size() > k_width) {
    std::size_t end = 0;
    for (std::size_t k = 4; k + 1 < note.size() && (k < k_width || end == 0); ++k) {
      if (note[k] == ' ' && std::string_view(",;:.").find(note[k - 1]) != std::string_view::npos) end = k;
    }
    if (end == 0) break;
    lines.push_back(note.substr(0, end));
    note = "    " + note.substr(end + 1);
  }
  lines.push_back(std::move(note));
}

std::string cell(const char* form, double value) {
  return std::isfinite(value) ? fmt::format(fmt::runtime(form), value) : "";
}

/// "K4 +11 %": the parameter that changes an output most, by one prior standard deviation.
std::string largest_change(const CheckOutcome& outcome, Eigen::Index output) {
  if (outcome.changes.size() == 0 || !outcome.changes.row(output).allFinite()) return "";
  Eigen::Index parameter = 0;
  outcome.changes.row(output).cwiseAbs().maxCoeff(&parameter);
  return fmt::format("{} {:+.2g} %", outcome.checked->made().space->names()[static_cast<std::size_t>(parameter)],
                     100.0 * outcome.changes(output, parameter));
}

/// Outputs at the parameters' means beside the tests, but for components of shapes.
void describe_outputs(const CheckOutcome& outcome, std::vector<std::string>& lines) {
  const std::vector<Quantity>& outputs = outcome.checked->made().model->outputs();
  const TestMoments tests = outcome.checked->plan ? test_moments(outcome.checked->plan->tests.data) : TestMoments{};
  lines.push_back(fmt::format("{:<12} {:>12} {:<8} {:>12} {:>8} {:>8}  {}", "output", "model", "unit", "tests' mean",
                              "diff. %", "std %", "changed most by (one prior std)"));
  for (std::size_t k = 0; k < outputs.size(); ++k) {
    const auto index = static_cast<Eigen::Index>(k);
    const QuantityKind kind = outputs[k].kind;
    if (kind == QuantityKind::displacement || kind == QuantityKind::rotation) continue;
    const double model = outcome.outputs(index);
    const double mean = tests.mean.size() > 0 ? tests.mean(index) : std::nan("");
    const double deviation = tests.mean.size() > 0 ? std::sqrt(tests.covariance(index, index)) : std::nan("");
    const double scatter = relative_scatter(deviation, mean);
    lines.push_back(fmt::format("{:<12} {:>12} {:<8} {:>12} {:>8} {:>8}  {}", outputs[k].name(), cell("{:.6g}", model),
                                outputs[k].unit, cell("{:.6g}", mean), cell("{:+.1f}", 100.0 * (model / mean - 1.0)),
                                cell("{:.2g}", 100.0 * scatter), largest_change(outcome, index)));
  }
}

/// What each parameter can change at most, and what asks for a second thought.
void describe_reach_of_parameters(const CheckOutcome& outcome, std::vector<std::string>& lines) {
  const StudyModel& made = outcome.checked->made();
  const std::vector<Quantity>& outputs = made.model->outputs();
  const std::vector<std::string> names = made.space->names();
  const Eigen::VectorXd sizes_of_outputs = reference_sizes(outputs, outcome.outputs);
  for (Eigen::Index i = 0; i < outcome.changes.cols(); ++i) {
    Eigen::Index output = 0;
    const Eigen::VectorXd sizes =
        outcome.changes.col(i).array().isFinite().select(outcome.changes.col(i).cwiseAbs(), 0.0);
    const double largest = sizes.maxCoeff(&output);
    const std::string& name = names[static_cast<std::size_t>(i)];
    if (largest == 0.0 && !outcome.changes.col(i).allFinite()) {
      lines.push_back(
          fmt::format("what {} changes is not known: the outputs cannot be computed near the parameters' means", name));
    } else if (largest == 0.0) {
      lines.push_back(fmt::format("warning: {} changes no output", name));
    } else {
      const bool is_near_node = sizes_of_outputs(output) > std::abs(outcome.outputs(output));
      lines.push_back(fmt::format("{} changes {} most: {:+.2g} %{} by one prior standard deviation", name,
                                  outputs[static_cast<std::size_t>(output)].name(), 100.0 * outcome.changes(output, i),
                                  is_near_node ? " of its shape's largest component" : ""));
    }
  }
  if (names.size() > outputs.size()) {
    lines.push_back(
        fmt::format("warning: {} parameters for {} outputs: of the parameters' combinations, the tests' means "
                    "determine at most {}; "
                    "the others stay as the prior has them",
                    names.size(), outputs.size(), outputs.size()));
  }
}

/// How many runs of its program an update takes, and for how long.
void describe_runs(const CheckOutcome& outcome, const ProgramRuns& program, std::vector<std::string>& lines,
                   Json& json) {
  const double seconds = outcome.solution_seconds;
  json["run_seconds"] = seconds > 0.0 ? Json(seconds) : Json(nullptr);
  const std::int64_t runs = outcome.expected_runs.count;
  json["expected_runs"] = runs > 0 ? Json(runs) : Json(nullptr);
  if (seconds > 0.0) lines.push_back(fmt::format("one model run took {}", duration_text(seconds)));
  if (runs == 0) return;
  lines.push_back(expected_runs_text(outcome.expected_runs, seconds, program.max_parallel));
  if (outcome.study.update.method != "perturbation") {
    lines.emplace_back(
        "fewer runs: a [surrogate] (50 or so, docs/howto/surrogate.md), or update.method = \"perturbation\"");
  }
}

/// Tests and method.
void describe_update(const CheckOutcome& outcome, std::vector<std::string>& lines, Json& json) {
  const Study& study = outcome.study;
  const UpdatePlan& plan = *outcome.checked->plan;
  const StudyTests& tests = plan.tests;
  const CloudSettings rules = cloud_settings(study, plan.made, tests.data.values.rows(), tests.data.values.cols());
  lines.push_back(fmt::format("tests: {} specimens of {} outputs", tests.data.values.rows(), tests.data.values.cols()));
  for (const TestDoubt& doubt : tests.doubts) add_wrapped("  warning: " + doubt.sentence, lines);
  for (const std::string& note : tests.notes) add_wrapped("  " + note, lines);
  const bool samples_always = find_method(study.update.method).samples_each_iteration;
  lines.push_back(
      samples_always
          ? fmt::format("would run: method {}, a cloud of {} samples in each of at most {} iterations and before: {} "
                        "model runs",
                        study.update.method, rules.samples, study.update.iterations,
                        static_cast<std::int64_t>(rules.samples) * (study.update.iterations + 1))
          : fmt::format(
                "would run: method {}, at most {} iterations; besides, a first and a last cloud of {} samples: {} "
                "model runs",
                study.update.method, study.update.iterations, rules.samples, 2 * rules.samples));
  lines.push_back(covariance_line(study, plan.made.space->names()));
  for (const auto& [name, value] : plan.method->options()) {
    lines.push_back(fmt::format("  {} = {}", name, option_text(value)));
  }
  if (plan.made.program) {
    describe_runs(outcome, *plan.made.program, lines, json);
  } else if (outcome.solution_seconds > 0.0) {
    const bool is_reduced = study.model->reduction_error() && study.may_reduce;
    lines.push_back(
        fmt::format("one model run took {:.2g} s{}", outcome.solution_seconds,
                    is_reduced ? "; in clouds a reduced model takes far less where it can be certified" : ""));
  }
  json["specimens"] = tests.data.values.rows();
  json["samples"] = rules.samples;
  json["method"] = study.update.method;
}

}  // namespace

RunSummary summarise(const CheckOutcome& outcome) {
  const Study& study = outcome.study;
  const StudyModel& made = outcome.checked->made();
  RunSummary summary{.status = "done"};
  summary.lines.push_back(fmt::format("{}: {} (units {})", study.file.string(), study.title, study.units));
  describe_model(outcome, summary.lines);
  describe_outputs(outcome, summary.lines);
  describe_reach_of_parameters(outcome, summary.lines);
  Json json = {{"command", "check"},
               {"title", study.title},
               {"units", study.units},
               {"total_mass", outcome.total_mass},
               {"frequencies", to_json(outcome.frequencies)},
               {"parameters", parameters_json(*made.space)},
               {"outputs", outputs_json(made.model->outputs())},
               {"output_values", to_json(outcome.outputs)},
               {"changes", to_json_rows(outcome.changes)}};
  if (outcome.checked->plan) {
    describe_update(outcome, summary.lines, json);
  } else {
    summary.lines.emplace_back("tests: none that parameters are updated to; propagate and simulate alone can run");
  }
  for (std::string& line : reach_lines(outcome.reach)) summary.lines.push_back(std::move(line));
  json["programs"] = outcome.reach.programs;
  json["outside"] = outcome.reach.outside;
  summary.json = one_line(json);
  return summary;
}

}  // namespace mottle::study
