// Intervals of a population by parametric bootstrap through the model itself.
#include <algorithm>
#include <cmath>
#include <limits>

#include "mottle/core/error.hpp"
#include "mottle/stats/distributions/standard_normal.hpp"
#include "mottle/stats/moments/quantiles.hpp"
#include "updating/population/population_report.hpp"

namespace mottle::updating {
namespace {

/// One error of the model for all specimens of a sample, from the stream after theirs.
Eigen::RowVectorXd draw_model_error(const ModelError& error, const StreamKey& key, Eigen::Index specimens) {
  RandomStream stream(key, static_cast<std::uint32_t>(specimens));
  return error.std.transpose().unaryExpr([&](double std) { return std * standard_normal_quantile(stream.uniform()); });
}

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
  if (fit.model_error) tests.rowwise() += draw_model_error(*fit.model_error, noise_key, tests.rows());
  for (Eigen::Index s = 0; s < tests.rows(); ++s) {
    RandomStream stream(noise_key, static_cast<std::uint32_t>(s));
    for (Eigen::Index k = 0; k < tests.cols(); ++k) {
      tests(s, k) += std::sqrt(fit.noise(k)) * standard_normal_quantile(stream.uniform());
      if (std::isnan(values(s, k))) tests(s, k) = std::numeric_limits<double>::quiet_NaN();
    }
  }
  return tests;
}

/// What is estimated again from each sample.
std::vector<PopulationEvidence> estimate_samples(const UpdatingProblem& problem, const PopulationFit& fit,
                                                 const PopulationFitSettings& settings, int samples,
                                                 const RunContext& context, std::int64_t& evaluations) {
  const auto population = JointDistribution::transformed_normal(problem.space.transforms(), fit.mean, fit.covariance);
  // Expectation-maximisation is slow at the border, and what a sample shows there does not wait for its last digits.
  constexpr int k_inner_iterations = 90;
  PopulationFitSettings quick = settings;
  quick.inner_iterations = k_inner_iterations;
  quick.region = fit.region;  // specimens drawn from the estimate lie where its own do
  std::vector<PopulationEvidence> drawn;
  for (int b = 0; b < samples; ++b) {
    context.throw_if_stopped();
    context.phase({.name = "bootstrap sample", .step = b + 1, .steps = samples});
    const Eigen::MatrixXd tests = draw_tests(problem, fit, population, b, context, evaluations);
    if (!tests.array().isNaN().cwiseEqual(problem.tests.values.array().isNaN()).all()) continue;  // a failed run
    try {
      const PopulationFit again =
          fit_population(problem, tests, quick, context, [](const PopulationFit&) { return true; });
      evaluations += again.evaluations;
      drawn.push_back(evidence_of(again));
    } catch (const ModelFailure&) {  // the model fails around some specimen of this sample
    }
  }
  if (2 * drawn.size() < static_cast<std::size_t>(samples)) {
    throw ModelFailure(
        fmt::format("intervals = \"bootstrap\": the model fails in {} of {} samples of specimens drawn from the "
                    "estimate; use intervals = \"analytic\"",
                    static_cast<std::size_t>(samples) - drawn.size(), samples));
  }
  return drawn;
}

/// The k-th smallest of B values is the quantile of k / (B + 1).
Eigen::RowVector2d ends_of(std::vector<double> values) {
  return equal_tails(std::move(values), k_confidence, QuantileRule::expectation);
}

double quotient(double above, double below) {
  return below > 0.0 ? above / below : 1.0;
}

/// The population's own values that each sample's pivots give back: a sample that shows twice the total variance that
/// it was drawn from says that the tests may have shown twice theirs.
class Pivots {
 public:
  Pivots(const PopulationFit& fit, const PopulationEvidence& seen, const std::vector<PopulationEvidence>& drawn)
      : seen_(seen), drawn_(drawn), truth_mean_(fit.mean), truth_total_(fit.covariance + seen.noise) {}

