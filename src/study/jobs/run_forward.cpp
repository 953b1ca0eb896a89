// The jobs that only run the model forward: propagate, simulate.
#include <algorithm>

#include "mottle/core/error.hpp"
#include "mottle/core/files.hpp"
#include "mottle/core/text.hpp"
#include "mottle/formats/tables/csv.hpp"
#include "mottle/model/journal.hpp"
#include "mottle/stats/moments/descriptive.hpp"
#include "mottle/study/input/text_file.hpp"
#include "mottle/study/jobs/run.hpp"
#include "mottle/study/results/run_folder.hpp"
#include "study/input/noise_rules.hpp"
#include "study/results/result_json.hpp"
#include "study/results/run_files.hpp"
#include "study/results/solver_use.hpp"

namespace mottle {
namespace {

Eigen::MatrixXd read_points(const std::filesystem::path& file, const ParameterSpace& space) {
  const CsvTable table = parse_csv(read_text_file(file), file.string());
  const std::vector<std::string> names = space.names();
  for (const std::string& column : table.header) {
    if (std::find(names.begin(), names.end(), column) == names.end()) {
      throw FormatError(table.file, 1, unknown_name_message("parameter", column, names));
    }
  }
  if (table.rows.empty()) throw FormatError(table.file, 0, "holds no point: there is no row under the header");
  Eigen::MatrixXd points(static_cast<Eigen::Index>(table.rows.size()), space.count());
  for (std::size_t i = 0; i < names.size(); ++i) {
    const int column = table.find(names[i]);
    if (column < 0) throw FormatError(table.file, 1, fmt::format("parameter '{}' has no column", names[i]));
    points.col(static_cast<Eigen::Index>(i)) = numbers_of_column(table, column);
  }
  for (Eigen::Index row = 0; row < points.rows(); ++row) {
    const int line = table.lines[static_cast<std::size_t>(row)];
    if (!points.row(row).allFinite()) throw FormatError(table.file, line, "a parameter has no value");
    if (!space.is_possible(points.row(row))) {
      throw FormatError(table.file, line,
                        "a stiffness or mass is <= 0 or a damping < 0, which is physically impossible");
    }
  }
  return points;
}

Json propagate_json(const Study& study, const StudyModel& made, const Cloud& cloud) {
  const Cloud::Valid valid = cloud.valid();
  Json json = result_head(study, "propagate");
  json["status"] = "converged";
  json["message"] = fmt::format("{} samples evaluated", cloud.samples.rows());
  json["parameters"] = parameters_json(*made.space);
  json["outputs"] = outputs_json(made.model->outputs());
  if (valid.outputs.rows() >= 2) {
    const Eigen::VectorXd mean = sample_mean(valid.outputs);
    const Eigen::MatrixXd covariance = sample_covariance(valid.outputs);
    json["outputs"]["initial_mean"] = to_json(mean);
    json["outputs"]["initial_covariance"] = to_json_rows(covariance);
    json["iterations"] = Json::array({{{"index", 0},
                                       {"output_mean", to_json(mean)},
                                       {"output_std", to_json(covariance.diagonal().cwiseSqrt())},
                                       {"output_covariance", to_json_rows(covariance)},
                                       {"ellipses", ellipses_json(mean, covariance)}}});
  }
  add_cloud_analysis(json, cloud, cloud);
  json["model_evaluations"] = cloud.samples.rows();
  json["rejected_draws"] = rejected_draws_json(cloud.rejected);
  json["failed_evaluations"] = failures_json(cloud.failures, 0);
  json["tracking"] = tracking_json(cloud.notes, 0);
  return json;
}

std::vector<std::string> cloud_lines(const Cloud& cloud, const std::vector<Output>& outputs) {
  const Cloud::Valid valid = cloud.valid();
  std::vector<std::string> lines;
  lines.push_back(fmt::format("{} samples, {} failed, {} impossible draws replaced", cloud.samples.rows(),
                              cloud.failures.size(), cloud.rejected));
  if (valid.outputs.rows() < 2) return lines;
  const Eigen::VectorXd mean = sample_mean(valid.outputs);
  const Eigen::VectorXd deviation = sample_standard_deviation(valid.outputs);
  lines.push_back(fmt::format("{:<14} {:>13} {:>13}  unit", "output", "mean", "std"));
  for (Eigen::Index k = 0; k < mean.size(); ++k) {
    const Output& output = outputs[static_cast<std::size_t>(k)];
    lines.push_back(fmt::format("{:<14} {:>13.6g} {:>13.6g}  {}", output.name, mean(k), deviation(k), output.unit));
  }
  return lines;
}

/// Measurement noise of the truth added to the outputs, one stream a specimen. A relative noise is a part of the
/// output at the parameters' means.
void add_noise(Eigen::MatrixXd& outputs, const Study& study, const StudyModel& made, const RunContext& context) {
  if (study.truth->noise.empty()) return;
  std::vector<std::string> names;
  for (const Output& output : made.model->outputs()) names.push_back(output.name);
  const Eigen::MatrixXd nominal = made.model->evaluate(made.space->prior().mean().transpose(), context).outputs;
  Eigen::VectorXd deviation;
  try {
    deviation = noise_deviations(study.truth->noise, names, nominal.row(0).transpose(), "truth.noise").std;
  } catch (const InvalidInput& error) {
    throw InvalidInput(located(study, error.what()));
  }
  if (deviation.isZero(0.0)) return;
  const JointDistribution noise =
      JointDistribution::multivariate_normal(Eigen::VectorXd::Zero(outputs.cols()), deviation.cwiseAbs2().asDiagonal());
  outputs += noise.from_uniform(uniform_design(SamplingDesign::monte_carlo, outputs.rows(), outputs.cols(),
                                               {.seed = study.seed, .purpose = StreamPurpose::test_noise}));
}

}  // namespace

RunSummary run_propagate(const Study& study, const std::optional<std::filesystem::path>& points,
                         const RunSettings& settings) {
  const double start = steady_seconds();
  const StudyModel made = make_model(study, study.parameters, settings);
  const Eigen::MatrixXd given = points ? read_points(*points, *made.space) : Eigen::MatrixXd();
  const Eigen::Index specimens = study.test ? read_tests(study, *made.model).data.values.rows() : 10;
  const auto outputs = static_cast<Eigen::Index>(made.model->outputs().size());
  const RunFolder folder(settings.folder);
  LogObserver log(folder.file("mottle.log"), settings.observer, settings.resume);
  const JournalledModel model(*made.model, folder.journal(), study_fingerprint(study, made, points), settings.resume);
  const RunContext context{.seed = study.seed, .threads = settings.threads, .observer = &log, .stop = settings.stop};

  const CloudSettings cloud_rules = cloud_settings(study, specimens, outputs);
  const StreamKey key{.seed = study.seed, .purpose = StreamPurpose::parameter_cloud};
  std::vector<std::string> earlier = result_names();
  std::error_code ignored;  // a file that is not there is not the points
  std::erase_if(earlier, [&](const std::string& name) {
    return points && std::filesystem::equivalent(folder.file(name), *points, ignored);
  });
  const Cloud cloud = compute_or_discard(study, folder, earlier, [&] {
    return points ? evaluate_points(model, given, cloud_rules.most_failed, context)
                  : evaluate_cloud(model, *made.space, made.space->prior(), cloud_rules, key, context);
  });

  folder.write("study.toml", study_text_for(study, folder.path()));
  folder.write("cloud.csv", cloud_csv(cloud, *made.space, model.outputs()));
  folder.write("clouds.csv", clouds_csv({cloud}, *made.space, model.outputs()));
  Json json = propagate_json(study, made, cloud);
  if (!cloud.failures.empty()) {
    context.warning(
        fmt::format("{} of {} model runs failed and were left out; if failures are not a matter of chance, "
                    "the cloud is biased",
                    cloud.failures.size(), cloud.samples.rows()));
  }
  json["timings_s"] = {{"total", steady_seconds() - start}};
  tell_solver_use(model.use(), json, context);
  folder.write("result.json", pretty(json));
  RunSummary summary;
  summary.status = "done";
  summary.lines = cloud_lines(cloud, model.outputs());
  summary.json = Json{{"command", "propagate"},
                      {"samples", cloud.samples.rows()},
                      {"failed", cloud.failures.size()},
                      {"rejected_draws", cloud.rejected},
                      {"outputs", json["outputs"]},
                      {"folder", folder.path().string()},
                      {"cloud", folder.file("cloud.csv").string()},
                      {"report", folder.file("report.html").string()}}
                     .dump(-1, ' ', false, Json::error_handler_t::replace);
  return summary;
}

RunSummary run_simulate(const Study& study, const RunSettings& settings) {
  require(study.truth.has_value(),
          "{}: truth: is missing; give [truth] specimens = 10 and, where they differ from "
          "[[parameter]], [[truth.parameter]]",
          study.file.string());
  const StudyParameters& parameters = study.truth->parameters.list.empty() ? study.parameters : study.truth->parameters;
  const StudyModel made = make_model(study, parameters, settings);
  const RunContext context{
      .seed = study.seed, .threads = settings.threads, .observer = settings.observer, .stop = settings.stop};
  const CloudSettings rules{.samples = study.truth->specimens, .most_failed = 0.0};
  const StreamKey key{.seed = study.seed, .purpose = StreamPurpose::truth};
  Cloud cloud = evaluate_cloud(*made.model, *made.space, made.space->prior(), rules, key, context);
  const Eigen::MatrixXd exact = cloud.outputs;
  add_noise(cloud.outputs, study, made, context);

  const RunFolder folder(settings.folder);
  std::vector<std::string> names;
  for (const Output& output : made.model->outputs()) names.push_back(output.name);
  Eigen::MatrixXd truth(cloud.samples.rows(), cloud.samples.cols() + exact.cols());
  truth << cloud.samples, exact;
  folder.write("study.toml", study_text_for(study, folder.path()));
  folder.write("specimens-truth.csv", format_csv(column_names(*made.space, made.model->outputs()), truth));
  folder.write("specimens.csv", format_csv(names, cloud.outputs));
  RunSummary summary;
  summary.status = "done";
  summary.lines = cloud_lines(cloud, made.model->outputs());
  summary.lines.push_back("specimens: " + folder.file("specimens.csv").string());
  summary.json = Json{{"command", "simulate"},
                      {"specimens", cloud.samples.rows()},
                      {"rejected_draws", cloud.rejected},
                      {"folder", folder.path().string()},
                      {"file", folder.file("specimens.csv").string()}}
                     .dump(-1, ' ', false, Json::error_handler_t::replace);
  return summary;
}

}  // namespace mottle
