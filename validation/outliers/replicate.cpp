// Replicates the search for outliers and the test of normality with new specimens each time.
//
//   mottle_outlier_replication linear|three-masses SPECIMENS VARIABLES MISSING NOISE POPULATION REPLICATIONS
//
// linear: y = G x + noise, x ~ N(0, 1), G = 1 plus 0.4 times standard normals, new in each replication; a fitted
// population and its units go to the tests. three-masses: k1, k2, k5 ~ N(1, 0.2), frequencies, the whole method.
// POPULATION: normal; same, opposite, apart: the first two lie 7.5 deviations off along the first variable, on the same
// side, on opposite sides, or one along each of the first two variables; oblique: both in one random direction;
// batches:W: the first variable is 0.6 or 1.4 by chance, deviation W in each batch; lognormal: it has mean 1, cv 0.8.
// MISSING: part of the entries. NOISE: deviation of the measurement. Prints one JSON object.
#include <fmt/format.h>

#include <chrono>
#include <cmath>
#include <iostream>
#include <limits>
#include <string>
#include <vector>

#include "mottle/core/parallel.hpp"
#include "mottle/core/random.hpp"
#include "mottle/stats/distributions/standard_normal.hpp"
#include "mottle/stats/tests/normality.hpp"
#include "mottle/stats/tests/outliers.hpp"
#include "mottle/updating/methods/maximum_likelihood.hpp"
#include "support/three_masses.hpp"

namespace {

using namespace mottle;
using namespace mottle::updating;

constexpr double k_nan = std::numeric_limits<double>::quiet_NaN();

struct Settings {
  bool is_linear = true;
  Eigen::Index specimens = 10;
  Eigen::Index variables = 3;
  double missing = 0.0;
  double noise = 0.0;
  std::string population = "normal";
};

class Normals {
 public:
  explicit Normals(std::uint32_t replication) : stream_({.seed = 20063, .iteration = replication}, 0) {}
  double uniform() { return stream_.uniform(); }
  double operator()() { return standard_normal_quantile(stream_.uniform()); }

