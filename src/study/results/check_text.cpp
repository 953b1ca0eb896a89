// The summary of `mottle check`.
#include "mottle/core/error.hpp"
#include "mottle/core/text.hpp"
#include "mottle/study/jobs/check.hpp"
#include "study/jobs/checked_study.hpp"
#include "study/jobs/study_reach.hpp"
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

void describe_parameters(const StudyParameters& parameters, const StudyModel& made, std::vector<std::string>& lines) {
  lines.push_back(fmt::format("{:<14} {:<24} {:<18} {:>12} {:>12}  bounds, how it enters", "parameter", "acts on",
                              "distribution", "mean", "std"));
  const Eigen::VectorXd mean = made.space->prior().mean();
  const Eigen::VectorXd standard_deviation = made.space->prior().covariance().diagonal().cwiseSqrt();
  for (std::size_t i = 0; i < parameters.list.size(); ++i) {
    const StudyParameter& parameter = parameters.list[i];
    const auto index = static_cast<Eigen::Index>(i);
    lines.push_back(fmt::format("{:<14} {:<24} {:<18} {:>12.6g} {:>12.6g}  [{}, {}], {} {}{}", parameter.name,
                                join(parameter.targets), distribution_kind_info(parameter.distribution.kind).name,
                                mean(index), standard_deviation(index), parameter.lower_bound, parameter.upper_bound,
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
  for (Eigen::Index k = 0; k < outcome.outputs.size(); ++k) {
    const Quantity& output = model.outputs()[static_cast<std::size_t>(k)];
    lines.push_back(
        fmt::format("{:<8} {:>12.6g} {} at the parameters' means", output.name(), outcome.outputs(k), output.unit));
  }
  std::vector<std::string> names;
  for (const Quantity& output : model.outputs()) names.push_back(fmt::format("{} [{}]", output.name(), output.unit));
  lines.push_back("outputs: " + join(names));
}

/// Tests and method.
void describe_update(const Study& study, const UpdatePlan& plan, std::vector<std::string>& lines, Json& json) {
  const StudyTests& tests = plan.tests;
  const CloudSettings rules = cloud_settings(study, tests.data.values.rows(), tests.data.values.cols());
  lines.push_back(fmt::format("tests: {} specimens of {} outputs", tests.data.values.rows(), tests.data.values.cols()));
  for (const std::string& note : tests.notes) lines.push_back("  " + note);
  lines.push_back(fmt::format("would run: method {}, {} samples an iteration, at most {} iterations: {} model runs",
                              study.update.method, rules.samples, study.update.iterations,
                              static_cast<std::int64_t>(rules.samples) * (study.update.iterations + 1)));
  lines.push_back(covariance_line(study, plan.made.space->names()));
  for (const auto& [name, value] : plan.method->options()) {
    lines.push_back(fmt::format("  {} = {}", name, option_text(value)));
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
  Json json = {{"command", "check"},
               {"title", study.title},
               {"units", study.units},
               {"total_mass", outcome.total_mass},
               {"frequencies", to_json(outcome.frequencies)},
               {"parameters", parameters_json(*made.space)},
               {"outputs", outputs_json(made.model->outputs())}};
  if (outcome.checked->plan) {
    describe_update(study, *outcome.checked->plan, summary.lines, json);
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