  /// Mean and deviation of a variable itself.
  void add_moments(Eigen::Index i, const ParameterTransform& scale, ParameterIntervals& intervals) const {
    std::vector<double> means;
    std::vector<double> standard_deviations;
    for (const PopulationEvidence& sample : drawn_) {
      const double total = seen_.total(i, i) * quotient(truth_total_(i, i), sample.total(i, i));
      const double variance = std::max(total - seen_.noise(i, i), 0.0);
      const double blown = quotient(seen_.mean_covariance(i, i), sample.mean_covariance(i, i));
      const double mean = seen_.mean(i) - (sample.mean(i) - truth_mean_(i)) * std::sqrt(blown);
      const VariableMoments moments =
          moments_of_variables({scale}, Eigen::VectorXd::Constant(1, mean), Eigen::MatrixXd::Constant(1, 1, variance));
      means.push_back(moments.mean(0));
      standard_deviations.push_back(std::sqrt(std::max(moments.covariance(0, 0), 0.0)));
    }
    intervals.mean.row(i) = ends_of(std::move(means));
    intervals.std.row(i) = ends_of(std::move(standard_deviations));
  }

  /// Correlation of two variables on their scales, over the samples that leave both a variance; not determined where
  /// those are few.
  Eigen::RowVector2d correlation(Eigen::Index i, Eigen::Index j) const {
    const Factor truth(truth_total_, i, j);
    const Factor seen(seen_.total, i, j);
    std::vector<double> values;
    for (const PopulationEvidence& sample : drawn_) {
      const Factor drawn(sample.total, i, j);
      // C = L_seen B^-1, B = L_truth^-1 L_drawn: in a linear model B is the root of a Wishart matrix.
      const double first = seen.first * quotient(truth.first, drawn.first);
      const double second = seen.second * quotient(truth.second, drawn.second);
      const double turned = (drawn.between - quotient(truth.between, truth.first) * drawn.first) / truth.second;
      const double between =
          seen.between * quotient(truth.first, drawn.first) - second * turned * quotient(truth.first, drawn.first);
      const double own_i = first * first - seen_.noise(i, i);
      const double own_j = between * between + second * second - seen_.noise(j, j);
      if (!(own_i > 0.0) || !(own_j > 0.0)) continue;
      values.push_back(std::clamp((first * between - seen_.noise(i, j)) / std::sqrt(own_i * own_j), -1.0, 1.0));
    }
    constexpr std::size_t k_fewest = 40;
    if (values.size() < k_fewest) return {-1.0, 1.0};
    return ends_of(std::move(values));
  }

 private:
  /// Lower triangular root of two variables' covariance, regular however they are correlated.
  struct Factor {
    Factor(const Eigen::MatrixXd& covariance, Eigen::Index i, Eigen::Index j) {
      constexpr double k_nearly_one = 1.0 - 1e-12;
      constexpr double k_min = 1e-300;
      const double a = std::max(covariance(i, i), k_min);
      const double b = std::max(covariance(j, j), k_min);
      const double r = std::clamp(covariance(i, j) / std::sqrt(a) / std::sqrt(b), -k_nearly_one, k_nearly_one);
      first = std::sqrt(a);
      between = r * std::sqrt(b);
      second = std::sqrt(b * (1.0 - r * r));
    }
    double first, between, second;
  };

  const PopulationEvidence& seen_;
  const std::vector<PopulationEvidence>& drawn_;
  Eigen::VectorXd truth_mean_;
  Eigen::MatrixXd truth_total_;
};

}  // namespace

ParameterIntervals bootstrap_intervals(const UpdatingProblem& problem, const PopulationFit& fit,
                                       const PopulationEvidence& evidence, const PopulationFitSettings& settings,
                                       int samples, const RunContext& context, std::int64_t& evaluations) {
  const Eigen::Index q = fit.mean.size();
  const std::vector<ParameterTransform> scales = problem.space.transforms();
  const std::vector<PopulationEvidence> drawn = estimate_samples(problem, fit, settings, samples, context, evaluations);
  const Pivots pivots(fit, evidence, drawn);
  ParameterIntervals intervals{Eigen::MatrixXd(q, 2), Eigen::MatrixXd(q, 2), Eigen::MatrixXd::Identity(q, q),
                               Eigen::MatrixXd::Identity(q, q), "bootstrap"};
  for (Eigen::Index i = 0; i < q; ++i) {
    pivots.add_moments(i, scales[static_cast<std::size_t>(i)], intervals);
    for (Eigen::Index j = 0; j < i; ++j) {
      const Eigen::RowVector2d ends = pivots.correlation(i, j);
      intervals.correlation_lower(i, j) = intervals.correlation_lower(j, i) = ends(0);
      intervals.correlation_upper(i, j) = intervals.correlation_upper(j, i) = ends(1);
    }
  }
  return intervals;
}

}  // namespace mottle::updating
