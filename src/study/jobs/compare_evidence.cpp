#include "study/jobs/compare_evidence.hpp"

#include <algorithm>
#include <cmath>
#include <map>
#include <numeric>

#include "mottle/core/text.hpp"
#include "mottle/formats/tables/csv.hpp"
#include "mottle/stats/chains/leave_one_out.hpp"
#include "mottle/study/input/text_file.hpp"
#include "study/results/update_results.hpp"

namespace mottle::study {
namespace {

/// Tested values of a run by output.
struct TestedOutputs {
  std::vector<std::string> names;
  Eigen::MatrixXd values;  ///< [specimen x output], nan where not measured
};

/// What a run says beside its evidence.
struct EvidenceRecord {
  ComparedModel model;
  TestedOutputs tests;
  Json noise;  ///< what is given of noise and model error, and the priors of what is not
  std::string status;
  Json islands;  ///< ln evidence of each
};

Json item(const Json& json, const char* path) {
  const Json::json_pointer pointer(path);
  return json.contains(pointer) ? json.at(pointer) : Json();
}

double number_at(const Json& json, const char* path) {
  const Json value = item(json, path);
  return value.is_number() ? value.get<double>() : std::nan("");
}

TestedOutputs read_tests_of(const std::filesystem::path& folder) {
  const std::filesystem::path file = folder / "tests.csv";
  const CsvTable table = parse_csv(read_text_file(file), file.string());
  TestedOutputs tests;
  for (const std::string& name : table.header) {
    if (name != "specimen") tests.names.push_back(name);
  }
  tests.values.resize(static_cast<Eigen::Index>(table.rows.size()), static_cast<Eigen::Index>(tests.names.size()));
  for (std::size_t k = 0; k < tests.names.size(); ++k) {
    tests.values.col(static_cast<Eigen::Index>(k)) = numbers_of_column(table, table.find(tests.names[k]));
  }
  return tests;
}

/// A list over outputs by their names, whose order says nothing.
std::map<std::string, Json> by_output(const Json& result, const char* path) {
  const Json names = item(result, "/outputs/names");
  const Json list = item(result, path);
  std::map<std::string, Json> values;
  for (std::size_t k = 0; list.is_array() && k < std::min(names.size(), list.size()); ++k)
    values[names[k].get<std::string>()] = list[k];
  return values;
}

/// Levels that are sampled have a prior, which belongs to what is assumed of the noise.
Json noise_of(const Json& result) {
  Json noise = {{"noise_std", by_output(result, "/evidence/noise_std")},
                {"model_error_std", by_output(result, "/evidence/model_error_std")},
                {"levels", Json::array()}};
  for (const Json& name : item(result, "/posterior/names")) {
    if (name.is_string() && name.get<std::string>().starts_with("noise:")) noise["levels"].push_back(name);
  }
  if (noise["levels"].empty()) return noise;
  for (const char* option : {"/options/noise_prior", "/options/noise_scale", "/options/noise_degrees_of_freedom"}) {
    noise[option] = item(result, option);
  }
  return noise;
}

/// Names in one list and not in the other.
std::vector<std::string> missing_from(const std::vector<std::string>& names, const std::vector<std::string>& others) {
  std::vector<std::string> missing;
  for (const std::string& name : names) {
    if (std::ranges::count(others, name) == 0) missing.push_back(name);
  }
  return missing;
}

bool is_same(double a, double b) {
  return a == b || (std::isnan(a) && std::isnan(b));
}

/// Columns of the same names, in this order.
Eigen::MatrixXd in_order(const TestedOutputs& tests, const std::vector<std::string>& names) {
  Eigen::MatrixXd values(tests.values.rows(), static_cast<Eigen::Index>(names.size()));
  for (std::size_t k = 0; k < names.size(); ++k) {
    const auto column = std::ranges::find(tests.names, names[k]) - tests.names.begin();
    values.col(static_cast<Eigen::Index>(k)) = tests.values.col(column);
  }
  return values;
}

/// For each row of `first` the row of `own` that is the same, each taken once; -1: there is none.
std::vector<Eigen::Index> matching_rows(const Eigen::MatrixXd& own, const Eigen::MatrixXd& first) {
  std::vector<Eigen::Index> rows, left(static_cast<std::size_t>(own.rows()));
  std::iota(left.begin(), left.end(), Eigen::Index{0});
  for (Eigen::Index s = 0; s < first.rows(); ++s) {
    const auto match = std::ranges::find_if(
        left, [&](Eigen::Index row) { return own.row(row).binaryExpr(first.row(s), &is_same).all(); });
    rows.push_back(match == left.end() ? -1 : *match);
    if (match != left.end()) left.erase(match);
  }
  return rows;
}

/// Why evidences of these tests are not of the same data; empty: they are.
///
/// @param rows  out: see matching_rows()
std::string difference_of(const TestedOutputs& own, const TestedOutputs& first, const std::string& label,
                          std::vector<Eigen::Index>& rows) {
  const std::vector<std::string> more = missing_from(own.names, first.names);
  const std::vector<std::string> fewer = missing_from(first.names, own.names);
  if (!more.empty()) return fmt::format("its outputs are others than those of {}, which has no {}", label, join(more));
  if (!fewer.empty()) return fmt::format("its outputs are others than those of {}: it has no {}", label, join(fewer));
  if (own.values.rows() != first.values.rows()) {
    return fmt::format("it has {} specimens, {} has {}", own.values.rows(), label, first.values.rows());
  }
  const Eigen::MatrixXd values = in_order(own, first.names);
  rows = matching_rows(values, first.values);
  const auto lacking = std::ranges::find(rows, Eigen::Index{-1});
  if (lacking == rows.end()) return {};
  const Eigen::Index s = lacking - rows.begin();
  Eigen::Index k = 0;
  while (k + 1 < values.cols() && is_same(values(s, k), first.values(s, k))) ++k;
  return fmt::format(
      "its tests are others than those of {}: row {} there (with {} = {:.6g}) is none of its rows; its own row {} has "
      "{:.6g}",
      label, s + 1, first.names[static_cast<std::size_t>(k)], first.values(s, k), s + 1, values(s, k));
}

/// Why a result has no evidence to compare; empty: it has.
std::string why_none(const Json& result, const ComparedRun& run) {
  if (!item(result, "/evidence").is_object()) return fmt::format("method '{}' gives no evidence", run.method);
  if (run.status != "converged" && run.status != "stalled") {
    return fmt::format("it ended as '{}', before its evidence was complete", run.status);
  }
  const bool is_known =
      std::isfinite(number_at(result, "/evidence/ln_evidence")) && number_at(result, "/evidence/standard_error") >= 0.0;
  if (!is_known) return "its evidence has no standard error";
  if (!std::filesystem::is_regular_file(run.folder / "tests.csv")) return "its folder has no tests.csv";
  return {};
}

EvidenceRecord read_record(const Json& result, const ComparedRun& run) {
  EvidenceRecord record{.model = {.label = run.label,
                                  .evidence = {number_at(result, "/evidence/ln_evidence"),
                                               number_at(result, "/evidence/standard_error")}},
                        .tests = read_tests_of(run.folder),
                        .noise = noise_of(result),
                        .status = run.status,
                        .islands = item(result, "/evidence/islands")};
  const double stated = number_at(result, "/evidence/degrees_of_freedom");
  const double of_chains = number_at(result, "/posterior/chains") - 1.0;  // results of earlier versions state none
  record.model.evidence.degrees_of_freedom = stated >= 1.0 ? stated : std::max(of_chains, 1.0);
  record.model.elpd = number_at(result, "/posterior/leave_one_out/elpd");
  const Json pointwise = item(result, "/posterior/leave_one_out/pointwise");
  if (pointwise.is_array()) record.model.elpd_pointwise = numbers_of(pointwise);
  const Json shapes = item(result, "/posterior/leave_one_out/pareto_k");
  if (shapes.is_array() && !shapes.empty()) {
    const Eigen::VectorXd k = numbers_of(shapes);  // null: infinite
    record.model.largest_pareto_k = k.array().isNaN().any() ? HUGE_VAL : k.maxCoeff();
  }
  return record;
}

/// Why a record is not compared with those before it; empty: it is. Its specimens take the order of the first's.
std::string why_not_beside(const std::vector<EvidenceRecord>& before, EvidenceRecord& record) {
  if (before.empty()) return {};
  const EvidenceRecord& first = before.front();
  std::vector<Eigen::Index> rows;
  std::string reason = difference_of(record.tests, first.tests, first.model.label, rows);
  if (!reason.empty()) return reason;
  const auto twin = std::ranges::find_if(before, [&](const EvidenceRecord& other) {
    return record.islands.is_array() && record.islands == other.islands;
  });
  if (twin != before.end()) {
    return fmt::format(
        "its evidence is that of {} to the last digit: it is the same run, or a model of the same outputs at the same "
        "seed, and no second look at the tests",
        twin->model.label);
  }
  if (record.model.elpd_pointwise.size() == static_cast<Eigen::Index>(rows.size())) {
    record.model.elpd_pointwise = record.model.elpd_pointwise(rows).eval();
  }
  return {};
}

/// Differences of elpd to the best of those of as many specimens.
void compare_predictions(std::vector<ComparedModel>& models) {
  const ComparedModel* best = nullptr;
  for (const ComparedModel& model : models) {
    if (std::isfinite(model.elpd) && (best == nullptr || model.elpd > best->elpd)) best = &model;
  }
  if (best == nullptr || best->elpd_pointwise.size() < 2) return;
  const Eigen::ArrayXd largest = best->elpd_pointwise.array();
  for (ComparedModel& model : models) {
    if (!std::isfinite(model.elpd) || model.elpd_pointwise.size() != largest.size()) continue;
    const Eigen::ArrayXd apart = model.elpd_pointwise.array() - largest;
    const auto n = static_cast<double>(apart.size());
    model.elpd_difference = apart.sum();
    model.elpd_standard_error = std::sqrt(n * (apart - apart.mean()).square().sum() / (n - 1.0));
  }
}

void add_warnings(const std::vector<EvidenceRecord>& records, EvidenceComparison& comparison) {
  std::vector<std::string> other_noise;
  for (const EvidenceRecord& record : records) {
    const std::string& label = record.model.label;
    if (record.status == "stalled") {
      comparison.warnings.push_back(fmt::format(
          "{} is stalled: its islands disagree, and the error of its evidence may be larger than stated. Give "
          "it more particles.",
          label));
    }
    if (record.model.largest_pareto_k > k_unreliable_pareto_k) {
      comparison.warnings.push_back(
          fmt::format("The leave-one-out density of {} is not to be relied on: its largest "
                      "Pareto k is {:.2f}, at most {} is allowed.",
                      label, record.model.largest_pareto_k, k_unreliable_pareto_k));
    }
    if (record.noise != records.front().noise) other_noise.push_back(label);
  }
  if (!other_noise.empty()) {
    comparison.warnings.push_back(fmt::format(
        "Noise, its prior or the model's error are others in {} than in {}: the Bayes factors compare these as "
        "well as the models.",
        join(other_noise), records.front().model.label));
  }
}

}  // namespace

std::optional<EvidenceComparison> compare_evidence_of(const std::vector<ComparedRun>& runs) {
  EvidenceComparison comparison;
  std::vector<EvidenceRecord> records;
  bool has_evidence = false;
  for (const ComparedRun& run : runs) {
    const Json result = read_update_result(run.folder);
    has_evidence = has_evidence || item(result, "/evidence").is_object();
    std::string reason = why_none(result, run);
    if (reason.empty()) {
      EvidenceRecord record = read_record(result, run);
      reason = why_not_beside(records, record);
      if (reason.empty()) records.push_back(std::move(record));
    }
    if (!reason.empty()) comparison.left_out.push_back({run.label, std::move(reason)});
  }
  if (!has_evidence) return std::nullopt;
  if (records.size() < 2) return comparison;
  std::vector<EstimatedEvidence> evidences;
  for (const EvidenceRecord& record : records) evidences.push_back(record.model.evidence);
  const std::vector<ModelProbability> against = compare_evidences(evidences);
  for (std::size_t i = 0; i < records.size(); ++i) {
    comparison.models.push_back(records[i].model);
    comparison.models.back().against = against[i];
  }
  compare_predictions(comparison.models);
  add_warnings(records, comparison);
  return comparison;
}

}  // namespace mottle::study
