// Replicates the three-mass cases with new specimens each time: bias, coverage of intervals, false alarms and
// rejections of the verdict, for any updating method.
//
//   mottle_population_replication CASE SPECIMENS NOISE MISSING frequencies|shapes REPLICATIONS [METHOD [KEY=VALUE ...]]
//
// CASE 1 to 4 as in [Mares2006]; 5: k6 = 3.1 in the tests, 3 in the model; 6: mass m1 10 % larger in the tests. NOISE:
// standard deviation of the measurement as a part of the outputs' scatter, or "1%" of the outputs themselves; it is
// given to the method as repeatability. MISSING: part of the entries. Prints one JSON object. KEYs that are not the
// method's: case.noise=unknown (not given), case.covariance=diagonal, case.bound=B (k1's lower bound B standard errors
// of its mean below the truth).
#include <fmt/format.h>
#include <fmt/ranges.h>

#include <chrono>
#include <cmath>
#include <cstdlib>
#include <iostream>
#include <limits>
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
  int which = 1;
  Eigen::Index specimens = 10;
  std::string noise = "0";
  double missing = 0.0;
  bool has_shapes = false;
  int replications = 1000;
  bool is_noise_given = true;
  bool is_diagonal = false;
  double bound = std::numeric_limits<double>::infinity();
};

OutputSelection outputs_of(const Settings& settings) {
  OutputSelection outputs{.frequencies = {1, 2, 3}};
  if (settings.has_shapes) {
    outputs.shape_modes = {1, 2, 3};
    outputs.shape_degrees_of_freedom = {"m1", "m2", "m3"};
  }
  return outputs;
}

/// The structures that are tested: all six springs.
struct Laboratory {
  explicit Laboratory(const Settings& settings) {
    std::vector<ParameterTargets> targets;
    for (int k = 1; k <= 6; ++k) targets.push_back({fmt::format("k{}", k), {fmt::format("spring:k{}", k)}});
    Eigen::VectorXd reference(6);
    reference << 2.0, 2.0, 1.0, 1.0, 2.0, 3.0;
    MassSpringSystem system = test::three_mass_system();
    if (settings.which == 6) system.masses[0].mass *= 1.1;
    model = std::make_unique<StructureModel>(separate(system, targets), outputs_of(settings), reference);
    mean = Eigen::VectorXd::Ones(6);
    mean(5) = settings.which == 2 ? 3.5 : settings.which == 5 ? 3.1 : 3.0;
    deviation = Eigen::VectorXd::Constant(6, 0.2);
    deviation(5) = 0.6;
    if (settings.which != 4) {
      for (const int k : {2, 3, 5}) deviation(k) = 0.0;
    }
  }

  Eigen::MatrixXd structures(Eigen::Index count, std::uint32_t replication) const {
    Eigen::MatrixXd x(count, 6);
    const StreamKey key{.seed = 20061, .purpose = StreamPurpose::truth, .iteration = replication};
    for (Eigen::Index s = 0; s < count; ++s) {
      RandomStream stream(key, static_cast<std::uint32_t>(s));
      for (Eigen::Index k = 0; k < 6; ++k) {
        x(s, k) = mean(k) + deviation(k) * standard_normal_quantile(stream.uniform());
      }
    }
    return x;
  }

  std::unique_ptr<StructureModel> model;
  Eigen::VectorXd mean;
  Eigen::VectorXd deviation;
};

/// Standard deviation of each output's measurement.
Eigen::VectorXd noise_of(const Settings& settings, const Laboratory& laboratory) {
  const Eigen::MatrixXd outputs = laboratory.model->evaluate(laboratory.structures(20000, 4000000), {}).outputs;
  if (settings.noise != "1%") {
    return std::stod(settings.noise) * sample_covariance(outputs).diagonal().cwiseSqrt();
  }
  Eigen::VectorXd noise = 0.01 * sample_mean(outputs).cwiseAbs();
  if (settings.has_shapes) {
    noise.tail(9).setConstant(0.01 * std::sqrt(outputs.rightCols(9).array().square().mean()));
  }
  return noise;
}

