// Replicates Case 1 of the three masses with a model that is a little wrong: an error of each output, drawn once a
// replication and the same for all specimens. Coverage of intervals, verdicts, and the level that is found.
//
//   mottle_model_error_replication SPECIMENS ERROR none|given|estimated frequencies|shapes REPLICATIONS
//       [METHOD [KEY=TEXT ...]]
//
// ERROR: standard deviation of the error, as a part of each frequency and of the root mean square of all components of
// shapes. Measurement noise: none with frequencies alone; with shapes 0.1 % in the same terms, given as repeatability.
// Prints one JSON object. Seeds: 20171 (structures), 20172 (noise), 20173 (errors).
#include <fmt/format.h>

#include <chrono>
#include <cmath>
#include <iostream>
#include <map>
#include <string>
#include <vector>

#include "mottle/core/parallel.hpp"
#include "mottle/stats/distributions/standard_normal.hpp"
#include "mottle/stats/moments/descriptive.hpp"
#include "mottle/updating/methods/updater.hpp"
#include "mottle/updating/verdict/verdict.hpp"
#include "support/three_masses.hpp"

namespace {

using namespace mottle;
using namespace mottle::updating;

struct Settings {
  Eigen::Index specimens = 50;
  double error = 0.003;
  std::string mode = "given";
  bool has_shapes = false;
  int replications = 200;
};

double normal(RandomStream& stream) {
  return standard_normal_quantile(stream.uniform());
}

/// k1, k2, k5 ~ N(1, 0.2) [specimen x parameter].
Eigen::MatrixXd structures(Eigen::Index count, std::uint32_t replication) {
  Eigen::MatrixXd x(count, 3);
  for (Eigen::Index s = 0; s < count; ++s) {
    RandomStream stream({.seed = 20171, .purpose = StreamPurpose::truth, .iteration = replication},
                        static_cast<std::uint32_t>(s));
    for (Eigen::Index k = 0; k < 3; ++k) x(s, k) = 1.0 + 0.2 * normal(stream);
  }
  return x;
}

/// A hundredth of each frequency, and of the root mean square of all components of shapes.
Eigen::VectorXd hundredths(const StructureModel& model) {
  const Eigen::MatrixXd outputs = model.evaluate(structures(2000, 4000000), {}).outputs;
  Eigen::VectorXd unit = 0.01 * sample_mean(outputs).cwiseAbs();
  const Eigen::Index shapes = unit.size() - 3;
  if (shapes > 0) unit.tail(shapes).setConstant(0.01 * std::sqrt(outputs.rightCols(shapes).array().square().mean()));
  return unit;
}

struct Outcome {
  std::vector<bool> mean_covered, deviation_covered;
  double width = 0.0;  // of k1's interval
  Conclusion conclusion = Conclusion::undecided;
  std::vector<std::string> failed_tests;
  double level = std::nan("");  // the first output's, against its true standard deviation
  bool has_estimate = false;
};

Outcome replicate(const Settings& settings, const Updater& method, const test::ThreeMasses& structure,
                  const StructureModel& model, const Eigen::VectorXd& unit, std::uint32_t replication) {
  Outcome outcome;
  const Eigen::VectorXd noise = settings.has_shapes ? Eigen::VectorXd(0.1 * unit) : Eigen::VectorXd(0.0 * unit);
  const Eigen::VectorXd deviation = 100.0 * settings.error * unit;
  Eigen::MatrixXd values = model.evaluate(structures(settings.specimens, replication), {}).outputs;
  RandomStream errors({.seed = 20173, .purpose = StreamPurpose::truth, .iteration = replication}, 0);
  Eigen::VectorXd error(unit.size());
  for (Eigen::Index k = 0; k < unit.size(); ++k) error(k) = deviation(k) * normal(errors);
  for (Eigen::Index s = 0; s < values.rows(); ++s) {
    RandomStream stream({.seed = 20172, .purpose = StreamPurpose::test_noise, .iteration = replication},
                        static_cast<std::uint32_t>(s));
    for (Eigen::Index k = 0; k < unit.size(); ++k) values(s, k) += error(k) + noise(k) * normal(stream);
  }
  UpdatingProblem problem{.model = model,
                          .derivatives = &model,
                          .space = *structure.space,
                          .tests = {.values = values, .repeatability_std = noise},
                          .cloud = {.samples = 200, .max_failed = 1.0},
                          .iterations = 50};
  if (settings.mode == "given") problem.tests.model_error_std = deviation;
  problem.tests.is_model_error_estimated = settings.mode == "estimated";
  try {
    const UpdatingResult result = method.update(problem, {.seed = replication + 1});
    const Verdict verdict = judge(problem, result);
    outcome.conclusion = verdict.conclusion;
    for (const VerdictTest& test : verdict.tests) {
      if (!test.passed) outcome.failed_tests.push_back(test.name);
    }
    if (result.model_error) outcome.level = result.model_error->std(0) / deviation(0);
    outcome.has_estimate = true;
    if (!result.intervals) return outcome;
    const Eigen::MatrixXd& mean = result.intervals->mean;
    const Eigen::MatrixXd& std = result.intervals->std;
    for (Eigen::Index i = 0; i < 3; ++i) {
      outcome.mean_covered.push_back(mean(i, 0) <= 1.0 && 1.0 <= mean(i, 1));
      outcome.deviation_covered.push_back(std(i, 0) <= 0.2 && 0.2 <= std(i, 1));
    }
    outcome.width = mean(0, 1) - mean(0, 0);
  } catch (const std::exception& fault) {
    outcome.failed_tests.emplace_back(fault.what());
  }
  return outcome;
}

std::string coverage(const std::vector<Outcome>& outcomes, std::vector<bool> Outcome::*member) {
  double sums[] = {0.0, 0.0, 0.0};
  double count = 0.0;
  for (const Outcome& outcome : outcomes) {
    if ((outcome.*member).empty()) continue;
    count += 1.0;
    for (std::size_t i = 0; i < 3; ++i) sums[i] += (outcome.*member)[i] ? 1.0 : 0.0;
  }
  return fmt::format("[{:.3f}, {:.3f}, {:.3f}]", sums[0] / count, sums[1] / count, sums[2] / count);
}

void print(std::vector<Outcome>& outcomes, double seconds) {
  double estimates = 0.0;
  double inadequate = 0.0;
  double undecided = 0.0;
  std::map<std::string, int> reasons;
  for (const Outcome& outcome : outcomes) {
    estimates += outcome.has_estimate ? 1.0 : 0.0;
    inadequate += outcome.conclusion == Conclusion::inadequate ? 1.0 : 0.0;
    undecided += outcome.conclusion == Conclusion::undecided ? 1.0 : 0.0;
    for (const std::string& reason : outcome.failed_tests) ++reasons[reason];
  }
  std::string text;
  for (const auto& [reason, count] : reasons) {
    text += fmt::format("{}\"{}\": {}", text.empty() ? "" : ", ", reason, count);
  }
  const auto quantile = [&](auto value, double part) {
    std::sort(outcomes.begin(), outcomes.end(),
              [&](const Outcome& a, const Outcome& b) { return value(a) < value(b); });
    return value(outcomes[static_cast<std::size_t>(part * static_cast<double>(outcomes.size() - 1))]);
  };
  const auto level = [](const Outcome& outcome) { return std::isnan(outcome.level) ? 0.0 : outcome.level; };
  const auto width = [](const Outcome& outcome) { return outcome.width; };
  const auto count = static_cast<double>(outcomes.size());
  fmt::print(
      "{{\"estimates\": {}, \"mean_coverage\": {}, \"deviation_coverage\": {}, \"median_width_k1\": {:.4f}, "
      "\"inadequate\": {:.3f}, \"undecided\": {:.3f}, \"failed_tests\": {{{}}}, \"level_over_truth\": [{:.2f}, {:.2f}, "
      "{:.2f}], \"seconds\": {:.1f}}}\n",
      estimates, coverage(outcomes, &Outcome::mean_covered), coverage(outcomes, &Outcome::deviation_covered),
      quantile(width, 0.5), inadequate / count, undecided / count, text, quantile(level, 0.05), quantile(level, 0.5),
      quantile(level, 0.95), seconds);
}

}  // namespace

