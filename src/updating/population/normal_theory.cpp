#include "updating/population/normal_theory.hpp"

#include <algorithm>
#include <boost/math/distributions/chi_squared.hpp>
#include <cmath>

#include "mottle/stats/distributions/standard_normal.hpp"
#include "mottle/stats/population/normal_intervals.hpp"
#include "mottle/stats/population/population_intervals.hpp"
#include "mottle/stats/sampling/sampling.hpp"
#include "updating/population/population_report.hpp"

namespace mottle::updating {
namespace {

constexpr Eigen::Index k_draws = 4096;  // Sobol points: quantiles of smooth functions to about 1e-3 of their width

/// mu = m + first * s, sigma = second * s: the same draws for every parameter.
Eigen::MatrixXd fiducial_draws(int count) {
  const Eigen::MatrixXd uniforms =
      uniform_design(SamplingDesign::sobol, k_draws, 2, {.seed = 1, .purpose = StreamPurpose::bootstrap});
  const double degrees_of_freedom = count - 1;
  const boost::math::chi_squared distribution(degrees_of_freedom);
  Eigen::MatrixXd draws(k_draws, 2);
  for (Eigen::Index i = 0; i < k_draws; ++i) {
    const double ratio = std::sqrt(degrees_of_freedom / boost::math::quantile(distribution, uniforms(i, 1)));
    draws(i, 0) = standard_normal_quantile(uniforms(i, 0)) * ratio / std::sqrt(count);
    draws(i, 1) = ratio;
  }
  return draws;
}

Interval central(Eigen::VectorXd& values) {
  std::sort(values.begin(), values.end());
  const auto tail = static_cast<Eigen::Index>(0.5 * (1.0 - k_confidence) * static_cast<double>(values.size()));
  return {values(tail), values(values.size() - 1 - tail)};
}

/// Intervals of mean and deviation of x.
std::pair<Interval, Interval> scaled_intervals(const ParameterTransform& scale, double mean, double std,
                                               const Eigen::MatrixXd& draws) {
  Eigen::VectorXd means(draws.rows());
  Eigen::VectorXd standard_deviations(draws.rows());
  for (Eigen::Index i = 0; i < draws.rows(); ++i) {
    const VariableMoments moments =
        moments_of_variables({scale}, Eigen::VectorXd::Constant(1, mean + draws(i, 0) * std),
                             Eigen::MatrixXd::Constant(1, 1, draws(i, 1) * draws(i, 1) * std * std));
    means(i) = moments.mean(0);
    standard_deviations(i) = std::sqrt(moments.covariance(0, 0));
  }
  return {central(means), central(standard_deviations)};
}

/// Correlation of x where that of t is given.
double carried_over(const ParameterTransform& first, const ParameterTransform& second, const Eigen::Vector2d& mean,
                    const Eigen::Vector2d& std, double correlation) {
  using Kind = ParameterTransform::Kind;
  if (first.kind == Kind::identity && second.kind == Kind::identity) return correlation;
  Eigen::Matrix2d covariance = std.cwiseAbs2().asDiagonal();
  covariance(0, 1) = covariance(1, 0) = correlation * std(0) * std(1);
  const Eigen::MatrixXd moved = moments_of_variables({first, second}, mean, covariance).covariance;
  return moved(0, 1) / std::sqrt(moved(0, 0) * moved(1, 1));
}

}  // namespace

PopulationEvidence sample_evidence(const Eigen::Ref<const Eigen::VectorXd>& mean,
                                   const Eigen::Ref<const Eigen::MatrixXd>& covariance, Eigen::Index count) {
  const Eigen::Index q = mean.size();
  const auto n = static_cast<double>(count);
  return {mean, covariance, Eigen::MatrixXd::Zero(q, q), covariance / n, Eigen::MatrixXd::Constant(q, q, n - 1.0)};
}

ParameterIntervals normal_theory_intervals(const std::vector<ParameterTransform>& scales,
                                           const Eigen::Ref<const Eigen::VectorXd>& mean,
                                           const Eigen::Ref<const Eigen::MatrixXd>& covariance, int count,
                                           const std::vector<int>& groups) {
  const Eigen::Index q = mean.size();
  const Eigen::VectorXd std = covariance.diagonal().cwiseSqrt();
  ParameterIntervals intervals{.mean = Eigen::MatrixXd(q, 2),
                               .std = Eigen::MatrixXd(q, 2),
                               .correlation_lower = Eigen::MatrixXd::Identity(q, q),
                               .correlation_upper = Eigen::MatrixXd::Identity(q, q),
                               .made_by = "analytic"};
  const auto scale = [&](Eigen::Index i) -> const ParameterTransform& { return scales[static_cast<std::size_t>(i)]; };
  Eigen::MatrixXd draws;
  for (Eigen::Index i = 0; i < q; ++i) {
    Interval of_mean = mean_interval(mean(i), std(i), count, k_confidence);
    Interval of_std = standard_deviation_interval(std(i), count, k_confidence);
    if (scale(i).kind != ParameterTransform::Kind::identity) {
      if (draws.size() == 0) draws = fiducial_draws(count);
      std::tie(of_mean, of_std) = scaled_intervals(scale(i), mean(i), std(i), draws);
    }
    intervals.mean.row(i) << of_mean.lower, of_mean.upper;
    intervals.std.row(i) << of_std.lower, of_std.upper;
    for (Eigen::Index j = 0; j < i; ++j) {
      Interval ends;
      if (groups.empty() || groups[static_cast<std::size_t>(i)] == groups[static_cast<std::size_t>(j)]) {
        const double product = std(i) * std(j);
        ends = product > 0.0
                   ? correlation_interval(std::clamp(covariance(i, j) / product, -1.0, 1.0), count, k_confidence)
                   : Interval{-1.0, 1.0};
        if (product > 0.0) {
          const Eigen::Vector2d means(mean(i), mean(j));
          const Eigen::Vector2d standard_deviations(std(i), std(j));
          // They ascend together, but where there is hardly any scatter rounding decides.
          const auto [lower, upper] =
              std::minmax({carried_over(scale(i), scale(j), means, standard_deviations, ends.lower),
                           carried_over(scale(i), scale(j), means, standard_deviations, ends.upper)});
          ends = {lower, upper};
        }
      }
      intervals.correlation_lower(i, j) = intervals.correlation_lower(j, i) = ends.lower;
      intervals.correlation_upper(i, j) = intervals.correlation_upper(j, i) = ends.upper;
    }
  }
  return intervals;
}

Eigen::MatrixXd normal_theory_means(const std::vector<ParameterTransform>& scales,
                                    const Eigen::Ref<const Eigen::VectorXd>& mean,
                                    const Eigen::Ref<const Eigen::MatrixXd>& covariance, int count,
                                    const Eigen::Ref<const Eigen::MatrixXd>& shared) {
  const Eigen::Index q = mean.size();
  PopulationEvidence evidence;
  evidence.mean = mean;
  evidence.total = covariance;
  evidence.noise = Eigen::MatrixXd::Zero(q, q);
  evidence.mean_covariance = covariance / static_cast<double>(count) + shared;
  evidence.mean_shared = shared;
  evidence.degrees_of_freedom = Eigen::MatrixXd::Constant(q, q, static_cast<double>(count - 1));
  return population_intervals(evidence, scales, k_confidence).mean;
}

}  // namespace mottle::updating
