#include "mottle/study/jobs/compare.hpp"

#include <algorithm>
#include <cmath>

#include "mottle/core/error.hpp"
#include "study/jobs/compare_evidence.hpp"
#include "study/results/update_results.hpp"

namespace mottle::study {
namespace {

namespace fs = std::filesystem;

/// result.json may be of another version: what a key does not hold is nan.
class Block {
 public:
  explicit Block(const Json& json) : json_(json) {}

  double number(const char* key, std::size_t i) const { return at(at(json_, key), i); }
  double end(const char* key, std::size_t i, std::size_t side) const {
    const Json* interval = item(json_, key, i);
    return interval == nullptr ? std::nan("") : at(*interval, side);
  }
  double diagonal(const char* key, std::size_t i) const { return end(key, i, i); }
  std::string text(const char* key, std::size_t i) const {
    const Json* value = item(json_, key, i);
    return value != nullptr && value->is_string() ? value->get<std::string>() : "";
  }
  std::size_t count() const { return json_.contains("names") && json_["names"].is_array() ? json_["names"].size() : 0; }

 private:
  static const Json& at(const Json& json, const char* key) {
    static const Json k_none;
    return json.contains(key) ? json[key] : k_none;
  }
  static double at(const Json& list, std::size_t i) {
    return list.is_array() && i < list.size() && list[i].is_number() ? list[i].get<double>() : std::nan("");
  }
  static const Json* item(const Json& json, const char* key, std::size_t i) {
    const Json& list = at(json, key);
    return list.is_array() && i < list.size() ? &list[i] : nullptr;
  }

  const Json& json_;
};

std::vector<ComparedParameter> parameters_of(const Block& block) {
  std::vector<ComparedParameter> parameters;
  for (std::size_t i = 0; i < block.count(); ++i) {
    parameters.push_back({.name = block.text("names", i),
                          .unit = block.text("units", i),
                          .prior_mean = block.number("prior_mean", i),
                          .mean = block.number("mean", i),
                          .mean_lower = block.end("mean_ci95", i, 0),
                          .mean_upper = block.end("mean_ci95", i, 1),
                          .standard_deviation = block.number("std", i),
                          .std_lower = block.end("std_ci95", i, 0),
                          .std_upper = block.end("std_ci95", i, 1),
                          .at_bound = block.text("at_bound", i)});
  }
  return parameters;
}

std::vector<ComparedOutput> outputs_of(const Block& block) {
  std::vector<ComparedOutput> outputs;
  for (std::size_t k = 0; k < block.count(); ++k) {
    const double noise = block.number("noise_std", k);
    const double model = block.diagonal("final_covariance", k) + (std::isnan(noise) ? 0.0 : noise * noise);
    const double tests = block.diagonal("test_covariance", k);
    outputs.push_back({.name = block.text("names", k),
                       .unit = block.text("units", k),
                       .test_mean = block.number("test_mean", k),
                       .initial_mean = block.number("initial_mean", k),
                       .final_mean = block.number("final_mean", k),
                       .scatter_ratio = tests > 0.0 ? std::sqrt(model / tests) : std::nan("")});
  }
  return outputs;
}

std::string text_or(const Json& json, const char* key) {
  return json.contains(key) && json[key].is_string() ? json[key].get<std::string>() : "";
}

ComparedRun read_run(const fs::path& folder) {
  const Json result = read_update_result(folder);
  ComparedRun run{.folder = folder,
                  .label = {},
                  .title = text_or(result, "title"),
                  .method = text_or(result, "method"),
                  .status = text_or(result, "status"),
                  .verdict = {}};
  if (result.contains("verdict") && result["verdict"].is_object())
    run.verdict = text_or(result["verdict"], "conclusion");
  const Json& outputs = result["outputs"];
  if (outputs.contains("test_count") && outputs["test_count"].is_array() && !outputs["test_count"].empty()) {
    const Eigen::VectorXd counts = numbers_of(outputs["test_count"]);
    run.specimens = static_cast<int>(counts.array().isNaN().select(0.0, counts.array()).maxCoeff());
  }
  if (result.contains("timings_s") && result["timings_s"].is_object()) {
    for (const auto& [phase, seconds] : result["timings_s"].items()) {
      if (seconds.is_number() && phase != "total") run.seconds += seconds.get<double>();
    }
  }
  run.parameters = parameters_of(Block(result["parameters"]));
  run.outputs = outputs_of(Block(outputs));
  return run;
}

/// Folders' names, with as much of the path in front as tells them apart.
void label(std::vector<ComparedRun>& runs) {
  const auto tail = [](const fs::path& folder, std::size_t parts) {
    const fs::path path = fs::weakly_canonical(fs::absolute(folder));
    std::vector<fs::path> names(path.begin(), path.end());
    std::erase_if(names, [](const fs::path& name) { return name.empty(); });
    fs::path text;
    for (std::size_t k = names.size() - std::min(parts, names.size()); k < names.size(); ++k) text /= names[k];
    return text.generic_string();
  };
  constexpr std::size_t k_deepest = 100;
  for (ComparedRun& run : runs) {
    for (std::size_t parts = 1; parts < k_deepest; ++parts) {
      run.label = tail(run.folder, parts);
      const auto same =
          std::ranges::count_if(runs, [&](const ComparedRun& other) { return tail(other.folder, parts) == run.label; });
      if (same == 1) break;
    }
  }
}

}  // namespace

Comparison compare_runs(const std::vector<fs::path>& folders) {
  require(folders.size() >= 2, "compare: {} folder is named; two or more are needed", folders.size());
  Comparison comparison;
  for (const fs::path& folder : folders) comparison.runs.push_back(read_run(folder));
  label(comparison.runs);
  comparison.evidence = compare_evidence_of(comparison.runs);
  return comparison;
}

}  // namespace mottle::study
