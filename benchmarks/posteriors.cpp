// Posteriors as compare_bayes.py measures them.
//
//   mottle_posterior_benchmark beck-au SEED FILE           the sampler alone; draws to FILE (chain, a, b)
//   mottle_posterior_benchmark chain SPRINGS always|never  method `bayes` on a chain of springs, with and without
//   gradients
//
// Each prints one JSON object; times are processor seconds of one thread.
#include <fmt/format.h>

#include <ctime>
#include <fstream>
#include <iostream>
#include <string>

#include "mottle/core/error.hpp"
#include "mottle/updating/estimate/posterior.hpp"
#include "mottle/updating/methods/bayes.hpp"
#include "support/bayes_references.hpp"
#include "support/spring_chain.hpp"

namespace {

using namespace mottle;
using namespace mottle::updating;

double processor_seconds() {
  timespec now{};
  clock_gettime(CLOCK_PROCESS_CPUTIME_ID, &now);
  return static_cast<double>(now.tv_sec) + 1e-9 * static_cast<double>(now.tv_nsec);
}

void sample_beck_au(std::uint64_t seed, const std::string& file) {
  std::int64_t evaluations = 0;
  SamplingTarget target = test::target_of<test::BeckAu>();
  target.log_likelihood = [&evaluations, inner = target.log_likelihood](const Eigen::MatrixXd& points) {
    evaluations += points.rows();
    return inner(points);
  };
  const double start = processor_seconds();
  const std::vector<SampledIsland> islands = sample_posterior(target, {}, {.seed = seed, .threads = 1});
  const double seconds = processor_seconds() - start;
  const Evidence evidence = combine_evidence(islands);
  const Eigen::MatrixXd x = test::parameters_of<test::BeckAu>(islands);
  std::ofstream out(file);
  out << "chain,a,b\n";
  for (Eigen::Index row = 0; row < x.rows(); ++row) {
    out << fmt::format("{},{:.10g},{:.10g}\n", row / islands.front().points.rows() + 1, x(row, 0), x(row, 1));
  }
  std::cout << fmt::format("{{\"seconds\": {}, \"evaluations\": {}, \"ln_evidence\": {}, \"standard_error\": {}}}\n",
                           seconds, evaluations, evidence.log_evidence, evidence.standard_error);
}

void sample_chain(int springs, const std::string& gradients) {
  require(gradients == "always" || gradients == "never", "gradients are always or never");
  const test::SpringChain chain(springs);
  const BayesOptions options{.gradients = gradients == "always" ? GradientMoves::always : GradientMoves::never};
  const double start = processor_seconds();
  const UpdatingResult result = BayesUpdater(options).update(chain.problem(), {.threads = 1});
  const double seconds = processor_seconds() - start;
  const SampledPosterior& posterior = *result.posterior;
  int moves = 0;
  for (const SamplingStage& stage : posterior.stages.front()) moves += stage.moves;
  std::cout << fmt::format(
      "{{\"seconds\": {}, \"evaluations\": {}, \"gradients\": {}, \"moves\": {}, \"ess\": {}, \"ln_evidence\": {}, "
      "\"standard_error\": {}, \"r_hat\": {}, \"status\": \"{}\"}}\n",
      seconds, posterior.evaluations, posterior.gradients, moves, posterior.ess_bulk.minCoeff(),
      posterior.evidence.log_evidence, posterior.evidence.standard_error, posterior.r_hat.maxCoeff(),
      status_text(result.status));
}

}  // namespace

int main(int count, char** arguments) {
  try {
    const std::string what = count == 4 ? arguments[1] : "";
    if (what == "beck-au")
      sample_beck_au(std::stoull(arguments[2]), arguments[3]);
    else if (what == "chain")
      sample_chain(std::stoi(arguments[2]), arguments[3]);
    else
      throw InvalidInput("usage: mottle_posterior_benchmark beck-au SEED FILE | chain SPRINGS always|never");
  } catch (const std::exception& error) {
    std::cerr << error.what() << '\n';
    return 2;
  }
}
