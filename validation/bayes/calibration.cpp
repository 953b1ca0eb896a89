// Simulation-based calibration of `bayes`: parameters drawn from their prior, tests simulated from them, and the ranks
// of the true values among the draws of the posterior, which are uniform where the sampler and the likelihood are
// right.
//
//   mottle_bayes_calibration CASE DATA_SETS FIRST_SEED PARTICLES
//
// CASE: noise-known (1 % of a frequency), noise-estimated. Prints CSV: a column a parameter, level of the noise, and
// log-likelihood; a row a data set; ranks from 0 to 99.
#include <fmt/format.h>

#include <cmath>
#include <cstdint>
#include <iostream>
#include <string>
#include <vector>

#include "mottle/core/parallel.hpp"
#include "mottle/core/random.hpp"
#include "mottle/stats/distributions/standard_normal.hpp"
#include "mottle/updating/methods/bayes.hpp"
#include "support/bayes_three_masses.hpp"
#include "updating/methods/common_likelihood.hpp"

namespace {

using namespace mottle;
using namespace mottle::updating;

constexpr Eigen::Index k_kept = 99;  // draws that a rank is among
constexpr Eigen::Index k_specimens = 3;
constexpr double k_noise = 0.01;  // known: of each frequency at the prior's mean

struct DataSet {
  Eigen::VectorXd truth;  // parameters, then the level where it is estimated
  TestData tests;
};

/// The method's level is a fraction of the root mean square of the tested values, here it is one of the output itself:
/// the two differ by the square of the level, by 1e-4 of it at 1 %.
DataSet simulate(const test::OneTestOfThreeMasses& one, bool is_estimated, std::uint64_t seed) {
  RandomStream random({.seed = seed, .purpose = StreamPurpose::truth}, 0);
  const auto normal = [&random] { return standard_normal_quantile(random.uniform()); };
  DataSet data;
  data.truth.resize(is_estimated ? 4 : 3);
  Eigen::RowVectorXd scores(3);
  for (double& score : scores) score = normal();
  data.truth.head(3) = one.space->prior().from_standard_normal(scores).transpose();
  const Eigen::RowVectorXd outputs = one.model->evaluate(data.truth.head(3).transpose(), {}).outputs.row(0);
  const Eigen::VectorXd known =
      k_noise * one.model->evaluate(one.space->prior().mean().transpose(), {}).outputs.row(0).transpose();
  data.tests.values.resize(k_specimens, outputs.size());
  data.tests.repeatability_std = is_estimated ? Eigen::VectorXd::Zero(3) : known;
  Eigen::VectorXd noise = known;
  if (is_estimated) {
    const UpdatingProblem any{
        .model = *one.model, .space = *one.space, .tests = {Eigen::MatrixXd(outputs), Eigen::VectorXd::Zero(3)}};
    data.truth(3) = NoiseLevels(any, BayesOptions{}).level(normal());
    noise = data.truth(3) * outputs.transpose();
  }
  for (double& value : data.tests.values.reshaped()) value = normal();
  data.tests.values = (data.tests.values * noise.asDiagonal()).rowwise() + outputs;
  return data;
}

/// Ranks of the true values among every so many draws.
std::vector<Eigen::Index> ranks_of(const test::OneTestOfThreeMasses& one, const DataSet& data,
                                   const BayesOptions& options, std::uint64_t seed) {
  UpdatingProblem problem = one.problem();
  problem.tests = data.tests;
  const UpdatingResult result = BayesUpdater(options).update(problem, {.seed = seed, .threads = 1});
  const SampledPosterior& posterior = *result.posterior;
  const NoiseLevels noise(problem, options);
  const Eigen::VectorXd outputs = one.model->evaluate(data.truth.head(3).transpose(), {}).outputs.row(0).transpose();
  Eigen::VectorXd truth(data.truth.size() + 1);
  truth << data.truth, CommonLikelihood(data.tests).log_value(outputs, noise.variances(data.truth.tail(noise.count())));
  Eigen::MatrixXd draws(posterior.values.rows(), truth.size());
  draws << posterior.values, posterior.log_likelihood;
  std::vector<Eigen::Index> ranks(static_cast<std::size_t>(truth.size()), 0);
  for (Eigen::Index k = 0; k < k_kept; ++k) {
    const Eigen::Index row = (2 * k + 1) * draws.rows() / (2 * k_kept);
    for (Eigen::Index j = 0; j < truth.size(); ++j) {
      ranks[static_cast<std::size_t>(j)] += draws(row, j) < truth(j) ? 1 : 0;
    }
  }
  return ranks;
}

}  // namespace

int main(int count, char** arguments) {
  try {
    require(count == 5, "usage: mottle_bayes_calibration CASE DATA_SETS FIRST_SEED PARTICLES");
    const std::string name = arguments[1];
    require(name == "noise-known" || name == "noise-estimated", "CASE is noise-known or noise-estimated");
    const bool is_estimated = name == "noise-estimated";
    const auto first = static_cast<std::uint64_t>(std::stoll(arguments[3]));
    const BayesOptions options{.particles = std::stoi(arguments[4])};
    const test::OneTestOfThreeMasses one(3.0);
    std::vector<std::vector<Eigen::Index>> ranks(static_cast<std::size_t>(std::stoi(arguments[2])));
    parallel_for(
        static_cast<std::int64_t>(ranks.size()), 1, available_threads(), [&](std::int64_t begin, std::int64_t) {
          const std::uint64_t seed = first + static_cast<std::uint64_t>(begin);
          ranks[static_cast<std::size_t>(begin)] = ranks_of(one, simulate(one, is_estimated, seed), options, seed);
        });
    std::cout << "k1,k2,k5," << (is_estimated ? "noise:f," : "") << "log_likelihood\n";
    for (const auto& row : ranks) std::cout << fmt::format("{}\n", fmt::join(row, ","));
  } catch (const std::exception& error) {
    std::cerr << error.what() << '\n';
    return 2;
  }
}
