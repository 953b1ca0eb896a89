#include "stats/tests/forward_search.hpp"

#include <boost/math/special_functions/beta.hpp>
#include <cmath>
#include <limits>
#include <numeric>

#include "mottle/linalg/dense/decompositions.hpp"

namespace mottle::stats {
namespace {

/// Of a squared distance whose covariance was estimated with so many degrees of freedom: Hotelling's T^2. Nothing is
/// known of it where there are none.
DeletedDistance deleted_distance(double square, double dimensions, double degrees_of_freedom) {
  if (!(degrees_of_freedom > 0.0)) return {0.0, 0.0};
  const double rest = std::max(degrees_of_freedom - dimensions + 1.0, 1.0);
  const double tail =
      boost::math::ibeta(0.5 * rest, 0.5 * dimensions, degrees_of_freedom / (degrees_of_freedom + square));
  return {std::sqrt(square), -std::log(std::max(tail, 1e-300))};
}

/// Standard normal deviate of about the probability of the same squared distance. Source: [Paulson1942].
double normal_deviate(double square, double dimensions, double degrees_of_freedom) {
  if (!(degrees_of_freedom > 0.0)) return std::sqrt(square);
  const double rest = std::max(degrees_of_freedom - dimensions + 1.0, 1.0);
  const double root = std::cbrt(square * rest / (degrees_of_freedom * dimensions));
  const double a = 2.0 / (9.0 * dimensions);
  const double b = 2.0 / (9.0 * rest);
  return ((1.0 - b) * root - (1.0 - a)) / std::sqrt(b * root * root + a);
}

/// Takes out the one or two of `kept` without which the rest scatters least: 1 + their leverage decides, det(I - H).
void take_out(const Eigen::Ref<const Eigen::MatrixXd>& points, bool is_pair, std::vector<Eigen::Index>& kept) {
  const auto n = static_cast<Eigen::Index>(kept.size());
  const Eigen::MatrixXd chosen = points(kept, Eigen::all);
  const Eigen::MatrixXd centred = chosen.rowwise() - chosen.colwise().mean();
  const CholeskyFactor factor = positive_factor(centred.transpose() * centred);
  const Eigen::MatrixXd whitened = factor.solve_lower(centred.transpose());
  const double mean_leverage = 1.0 / static_cast<double>(n);
  const Eigen::ArrayXd own = (1.0 - mean_leverage) - whitened.colwise().squaredNorm().transpose().array();
  Eigen::Index first = 0;
  Eigen::Index second = -1;
  double smallest = own.minCoeff(&first);
  if (is_pair) {
    smallest = 2.0;
    const Eigen::MatrixXd shared = whitened.transpose() * whitened;
    for (Eigen::Index i = 0; i < n; ++i) {
      for (Eigen::Index j = i + 1; j < n; ++j) {
        const double left = own(i) * own(j) - std::pow(shared(j, i) + mean_leverage, 2);
        if (left >= smallest) continue;
        smallest = left;
        first = i;
        second = j;
      }
    }
  }
  if (second >= 0) kept.erase(kept.begin() + second);  // the later one first
  kept.erase(kept.begin() + first);
}

}  // namespace

CompleteSample::Estimate CompleteSample::estimate(const std::vector<Eigen::Index>& core, const Estimate*) const {
  Estimate result;
  result.count = static_cast<double>(core.size());
  const Eigen::MatrixXd chosen = columns_(Eigen::all, core);
  result.mean = chosen.rowwise().mean();
  const Eigen::MatrixXd centred = chosen.colwise() - result.mean;
  result.factor = positive_factor(centred * centred.transpose() / (result.count - 1.0));
  return result;
}

Eigen::VectorXd CompleteSample::ranking(const Estimate& estimate) const {
  const Eigen::MatrixXd centred = columns_.colwise() - estimate.mean;
  return estimate.factor.solve_lower(centred).colwise().squaredNorm();
}

DeletedDistance CompleteSample::deleted(Eigen::Index specimen, const Estimate& estimate) const {
  const Eigen::VectorXd centred = columns_.col(specimen) - estimate.mean;
  const double square = estimate.factor.solve_lower(centred).squaredNorm() * estimate.count / (estimate.count + 1.0);
  return deleted_distance(square, static_cast<double>(columns_.rows()), estimate.count - 1.0);
}

struct PartialSample::Sums {
  Eigen::VectorXd mean;
  Eigen::MatrixXd mean_variance;
  Eigen::MatrixXd growth;  ///< sum of u u' - H, u = A' C^-1 (y - A mean), H = A' C^-1 A
};

PartialSample::PartialSample(std::vector<EffectEvidence> specimens, double shrinkage)
    : specimens_(std::move(specimens)), shrinkage_(shrinkage) {
  std::vector<Eigen::Index> all(specimens_.size());
  std::iota(all.begin(), all.end(), Eigen::Index{0});
  const Estimate whole = estimate(all, nullptr);
  effects_ = shrink_effects(specimens_, whole.mean, whole.covariance);
}

double PartialSample::complete_specimens() const {
  double rows = 0.0;
  for (const EffectEvidence& own : specimens_) rows += static_cast<double>(own.response.size());
  return rows / static_cast<double>(std::max<Eigen::Index>(effects(), 1));
}

Eigen::MatrixXd PartialSample::along(const Eigen::Ref<const Eigen::MatrixXd>& axes) const {
  return effects_.along(axes).cwiseQuotient(effects_.standard_deviations(axes).cwiseMax(1e-300));
}

PartialSample::Sums PartialSample::pass(const std::vector<Eigen::Index>& core,
                                        const Eigen::MatrixXd& covariance) const {
  constexpr double k_unseen = 1e-9;
  const Eigen::Index effects = covariance.rows();
  std::vector<Eigen::MatrixXd> seen(core.size());
  std::vector<Eigen::VectorXd> scores(core.size());
  Eigen::MatrixXd information = k_unseen * Eigen::MatrixXd::Identity(effects, effects);
  Eigen::VectorXd gradient = Eigen::VectorXd::Zero(effects);
  for (std::size_t i = 0; i < core.size(); ++i) {
    const EffectEvidence& own = specimens_[static_cast<std::size_t>(core[i])];
    const CholeskyFactor factor = positive_factor(own.design * covariance * own.design.transpose() + own.noise);
    const Eigen::MatrixXd whitened = factor.solve_lower(own.design);
    seen[i] = whitened.transpose() * whitened;
    scores[i] = whitened.transpose() * factor.solve_lower(own.response);
    information += seen[i];
    gradient += scores[i];
  }
  Sums sums;
  const CholeskyFactor factor(information);
  sums.mean = factor.solve(gradient);
  sums.mean_variance = factor.solve(Eigen::MatrixXd::Identity(effects, effects));
  sums.growth = Eigen::MatrixXd::Zero(effects, effects);
  for (std::size_t i = 0; i < core.size(); ++i) {
    const Eigen::VectorXd score = scores[i] - seen[i] * sums.mean;
    sums.growth += score * score.transpose() - seen[i];
  }
  return sums;
}

PartialSample::Estimate PartialSample::estimate(const std::vector<Eigen::Index>& core, const Estimate* near) const {
  constexpr int k_passes = 6;
  constexpr double k_at_rest = 0.05;
  const Eigen::Index effects = specimens_.front().design.cols();
  Estimate result;
  result.covariance = near != nullptr ? near->covariance : Eigen::MatrixXd(Eigen::MatrixXd::Identity(effects, effects));
  for (const Eigen::Index s : core) {
    result.count +=
        static_cast<double>(specimens_[static_cast<std::size_t>(s)].response.size()) / static_cast<double>(effects);
  }
  const auto members = static_cast<double>(core.size());
  for (int step = 0; step < k_passes; ++step) {
    Sums sums = pass(core, result.covariance);
    result.mean = std::move(sums.mean);
    result.mean_variance = std::move(sums.mean_variance);
    Eigen::MatrixXd next = result.covariance + result.covariance * sums.growth * result.covariance / members;
    next.diagonal() *= (members + shrinkage_) / members;
    next *= members / (members + shrinkage_);
    const double change = (next - result.covariance).cwiseAbs().maxCoeff();
    result.covariance = std::move(next);
    if (change <= k_at_rest * result.covariance.diagonal().maxCoeff()) break;
  }
  result.covariance *= result.count / std::max(result.count - 1.0, 1.0);
  return result;
}

Eigen::VectorXd PartialSample::ranking(const Estimate& estimate) const {
  Eigen::VectorXd ranking(size());
  for (std::size_t s = 0; s < specimens_.size(); ++s) {
    const EffectEvidence& own = specimens_[s];
    const auto factor = positive_factor(own.design * estimate.covariance * own.design.transpose() + own.noise);
    const double square = factor.solve_lower(own.response - own.design * estimate.mean).squaredNorm();
    ranking(static_cast<Eigen::Index>(s)) =
        normal_deviate(square, static_cast<double>(own.response.size()), estimate.count - 1.0);
  }
  return ranking;
}

DeletedDistance PartialSample::deleted(Eigen::Index specimen, const Estimate& estimate) const {
  const auto s = static_cast<std::size_t>(specimen);
  const EffectEvidence& own = specimens_[s];
  const auto factor =
      positive_factor(own.design * (estimate.covariance + estimate.mean_variance) * own.design.transpose() + own.noise);
  const double square = factor.solve_lower(own.response - own.design * estimate.mean).squaredNorm();
  return deleted_distance(square, static_cast<double>(own.response.size()), estimate.count - 1.0);
}

std::vector<Eigen::Index> core_without_pairs(const Eigen::Ref<const Eigen::MatrixXd>& points, Eigen::Index suspects) {
  std::vector<Eigen::Index> kept(static_cast<std::size_t>(points.rows()));
  std::iota(kept.begin(), kept.end(), Eigen::Index{0});
  for (Eigen::Index left = suspects; left > 0; left -= 2) take_out(points, left > 1, kept);
  return kept;
}

std::vector<ForwardStep> line_search(const Eigen::Ref<const Eigen::VectorXd>& values, Eigen::Index max_suspects) {
  const Eigen::Index size = values.size();
  std::vector<Eigen::Index> order(static_cast<std::size_t>(size));
  std::iota(order.begin(), order.end(), Eigen::Index{0});
  std::stable_sort(order.begin(), order.end(), [&](Eigen::Index a, Eigen::Index b) { return values(a) < values(b); });
  const Eigen::VectorXd sorted = (values.array() - values.mean()).matrix()(order);
  std::vector<ForwardStep> steps(static_cast<std::size_t>(max_suspects));
  for (Eigen::Index suspects = max_suspects; suspects > 0; --suspects) {
    const Eigen::Index count = size - suspects;
    Eigen::Index best = 0;
    double smallest = std::numeric_limits<double>::infinity();
    double centre = 0.0;
    for (Eigen::Index begin = 0; begin <= suspects; ++begin) {
      const auto window = sorted.segment(begin, count);
      const double mean = window.mean();
      const double squares = (window.array() - mean).square().sum();
      if (squares >= smallest) continue;
      best = begin;
      smallest = squares;
      centre = mean;
    }
    ForwardStep& step = steps[static_cast<std::size_t>(suspects - 1)];
    for (Eigen::Index i = 0; i < size; ++i) {
      if (i < best || i >= best + count) step.suspects.push_back(i);
    }
    std::stable_sort(step.suspects.begin(), step.suspects.end(), [&](Eigen::Index a, Eigen::Index b) {
      return std::abs(sorted(a) - centre) < std::abs(sorted(b) - centre);
    });
    const auto degrees_of_freedom = static_cast<double>(count - 1);
    const double variance = std::max(smallest / degrees_of_freedom, 1e-24 * sorted.squaredNorm());
    const double away = sorted(step.suspects.front()) - centre;
    step.evidence = deleted_distance(away * away / std::max(variance, 1e-300) * static_cast<double>(count) /
                                         static_cast<double>(count + 1),
                                     1.0, degrees_of_freedom)
                        .evidence;
    for (Eigen::Index& s : step.suspects) s = order[static_cast<std::size_t>(s)];
  }
  return steps;
}

std::vector<Eigen::Index> nearest_specimens(const Eigen::VectorXd& ranking, Eigen::Index count) {
  std::vector<Eigen::Index> order(static_cast<std::size_t>(ranking.size()));
  std::iota(order.begin(), order.end(), Eigen::Index{0});
  std::stable_sort(order.begin(), order.end(), [&](Eigen::Index a, Eigen::Index b) { return ranking(a) < ranking(b); });
  order.resize(static_cast<std::size_t>(count));
  std::sort(order.begin(), order.end());
  return order;
}

}  // namespace mottle::stats
