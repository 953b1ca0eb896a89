// Intervals of a population by parametric bootstrap through the model itself.
#include <algorithm>
#include <cmath>
#include <limits>

#include "mottle/core/error.hpp"
#include "mottle/stats/descriptive.hpp"
#include "mottle/stats/standard_normal.hpp"
#include "population_report.hpp"

namespace mottle {
namespace {

/// Tests of specimens drawn from the estimate, with its noise and with the same entries missing.
Eigen::MatrixXd draw_tests(const UpdatingProblem& problem, const PopulationFit& fit,
                           const JointDistribution& population, int sample, const RunContext& context,
                           std::int64_t& evaluations) {
  const Eigen::MatrixXd& values = problem.tests.values;
  const StreamKey key{
      .seed = context.seed, .purpose = StreamPurpose::bootstrap, .iteration = static_cast<std::uint32_t>(sample)};
  const ParameterDraw draw = problem.space.draw(population, SamplingDesign::monte_carlo, values.rows(), key);
  Eigen::MatrixXd tests = problem.model.evaluate(draw.samples, context).outputs;
  evaluations += draw.samples.rows();
  const StreamKey noise_key{
      .seed = context.seed, .purpose = StreamPurpose::test_noise, .iteration = static_cast<std::uint32_t>(sample)};
  for (Eigen::Index s = 0; s < tests.rows(); ++s) {
    RandomStream stream(noise_key, static_cast<std::uint32_t>(s));
    for (Eigen::Index k = 0; k < tests.cols(); ++k) {
      tests(s, k) += std::sqrt(fit.noise(k)) * standard_normal_quantile(stream.uniform());
      if (std::isnan(values(s, k))) tests(s, k) = std::numeric_limits<double>::quiet_NaN();
    }
  }
  return tests;
}

/// Ends theta such that the pivots of the samples leave equal tails: quantiles of `values`, sorted here.
double quantile(std::vector<double>& values, double probability) {
  const auto place = static_cast<std::size_t>(std::lround(probability * static_cast<double>(values.size() - 1)));
  std::nth_element(values.begin(), values.begin() + static_cast<std::ptrdiff_t>(place), values.end());
  return values[place];
}

constexpr double k_tail = 0.025;

}  // namespace

ParameterIntervals bootstrap_intervals(const UpdatingProblem& problem, const PopulationFit& fit,
                                       const PopulationFitSettings& settings, int samples, const RunContext& context,
                                       std::int64_t& evaluations) {
  const Eigen::Index q = fit.mean.size();
  const auto population = JointDistribution::normal_on_scales(problem.space.scales(), fit.mean, fit.covariance);
  const Eigen::VectorXd mean = population.mean();
  const Eigen::VectorXd deviation = population.covariance().diagonal().cwiseSqrt();
  const Eigen::MatrixXd correlation = correlation_from_covariance(population.covariance());
  const auto pairs = static_cast<std::size_t>(q * q);
  std::vector<std::vector<double>> shifts(static_cast<std::size_t>(q));
  std::vector<std::vector<double>> ratios(static_cast<std::size_t>(q));
  std::vector<std::vector<double>> turns(pairs);
  for (int b = 0; b < samples; ++b) {
    context.throw_if_stopped();
    context.progress("bootstrap", b, samples);
    const Eigen::MatrixXd tests = draw_tests(problem, fit, population, b, context, evaluations);
    if (!tests.array().isNaN().cwiseEqual(problem.tests.values.array().isNaN()).all()) continue;  // a failed run
    const PopulationFit again =
        fit_population(problem, tests, settings, context, [](const PopulationFit&) { return true; });
    evaluations += again.evaluations;
    const auto drawn = JointDistribution::normal_on_scales(problem.space.scales(), again.mean, again.covariance);
    const Eigen::VectorXd drawn_deviation = drawn.covariance().diagonal().cwiseSqrt();
    const Eigen::MatrixXd drawn_correlation = correlation_from_covariance(drawn.covariance());
    constexpr double k_least = 1e-3;  // of the deviation: an estimate of zero is no infinite ratio
    for (Eigen::Index i = 0; i < q; ++i) {
      const auto place = static_cast<std::size_t>(i);
      const double scale = std::max(drawn_deviation(i), k_least * deviation(i));
      shifts[place].push_back((drawn.mean()(i) - mean(i)) / scale);
      ratios[place].push_back(scale / std::max(deviation(i), 1e-300));
      for (Eigen::Index j = 0; j < i; ++j) {
        constexpr double k_one = 1.0 - 1e-9;
        turns[static_cast<std::size_t>(i * q + j)].push_back(
            std::atanh(std::clamp(drawn_correlation(i, j), -k_one, k_one)));
      }
    }
  }
  ParameterIntervals intervals{Eigen::MatrixXd(q, 2), Eigen::MatrixXd(q, 2), Eigen::MatrixXd::Identity(q, q),
                               Eigen::MatrixXd::Identity(q, q), "bootstrap"};
  for (Eigen::Index i = 0; i < q; ++i) {
    const auto place = static_cast<std::size_t>(i);
    intervals.mean.row(i) << mean(i) - deviation(i) * quantile(shifts[place], 1.0 - k_tail),
        mean(i) - deviation(i) * quantile(shifts[place], k_tail);
    intervals.std.row(i) << deviation(i) / quantile(ratios[place], 1.0 - k_tail),
        deviation(i) / quantile(ratios[place], k_tail);
    for (Eigen::Index j = 0; j < i; ++j) {
      std::vector<double>& turned = turns[static_cast<std::size_t>(i * q + j)];
      constexpr double k_one = 1.0 - 1e-9;
      const double z = std::atanh(std::clamp(correlation(i, j), -k_one, k_one));
      const double lower = std::tanh(2.0 * z - quantile(turned, 1.0 - k_tail));
      const double upper = std::tanh(2.0 * z - quantile(turned, k_tail));
      intervals.correlation_lower(i, j) = intervals.correlation_lower(j, i) = lower;
      intervals.correlation_upper(i, j) = intervals.correlation_upper(j, i) = upper;
    }
  }
  return intervals;
}

}  // namespace mottle
