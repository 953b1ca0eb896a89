#include "mottle/stats/population/population_intervals.hpp"

#include <algorithm>
#include <boost/math/distributions/chi_squared.hpp>
#include <boost/math/distributions/students_t.hpp>
#include <cmath>
#include <limits>
#include <map>

#include "mottle/core/error.hpp"
#include "mottle/core/process_mutex.hpp"
#include "mottle/stats/distributions/standard_normal.hpp"
#include "mottle/stats/moments/quantiles.hpp"
#include "mottle/stats/sampling/sampling.hpp"

namespace mottle::stats {
namespace {

constexpr double k_nan = std::numeric_limits<double>::quiet_NaN();
constexpr double k_min_level_degrees_of_freedom = 0.1;  // less says nothing of a level
constexpr Eigen::Index k_max_levels = 8;                // with draws of their own
constexpr double k_min_degrees_of_freedom = 1.2;        // the Bartlett decomposition needs more than one

/// Draws that all intervals share, and chi-squared deviates made of them by degrees of freedom.
class Draws {
 public:
  static const Eigen::ArrayXd& normal() {
    const NoFork no_fork;
    static const Eigen::ArrayXd deviates =
        uniforms().col(2).unaryExpr([](double u) { return standard_normal_quantile(u); }).array();
    return deviates;
  }

  /// Chi-squared of a column of uniforms: 0 or 1, or one of a level.
  const Eigen::ArrayXd& chi_squared(Eigen::Index column, double degrees_of_freedom) {
    const auto [found, is_new] = made_.try_emplace({column, degrees_of_freedom});
    if (is_new) {
      const boost::math::chi_squared distribution(degrees_of_freedom);
      found->second =
          uniforms().col(column).unaryExpr([&](double u) { return boost::math::quantile(distribution, u); }).array();
    }
    return found->second;
  }

 private:
  static const Eigen::MatrixXd& uniforms() {
    constexpr Eigen::Index k_count = 2048;
    const NoFork no_fork;
    static const Eigen::MatrixXd design =
        uniform_design(SamplingDesign::sobol, k_count, 3 + k_max_levels, {.purpose = StreamPurpose::bootstrap});
    return design;
  }

