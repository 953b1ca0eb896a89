// mottle check: reads everything, says what would run, and refuses whatever an update would refuse.
#include <unistd.h>

#include <algorithm>

#include "mottle/core/error.hpp"
#include "mottle/core/text.hpp"
#include "mottle/drivers/command/run_folders.hpp"
#include "mottle/dynamics/modes/mode_set.hpp"
#include "mottle/study/jobs/run.hpp"
#include "mottle/study/models/model_source.hpp"
#include "study/jobs/study_reach.hpp"
#include "study/jobs/update_plan.hpp"
#include "study/results/result_json.hpp"

namespace mottle {
namespace {

constexpr Eigen::Index k_listed_modes = 10;

std::string scale_text(const NormalScale& scale) {
  if (scale.kind == NormalScale::Kind::log) return ", normal on its logarithm";
  return scale.kind == NormalScale::Kind::logit ? ", normal on its logit between the bounds" : "";
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
    if (group.front() == names[i] && group.size() > 1) together.push_back("[" + join(group) + "]");
  }
  if (groups.empty()) return "  covariance: full";
  return together.empty() ? "  covariance: diagonal" : fmt::format("  covariance: only within {}", join(together));
}

/// Throws InvalidInput where an update could not put its results: a file, or a folder that may not be written.
void require_place(const std::filesystem::path& folder) {
  if (folder.empty()) return;
  std::error_code ignored;
  std::filesystem::path place = std::filesystem::absolute(folder);
  while (place.has_relative_path() && !std::filesystem::exists(place, ignored)) place = place.parent_path();
  require(std::filesystem::is_directory(place, ignored), "{}: this folder cannot be made: Not a directory",
          folder.string());
  require(::access(place.c_str(), W_OK | X_OK) == 0, "{}: nothing can be written there; name another place with --out",
          folder.string());
}

void describe_parameters(const StudyParameters& parameters, const StudyModel& made, std::vector<std::string>& lines) {
  lines.push_back(fmt::format("{:<14} {:<24} {:<18} {:>12} {:>12}  bounds, how it enters", "parameter", "acts on",
                              "distribution", "mean", "std"));
  const Eigen::VectorXd mean = made.space->prior().mean();
  const Eigen::VectorXd deviation = made.space->prior().covariance().diagonal().cwiseSqrt();
  for (std::size_t i = 0; i < parameters.list.size(); ++i) {
    const StudyParameter& parameter = parameters.list[i];
    const auto place = static_cast<Eigen::Index>(i);
    lines.push_back(fmt::format("{:<14} {:<24} {:<18} {:>12.6g} {:>12.6g}  [{}, {}], {} {}{}", parameter.name,
                                join(parameter.targets), distribution_kind_info(parameter.distribution.kind).name,
                                mean(place), deviation(place), parameter.lower_bound, parameter.upper_bound,
                                parameter.is_factor ? "as a factor," : "in place of the value,",
                                made.model->structure().parameter_role(place), scale_text(parameter.scale)));
  }
}

/// Model, parameters and modes at the parameters' means.
Json describe_model(const Study& study, const StudyParameters& parameters, const StudyModel& made,
                    std::vector<std::string>& lines) {
  const StructureModel& model = *made.model;
  const Eigen::VectorXd mean = made.space->prior().mean();
  const int most_modes = static_cast<int>(std::min(k_listed_modes, model.structure().mode_count()));
  const ModeSet modes = model.solver().modes_at(mean, most_modes);
  for (std::string& line : model.structure().description(mean)) lines.push_back(std::move(line));
  for (const std::string& note : made.notes) lines.push_back("note: " + note);
  describe_parameters(parameters, made, lines);
  Json frequencies = Json::array();
  const Eigen::Index listed = std::min(k_listed_modes, modes.eigenvalues.size());
  const double scale = modes.eigenvalues.cwiseAbs().maxCoeff();
  const std::string& unit = model.selection().frequency_unit;
  for (Eigen::Index r = 0; r < listed; ++r) {
    const double frequency = natural_frequency_hz(modes.eigenvalues(r), scale);
    frequencies.push_back(frequency);
    lines.push_back(fmt::format("mode {:<3} {:>12.6g} {} at the parameters' means", r + 1, frequency, unit));
  }
  std::vector<std::string> names;
  for (const Quantity& output : model.outputs()) names.push_back(fmt::format("{} [{}]", output.name(), output.unit));
  lines.push_back("outputs: " + join(names));
  return {{"command", "check"},
          {"title", study.title},
          {"units", study.units},
          {"total_mass", model.structure().total_mass(mean)},
          {"frequencies", frequencies},
          {"parameters", parameters_json(*made.space)},
          {"outputs", outputs_json(model.outputs())}};
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

RunSummary run_check(const Study& study, const RunSettings& settings) {
  require_place(settings.folder);
  if (study.model->keeps_runs()) require_no_linked_runs(settings.folder);
  if (!settings.may_run_programs && settings.observer != nullptr) {  // before the study may be refused for it
    for (const std::string& line : reach_lines(reach_of(study))) settings.observer->warning(line);
  }
  RunSettings without_results = settings;
  without_results.folder.clear();
  const bool has_update = study.test && !study.parameters.list.empty();
  const StudyParameters& parameters = study.parameters.list.empty() ? study.truth->parameters : study.parameters;
  std::optional<UpdatePlan> plan;
  std::optional<StudyModel> alone;
  if (has_update) {
    plan = plan_update(study, without_results);
  } else {
    alone = make_model(study, parameters, without_results);
  }
  const StudyModel& made = plan ? plan->made : *alone;

  RunSummary summary;
  summary.status = "done";
  summary.lines.push_back(fmt::format("{}: {} (units {})", study.file.string(), study.title, study.units));
  Json json = describe_model(study, parameters, made, summary.lines);
  if (plan) {
    refuse_what_methods_refuse(study, *plan, {.seed = study.seed, .threads = settings.threads, .stop = settings.stop});
    describe_update(study, *plan, summary.lines, json);
  } else {
    summary.lines.emplace_back("tests: none that parameters are updated to; propagate and simulate alone can run");
  }
  const StudyReach reach = reach_of(study, made.files);
  for (std::string& line : reach_lines(reach)) summary.lines.push_back(std::move(line));
  json["programs"] = reach.programs;
  json["outside"] = reach.outside;
  summary.json = one_line(json);
  return summary;
}

}  // namespace mottle