Eigen::MatrixXd measure(const Laboratory& laboratory, const Settings& settings, const Eigen::VectorXd& noise,
                        std::uint32_t replication) {
  Eigen::MatrixXd tests;
  // Entries go missing at random; a set in which an output is measured less than twice could not be a study.
  for (std::uint32_t attempt = 0;; ++attempt) {
    tests = laboratory.model->evaluate(laboratory.structures(settings.specimens, replication), {}).outputs;
    const StreamKey key{.seed = 20062 + attempt, .purpose = StreamPurpose::test_noise, .iteration = replication};
    for (Eigen::Index s = 0; s < tests.rows(); ++s) {
      RandomStream stream(key, static_cast<std::uint32_t>(s));
      for (Eigen::Index k = 0; k < tests.cols(); ++k) {
        tests(s, k) += noise(k) * standard_normal_quantile(stream.uniform());
        if (stream.uniform() < settings.missing) tests(s, k) = std::numeric_limits<double>::quiet_NaN();
      }
    }
    const auto measured = (!tests.array().isNaN()).cast<int>();
    if (measured.colwise().sum().minCoeff() >= 2 && measured.rowwise().sum().minCoeff() >= 1) return tests;
  }
}

/// What one replication found.
struct Outcome {
  Eigen::VectorXd mean;
  Eigen::VectorXd deviation;
  Eigen::MatrixXd own;  // sample moments of the true parameters
  std::vector<int> mean_covered, deviation_covered, correlation_covered;
  Conclusion conclusion = Conclusion::undecided;
  bool has_estimate = false;
  std::vector<std::string> failed_tests;
  bool has_other_solutions = false;
};

Outcome replicate(const Settings& settings, const Updater& method, const test::ThreeMasses& structure,
                  const StructureModel& model, const Laboratory& laboratory, const Eigen::VectorXd& noise,
                  std::uint32_t replication) {
  Outcome outcome;
  UpdatingProblem problem{.model = model,
                          .derivatives = &model,
                          .space = *structure.space,
                          .tests = {measure(laboratory, settings, noise, replication),
                                    settings.is_noise_given ? noise : Eigen::VectorXd::Zero(noise.size())},
                          .cloud = {.samples = 200, .max_failed = 1.0},
                          .iterations = 50};
  if (settings.is_diagonal) problem.covariance_groups = {0, 1, 2};
  const Eigen::MatrixXd x = laboratory.structures(settings.specimens, replication)(Eigen::all, std::vector{0, 1, 4});
  outcome.own.resize(3, 2);
  outcome.own.col(0) = sample_mean(x);
  outcome.own.col(1) = sample_standard_deviation(x);
  try {
    const UpdatingResult result = method.update(problem, {.seed = replication + 1});
    const Verdict verdict = judge(problem, result);
    outcome.conclusion = verdict.conclusion;
    for (const VerdictTest& test : verdict.tests) {
      if (!test.passed) outcome.failed_tests.push_back(test.name);
    }
    if (result.status != UpdatingStatus::converged) outcome.failed_tests.push_back(status_text(result.status));
    if (!problem.space.active_bounds(result.mean).isZero()) outcome.failed_tests.emplace_back("held");
    outcome.has_other_solutions = !result.other_solutions.empty();
    outcome.mean = result.mean;
    outcome.deviation = result.covariance.diagonal().cwiseSqrt();
    outcome.has_estimate = true;
    if (!result.intervals) return outcome;
    const ParameterIntervals& ends = *result.intervals;
    for (Eigen::Index i = 0; i < 3; ++i) {
      outcome.mean_covered.push_back(ends.mean(i, 0) <= 1.0 && 1.0 <= ends.mean(i, 1) ? 1 : 0);
      outcome.deviation_covered.push_back(ends.std(i, 0) <= 0.2 && 0.2 <= ends.std(i, 1) ? 1 : 0);
      for (Eigen::Index j = 0; j < i; ++j) {
        const bool is_covered = ends.correlation_lower(i, j) <= 0.0 && 0.0 <= ends.correlation_upper(i, j);
        outcome.correlation_covered.push_back(is_covered ? 1 : 0);
      }
    }
  } catch (const std::exception& error) {
    outcome.conclusion = Conclusion::inadequate;
    outcome.failed_tests.push_back(error.what());
  }
  return outcome;
}