int main(int argc, char** argv) {
  if (argc < 6) {
    std::cerr
        << "usage: SPECIMENS ERROR none|given|estimated frequencies|shapes REPLICATIONS [METHOD [KEY=TEXT ...]]\n";
    return 2;
  }
  const Settings settings{.specimens = std::stoi(argv[1]),
                          .error = std::stod(argv[2]),
                          .mode = argv[3],
                          .has_shapes = std::string(argv[4]) == "shapes",
                          .replications = std::stoi(argv[5])};
  OptionValues options;
  for (int k = 7; k < argc; ++k) {
    const std::string text = argv[k];
    const std::size_t at = text.find('=');
    const std::string value = text.substr(at + 1);
    const bool is_whole = !value.empty() && value.find_first_not_of("0123456789") == std::string::npos;
    if (is_whole) {
      options[text.substr(0, at)] = static_cast<std::int64_t>(std::stoll(value));
    } else {
      options[text.substr(0, at)] = value;
    }
  }
  const std::unique_ptr<Updater> method =
      find_method(argc > 6 ? argv[6] : "maximum-likelihood").make(options, "options");
  const test::ThreeMasses structure;
  OutputSelection outputs{.frequencies = {1, 2, 3}};
  if (settings.has_shapes) {
    outputs.shape_modes = {1, 2, 3};
    outputs.shape_degrees_of_freedom = {"m1", "m2", "m3"};
  }
  const std::vector<ParameterTargets> targets{{"k1", {"spring:k1"}}, {"k2", {"spring:k2"}}, {"k5", {"spring:k5"}}};
  const StructureModel model(separate(test::three_mass_system(3.0), targets), outputs,
                             Eigen::VectorXd::Constant(3, 2.0));
  const Eigen::VectorXd unit = hundredths(model);
  std::vector<Outcome> outcomes(static_cast<std::size_t>(settings.replications));
  const auto start = std::chrono::steady_clock::now();
  parallel_for(settings.replications, 5, available_threads(), [&](std::int64_t begin, std::int64_t end) {
    for (std::int64_t r = begin; r < end; ++r) {
      outcomes[static_cast<std::size_t>(r)] =
          replicate(settings, *method, structure, model, unit, static_cast<std::uint32_t>(r));
    }
  });
  print(outcomes, std::chrono::duration<double>(std::chrono::steady_clock::now() - start).count());
  return 0;
}
