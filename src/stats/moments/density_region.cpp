#include "mottle/stats/moments/density_region.hpp"

#include <algorithm>
#include <array>
#include <boost/math/special_functions/digamma.hpp>
#include <cmath>
#include <numbers>
#include <numeric>

namespace mottle::stats {
namespace {

constexpr Eigen::Index k_max_nodes = 160;  // of an axis
constexpr double k_kernel_reach = 3.0;

/// Axes on which the points have mean 0 and covariance I.
struct WhiteAxes {
  Eigen::Vector2d mean;
  Eigen::Matrix2d root;  // lower triangle; points = mean + root * white

  WhiteAxes(const Eigen::Ref<const Eigen::MatrixXd>& points, const Eigen::Ref<const Eigen::VectorXd>& weights) {
    mean = points.transpose() * weights;
    const Eigen::MatrixXd apart = points.rowwise() - mean.transpose();
    const Eigen::Matrix2d c = apart.transpose() * weights.asDiagonal() * apart;
    const double first = std::sqrt(c(0, 0));
    root << first, 0.0, c(1, 0) / first, std::sqrt(std::max(c(1, 1) - c(1, 0) * c(1, 0) / c(0, 0), 0.0));
    constexpr double k_min_width = 1e-6;  // of what is not explained by the other: points on a line
    has_area = first > 0.0 && root(1, 1) > k_min_width * std::sqrt(c(1, 1));
  }
  Eigen::MatrixXd white(const Eigen::Ref<const Eigen::MatrixXd>& points) const {
    Eigen::MatrixXd z = points.rowwise() - mean.transpose();
    z.col(0) /= root(0, 0);
    z.col(1) = (z.col(1) - root(1, 0) * z.col(0)) / root(1, 1);
    return z;
  }
  bool has_area = false;
};

/// Systematically chosen points of equal weight.
Eigen::MatrixXd some_of(const Eigen::MatrixXd& points, const Eigen::Ref<const Eigen::VectorXd>& weights) {
  constexpr Eigen::Index k_most = 500;
  const Eigen::Index count = std::min(k_most, points.rows());
  Eigen::MatrixXd some(count, 2);
  double sum = weights(0);
  for (Eigen::Index i = 0, at = 0; i < count; ++i) {
    const double place = (static_cast<double>(i) + 0.5) / static_cast<double>(count);
    while (sum < place && at + 1 < points.rows()) sum += weights(++at);
    some.row(i) = points.row(at);
  }
  return some;
}

/// exp((H - H_normal) / d) of points of covariance I in d = 1 or 2 dimensions, at most 1.
double narrowness(const Eigen::Ref<const Eigen::MatrixXd>& points) {
  constexpr Eigen::Index k_neighbour = 8;
  constexpr double k_least = 0.01;
  const Eigen::Index n = points.rows();
  const auto d = static_cast<double>(points.cols());
  if (n <= k_neighbour) return 1.0;
  double logs = 0.0;
  for (Eigen::Index i = 0; i < n; ++i) {
    Eigen::VectorXd squares = (points.rowwise() - points.row(i)).rowwise().squaredNorm();
    std::nth_element(squares.begin(), squares.begin() + k_neighbour, squares.end());
    logs += 0.5 * std::log(std::max(squares(k_neighbour), 1e-12));
  }
  const double unit_ball = points.cols() == 1 ? 2.0 : std::numbers::pi;
  const double entropy = boost::math::digamma(static_cast<double>(n)) - boost::math::digamma(double{k_neighbour}) +
                         std::log(unit_ball) + d * logs / static_cast<double>(n);
  const double of_normal = 0.5 * d * (1.0 + std::log(2.0 * std::numbers::pi));
  return std::clamp(std::exp((entropy - of_normal) / d), k_least, 1.0);
}

/// Bandwidths of both axes.
Eigen::Vector2d bandwidths(const Eigen::MatrixXd& points, double effective) {
  const Eigen::Vector2d own(narrowness(points.col(0)), narrowness(points.col(1)));
  const double common = std::min(narrowness(points) / std::sqrt(own.prod()), 1.0);
  return std::pow(effective, -1.0 / 6.0) * common * own;
}

/// Density on a grid whose border is empty.
struct DensityGrid {
  Eigen::Vector2d origin, step;
  Eigen::MatrixXd density;  // [node along the first axis x node along the second]