std::vector<double> rounded(const Eigen::VectorXd& values) {
  std::vector<double> list;
  for (const double value : values) list.push_back(std::round(value * 1e5) / 1e5);
  return list;
}

Eigen::VectorXd coverage(const std::vector<Outcome>& outcomes, std::vector<int> Outcome::*member) {
  Eigen::VectorXd sums = Eigen::VectorXd::Zero(3);
  double count = 0.0;
  for (const Outcome& outcome : outcomes) {
    if ((outcome.*member).empty()) continue;
    count += 1.0;
    for (std::size_t i = 0; i < 3; ++i) sums(static_cast<Eigen::Index>(i)) += (outcome.*member)[i];
  }
  return sums / std::max(count, 1.0);
}

void print(const std::vector<Outcome>& outcomes, double seconds) {
  Eigen::VectorXd mean = Eigen::VectorXd::Zero(3);
  Eigen::VectorXd variance = mean, deviation = mean, mean_square = mean, deviation_square = mean, own_mean = mean,
                  own_deviation = mean;
  double estimates = 0.0;
  double rejected = 0.0;
  double adequate = 0.0;
  double others = 0.0;
  std::map<std::string, int> reasons;
  for (const Outcome& outcome : outcomes) {
    rejected += outcome.conclusion == Conclusion::inadequate ? 1.0 : 0.0;
    adequate += outcome.conclusion == Conclusion::adequate ? 1.0 : 0.0;
    others += outcome.has_other_solutions ? 1.0 : 0.0;
    for (const std::string& reason : outcome.failed_tests) ++reasons[reason];
    if (!outcome.has_estimate) continue;
    estimates += 1.0;
    mean += outcome.mean;
    variance += outcome.deviation.cwiseAbs2();
    deviation += outcome.deviation;
    mean_square += (outcome.mean.array() - 1.0).square().matrix();
    deviation_square += (outcome.deviation.array() - 0.2).square().matrix();
    own_mean += (outcome.own.col(0).array() - 1.0).square().matrix();
    own_deviation += (outcome.own.col(1).array() - 0.2).square().matrix();
  }
  const auto root = [&](const Eigen::VectorXd& sum) { return rounded((sum / estimates).cwiseSqrt()); };
  std::string text;
  for (const auto& [reason, count] : reasons) {
    text += fmt::format("{}\"{}\": {}", text.empty() ? "" : ", ", reason, count);
  }
  fmt::print(
      "{{\"estimates\": {}, \"mean_bias\": {}, \"variance_bias\": {}, \"deviation_bias\": {}, \"mean_rmse\": {}, "
      "\"deviation_rmse\": {}, \"own_mean_rmse\": {}, \"own_deviation_rmse\": {}, \"mean_coverage\": {}, "
      "\"deviation_coverage\": {}, \"correlation_coverage\": {}, \"rejected\": {:.4f}, \"adequate\": {:.4f}, "
      "\"other_solutions\": {:.4f}, \"failed_tests\": {{{}}}, "
      "\"seconds\": {:.1f}}}\n",
      estimates, rounded((mean / estimates).array() - 1.0), rounded((variance / estimates / 0.04).array() - 1.0),
      rounded((deviation / estimates / 0.2).array() - 1.0), root(mean_square), root(deviation_square), root(own_mean),
      root(own_deviation), rounded(coverage(outcomes, &Outcome::mean_covered)),
      rounded(coverage(outcomes, &Outcome::deviation_covered)),
      rounded(coverage(outcomes, &Outcome::correlation_covered)), rejected / static_cast<double>(outcomes.size()),
      adequate / static_cast<double>(outcomes.size()), others / static_cast<double>(outcomes.size()), text, seconds);
}

