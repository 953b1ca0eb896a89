#include "mottle/stats/moments/wasserstein.hpp"

#include <algorithm>
#include <cmath>

#include "mottle/core/error.hpp"
#include "mottle/stats/distributions/standard_normal.hpp"

namespace mottle::stats {
namespace {

Eigen::VectorXd sorted(Eigen::VectorXd values) {
  std::sort(values.begin(), values.end());
  return values;
}

/// Calls visit(i, j, length) for the pieces of (0, 1) on which the i-th of `n` and the j-th of `m` equal parts meet.
/// Borders are counted in units of 1 / (n m), so that they agree exactly.
template <typename Visit>
void for_each_piece(Eigen::Index n, Eigen::Index m, const Visit& visit) {
  const double unit = 1.0 / (static_cast<double>(n) * static_cast<double>(m));
  Eigen::Index i = 0;
  Eigen::Index j = 0;
  for (Eigen::Index at = 0; i < n && j < m;) {
    const Eigen::Index next = std::min((i + 1) * m, (j + 1) * n);
    visit(i, j, static_cast<double>(next - at) * unit);
    at = next;
    if (at == (i + 1) * m) ++i;
    if (at == (j + 1) * n) ++j;
  }
}

}  // namespace

double wasserstein_distance(const Eigen::Ref<const Eigen::VectorXd>& first,
                            const Eigen::Ref<const Eigen::VectorXd>& second, int order) {
  require(first.size() >= 1 && second.size() >= 1, "Wasserstein distance: {} and {} values, need at least 1 of each",
          first.size(), second.size());
  require(order == 1 || order == 2, "Wasserstein distance: order {}, need 1 or 2", order);
  const Eigen::VectorXd x = sorted(first);
  const Eigen::VectorXd y = sorted(second);
  double sum = 0.0;
  for_each_piece(x.size(), y.size(), [&](Eigen::Index i, Eigen::Index j, double length) {
    const double difference = std::abs(x(i) - y(j));
    sum += length * (order == 1 ? difference : difference * difference);
  });
  return order == 1 ? sum : std::sqrt(sum);
}

Eigen::VectorXd quantile_means(const Eigen::Ref<const Eigen::VectorXd>& values, Eigen::Index cells) {
  const Eigen::VectorXd x = sorted(values);
  Eigen::VectorXd means = Eigen::VectorXd::Zero(cells);
  for_each_piece(x.size(), cells, [&](Eigen::Index i, Eigen::Index j, double length) { means(j) += length * x(i); });
  return means * static_cast<double>(cells);
}

Eigen::MatrixXd random_directions(Eigen::Index count, Eigen::Index dimension, const StreamKey& key) {
  Eigen::MatrixXd directions(count, dimension);
  for (Eigen::Index i = 0; i < count; ++i) {
    RandomStream stream(key, static_cast<std::uint32_t>(i));
    for (double& entry : directions.row(i)) entry = standard_normal_quantile(stream.uniform());
    directions.row(i).normalize();
  }
  return directions;
}

double sliced_wasserstein_distance(const Eigen::Ref<const Eigen::MatrixXd>& first,
                                   const Eigen::Ref<const Eigen::MatrixXd>& second,
                                   const Eigen::Ref<const Eigen::MatrixXd>& directions) {
  require(directions.rows() >= 1, "sliced Wasserstein distance: no direction");
  double sum = 0.0;
  for (Eigen::Index k = 0; k < directions.rows(); ++k) {
    const double distance =
        wasserstein_distance(first * directions.row(k).transpose(), second * directions.row(k).transpose(), 2);
    sum += distance * distance;
  }
  return std::sqrt(sum / static_cast<double>(directions.rows()));
}

}  // namespace mottle::stats
