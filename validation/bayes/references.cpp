// Posteriors whose evidence and moments are known by quadrature, sampled under many seeds.
//
//   mottle_bayes_references CASE SEEDS FIRST_SEED [PARTICLES [EFFECTIVE_FRACTION]]
//
// CASE: k6-3, k6-3.5, no-k6 (the method `bayes` on one test of the three masses), beck-au, eigenvalues (the sampler
// alone). Prints one JSON object: errors of ln evidence, how often its interval holds the reference, moments over all
// seeds, and for the eigenvalues the probability of the first mode.
#include <fmt/format.h>

#include <algorithm>
#include <chrono>
#include <cmath>
#include <cstdint>
#include <functional>
#include <iostream>
#include <memory>
#include <string>
#include <vector>

#include "mottle/core/parallel.hpp"
#include "mottle/updating/estimate/posterior.hpp"
#include "mottle/updating/methods/bayes.hpp"
#include "support/bayes_references.hpp"
#include "support/bayes_shapes.hpp"
#include "support/bayes_three_masses.hpp"

namespace {

using namespace mottle;
using namespace mottle::updating;

/// What one seed found.
struct Found {
  Evidence evidence;
  Eigen::VectorXd mean = {}, standard_deviation = {};
  double correlation = 0.0;  ///< of the first two parameters
  double first_mode = 0.0;
  double r_hat = 1.0;
  std::int64_t evaluations = 0;
  int most_moves = 0;
  bool has_converged = true;
};

struct Case {
  double log_evidence = 0.0;
  std::function<Found(std::uint64_t seed)> run;
};

void add_stages(const SampledPosterior& posterior, Found& found) {
  found.r_hat = posterior.r_hat.maxCoeff();
  for (const auto& stages : posterior.stages) {
    for (const SamplingStage& stage : stages) found.most_moves = std::max(found.most_moves, stage.moves);
  }
}

template <typename Problem>
Found sample(const SamplingSettings& settings, std::uint64_t seed) {
  Found found;
  SamplingTarget target = test::target_of<Problem>();
  target.log_likelihood = [&found, inner = target.log_likelihood](const Eigen::MatrixXd& points) {
    found.evaluations += points.rows();
    return inner(points);
  };
  const std::vector<SampledIsland> islands = sample_posterior(target, settings, {.seed = seed, .threads = 1});
  const Eigen::MatrixXd x = test::parameters_of<Problem>(islands);
  const SampledPosterior posterior = make_posterior(islands, {"a", "b"}, x);
  found.evidence = posterior.evidence;
  found.mean = x.colwise().mean();
  const Eigen::MatrixXd apart = x.rowwise() - found.mean.transpose();
  found.standard_deviation = (apart.colwise().squaredNorm() / static_cast<double>(x.rows())).cwiseSqrt();
  found.correlation =
      apart.col(0).dot(apart.col(1)) / (static_cast<double>(x.rows()) * found.standard_deviation.prod());
  for (const PosteriorMode& mode : posterior.modes) {
    if (mode.mean(0) > 2.0 * mode.mean(1) || posterior.modes.size() == 1) found.first_mode = mode.probability;
  }
  add_stages(posterior, found);
  return found;
}

Found update(const UpdatingProblem& problem, const BayesOptions& options, std::uint64_t seed) {
  const UpdatingResult result = BayesUpdater(options).update(problem, {.seed = seed, .threads = 1});
  Found found{.evidence = result.posterior->evidence, .mean = result.mean};
  found.standard_deviation = result.covariance.diagonal().cwiseSqrt();
  found.correlation = result.covariance(0, 1) / (found.standard_deviation(0) * found.standard_deviation(1));
  found.evaluations = result.posterior->evaluations;
  found.has_converged = result.status == UpdatingStatus::converged;
  add_stages(*result.posterior, found);
  return found;
}

test::ShapedPosterior shaped(const std::string& name) {
  if (name == "permuted-3") return test::permuted_modes(3, 0.003);
  if (name == "permuted-4") return test::permuted_modes(4, 0.01);
  if (name == "banana") return test::banana(1.0, 0.05);
  if (name == "banana-thin") return test::banana(1.0, 0.005);
  if (name == "banana-bent") return test::banana(2.0, 0.01);
  throw InvalidInput(
      "CASE is k6-3, k6-3.5, no-k6, beck-au, eigenvalues, permuted-3, permuted-4, banana, banana-thin or banana-bent");
}

Case make_case(const std::string& name, const SamplingSettings& settings) {
  if (name == "beck-au") {
    return {std::log(1.50950476e-3), [=](std::uint64_t seed) { return sample<test::BeckAu>(settings, seed); }};
  }
  if (name == "eigenvalues") {
    return {std::log(0.00484102285), [=](std::uint64_t seed) { return sample<test::TwinEigenvalues>(settings, seed); }};
  }
  for (const test::ThreeMassesReference& reference : test::three_masses_references()) {
    const std::string model = reference.k6 == 0.0 ? "no-k6" : fmt::format("k6-{}", reference.k6);
    if (model != name) continue;
    const auto one = std::make_shared<test::OneTestOfThreeMasses>(reference.k6);
    const BayesOptions options{.particles = settings.particles, .effective_fraction = settings.effective_fraction};
    return {reference.log_evidence, [=](std::uint64_t seed) { return update(one->problem(), options, seed); }};
  }
  const BayesOptions options{.particles = settings.particles, .effective_fraction = settings.effective_fraction};
  const auto shape = std::make_shared<const test::ShapedPosterior>(shaped(name));
  return {shape->log_evidence, [=](std::uint64_t seed) { return update(shape->problem(), options, seed); }};
}

std::string list(const Eigen::VectorXd& values) {
  std::string text;
  for (const double value : values) text += fmt::format("{}{:.8g}", text.empty() ? "" : ", ", value);
  return "[" + text + "]";
}

void print(const Case& one, const std::vector<Found>& found, double seconds) {
  const auto n = static_cast<double>(found.size());
  double bias = 0.0, squares = 0.0, stated = 0.0, covered = 0.0, correlation = 0.0, mode = 0.0, worst_mode = 0.0;
  double evaluations = 0.0, converged = 0.0, r_hat = 0.0;
  int most_moves = 0;
  Eigen::VectorXd mean = Eigen::VectorXd::Zero(found.front().mean.size());
  Eigen::VectorXd deviation = mean, mean_squares = mean, deviation_squares = mean;
  for (const Found& seed : found) {
    const double error = seed.evidence.log_evidence - one.log_evidence;
    bias += error / n;
    squares += error * error / n;
    stated += seed.evidence.standard_error / n;
    covered += seed.evidence.lower <= one.log_evidence && one.log_evidence <= seed.evidence.upper ? 1.0 / n : 0.0;
    correlation += seed.correlation / n;
    mode += seed.first_mode / n;
    worst_mode = std::max(worst_mode, std::abs(seed.first_mode - 0.5));
    evaluations += static_cast<double>(seed.evaluations) / n;
    converged += seed.has_converged ? 1.0 / n : 0.0;
    r_hat = std::max(r_hat, seed.r_hat);
    most_moves = std::max(most_moves, seed.most_moves);
    mean += seed.mean / n;
    deviation += seed.standard_deviation / n;
    mean_squares += seed.mean.cwiseAbs2() / n;
    deviation_squares += seed.standard_deviation.cwiseAbs2() / n;
  }
  // Standard errors of the averages over the seeds.
  const Eigen::VectorXd mean_error = ((mean_squares - mean.cwiseAbs2()) / (n - 1.0)).cwiseMax(0.0).cwiseSqrt();
  const Eigen::VectorXd deviation_error =
      ((deviation_squares - deviation.cwiseAbs2()) / (n - 1.0)).cwiseMax(0.0).cwiseSqrt();
  std::cout << fmt::format(
      "{{\"seeds\": {}, \"reference\": {:.8g}, \"bias\": {:.6f}, \"rms\": {:.6f}, \"stated\": {:.6f}, \"covered\": "
      "{:.4f}, \"mean\": {}, \"std\": {}, \"mean_error\": {}, \"std_error\": {}, \"correlation\": {:.7f}, "
      "\"first_mode\": {:.6f}, \"worst_mode\": {:.6f}, "
      "\"evaluations\": {:.0f}, \"converged\": {:.4f}, \"largest_r_hat\": {:.5f}, \"most_moves\": {}, \"seconds\": "
      "{:.3f}}}\n",
      found.size(), one.log_evidence, bias, std::sqrt(squares), stated, covered, list(mean), list(deviation),
      list(mean_error), list(deviation_error), correlation, mode, worst_mode, evaluations, converged, r_hat, most_moves,
      seconds / n);
}

}  // namespace

int main(int count, char** arguments) {
  try {
    require(count >= 4, "usage: mottle_bayes_references CASE SEEDS FIRST_SEED [PARTICLES [EFFECTIVE_FRACTION]]");
    const SamplingSettings defaults;
    const Case one = make_case(
        arguments[1], {.particles = count > 4 ? std::stoi(arguments[4]) : defaults.particles,
                       .effective_fraction = count > 5 ? std::stod(arguments[5]) : defaults.effective_fraction});
    const auto first = static_cast<std::uint64_t>(std::stoll(arguments[3]));
    std::vector<Found> found(static_cast<std::size_t>(std::stoi(arguments[2])));
    const auto start = std::chrono::steady_clock::now();
    parallel_for(static_cast<std::int64_t>(found.size()), 1, available_threads(),
                 [&](std::int64_t begin, std::int64_t) {
                   found[static_cast<std::size_t>(begin)] = one.run(first + static_cast<std::uint64_t>(begin));
                 });
    print(one, found, std::chrono::duration<double>(std::chrono::steady_clock::now() - start).count());
  } catch (const std::exception& error) {
    std::cerr << error.what() << '\n';
    return 2;
  }
}
