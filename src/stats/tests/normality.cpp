#include "mottle/stats/tests/normality.hpp"

#include <Eigen/Core>
#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <map>
#include <mutex>
#include <numeric>

#include "mottle/core/process_mutex.hpp"
#include "mottle/linalg/dense/decompositions.hpp"
#include "mottle/stats/distributions/standard_normal.hpp"
#include "mottle/stats/moments/descriptive.hpp"
#include "stats/distributions/standard_normals.hpp"
#include "stats/population/effect_evidence.hpp"

namespace mottle::stats {
namespace {

constexpr Eigen::Index k_min_size = 5;

double polynomial(const std::array<double, 6>& coefficients, double x) {
  return std::accumulate(coefficients.rbegin(), coefficients.rend(), 0.0,
                         [x](double value, double coefficient) { return value * x + coefficient; });
}

/// Royston's weights of the ordered values, antisymmetric, of length 1.
Eigen::VectorXd shapiro_wilk_weights(Eigen::Index size) {
  constexpr std::array<double, 6> k_last{0.0, 0.221157, -0.147981, -2.07119, 4.434685, -2.706056};
  constexpr std::array<double, 6> k_before{0.0, 0.042981, -0.293762, -1.752461, 5.682633, -3.582633};
  const auto n = static_cast<double>(size);
  Eigen::VectorXd scores(size);
  for (Eigen::Index i = 0; i < size; ++i) {
    scores(i) = standard_normal_quantile((static_cast<double>(i) + 1.0 - 0.375) / (n + 0.25));
  }
  const double squares = scores.squaredNorm();
  const double root = 1.0 / std::sqrt(n);
  Eigen::VectorXd weights(size);
  const double last = polynomial(k_last, root) + scores(size - 1) / std::sqrt(squares);
  double rest = squares - 2.0 * scores(size - 1) * scores(size - 1);
  double left = 1.0 - 2.0 * last * last;
  const bool has_before = size > 5;
  const double before = polynomial(k_before, root) + scores(size - 2) / std::sqrt(squares);
  if (has_before) {
    rest -= 2.0 * scores(size - 2) * scores(size - 2);
    left -= 2.0 * before * before;
  }
  weights = scores / std::sqrt(rest / left);
  weights(size - 1) = last;
  weights(0) = -last;
  if (has_before) {
    weights(size - 2) = before;
    weights(1) = -before;
  }
  return weights;
}

/// Samples of one size from a normal population.
struct UnivariateReference {
  std::vector<double> shapiro_wilk;  ///< ascending
  std::vector<double> two_batches;   ///< ascending
  std::vector<double> smaller;       ///< of the two probabilities, ascending
};

double part_up_to(const std::vector<double>& ascending, double value) {
  const auto count = std::upper_bound(ascending.begin(), ascending.end(), value) - ascending.begin();
  return static_cast<double>(count + 1) / static_cast<double>(ascending.size() + 1);
}

double part_from(const std::vector<double>& ascending, double value) {
  const auto count = ascending.end() - std::lower_bound(ascending.begin(), ascending.end(), value);
  return static_cast<double>(count + 1) / static_cast<double>(ascending.size() + 1);
}

UnivariateReference make_reference(Eigen::Index size) {
  constexpr Eigen::Index k_samples = 1999;
  UnivariateReference reference;
  for (Eigen::Index r = 0; r < k_samples; ++r) {
    const NormalityStatistics drawn = normality_statistics(standard_normals(size, k_normality_stream, r));
    reference.shapiro_wilk.push_back(drawn.shapiro_wilk);
    reference.two_batches.push_back(drawn.two_batches);
  }
  const std::vector<double> w = reference.shapiro_wilk;
  const std::vector<double> batches = reference.two_batches;
  std::sort(reference.shapiro_wilk.begin(), reference.shapiro_wilk.end());
  std::sort(reference.two_batches.begin(), reference.two_batches.end());
  for (std::size_t r = 0; r < w.size(); ++r) {
    reference.smaller.push_back(
        std::min(part_up_to(reference.shapiro_wilk, w[r]), part_from(reference.two_batches, batches[r])));
  }
  std::sort(reference.smaller.begin(), reference.smaller.end());
  return reference;
}

double henze_zirkler_probability(double statistic, Eigen::Index specimens, Eigen::Index variables) {
  constexpr Eigen::Index k_samples = 999;
  static constinit ProcessMutex mutex;
  static std::map<std::pair<Eigen::Index, Eigen::Index>, std::vector<double>> kept;
  const std::lock_guard lock(mutex);
  std::vector<double>& reference = kept[{specimens, variables}];
  if (reference.empty()) {
    for (Eigen::Index r = 0; r < k_samples; ++r) {
      reference.push_back(
          henze_zirkler(standard_normals(specimens * variables, k_normality_stream, r).reshaped(specimens, variables)));
    }
    std::sort(reference.begin(), reference.end());
  }
  return part_from(reference, statistic);
}

/// The specimens that determine all directions, each estimate whitened to unit covariance.
Eigen::MatrixXd joint_scores(const ShrunkenEffects& effects, double min_variance) {
  const Eigen::Index directions = effects.points.cols();
  std::vector<Eigen::VectorXd> scores;
  for (std::size_t s = 0; s < effects.spreads.size(); ++s) {
    const SymmetricEigen solver(effects.spreads[s] * effects.spreads[s].transpose());
    if (!(solver.eigenvalues().minCoeff() > min_variance)) continue;
    const Eigen::MatrixXd inverse_root = solver.eigenvectors() *
                                         solver.eigenvalues().cwiseInverse().cwiseSqrt().asDiagonal() *
                                         solver.eigenvectors().transpose();
    scores.emplace_back(inverse_root * effects.points.row(static_cast<Eigen::Index>(s)).transpose());
  }
  Eigen::MatrixXd rows(static_cast<Eigen::Index>(scores.size()), directions);
  for (std::size_t s = 0; s < scores.size(); ++s) rows.row(static_cast<Eigen::Index>(s)) = scores[s].transpose();
  return rows;
}

VariableNormality test_variable(const Eigen::VectorXd& values, const Eigen::VectorXd& standard_deviations, double scale,
                                double min_reliability) {
  VariableNormality variable;
  variable.scores.setConstant(values.size(), std::numeric_limits<double>::quiet_NaN());
  std::vector<double> kept;
  for (Eigen::Index s = 0; s < values.size(); ++s) {
    const double part = scale > 0.0 ? std::pow(standard_deviations(s) / scale, 2) : 0.0;
    variable.reliability += part / static_cast<double>(values.size());
    if (part < min_reliability) continue;
    variable.scores(s) = values(s) / standard_deviations(s) * scale;
    kept.push_back(variable.scores(s));
  }
  const auto size = static_cast<Eigen::Index>(kept.size());
  variable.is_tested = size >= k_min_size;
  if (!variable.is_tested) return variable;
  variable.statistics = normality_statistics(Eigen::Map<const Eigen::VectorXd>(kept.data(), size));
  variable.probabilities = normality_probabilities(variable.statistics, size);
  return variable;
}

}  // namespace

NormalityStatistics normality_statistics(const Eigen::Ref<const Eigen::VectorXd>& values) {
  const Eigen::Index size = values.size();
  Eigen::VectorXd sorted = values;
  std::sort(sorted.begin(), sorted.end());
  sorted.array() -= sorted.mean();
  const double total = std::max(sorted.squaredNorm(), 1e-300);
  static thread_local Eigen::VectorXd weights;
  if (weights.size() != size) weights = shapiro_wilk_weights(size);
  NormalityStatistics result;
  result.shapiro_wilk = std::pow(weights.dot(sorted), 2) / total;
  const auto n = static_cast<double>(size);
  result.skewness = sorted.array().cube().sum() / n / std::pow(total / n, 1.5);
  const Eigen::Index smallest = std::max<Eigen::Index>(2, size / 5);
  double sum = 0.0;
  for (Eigen::Index below = 1; below <= size - smallest; ++below) {
    sum += sorted(below - 1);
    if (below < smallest) continue;
    const auto count = static_cast<double>(below);
    const double between = sum * sum * n / (count * (n - count));
    const double ratio = between / std::max(total - between, 1e-12 * total);
    if (ratio <= result.two_batches) continue;
    result.two_batches = ratio;
    result.lower_batch = below;
  }
  return result;
}

NormalityProbabilities normality_probabilities(const NormalityStatistics& statistics, Eigen::Index size) {
  static constinit ProcessMutex mutex;
  static std::map<Eigen::Index, UnivariateReference> kept;
  const std::lock_guard lock(mutex);
  auto found = kept.find(size);
  if (found == kept.end()) found = kept.emplace(size, make_reference(size)).first;
  const UnivariateReference& reference = found->second;
  const double batches = part_from(reference.two_batches, statistics.two_batches);
  const double smaller = std::min(part_up_to(reference.shapiro_wilk, statistics.shapiro_wilk), batches);
  return {part_up_to(reference.smaller, smaller), batches};
}

double henze_zirkler(const Eigen::Ref<const Eigen::MatrixXd>& samples) {
  const auto n = static_cast<double>(samples.rows());
  const auto q = static_cast<double>(samples.cols());
  const Eigen::MatrixXd centred = (samples.rowwise() - samples.colwise().mean()).transpose();
  const Eigen::MatrixXd whitened = positive_factor(centred * centred.transpose() / n).solve_lower(centred);
  const double square = 0.5 * std::pow((2.0 * q + 1.0) * n / 4.0, 2.0 / (q + 4.0));
  const Eigen::MatrixXd products = whitened.transpose() * whitened;
  const Eigen::VectorXd own = products.diagonal();
  double pairs = n;
  for (Eigen::Index j = 0; j < samples.rows(); ++j) {
    for (Eigen::Index i = 0; i < j; ++i) {
      pairs += 2.0 * std::exp(-0.5 * square * (own(i) + own(j) - 2.0 * products(i, j)));
    }
  }
  const double centre = (-square / (2.0 * (1.0 + square)) * own.array()).exp().sum();
  return pairs / n - 2.0 * std::pow(1.0 + square, -0.5 * q) * centre + n * std::pow(1.0 + 2.0 * square, -0.5 * q);
}

double NormalityTest::level_of_each(double level) const {
  return 1.0 - std::pow(1.0 - level, 1.0 / std::max(tests, 1));
}

NormalityTest test_normality(const std::vector<RandomEffectsUnit>& units, const RandomEffectsFit& fit,
                             const Eigen::Ref<const Eigen::MatrixXd>& map) {
  constexpr double k_min_reliability = 0.1;
  const WhitenedEffects effects = whiten_effects(units, fit);
  const Eigen::Index directions = effects.root.cols();
  const ShrunkenEffects shrunken = shrink_effects(effects.specimens, Eigen::VectorXd::Zero(directions),
                                                  Eigen::MatrixXd::Identity(directions, directions));
  const Eigen::MatrixXd axes = map * effects.root;
  const Eigen::MatrixXd values = shrunken.along(axes);
  const Eigen::MatrixXd standard_deviations = shrunken.standard_deviations(axes);
  NormalityTest test;
  double smallest = 1.0;
  for (Eigen::Index i = 0; i < axes.rows(); ++i) {
    test.variables.push_back(
        test_variable(values.col(i), standard_deviations.col(i), axes.row(i).norm(), k_min_reliability));
    if (!test.variables.back().is_tested) continue;
    ++test.tests;
    smallest = std::min(smallest, test.variables.back().probabilities.p_value);
  }
  if (directions > 1) {
    const Eigen::MatrixXd scores = joint_scores(shrunken, k_min_reliability);
    if (scores.rows() >= directions + 3) {
      test.is_joint_tested = true;
      test.henze_zirkler = henze_zirkler(scores);
      test.henze_zirkler_p = henze_zirkler_probability(test.henze_zirkler, scores.rows(), directions);
      ++test.tests;
      smallest = std::min(smallest, test.henze_zirkler_p);
    }
  }
  test.p_value = 1.0 - std::pow(1.0 - smallest, test.tests);
  return test;
}

}  // namespace mottle::stats