 private:
  RandomStream stream_;
};

/// Effects of the specimens: deviation 1, mean 0; the first variable has its own law where the population says so, in
/// units of 0.2 about 1 [specimen x variable].
Eigen::MatrixXd draw_effects(const Settings& settings, Normals& normal) {
  constexpr double k_far = 7.5;
  Eigen::MatrixXd x(settings.specimens, settings.variables);
  for (double& value : x.reshaped()) value = normal();
  const std::string& population = settings.population;
  Eigen::VectorXd direction = Eigen::VectorXd::Unit(x.cols(), 0);
  if (population == "oblique") {
    for (double& value : direction) value = normal();
    direction.normalize();
  }
  if (population == "same" || population == "oblique") x.topRows(2).rowwise() += k_far * direction.transpose();
  if (population == "opposite") x(0, 0) += k_far;
  if (population == "opposite") x(1, 0) -= k_far;
  if (population == "apart") x(0, 0) += k_far;
  if (population == "apart") x(1, 1) += k_far;
  if (population.starts_with("batches:")) {
    const double width = std::stod(population.substr(8));
    for (double& value : x.col(0)) value = ((normal.uniform() < 0.5 ? -0.4 : 0.4) + width * value) / 0.2;
  }
  if (population == "lognormal") {
    const double variance = std::log(1.0 + 0.8 * 0.8);
    for (double& value : x.col(0)) value = (std::exp(std::sqrt(variance) * value - 0.5 * variance) - 1.0) / 0.2;
  }
  return x;
}

/// Entries go missing at random; every specimen keeps one, every output two.
void lose_entries(const Settings& settings, Normals& normal, Eigen::MatrixXd& tests) {
  if (settings.missing == 0.0) return;
  const Eigen::MatrixXd all = tests;
  do {
    tests = all;
    for (double& value : tests.reshaped()) {
      if (normal.uniform() < settings.missing) value = k_nan;
    }
  } while ((!tests.array().isNaN()).cast<int>().colwise().sum().minCoeff() < 2 ||
           (!tests.array().isNaN()).cast<int>().rowwise().sum().minCoeff() < 1);
}

struct Outcome {
  std::vector<Outlier> outliers;
  bool is_normal = true;
  std::string suggestion;
};

Outcome replicate_linear(const Settings& settings, std::uint32_t replication) {
  Normals normal(replication);
  const Eigen::Index q = settings.variables;
  Eigen::MatrixXd design = Eigen::MatrixXd::Identity(q, q);
  for (double& value : design.reshaped()) value += 0.4 * normal();
  Eigen::MatrixXd tests = draw_effects(settings, normal) * design.transpose();
  for (double& value : tests.reshaped()) value += settings.noise * normal();
  lose_entries(settings, normal, tests);
  std::vector<RandomEffectsUnit> units;
  for (Eigen::Index s = 0; s < tests.rows(); ++s) {
    std::vector<Eigen::Index> rows;
    for (Eigen::Index k = 0; k < q; ++k) {
      if (!std::isnan(tests(s, k))) rows.push_back(k);
    }
    const auto count = static_cast<Eigen::Index>(rows.size());
    units.push_back({design(rows, Eigen::all), tests.row(s)(rows).transpose(),
                     Eigen::VectorXd::Constant(count, settings.noise * settings.noise)});
  }
  // As the population's fit does.
  const auto n = static_cast<double>(tests.rows());
  const double missing = static_cast<double>(tests.array().isNaN().count()) / static_cast<double>(tests.size());
  const RandomEffectsSettings fitting{.shrinkage = 0.2 * missing * n / (1.0 + n / 50.0), .iterations = 300};
  const Eigen::MatrixXd start = Eigen::MatrixXd::Identity(q, q);
  const RandomEffectsFit fit = fit_random_effects(units, start, fitting);
  return {find_outliers(units, fit, fitting, start, 0.05), test_normality(units, fit, start).p_value > 0.05, {}};
}

Outcome replicate_three_masses(const Settings& settings, std::uint32_t replication) {
  static const test::ThreeMasses structure;
  Normals normal(replication);
  const Eigen::MatrixXd x = (0.2 * draw_effects(settings, normal)).array() + 1.0;
  UpdatingProblem problem = structure.problem(test::frequencies_of(structure, x));
  for (double& value : problem.tests.values.reshaped()) value += settings.noise * normal();
  lose_entries(settings, normal, problem.tests.values);
  problem.tests.repeatability_std.setConstant(settings.noise);
  problem.cloud = {.samples = 200, .max_failed = 1.0};
  const UpdatingResult result = MaximumLikelihoodUpdater({}).update(problem, {.seed = replication + 1});
  if (!result.normality) return {result.outliers, true, {}};
  return {result.outliers, !result.normality->is_remarkable, result.normality->suggestions.front()};
}

/// Per cent of the replications in which `is_so`.
template <class Claim>
double percentage(const std::vector<Outcome>& outcomes, const Claim& is_so) {
  double count = 0.0;
  for (const Outcome& outcome : outcomes) count += is_so(outcome) ? 1.0 : 0.0;
  return 100.0 * count / static_cast<double>(outcomes.size());
}

void print(const std::vector<Outcome>& outcomes, double seconds) {
  const auto of_the_two = [](const Outcome& outcome) {
    std::size_t count = 0;
    for (const Outlier& outlier : outcome.outliers) count += outlier.sample < 2 ? 1 : 0;
    return count;
  };
  fmt::print(
      "{{\"named\": {:.2f}, \"both\": {:.2f}, \"others\": {:.2f}, \"remark\": {:.2f}, \"log\": {:.2f}, "
      "\"batches\": {:.2f}, \"seconds\": {:.1f}}}\n",
      percentage(outcomes, [](const Outcome& o) { return !o.outliers.empty(); }),
      percentage(outcomes, [&](const Outcome& o) { return of_the_two(o) == 2; }),
      percentage(outcomes, [&](const Outcome& o) { return o.outliers.size() > of_the_two(o); }),
      percentage(outcomes, [](const Outcome& o) { return !o.is_normal; }),
      percentage(outcomes, [](const Outcome& o) { return o.suggestion.find("\"log\"") != std::string::npos; }),
      percentage(outcomes, [](const Outcome& o) { return o.suggestion.find("batches") != std::string::npos; }),
      seconds);
}

}  // namespace

int main(int argc, char** argv) {
  if (argc != 8) {
    std::cerr << "usage: linear|three-masses SPECIMENS VARIABLES MISSING NOISE POPULATION REPLICATIONS\n";
    return 2;
  }
  const Settings settings{.is_linear = std::string(argv[1]) == "linear",
                          .specimens = std::stoi(argv[2]),
                          .variables = std::stoi(argv[3]),
                          .missing = std::stod(argv[4]),
                          .noise = std::stod(argv[5]),
                          .population = argv[6]};
  std::vector<Outcome> outcomes(std::stoul(argv[7]));
  const auto start = std::chrono::steady_clock::now();
  parallel_for(
      static_cast<std::int64_t>(outcomes.size()), 5, available_threads(), [&](std::int64_t begin, std::int64_t end) {
        for (std::int64_t r = begin; r < end; ++r) {
          const auto replication = static_cast<std::uint32_t>(r);
          outcomes[static_cast<std::size_t>(r)] = settings.is_linear ? replicate_linear(settings, replication)
                                                                     : replicate_three_masses(settings, replication);
        }
      });
  print(outcomes, std::chrono::duration<double>(std::chrono::steady_clock::now() - start).count());
  return 0;
}
