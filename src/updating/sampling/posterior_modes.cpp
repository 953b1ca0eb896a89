#include "updating/sampling/posterior_modes.hpp"

#include <algorithm>
#include <limits>
#include <numeric>
#include <vector>

namespace mottle::updating {
namespace {

constexpr Eigen::Index k_max_linked = 2000;
constexpr std::size_t k_neighbours = 12;
constexpr double k_prominence = 2.0;  // of a peak, in ln density
constexpr double k_least = 0.01;      // probability of a mode

/// Draws [dimension x draw] in units of their standard deviations.
Eigen::MatrixXd standardised(const Eigen::Ref<const Eigen::MatrixXd>& points) {
  const Eigen::MatrixXd apart = points.rowwise() - points.colwise().mean();
  const Eigen::VectorXd deviation =
      (apart.colwise().squaredNorm() / static_cast<double>(points.rows())).cwiseSqrt().cwiseMax(1e-300);
  return (apart * deviation.cwiseInverse().asDiagonal()).transpose();
}

/// Links of each point with those nearest to it, in both directions.
std::vector<std::vector<Eigen::Index>> linked(const Eigen::MatrixXd& points) {
  std::vector<std::vector<Eigen::Index>> links(static_cast<std::size_t>(points.cols()));
  std::vector<Eigen::Index> order(links.size());
  const std::size_t count = std::min(k_neighbours + 1, order.size());
  for (Eigen::Index i = 0; i < points.cols(); ++i) {
    const Eigen::VectorXd distance = (points.colwise() - points.col(i)).colwise().squaredNorm();
    std::iota(order.begin(), order.end(), Eigen::Index{0});
    std::partial_sort(order.begin(), order.begin() + static_cast<std::ptrdiff_t>(count), order.end(),
                      [&](Eigen::Index a, Eigen::Index b) {
                        return distance(a) < distance(b) || (distance(a) == distance(b) && a < b);
                      });
    for (std::size_t k = 0; k < count; ++k) {
      if (order[k] == i) continue;
      links[static_cast<std::size_t>(i)].push_back(order[k]);
      links[static_cast<std::size_t>(order[k])].push_back(i);
    }
  }
  return links;
}

/// Peaks that grow together as the level of density sinks.
class Peaks {
 public:
  explicit Peaks(const Eigen::VectorXd& density)
      : density_(density), parent_(static_cast<std::size_t>(density.size())) {
    std::iota(parent_.begin(), parent_.end(), Eigen::Index{0});
  }
  /// The highest point of what `point` has grown together with.
  Eigen::Index peak_of(Eigen::Index point) const {
    while (parent_[static_cast<std::size_t>(point)] != point) point = parent_[static_cast<std::size_t>(point)];
    return point;
  }
  /// Joins the regions of two points that meet at `level`, the lower peak to the higher, unless both are prominent.
  void meet(Eigen::Index first, Eigen::Index second, double level) {
    Eigen::Index high = peak_of(first);
    Eigen::Index low = peak_of(second);
    if (high == low) return;
    if (is_lower(high, low)) std::swap(high, low);
    if (density_(low) - level < k_prominence) parent_[static_cast<std::size_t>(low)] = high;
  }

 private:
  bool is_lower(Eigen::Index a, Eigen::Index b) const {
    return density_(a) < density_(b) || (density_(a) == density_(b) && a > b);
  }
  const Eigen::VectorXd& density_;
  std::vector<Eigen::Index> parent_;
};

/// The peak of each linked point.
std::vector<Eigen::Index> climb(const Eigen::MatrixXd& points, const Eigen::VectorXd& density) {
  const std::vector<std::vector<Eigen::Index>> links = linked(points);
  std::vector<Eigen::Index> order(links.size());
  std::iota(order.begin(), order.end(), Eigen::Index{0});
  std::stable_sort(order.begin(), order.end(), [&](Eigen::Index a, Eigen::Index b) { return density(a) > density(b); });
  std::vector<bool> is_above(links.size(), false);
  Peaks peaks(density);
  for (const Eigen::Index i : order) {
    is_above[static_cast<std::size_t>(i)] = true;
    for (const Eigen::Index j : links[static_cast<std::size_t>(i)]) {
      if (is_above[static_cast<std::size_t>(j)]) peaks.meet(j, i, density(i));
    }
  }
  for (Eigen::Index& i : order) i = 0;
  for (std::size_t i = 0; i < order.size(); ++i) order[i] = peaks.peak_of(static_cast<Eigen::Index>(i));
  return order;
}

/// Modes numbered by their share, small ones left out: -1 [point].
std::vector<int> numbered(const std::vector<Eigen::Index>& peaks) {
  std::vector<std::size_t> count(peaks.size(), 0);
  for (const Eigen::Index peak : peaks) ++count[static_cast<std::size_t>(peak)];
  std::vector<std::size_t> order;
  for (std::size_t i = 0; i < count.size(); ++i) {
    if (static_cast<double>(count[i]) >= k_least * static_cast<double>(peaks.size())) order.push_back(i);
  }
  std::stable_sort(order.begin(), order.end(), [&](std::size_t a, std::size_t b) { return count[a] > count[b]; });
  std::vector<int> number(peaks.size(), -1);
  for (std::size_t k = 0; k < order.size(); ++k) number[order[k]] = static_cast<int>(k);
  std::vector<int> modes;
  for (const Eigen::Index peak : peaks) modes.push_back(number[static_cast<std::size_t>(peak)]);
  return modes;
}

}  // namespace

Eigen::VectorXi find_modes(const Eigen::Ref<const Eigen::MatrixXd>& points,
                           const Eigen::Ref<const Eigen::VectorXd>& log_density) {
  const Eigen::Index stride = (points.rows() + k_max_linked - 1) / k_max_linked;
  const Eigen::MatrixXd all = standardised(points);
  const Eigen::Index kept = (points.rows() + stride - 1) / stride;
  Eigen::MatrixXd linked_points(points.cols(), kept);
  Eigen::VectorXd density(kept);
  for (Eigen::Index k = 0; k < kept; ++k) {
    linked_points.col(k) = all.col(k * stride);
    density(k) = log_density(k * stride);
  }
  const std::vector<int> modes = numbered(climb(linked_points, density));
  Eigen::VectorXi found = Eigen::VectorXi::Zero(points.rows());
  if (*std::max_element(modes.begin(), modes.end()) <= 0) return found;
  for (Eigen::Index i = 0; i < points.rows(); ++i) {
    double nearest = std::numeric_limits<double>::infinity();
    for (Eigen::Index k = 0; k < kept; ++k) {
      if (modes[static_cast<std::size_t>(k)] < 0) continue;
      const double distance = (linked_points.col(k) - all.col(i)).squaredNorm();
      if (distance < nearest) {
        nearest = distance;
        found(i) = modes[static_cast<std::size_t>(k)];
      }
    }
  }
  return found;
}

}  // namespace mottle::updating