  DensityGrid(const Eigen::MatrixXd& points, const Eigen::Ref<const Eigen::VectorXd>& weights,
              const Eigen::Vector2d& width) {
    Eigen::Vector2i nodes;
    for (Eigen::Index axis = 0; axis < 2; ++axis) {
      const double margin = (k_kernel_reach + 1.0) * width(axis);
      origin(axis) = points.col(axis).minCoeff() - margin;
      const double range = points.col(axis).maxCoeff() + margin - origin(axis);
      nodes(axis) = static_cast<int>(std::min(std::ceil(2.0 * range / width(axis)) + 2.0, double{k_max_nodes}));
      step(axis) = range / static_cast<double>(nodes(axis) - 1);
    }
    density = Eigen::MatrixXd::Zero(nodes(0), nodes(1));
    for (Eigen::Index i = 0; i < points.rows(); ++i) {
      const auto [x, y, a, b] = place_of(points.row(i));
      density(x, y) += weights(i) * (1.0 - a) * (1.0 - b);
      density(x + 1, y) += weights(i) * a * (1.0 - b);
      density(x, y + 1) += weights(i) * (1.0 - a) * b;
      density(x + 1, y + 1) += weights(i) * a * b;
    }
    density = smoother(nodes(0), step(0), width(0)) * density * smoother(nodes(1), step(1), width(1));
    density.row(0).setZero();
    density.bottomRows(1).setZero();
    density.col(0).setZero();
    density.rightCols(1).setZero();
  }
  double at(const Eigen::RowVector2d& point) const {
    const auto [x, y, a, b] = place_of(point);
    return (1.0 - b) * ((1.0 - a) * density(x, y) + a * density(x + 1, y)) +
           b * ((1.0 - a) * density(x, y + 1) + a * density(x + 1, y + 1));
  }
  /// Where a level lies between two neighbouring nodes.
  Eigen::Vector2d crossing(Eigen::Vector2i from, Eigen::Vector2i to, double level) const {
    const double a = density(from(0), from(1));
    const double b = density(to(0), to(1));
    const Eigen::Vector2d node = from.cast<double>() + (level - a) / (b - a) * (to - from).cast<double>();
    return origin + node.cwiseProduct(step);
  }

 private:
  struct Place {
    Eigen::Index x, y;
    double a, b;
  };
  Place place_of(const Eigen::RowVector2d& point) const {
    const double x = (point(0) - origin(0)) / step(0);
    const double y = (point(1) - origin(1)) / step(1);
    return {static_cast<Eigen::Index>(x), static_cast<Eigen::Index>(y), x - std::floor(x), y - std::floor(y)};
  }
  /// Normal kernels between the nodes of an axis, cut at their reach.
  static Eigen::MatrixXd smoother(Eigen::Index nodes, double step, double width) {
    Eigen::MatrixXd kernels = Eigen::MatrixXd::Zero(nodes, nodes);
    for (Eigen::Index i = 0; i < nodes; ++i) {
      for (Eigen::Index j = 0; j < nodes; ++j) {
        const double z = static_cast<double>(i - j) * step / width;
        if (std::abs(z) <= k_kernel_reach) kernels(i, j) = std::exp(-0.5 * z * z);
      }
    }
    return kernels;
  }
};

/// Level that `probability` of the points are above.
double level_of(const DensityGrid& grid, const Eigen::MatrixXd& points,
                const Eigen::Ref<const Eigen::VectorXd>& weights, double probability) {
  std::vector<std::pair<double, double>> heights;
  for (Eigen::Index i = 0; i < points.rows(); ++i) heights.emplace_back(grid.at(points.row(i)), weights(i));
  std::sort(heights.begin(), heights.end());
  double below = 0.0;
  for (const auto& [height, weight] : heights) {
    below += weight;
    if (below >= 1.0 - probability) return height;
  }
  return heights.back().first;
}

/// Loops along which the density has the level, by marching squares: each crossed edge between nodes is followed by
/// the one that it shares a cell with.
class Contours {
 public:
  Contours(const DensityGrid& grid, double level) : grid_(grid), level_(level), columns_(grid.density.rows()) {
    next_.resize(static_cast<std::size_t>(2 * grid.density.size()), {-1, -1});
    for (Eigen::Index y = 0; y + 1 < grid.density.cols(); ++y) {
      for (Eigen::Index x = 0; x + 1 < columns_; ++x) add_cell(x, y);
    }
  }
  std::vector<Eigen::MatrixXd> loops() {
    std::vector<Eigen::MatrixXd> found;
    for (Eigen::Index edge = 0; edge < static_cast<Eigen::Index>(next_.size()); ++edge) {
      std::vector<Eigen::Vector2d> loop;
      for (Eigen::Index at = edge; at >= 0 && is_open(at);) {
        loop.push_back(point_on(at));
        const std::array<Eigen::Index, 2> both = std::exchange(next_[static_cast<std::size_t>(at)], {-1, -1});
        at = is_open(both[0]) ? both[0] : both[1];
      }
      if (loop.size() < 3) continue;
      loop.push_back(loop.front());
      Eigen::MatrixXd outline(static_cast<Eigen::Index>(loop.size()), 2);
      for (std::size_t k = 0; k < loop.size(); ++k) outline.row(static_cast<Eigen::Index>(k)) = loop[k].transpose();
      found.push_back(std::move(outline));
    }
    return found;
  }