  std::map<std::pair<Eigen::Index, double>, Eigen::ArrayXd> made_;
};

/// nan where there are too few values. Those that are no number are beyond what numbers can hold: so little is known of
/// a variable with a log or logit transform.
Eigen::RowVector2d ends_of(std::vector<double> values, double confidence) {
  constexpr std::size_t k_fewest = 40;
  if (values.size() < k_fewest) return {k_nan, k_nan};
  return equal_tails(std::move(values), confidence, QuantileRule::ends);
}

/// Correlation of two variables from its fiducial draws, less the noise.
Eigen::RowVector2d correlation_interval(const PopulationEvidence& evidence, Eigen::Index i, Eigen::Index j,
                                        double confidence, Draws& draws) {
  const double degrees_of_freedom = std::max(evidence.degrees_of_freedom(i, j), k_min_degrees_of_freedom);
  const double a = evidence.total(i, i);
  const double b = evidence.total(j, j);
  if (!(evidence.degrees_of_freedom(i, j) > 0.0) || !(a > 0.0) || !(b > 0.0)) return {k_nan, k_nan};
  constexpr double k_nearly_one = 1.0 - 1e-12;
  const double r = std::clamp(evidence.total(i, j) / std::sqrt(a * b), -k_nearly_one, k_nearly_one);
  const double slope = r / std::sqrt(1.0 - r * r);
  const Eigen::ArrayXd& first = draws.chi_squared(0, degrees_of_freedom);
  const Eigen::ArrayXd& second = draws.chi_squared(1, degrees_of_freedom - 1.0);
  std::vector<double> values;
  values.reserve(static_cast<std::size_t>(first.size()));
  for (Eigen::Index k = 0; k < first.size(); ++k) {
    const double f = (slope * std::sqrt(second(k)) - Draws::normal()(k)) / std::sqrt(first(k));
    const double rho = f / std::sqrt(1.0 + f * f);
    const double variance_i = degrees_of_freedom * a / first(k);
    const double variance_j = degrees_of_freedom * b * (1.0 - r * r) / second(k) * (1.0 + f * f);
    const double own_i = variance_i - evidence.noise(i, i);
    const double own_j = variance_j - evidence.noise(j, j);
    if (!(own_i > 0.0) || !(own_j > 0.0)) continue;
    const double covariance = rho * std::sqrt(variance_i * variance_j) - evidence.noise(i, j);
    values.push_back(std::clamp(covariance / std::sqrt(own_i * own_j), -1.0, 1.0));
  }
  const Eigen::RowVector2d ends = ends_of(std::move(values), confidence);
  return ends.allFinite() ? ends : Eigen::RowVector2d(-1.0, 1.0);
}

/// Draws of the part of a mean's variance due to shared errors; a constant where their variance is known.
Eigen::ArrayXd shared_variances(const PopulationEvidence& evidence, Eigen::Index i, Eigen::Index count, Draws& draws) {
  if (evidence.mean_shared.size() == 0) return Eigen::ArrayXd::Zero(count);
  Eigen::ArrayXd variances = Eigen::ArrayXd::Constant(count, evidence.mean_shared(i, i));
  Eigen::Index column = 3;
  for (const auto& [spread, level] : evidence.levels) {
    const double degrees_of_freedom = level.degrees_of_freedom;
    const double estimate = std::max(level.observed - level.known, 0.0);
    if (!(spread(i, i) > 0.0)) continue;
    if (!(degrees_of_freedom > k_min_level_degrees_of_freedom)) return Eigen::ArrayXd::Constant(count, k_nan);
    const Eigen::ArrayXd drawn =
        (degrees_of_freedom * level.observed / draws.chi_squared(column, degrees_of_freedom) - level.known).max(0.0);
    variances += spread(i, i) * (drawn - estimate);
    column = std::min(column + 1, 2 + k_max_levels);
  }
  return variances.max(0.0);
}

/// Half the width of a mean's interval where levels of shared errors are estimated: it holds the given probability of
/// the fiducial distribution, normal at given variances.
double half_width(const Eigen::ArrayXd& variances, double confidence) {
  const Eigen::ArrayXd standard_deviation = variances.max(0.0).sqrt();
  const auto coverage = [&](double half) {
    return (half / standard_deviation.max(1e-300))
        .unaryExpr([](double z) { return std::erf(z / std::sqrt(2.0)); })
        .mean();
  };
  double lower = 0.0;
  double upper = standard_deviation.maxCoeff() + std::numeric_limits<double>::min();
  while (coverage(upper) < confidence) upper *= 2.0;
  for (int halving = 0; halving < 60; ++halving) {
    const double middle = 0.5 * (lower + upper);
    (coverage(middle) < confidence ? lower : upper) = middle;
  }
  return upper;
}

/// Half the width of the interval of a mean that is normal.
double mean_half_width(const PopulationEvidence& evidence, Eigen::Index i, double confidence, Draws& draws) {
  const double variance = evidence.mean_covariance(i, i);
  const double shared = evidence.mean_shared.size() > 0 ? evidence.mean_shared(i, i) : 0.0;
  const double own = std::max(variance - shared, 0.0);
  if (!evidence.levels.empty()) {
    const Eigen::ArrayXd& chi_squared = draws.chi_squared(0, evidence.degrees_of_freedom(i, i));
    const Eigen::ArrayXd drawn = shared_variances(evidence, i, chi_squared.size(), draws);
    if (!drawn.allFinite()) return k_nan;
    return half_width(own * evidence.degrees_of_freedom(i, i) / chi_squared + drawn, confidence);
  }
  const double ratio = own > 0.0 ? variance / own : std::numeric_limits<double>::infinity();
  constexpr double k_nearly_normal = 1e9;
  const boost::math::students_t t(std::min(evidence.degrees_of_freedom(i, i) * ratio * ratio, k_nearly_normal));
  return boost::math::quantile(complement(t, 0.5 * (1.0 - confidence))) * std::sqrt(variance);
}

/// Mean and standard deviation of a variable that is normal only after its transform.
void add_transformed_intervals(const PopulationEvidence& evidence, Eigen::Index i, const ParameterTransform& transform,
                               double confidence, Draws& draws, PopulationIntervals& intervals) {
  const double degrees_of_freedom = evidence.degrees_of_freedom(i, i);
  const Eigen::ArrayXd& chi_squared = draws.chi_squared(0, degrees_of_freedom);
  const Eigen::ArrayXd shared = shared_variances(evidence, i, chi_squared.size(), draws);
  const double own_variance =
      evidence.mean_covariance(i, i) - (evidence.mean_shared.size() > 0 ? evidence.mean_shared(i, i) : 0.0);
  std::vector<double> means;
  std::vector<double> standard_deviations;
  for (Eigen::Index k = 0; k < chi_squared.size(); ++k) {
    const double blown = degrees_of_freedom / chi_squared(k);
    const double variance = std::max(evidence.total(i, i) * blown - evidence.noise(i, i), 0.0);
    const double mean = evidence.mean(i) - Draws::normal()(k) * std::sqrt(own_variance * blown + shared(k));
    const VariableMoments moments = moments_of_variables({transform}, Eigen::VectorXd::Constant(1, mean),
                                                         Eigen::MatrixXd::Constant(1, 1, variance));
    means.push_back(moments.mean(0));
    standard_deviations.push_back(std::sqrt(moments.covariance(0, 0)));
  }
  intervals.mean.row(i) = ends_of(std::move(means), confidence);
  intervals.std.row(i) = ends_of(std::move(standard_deviations), confidence);
}

}  // namespace

PopulationIntervals population_intervals(const PopulationEvidence& evidence,
                                         const std::vector<ParameterTransform>& transforms, double confidence) {
  require(confidence > 0.0 && confidence < 1.0, "confidence: {} is outside (0, 1)", confidence);
  const Eigen::Index q = evidence.mean.size();
  PopulationIntervals intervals{Eigen::MatrixXd::Constant(q, 2, k_nan), Eigen::MatrixXd::Constant(q, 2, k_nan),
                                Eigen::MatrixXd::Identity(q, q), Eigen::MatrixXd::Identity(q, q)};
  Draws draws;
  const double tail = 0.5 * (1.0 - confidence);
  for (Eigen::Index i = 0; i < q; ++i) {
    const double degrees_of_freedom = evidence.degrees_of_freedom(i, i);
    if (!(degrees_of_freedom > 0.0)) continue;
    if (transforms[static_cast<std::size_t>(i)].kind != ParameterTransform::Kind::identity) {
      add_transformed_intervals(evidence, i, transforms[static_cast<std::size_t>(i)], confidence, draws, intervals);
    } else {
      const double half = mean_half_width(evidence, i, confidence, draws);
      intervals.mean.row(i) << evidence.mean(i) - half, evidence.mean(i) + half;
      const boost::math::chi_squared chi_squared(degrees_of_freedom);
      const double sum = degrees_of_freedom * evidence.total(i, i);
      const auto standard_deviation = [&](double quantile) {
        return std::sqrt(std::max(sum / quantile - evidence.noise(i, i), 0.0));
      };
      intervals.std.row(i) << standard_deviation(boost::math::quantile(complement(chi_squared, tail))),
          standard_deviation(boost::math::quantile(chi_squared, tail));
    }
    for (Eigen::Index j = 0; j < i; ++j) {
      const Eigen::RowVector2d ends = correlation_interval(evidence, i, j, confidence, draws);
      intervals.correlation_lower(i, j) = intervals.correlation_lower(j, i) = ends(0);
      intervals.correlation_upper(i, j) = intervals.correlation_upper(j, i) = ends(1);
    }
  }
  return intervals;
}

}  // namespace mottle::stats
