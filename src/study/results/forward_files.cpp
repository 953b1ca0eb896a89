// The files and the summaries of propagate and simulate.
#include <algorithm>
#include <cmath>
#include <iterator>

#include "mottle/core/clock.hpp"
#include "mottle/core/shell_word.hpp"
#include "mottle/formats/tables/csv.hpp"
#include "mottle/model/reference_sizes.hpp"
#include "mottle/stats/moments/descriptive.hpp"
#include "mottle/study/jobs/forward.hpp"
#include "mottle/study/results/run_folder.hpp"
#include "mottle/updating/estimate/sample_estimate.hpp"
#include "study/results/next_steps.hpp"
#include "study/results/result_json.hpp"
#include "study/results/run_files.hpp"
#include "study/results/solver_use.hpp"

namespace mottle::study {
namespace {

/// What 95 % of the samples lie within [output x 2], linear between the samples.
Eigen::MatrixXd sample_intervals(const Eigen::MatrixXd& samples) {
  Eigen::MatrixXd intervals(samples.cols(), 2);
  const Eigen::VectorXd equal = Eigen::VectorXd::Constant(samples.rows(), 1.0 / static_cast<double>(samples.rows()));
  for (Eigen::Index k = 0; k < samples.cols(); ++k) {
    intervals.row(k) << weighted_quantile(samples.col(k), equal, 0.025),
        weighted_quantile(samples.col(k), equal, 0.975);
  }
  return intervals;
}

/// What to do with a cloud: `next` of result.json.
Json next_of(const Study& study) {
  const std::string file = shell_word(study.file.filename().string());
  if (study.test) {
    return Json::array({{{"command", "mottle update " + file},
                         {"reason",
                          "Finds the parameters that explain the study's tests, and says whether the model can "
                          "be right."}}});
  }
  return Json::array({{{"command", "mottle check " + file},
                       {"reason", "After adding [test] to the study: with tests the parameters can be updated."}}});
}

/// Names and units of the outputs, with their moments where there are two samples or more.
Json propagated_outputs(const PropagateOutcome& outcome) {
  const Cloud::Valid valid = outcome.cloud.valid();
  Json json = outputs_json(outcome.made.model->outputs());
  if (valid.outputs.rows() < 2) return json;
  json["initial_mean"] = to_json(sample_mean(valid.outputs));
  json["initial_covariance"] = to_json_rows(sample_covariance(valid.outputs));
  json["coefficient_of_variation"] =
      to_json(sample_standard_deviation(valid.outputs)
                  .cwiseQuotient(reference_sizes(outcome.made.model->outputs(), sample_mean(valid.outputs))));
  json["interval95"] = to_json_rows(sample_intervals(valid.outputs));
  return json;
}

Json outcome_json(const PropagateOutcome& outcome) {
  const Cloud& cloud = outcome.cloud;
  const Cloud::Valid valid = cloud.valid();
  Json json = result_head(outcome.study, "propagate");
  json["status"] = "converged";
  json["message"] = fmt::format("{} samples evaluated", cloud.samples.rows());
  json["parameters"] = parameters_json(*outcome.made.space);
  json["outputs"] = propagated_outputs(outcome);
  if (valid.outputs.rows() >= 2) {
    const Eigen::VectorXd mean = sample_mean(valid.outputs);
    const Eigen::MatrixXd covariance = sample_covariance(valid.outputs);
    json["iterations"] = Json::array({{{"index", 0},
                                       {"output_mean", to_json(mean)},
                                       {"output_std", to_json(covariance.diagonal().cwiseSqrt())},
                                       {"output_covariance", to_json_rows(covariance)},
                                       {"ellipses", ellipses_json(mean, covariance)}}});
  }
  add_cloud_analysis(outcome.made.model->outputs(), json, cloud, cloud);
  json["model_evaluations"] = cloud.samples.rows();
  json["rejected_draws"] = rejected_draws_json(cloud.rejected);
  json["failed_evaluations"] = failures_json(cloud.failures, 0);
  json["tracking"] = tracking_json(cloud.notes, 0);
  json["next"] = next_of(outcome.study);
  return json;
}

/// @param writing  seconds that the files have taken so far
std::string result_text(const PropagateOutcome& outcome, double writing) {
  const double start = steady_seconds();
  Json json = outcome_json(outcome);
  json["timings_s"] = {{"total", outcome.seconds + writing + steady_seconds() - start}};
  json["ranks"] = outcome.ranks;
  add_solver_use(outcome.solver_use, json);
  return pretty(json);
}

std::vector<std::string> cloud_lines(const Cloud& cloud, const std::vector<Quantity>& outputs) {
  const Cloud::Valid valid = cloud.valid();
  std::vector<std::string> lines;
  lines.push_back(fmt::format("{} samples, {} failed, {} impossible draws replaced", cloud.samples.rows(),
                              cloud.failures.size(), cloud.rejected));
  if (valid.outputs.rows() < 2) return lines;
  lines.push_back(fmt::format("{:<14} {:>13} {:>13}  unit", "output", "mean", "std"));
  for (std::size_t k = 0; k < outputs.size(); ++k) {
    std::vector<double> values;  // without those that a simulated test left out
    std::ranges::copy_if(valid.outputs.col(static_cast<Eigen::Index>(k)), std::back_inserter(values),
                         [](double value) { return !std::isnan(value); });
    if (values.size() < 2) continue;
    const Eigen::Map<const Eigen::MatrixXd> column(values.data(), static_cast<Eigen::Index>(values.size()), 1);
    lines.push_back(fmt::format("{:<14} {:>13.6g} {:>13.6g}  {}", outputs[k].name(), sample_mean(column)(0),
                                sample_standard_deviation(column)(0), outputs[k].unit));
  }
  return lines;
}

}  // namespace

void write_results(const PropagateOutcome& outcome, const std::filesystem::path& path) {
  const double start = steady_seconds();
  const RunFolder folder(path);
  const std::vector<Quantity>& outputs = outcome.made.model->outputs();
  folder.write("study.toml", study_text_for(outcome.study, folder.path()));
  folder.write("cloud.csv", cloud_csv(outcome.cloud, *outcome.made.space, outputs));
  folder.write("clouds.csv", clouds_csv({outcome.cloud}, *outcome.made.space, outputs));
  folder.write("result.json", result_text(outcome, steady_seconds() - start));
}

std::string result_text(const PropagateOutcome& outcome) {
  return result_text(outcome, 0.0);
}

RunSummary summarise(const PropagateOutcome& outcome, const std::filesystem::path& folder) {
  const std::vector<Quantity>& outputs = outcome.made.model->outputs();
  const Json json = {{"command", "propagate"},
                     {"samples", outcome.cloud.samples.rows()},
                     {"failed", outcome.cloud.failures.size()},
                     {"rejected_draws", outcome.cloud.rejected},
                     {"outputs", propagated_outputs(outcome)},
                     {"folder", folder.string()},
                     {"cloud", (folder / "cloud.csv").string()},
                     {"report", (folder / "report.html").string()}};
  return {.status = "done", .lines = cloud_lines(outcome.cloud, outputs), .json = one_line(json)};
}

void write_results(const SimulateOutcome& outcome, const std::filesystem::path& path) {
  const RunFolder folder(path);
  const std::vector<Quantity>& outputs = outcome.made.model->outputs();
  std::vector<std::string> names;
  for (const Quantity& output : outputs) names.push_back(output.name());
  Eigen::MatrixXd truth(outcome.exact.rows(), outcome.cloud.samples.cols() + outcome.exact.cols());
  truth << outcome.cloud.samples, outcome.exact;
  folder.write("study.toml", study_text_for(outcome.study, folder.path()));
  folder.write("specimens-truth.csv", format_csv(column_names(*outcome.made.space, outputs), truth));
  folder.write("specimens.csv", format_csv(names, outcome.cloud.outputs));
  folder.forget_previous(specimen_names());
}

RunSummary summarise(const SimulateOutcome& outcome, const std::filesystem::path& folder) {
  const std::string file = (folder / "specimens.csv").string();
  const Json json = {{"command", "simulate"},
                     {"specimens", outcome.cloud.samples.rows()},
                     {"rejected_draws", outcome.cloud.rejected},
                     {"folder", folder.string()},
                     {"file", file}};
  RunSummary summary{.status = "done", .json = one_line(json)};
  summary.lines = cloud_lines(outcome.cloud, outcome.made.model->outputs());
  summary.lines.push_back("specimens: " + file);
  return summary;
}

}  // namespace mottle::study
