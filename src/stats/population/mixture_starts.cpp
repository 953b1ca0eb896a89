#include "stats/population/mixture_starts.hpp"

#include <algorithm>
#include <cmath>
#include <limits>
#include <numeric>

#include "mottle/linalg/dense/decompositions.hpp"
#include "mottle/stats/distributions/standard_normal.hpp"

namespace mottle::stats {
namespace {

/// The indices of smallest values.
std::vector<Eigen::Index> smallest(const Eigen::VectorXd& values, std::size_t count) {
  std::vector<Eigen::Index> order(static_cast<std::size_t>(values.size()));
  std::iota(order.begin(), order.end(), 0);
  std::stable_sort(order.begin(), order.end(), [&](Eigen::Index i, Eigen::Index j) { return values(i) < values(j); });
  order.resize(std::min(count, order.size()));
  return order;
}

Eigen::VectorXd medians(const Eigen::MatrixXd& points, const std::vector<Eigen::Index>& rows) {
  Eigen::VectorXd median(points.cols());
  for (Eigen::Index i = 0; i < points.cols(); ++i) {
    std::vector<double> values;
    for (const Eigen::Index s : rows) values.push_back(points(s, i));
    const auto middle = values.begin() + static_cast<std::ptrdiff_t>(values.size() / 2);
    std::nth_element(values.begin(), middle, values.end());
    median(i) = *middle;
  }
  return median;
}

/// The share of a part's units that is nearest to its median; all of a small part.
std::vector<Eigen::Index> core_of(const Eigen::MatrixXd& points, const std::vector<Eigen::Index>& rows, double share) {
  constexpr std::size_t k_small = 6;
  if (rows.size() < k_small) return rows;
  const Eigen::VectorXd centre = medians(points, rows);
  Eigen::VectorXd distances(static_cast<Eigen::Index>(rows.size()));
  for (std::size_t r = 0; r < rows.size(); ++r) {
    distances(static_cast<Eigen::Index>(r)) = (points.row(rows[r]).transpose() - centre).squaredNorm();
  }
  std::vector<Eigen::Index> core;
  const auto count = static_cast<std::size_t>(std::ceil(share * static_cast<double>(rows.size())));
  for (const Eigen::Index r : smallest(distances, count)) core.push_back(rows[static_cast<std::size_t>(r)]);
  return core;
}

constexpr double k_core = 0.8;  // of a part's units

Eigen::MatrixXd start_of(const Eigen::MatrixXd& points, const std::vector<std::vector<Eigen::Index>>& parts) {
  Eigen::MatrixXd start = Eigen::MatrixXd::Zero(points.rows(), static_cast<Eigen::Index>(parts.size()));
  for (std::size_t k = 0; k < parts.size(); ++k) {
    for (const Eigen::Index s : core_of(points, parts[k], k_core)) start(s, static_cast<Eigen::Index>(k)) = 1.0;
  }
  return start;
}

/// A split of one component.
struct Split {
  double ratio = 0.0;
  std::size_t component = 0;
  std::vector<Eigen::Index> lower;
  std::vector<Eigen::Index> upper;
};

/// The split with the largest ratio along one direction, parts of `k_smallest_batch` at least.
Split best_split(const Eigen::VectorXd& values, const std::vector<Eigen::Index>& rows) {
  const std::vector<Eigen::Index> order = smallest(values, rows.size());
  const auto m = static_cast<Eigen::Index>(rows.size());
  const double mean = values.mean();
  const double all = (values.array() - mean).square().sum();
  Split best;
  double sum = 0.0;
  Eigen::Index at = 0;
  for (Eigen::Index i = 1; i <= m - k_smallest_batch; ++i) {
    sum += values(order[static_cast<std::size_t>(i - 1)]) - mean;
    if (i < k_smallest_batch) continue;
    const auto below = static_cast<double>(i);
    const double between = sum * sum * (1.0 / below + 1.0 / (static_cast<double>(m) - below));
    const double ratio = between / std::max(all - between, 1e-12 * all);
    if (ratio <= best.ratio) continue;
    best.ratio = ratio;
    at = i;
  }
  for (Eigen::Index i = 0; i < m && at > 0; ++i) {
    (i < at ? best.lower : best.upper).push_back(rows[static_cast<std::size_t>(order[static_cast<std::size_t>(i)])]);
  }
  return best;
}

/// Directions along which units are split: the axes, those of the component, and random ones [direction x effect].
Eigen::MatrixXd split_directions(const Eigen::MatrixXd& covariance, const StreamKey& key, std::size_t component) {
  constexpr Eigen::Index k_random_an_effect = 4;
  const Eigen::Index q = covariance.rows();
  const SymmetricEigen axes(covariance);
  const Eigen::VectorXd inverse =
      axes.eigenvalues().cwiseMax(1e-12 * axes.eigenvalues().maxCoeff()).cwiseSqrt().cwiseInverse();
  const Eigen::MatrixXd whitening = inverse.asDiagonal() * axes.eigenvectors().transpose();
  Eigen::MatrixXd directions(q * (2 + k_random_an_effect), q);
  directions.topRows(q).setIdentity();
  directions.middleRows(q, q) = whitening;
  RandomStream stream(key, static_cast<std::uint32_t>(1000000U + component));
  for (Eigen::Index r = 2 * q; r < directions.rows(); ++r) {
    Eigen::RowVectorXd random(q);
    for (double& value : random) value = standard_normal_quantile(stream.uniform());
    directions.row(r) = random * whitening;
  }
  return directions;
}

}  // namespace

std::vector<Eigen::MatrixXd> whole_starts(const Eigen::MatrixXd& points) {
  std::vector<Eigen::Index> rows(static_cast<std::size_t>(points.rows()));
  std::iota(rows.begin(), rows.end(), 0);
  constexpr double k_half = 0.5;
  Eigen::MatrixXd half = Eigen::MatrixXd::Zero(points.rows(), 1);
  for (const Eigen::Index s : core_of(points, rows, k_half)) half(s, 0) = 1.0;
  return {Eigen::MatrixXd::Ones(points.rows(), 1), half};
}

std::vector<Eigen::MatrixXd> split_starts(const Eigen::MatrixXd& points, const MixtureFit& fewer, int count,
                                          const StreamKey& key) {
  const std::size_t components = fewer.components.size();
  std::vector<std::vector<Eigen::Index>> parts(components);
  for (Eigen::Index s = 0; s < points.rows(); ++s) {
    parts[static_cast<std::size_t>(fewer.component_of(s))].push_back(s);
  }
  std::vector<Split> splits;
  for (std::size_t k = 0; k < components; ++k) {
    if (parts[k].size() < 2 * k_smallest_batch) continue;
    const Eigen::MatrixXd own = points(parts[k], Eigen::all);
    const Eigen::MatrixXd values = own * split_directions(fewer.components[k].covariance, key, k).transpose();
    for (Eigen::Index c = 0; c < values.cols(); ++c) {
      splits.push_back(best_split(values.col(c), parts[k]));
      splits.back().component = k;
    }
  }
  std::stable_sort(splits.begin(), splits.end(), [](const Split& a, const Split& b) { return a.ratio > b.ratio; });
  std::vector<Eigen::MatrixXd> starts;
  for (const Split& split : splits) {
    if (static_cast<int>(starts.size()) == count) break;
    if (split.lower.empty()) continue;
    auto next = parts;
    next[split.component] = split.lower;
    next.push_back(split.upper);
    Eigen::MatrixXd start = start_of(points, next);
    if (std::none_of(starts.begin(), starts.end(), [&](const Eigen::MatrixXd& old) { return old == start; })) {
      starts.push_back(std::move(start));
    }
  }
  return starts;
}

std::vector<Eigen::MatrixXd> random_starts(const Eigen::MatrixXd& points, int components, int count,
                                           const StreamKey& key) {
  constexpr int k_rounds = 4;
  std::vector<Eigen::MatrixXd> starts;
  for (int start = 0; start < count; ++start) {
    RandomStream stream(key, static_cast<std::uint32_t>(start));
    Eigen::MatrixXd centres(components, points.cols());
    // The next centre with a probability that grows with its squared distance from those before it.
    Eigen::VectorXd nearest = Eigen::VectorXd::Ones(points.rows());
    for (int k = 0; k < components; ++k) {
      double left = stream.uniform() * nearest.sum();
      Eigen::Index row = 0;
      while (row + 1 < points.rows() && left > nearest(row)) left -= nearest(row++);
      centres.row(k) = points.row(row);
      const Eigen::VectorXd own = (points.rowwise() - centres.row(k)).rowwise().squaredNorm();
      nearest = k == 0 ? own : Eigen::VectorXd(nearest.cwiseMin(own));
    }
    std::vector<std::vector<Eigen::Index>> parts;
    for (int round = 0; round < k_rounds; ++round) {
      parts.assign(static_cast<std::size_t>(components), {});
      for (Eigen::Index s = 0; s < points.rows(); ++s) {
        Eigen::Index place = 0;
        (centres.rowwise() - points.row(s)).rowwise().squaredNorm().minCoeff(&place);
        parts[static_cast<std::size_t>(place)].push_back(s);
      }
      for (std::size_t k = 0; k < parts.size(); ++k) {
        if (!parts[k].empty()) {
          centres.row(static_cast<Eigen::Index>(k)) = points(parts[k], Eigen::all).colwise().mean();
        }
      }
    }
    starts.push_back(start_of(points, parts));
  }
  return starts;
}

}  // namespace mottle::stats