 private:
  bool is_open(Eigen::Index edge) const { return next_[static_cast<std::size_t>(edge)][0] >= 0; }
  bool is_high(Eigen::Index x, Eigen::Index y) const { return grid_.density(x, y) > level_; }
  /// From node (x, y) along the first axis (way 0) or the second.
  Eigen::Index edge(Eigen::Index x, Eigen::Index y, Eigen::Index way) const { return 2 * (y * columns_ + x) + way; }
  Eigen::Vector2d point_on(Eigen::Index edge) const {
    const Eigen::Vector2i node(static_cast<int>(edge / 2 % columns_), static_cast<int>(edge / 2 / columns_));
    const Eigen::Vector2i other = node + (edge % 2 == 0 ? Eigen::Vector2i(1, 0) : Eigen::Vector2i(0, 1));
    return grid_.crossing(node, other, level_);
  }
  void link(Eigen::Index a, Eigen::Index b) {
    for (const auto& [from, to] : {std::pair(a, b), std::pair(b, a)}) {
      auto& both = next_[static_cast<std::size_t>(from)];
      (both[0] < 0 ? both[0] : both[1]) = to;
    }
  }
  void add_cell(Eigen::Index x, Eigen::Index y) {
    const std::array<bool, 4> high{is_high(x, y), is_high(x + 1, y), is_high(x + 1, y + 1), is_high(x, y + 1)};
    const std::array<Eigen::Index, 4> edges{edge(x, y, 0), edge(x + 1, y, 1), edge(x, y + 1, 0), edge(x, y, 1)};
    std::vector<Eigen::Index> crossed;
    for (std::size_t k = 0; k < 4; ++k) {
      if (high[k] != high[(k + 1) % 4]) crossed.push_back(edges[k]);
    }
    if (crossed.size() == 2) link(crossed[0], crossed[1]);
    if (crossed.size() != 4) return;
    // A saddle: the high corners are joined where the middle is high.
    const bool is_joined = (grid_.density(x, y) + grid_.density(x + 1, y) + grid_.density(x, y + 1) +
                            grid_.density(x + 1, y + 1)) > 4.0 * level_;
    const std::size_t shift = is_joined == high[0] ? 0 : 1;
    link(crossed[shift], crossed[shift + 1]);
    link(crossed[(shift + 2) % 4], crossed[(shift + 3) % 4]);
  }

  const DensityGrid& grid_;
  double level_;
  Eigen::Index columns_;
  std::vector<std::array<Eigen::Index, 2>> next_;
};

double area_of(const Eigen::MatrixXd& outline) {
  double twice = 0.0;
  for (Eigen::Index k = 0; k + 1 < outline.rows(); ++k) {
    twice += outline(k, 0) * outline(k + 1, 1) - outline(k + 1, 0) * outline(k, 1);
  }
  return 0.5 * std::abs(twice);
}

}  // namespace

std::vector<Eigen::MatrixXd> highest_density_outlines(const Eigen::Ref<const Eigen::MatrixXd>& points,
                                                      const Eigen::Ref<const Eigen::VectorXd>& weights,
                                                      double effective, double probability) {
  const WhiteAxes axes(points, weights);
  if (!axes.has_area) return {};
  const Eigen::MatrixXd white = axes.white(points);
  const Eigen::Vector2d width = bandwidths(some_of(white, weights), effective);
  const DensityGrid grid(white, weights, width);
  std::vector<Eigen::MatrixXd> outlines = Contours(grid, level_of(grid, white, weights, probability)).loops();
  const double least_area = 2.0 * std::numbers::pi * width.prod();
  std::erase_if(outlines, [&](const Eigen::MatrixXd& outline) { return area_of(outline) < least_area; });
  for (Eigen::MatrixXd& outline : outlines) {
    outline = ((outline * axes.root.transpose()).rowwise() + axes.mean.transpose()).eval();
  }
  return outlines;
}

}  // namespace mottle::stats
