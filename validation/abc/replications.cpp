// Replications of the method `abc` on the three masses of [Mares2006] with known answers; see README.md.
//
//   mottle_abc_replications N FIRST LAST POPULATION DISTANCE NOISE
//
// N specimens, data sets FIRST to LAST, POPULATION: normal, two-peaked or skewed; DISTANCE: energy or
// sliced-wasserstein; NOISE: standard deviation of a test as a fraction of the frequency. Prints one line of JSON a
// data set: whether the intervals of `abc` and of `maximum-likelihood` hold the truth, estimates, what `abc` says of
// itself.
#include <fmt/format.h>
#include <fmt/ranges.h>

#include <cmath>
#include <cstdlib>
#include <string>
#include <vector>

#include "mottle/core/random.hpp"
#include "mottle/stats/distributions/standard_normal.hpp"
#include "mottle/updating/methods/abc.hpp"
#include "mottle/updating/methods/maximum_likelihood.hpp"
#include "support/three_masses.hpp"

namespace mottle::updating {
namespace {

constexpr double k_mean = 1.0;  // as in the paper
constexpr double k_std = 0.2;

/// A number of mean 0 and variance 1. Two-peaked: the first parameter lies 0.9 to either side, the others are normal.
/// Skewed: gamma of shape 4, whose skewness is 1.
double standardised_draw(const std::string& population, Eigen::Index parameter, RandomStream& stream) {
  if (population == "skewed") {
    double sum = 0.0;
    for (int i = 0; i < 4; ++i) sum -= std::log(stream.uniform());
    return (sum - 4.0) / 2.0;
  }
  const double normal = standard_normal_quantile(stream.uniform());
  if (population != "two-peaked" || parameter != 0) return normal;
  constexpr double k_peak = 0.9;
  return (stream.uniform() < 0.5 ? -k_peak : k_peak) + std::sqrt(1.0 - k_peak * k_peak) * normal;
}

Eigen::MatrixXd draw_tests(const test::ThreeMasses& structure, Eigen::Index specimens, const std::string& population,
                           const Eigen::RowVectorXd& noise, std::uint32_t number) {
  Eigen::MatrixXd x(specimens, 3);
  Eigen::MatrixXd e(specimens, 3);
  for (Eigen::Index s = 0; s < specimens; ++s) {
    RandomStream stream({.seed = 2026, .purpose = StreamPurpose::truth, .iteration = number},
                        static_cast<std::uint32_t>(s));
    for (Eigen::Index i = 0; i < 3; ++i) {
      do {
        x(s, i) = k_mean + k_std * standardised_draw(population, i, stream);
      } while (x(s, i) <= 0.2);
    }
    for (double& value : e.row(s)) value = standard_normal_quantile(stream.uniform());
  }
  return test::frequencies_of(structure, x) + e * noise.asDiagonal();
}

/// 1 where an interval holds the value, for each parameter.
std::vector<int> held(const Eigen::MatrixXd& intervals, double value) {
  std::vector<int> is_held;
  for (Eigen::Index i = 0; i < intervals.rows(); ++i) {
    is_held.push_back(intervals(i, 0) <= value && value <= intervals(i, 1) ? 1 : 0);
  }
  return is_held;
}

std::vector<double> entries(const Eigen::Ref<const Eigen::VectorXd>& values) {
  return {values.begin(), values.end()};
}

std::string findings_text(const UpdatingResult& result) {
  std::vector<double> width;
  for (Eigen::Index i = 0; i < 3; ++i) width.push_back(result.intervals->mean(i, 1) - result.intervals->mean(i, 0));
  std::vector<double> std_width;
  for (Eigen::Index i = 0; i < 3; ++i) std_width.push_back(result.intervals->std(i, 1) - result.intervals->std(i, 0));
  return fmt::format(
      R"("status": "{}", "mean_held": [{}], "std_held": [{}], "mean": [{}], "std": [{}], "mean_width": [{}], "std_width": [{}])",
      status_text(result.status), fmt::join(held(result.intervals->mean, k_mean), ", "),
      fmt::join(held(result.intervals->std, k_std), ", "), fmt::join(entries(result.mean), ", "),
      fmt::join(entries(test::standard_deviations(result)), ", "), fmt::join(width, ", "), fmt::join(std_width, ", "));
}

void replicate(Eigen::Index specimens, std::uint32_t number, const std::string& population, const std::string& distance,
               double fraction) {
  const test::ThreeMasses structure;
  const Eigen::RowVectorXd level =
      fraction * test::frequencies_of(structure, Eigen::MatrixXd::Constant(1, 3, k_mean)).row(0);
  UpdatingProblem problem = structure.problem(draw_tests(structure, specimens, population, level, number));
  problem.tests.repeatability_std = level.transpose();
  const AbcOptions options{.distance = distance == "energy" ? AbcOptions::Distance::energy
                                                            : AbcOptions::Distance::sliced_wasserstein};
  const RunContext context{.seed = number};
  const UpdatingResult own = AbcUpdater(options).update(problem, context);
  const UpdatingResult peer = MaximumLikelihoodUpdater({}).update(problem, context);
  const AbcFindings& found = *own.abc;
  fmt::print(
      "{{\"abc\": {{{}, \"coverage\": [{}], \"factor\": [{}], \"checked\": {}, \"fraction\": {}, \"effective\": {}, "
      "\"iterations\": {}, \"runs\": {}, \"exceeded\": {}, \"normality_p\": {}, \"better\": {}, \"ratio_mean\": {}, "
      "\"ratio_std\": {}, \"r_hat\": {}}}, \"likelihood\": {{{}}}}}\n",
      findings_text(own), fmt::join(entries(found.coverage), ", "), fmt::join(entries(found.factor), ", "),
      found.checked_coverage, found.fraction, found.stages.back().effective_samples, own.history.size() - 2,
      own.model_evaluations, found.exceeded, found.normality_p, found.is_likelihood_better ? "true" : "false",
      found.width_ratio_mean, found.width_ratio_std, found.r_hat.maxCoeff(), findings_text(peer));
  std::fflush(stdout);
}

}  // namespace
}  // namespace mottle::updating

int main(int count, char** words) {
  if (count < 7) return 2;
  for (int number = std::atoi(words[2]); number <= std::atoi(words[3]); ++number) {
    mottle::updating::replicate(std::atoi(words[1]), static_cast<std::uint32_t>(number), words[4], words[5],
                                std::atof(words[6]));
  }
  return 0;
}
