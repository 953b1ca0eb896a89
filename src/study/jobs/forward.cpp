#include "mottle/study/jobs/forward.hpp"

#include <algorithm>
#include <limits>

#include "mottle/core/clock.hpp"
#include "mottle/core/error.hpp"
#include "mottle/core/text.hpp"
#include "mottle/formats/tables/csv.hpp"
#include "mottle/model/journal.hpp"
#include "mottle/study/input/text_file.hpp"
#include "mottle/study/models/model_source.hpp"
#include "study/input/noise_rules.hpp"
#include "study/jobs/job_files.hpp"
#include "study/jobs/study_reach.hpp"
#include "study/results/solver_use.hpp"

namespace mottle::study {
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

/// Leaves out frequencies that noise made impossible, as an engineer would: no test file may have them.
void leave_out_impossible(Eigen::MatrixXd& outputs, const std::vector<Quantity>& quantities,
                          const RunContext& context) {
  Eigen::Index left_out = 0;
  for (std::size_t k = 0; k < quantities.size(); ++k) {
    if (!traits_of(quantities[k].kind).is_positive) continue;
    auto column = outputs.col(static_cast<Eigen::Index>(k)).array();
    left_out += (column <= 0.0).count();
    column = (column <= 0.0).select(std::numeric_limits<double>::quiet_NaN(), column);
  }
  if (left_out == 0) return;
  context.warning(fmt::format("noise made {} of {} frequencies 0 or less: left out, as modes that were not measured",
                              left_out, outputs.size()));
}

/// Measurement noise of the truth added to the outputs, one stream a specimen. A relative noise is a fraction of the
/// output at the parameters' means.
void add_noise(Eigen::MatrixXd& outputs, const Study& study, const StudyModel& made, const RunContext& context) {
  if (study.truth->noise.empty()) return;
  std::vector<std::string> names;
  for (const Quantity& output : made.model->outputs()) names.push_back(output.name());
  const Eigen::MatrixXd nominal = made.model->evaluate(made.space->prior().mean().transpose(), context).outputs;
  Eigen::VectorXd standard_deviation;
  try {
    standard_deviation = noise_standard_deviations(study.truth->noise, names, nominal.row(0).transpose()).std;
  } catch (const InvalidInput& error) {
    throw InvalidInput(located(study, "truth.noise", error.what()));
  }
  if (standard_deviation.isZero(0.0)) return;
  const JointDistribution noise = JointDistribution::multivariate_normal(Eigen::VectorXd::Zero(outputs.cols()),
                                                                         standard_deviation.cwiseAbs2().asDiagonal());
  outputs += noise.from_uniform(uniform_design(SamplingDesign::monte_carlo, outputs.rows(), outputs.cols(),
                                               {.seed = study.seed, .purpose = StreamPurpose::test_noise}));
  leave_out_impossible(outputs, made.model->outputs(), context);
}

PropagateOutcome propagate_here(const Study& study, const std::optional<std::filesystem::path>& points,
                                const RunSettings& settings) {
  const double start = steady_seconds();
  PropagateOutcome outcome{
      .study = study, .made = make_model(study, study.parameters, settings), .ranks = rank_count(settings)};
  const StudyModel& made = outcome.made;
  const Eigen::MatrixXd given = points ? read_points(*points, *made.space) : Eigen::MatrixXd();
  const Eigen::Index specimens = study.test ? read_tests(study, *made.model).data.values.rows() : 10;
  const JobFiles files(settings, k_log, k_journal);
  const RunContext context = files.context(study, settings);
  const JournalledModel model(*made.model, files.journal(), study_fingerprint(study, made, points), settings.resume,
                              settings.ranks);
  const CloudSettings rules =
      cloud_settings(study, made, specimens, static_cast<Eigen::Index>(made.model->outputs().size()));
  const StreamKey key{.seed = study.seed, .purpose = StreamPurpose::parameter_cloud};
  note_ranks(settings, context);
  context.phase({.name = points ? "given points" : "cloud"});
  outcome.cloud = files.compute(study, [&] {
    return points ? evaluate_points(model, given, rules.max_failed, context)
                  : evaluate_cloud(model, *made.space, made.space->prior(), rules, key, context);
  });
  if (!outcome.cloud.failures.empty()) {
    context.warning(
        fmt::format("{} of {} model runs failed and were left out; if failures are not a matter of chance, "
                    "the cloud is biased",
                    outcome.cloud.failures.size(), outcome.cloud.samples.rows()));
  }
  outcome.solver_use = model.use();
  log_solver_use(outcome.solver_use, context);
  outcome.seconds = steady_seconds() - start;
  return outcome;
}

SimulateOutcome simulate_here(const Study& study, const RunSettings& settings) {
  require(study.truth.has_value(),
          "{}: truth: is missing; give [truth] specimens = 10 and, where they differ from "
          "[[parameter]], [[truth.parameter]]",
          study.file.string());
  const StudyParameters& parameters = study.truth->parameters.list.empty() ? study.parameters : study.truth->parameters;
  Study measured = study;
  measured.outputs.shape_size = ShapeSize::mass_normalised;  // as those of a table of tests are
  SimulateOutcome outcome{.study = study, .made = make_model(measured, parameters, settings)};
  const RunContext context{
      .seed = study.seed, .threads = settings.threads, .observer = settings.observer, .stop = settings.stop};
  const CloudSettings rules{.samples = study.truth->specimens, .max_failed = 0.0};
  const StreamKey key{.seed = study.seed, .purpose = StreamPurpose::truth};
  const ParameterSpace& space = *outcome.made.space;
  context.phase({.name = "specimens"});
  outcome.cloud = evaluate_cloud(*outcome.made.model, space, space.prior(), rules, key, context);
  outcome.exact = outcome.cloud.outputs;
  add_noise(outcome.cloud.outputs, study, outcome.made, context);
  return outcome;
}

}  // namespace

PropagateOutcome propagate(const Study& study, const std::optional<std::filesystem::path>& points,
                           const RunSettings& settings) {
  require_ranks(study, settings);
  std::vector<std::filesystem::path> read = paths_of(study);
  if (points) read.push_back(*points);
  require_none_is_read(settings.folder,
                       {"study.toml", "cloud.csv", "clouds.csv", "report.html", k_log, k_journal, "result.json"}, read);
  require_own(settings.folder, files_of_jobs(), read);
  return without_earlier(settings.folder, results_not_read(settings.folder, result_names(), read),
                         [&] { return propagate_here(study, points, settings); });
}

SimulateOutcome simulate(const Study& study, const RunSettings& settings) {
  std::vector<std::filesystem::path> read{study.file};  // without its tests, which may be what it makes
  for (const NamedFile& file : study.model->files()) read.push_back(file.file);
  require_none_is_read(settings.folder, {"study.toml", "specimens.csv", "specimens-truth.csv"}, read);
  require_own(settings.folder, {"study.toml", "specimens.csv", "specimens-truth.csv"}, read);
  return without_earlier(settings.folder, results_not_read(settings.folder, specimen_names(), read),
                         [&] { return simulate_here(study, settings); });
}

}  // namespace mottle::study