OptionValues options_from(int argc, char** argv, int first) {
  OptionValues values;
  for (int k = first; k < argc; ++k) {
    const std::string text = argv[k];
    if (text.starts_with("case.")) continue;
    const std::size_t at = text.find('=');
    const std::string value = text.substr(at + 1);
    char* end = nullptr;
    const double number = std::strtod(value.c_str(), &end);
    const bool is_number = end != nullptr && *end == '\0' && !value.empty();
    const bool is_whole = is_number && value.find_first_of(".e") == std::string::npos;
    if (is_whole) {
      values[text.substr(0, at)] = static_cast<std::int64_t>(number);
    } else if (is_number) {
      values[text.substr(0, at)] = number;
    } else {
      values[text.substr(0, at)] = value;
    }
  }
  return values;
}

/// KEYs of the case.
void read_case(int argc, char** argv, Settings& settings) {
  for (int k = 8; k < argc; ++k) {
    const std::string text = argv[k];
    const std::string value = text.substr(text.find('=') + 1);
    if (text.starts_with("case.noise=")) settings.is_noise_given = value != "unknown";
    if (text.starts_with("case.covariance=")) settings.is_diagonal = value == "diagonal";
    if (text.starts_with("case.bound=")) settings.bound = std::stod(value);
  }
}

/// The prior of the paper, k1's lower bound where the case wants it.
std::unique_ptr<ParameterSpace> bounded_space(const test::ThreeMasses& structure, const Settings& settings) {
  std::vector<Parameter> parameters = structure.space->parameters();
  if (std::isfinite(settings.bound)) {
    parameters[0].lower_bound = 1.0 - settings.bound * 0.2 / std::sqrt(static_cast<double>(settings.specimens));
  }
  return std::make_unique<ParameterSpace>(parameters, structure.space->prior());
}

}  // namespace

int main(int argc, char** argv) {
  if (argc < 7) {
    std::cerr << "usage: CASE SPECIMENS NOISE MISSING frequencies|shapes REPLICATIONS [METHOD [KEY=VALUE ...]]\n";
    return 2;
  }
  Settings settings{.which = std::stoi(argv[1]),
                    .specimens = std::stoi(argv[2]),
                    .noise = argv[3],
                    .missing = std::stod(argv[4]),
                    .has_shapes = std::string(argv[5]) == "shapes",
                    .replications = std::stoi(argv[6])};
  const std::unique_ptr<Updater> method =
      find_method(argc > 7 ? argv[7] : "maximum-likelihood").make(options_from(argc, argv, 8), "options");
  read_case(argc, argv, settings);
  const Laboratory laboratory(settings);
  test::ThreeMasses structure;
  structure.space = bounded_space(structure, settings);
  const std::vector<ParameterTargets> targets{{"k1", {"spring:k1"}}, {"k2", {"spring:k2"}}, {"k5", {"spring:k5"}}};
  const StructureModel model(separate(test::three_mass_system(settings.which == 3 ? 0.0 : 3.0), targets),
                             outputs_of(settings), Eigen::VectorXd::Constant(3, 2.0));
  const Eigen::VectorXd noise = noise_of(settings, laboratory);
  std::vector<Outcome> outcomes(static_cast<std::size_t>(settings.replications));
  const auto start = std::chrono::steady_clock::now();
  parallel_for(settings.replications, 10, available_threads(), [&](std::int64_t begin, std::int64_t end) {
    for (std::int64_t r = begin; r < end; ++r) {
      outcomes[static_cast<std::size_t>(r)] =
          replicate(settings, *method, structure, model, laboratory, noise, static_cast<std::uint32_t>(r));
    }
  });
  print(outcomes, std::chrono::duration<double>(std::chrono::steady_clock::now() - start).count());
  return 0;
}
