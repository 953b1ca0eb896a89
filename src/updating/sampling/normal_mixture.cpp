#include "updating/sampling/normal_mixture.hpp"

#include <algorithm>
#include <boost/math/special_functions/gamma.hpp>
#include <cmath>
#include <limits>
#include <numbers>

#include "updating/estimate/normal_draws.hpp"

namespace mottle::updating {
namespace {

constexpr Eigen::Index k_max_fitted = 500;  // particles: more make the fit dearer, not the moves better
constexpr Eigen::Index k_first_components = 4;
constexpr double k_per_number = 10.0;           // particles for each number of the first components
constexpr Eigen::Index k_max_components = 64;   // each costs time at every proposal
constexpr Eigen::Index k_least_particles = 10;  // of a component, on average: its shape is mostly that of all
constexpr int k_sweeps = 12;
constexpr double k_inflation = 1.3;      // of variances: a proposal that is too narrow is worse than one too wide
constexpr double k_wide_weight = 0.1;    // of the last component
constexpr int k_degrees_of_freedom = 3;  // and of its t: the fewest with a variance
constexpr double k_smallest = 1e-12;     // of a variance's own, added to it

/// Weight, mean and covariance of a component.
double numbers_of_component(Eigen::Index dimension) {
  const auto d = static_cast<double>(dimension);
  return 1.0 + d + 0.5 * d * (d + 1.0);
}

Eigen::Index first_component_count(Eigen::Index particles, Eigen::Index dimension) {
  const auto affordable =
      static_cast<Eigen::Index>(static_cast<double>(particles) / (k_per_number * numbers_of_component(dimension)));
  return std::clamp<Eigen::Index>(affordable, 1, k_first_components);
}

/// Particles for each different one: copies, which follow each other, are one observation.
double copies_of(const Eigen::MatrixXd& points) {
  Eigen::Index different = 1;
  for (Eigen::Index row = 1; row < points.rows(); ++row) different += points.row(row) != points.row(row - 1) ? 1 : 0;
  return static_cast<double>(points.rows()) / static_cast<double>(different);
}

Eigen::MatrixXd covariance_of(const Eigen::MatrixXd& points, const Eigen::VectorXd& mean,
                              const Eigen::VectorXd& weights) {
  const Eigen::MatrixXd apart = points.rowwise() - mean.transpose();
  return apart.transpose() * weights.asDiagonal() * apart;
}

/// ln of the constant of a density of unit covariance or scale.
double log_constant(bool is_t, double dimension) {
  return is_t ? log_t_constant(k_degrees_of_freedom, dimension) : -0.5 * dimension * std::log(2.0 * std::numbers::pi);
}

double chi_squared(RandomStream& random, Eigen::Index degrees_of_freedom) {
  return standard_normals(random, degrees_of_freedom).squaredNorm();
}

/// Every so many of the particles that no more than k_max_fitted are left: neighbours have common ancestors.
Eigen::MatrixXd thinned(const Eigen::Ref<const Eigen::MatrixXd>& points) {
  const Eigen::Index stride = (points.rows() + k_max_fitted - 1) / k_max_fitted;
  Eigen::MatrixXd kept((points.rows() + stride - 1) / stride, points.cols());
  for (Eigen::Index row = 0; row < kept.rows(); ++row) kept.row(row) = points.row(row * stride);
  return kept;
}

}  // namespace

double log_t_constant(double degrees_of_freedom, double dimension) {
  return boost::math::lgamma(0.5 * (degrees_of_freedom + dimension)) - boost::math::lgamma(0.5 * degrees_of_freedom) -
         0.5 * dimension * std::log(degrees_of_freedom * std::numbers::pi);
}

NormalMixture::NormalMixture(const Eigen::Ref<const Eigen::MatrixXd>& points, RandomStream stream, Size size) {
  const Eigen::MatrixXd fitted = thinned(points);
  const Eigen::VectorXd equal = Eigen::VectorXd::Constant(points.rows(), 1.0 / static_cast<double>(points.rows()));
  mean_ = points.colwise().mean();
  covariance_ = covariance_of(points, mean_, equal);
  fit(fitted, stream, size);
  widen();
}

/// Twice as many components as long as Akaike's criterion is for them: many modes and bent ridges need many.
void NormalMixture::fit(const Eigen::MatrixXd& points, RandomStream& stream, Size size) {
  const Eigen::Index most = size.may_grow ? std::min(k_max_components, points.rows() / k_least_particles) : 0;
  const double price = copies_of(points) * numbers_of_component(points.cols());
  std::vector<Part> best;
  double best_criterion = -std::numeric_limits<double>::infinity();
  const Eigen::Index first =
      size.components > 0 ? size.components : first_component_count(points.rows(), points.cols());
  for (Eigen::Index count = first;; count *= 2) {
    start(points, count, stream);
    double criterion = 0.0;
    for (int sweep = 0; sweep < k_sweeps && (sweep == 0 || count > 1); ++sweep) {
      criterion = improve(points) - price * static_cast<double>(count);
    }
    if (!(criterion > best_criterion)) break;
    best = parts_;
    best_criterion = criterion;
    if (2 * count > most) break;
  }
  parts_ = std::move(best);
}

void NormalMixture::factorise(Part& part) const {
  // Particles on a line or plane, as duplicates of few are, have no factor: a little of the whole spread is added.
  double ridge = k_smallest;
  for (;;) {
    Eigen::MatrixXd covariance = part.covariance;
    covariance.diagonal() +=
        ridge * (part.covariance.diagonal() + k_smallest * Eigen::VectorXd::Ones(part.mean.size()));
    const CholeskyFactor cholesky(covariance);
    ridge *= 100.0;
    if (!cholesky.is_positive_definite()) continue;
    part.factor = cholesky.lower();
    part.inverse = cholesky.solve_lower(Eigen::MatrixXd::Identity(part.mean.size(), part.mean.size()));
    part.log_scale = std::log(part.weight) - 0.5 * cholesky.log_determinant() +
                     log_constant(part.is_t, static_cast<double>(part.mean.size()));
    return;
  }
}

/// Means at particles, each drawn in proportion to its squared distance from those before it.
void NormalMixture::start(const Eigen::MatrixXd& points, Eigen::Index count, RandomStream& stream) {
  parts_.clear();
  Part part{.weight = 1.0 / static_cast<double>(count), .mean = mean_, .covariance = covariance_};
  if (count == 1) {
    factorise(part);
    parts_.push_back(std::move(part));
    return;
  }
  const Eigen::VectorXd scale = covariance_.diagonal().cwiseSqrt().cwiseMax(1e-300).cwiseInverse();
  Eigen::VectorXd distance = Eigen::VectorXd::Ones(points.rows());
  part.covariance /= static_cast<double>(count);
  for (Eigen::Index k = 0; k < count; ++k) {
    double rest = stream.uniform() * distance.sum();
    Eigen::Index chosen = 0;
    while (chosen + 1 < points.rows() && rest > distance(chosen)) rest -= distance(chosen++);
    part.mean = points.row(chosen);
    factorise(part);
    parts_.push_back(part);
    const Eigen::VectorXd apart =
        ((points.rowwise() - points.row(chosen)) * scale.asDiagonal()).rowwise().squaredNorm();
    distance = k == 0 ? apart : Eigen::VectorXd(distance.cwiseMin(apart));
  }
}

double NormalMixture::squared_distance(const Part& part, const Eigen::Ref<const Eigen::VectorXd>& x) const {
  double square = 0.0;
  for (Eigen::Index i = 0; i < x.size(); ++i) {
    double whitened = 0.0;
    for (Eigen::Index j = 0; j <= i; ++j) whitened += part.inverse(i, j) * (x(j) - part.mean(j));
    square += whitened * whitened;
  }
  return square;
}

double NormalMixture::log_parts(const Eigen::Ref<const Eigen::VectorXd>& x, std::vector<double>& values) const {
  constexpr double k_nu = k_degrees_of_freedom;
  double largest = -std::numeric_limits<double>::infinity();
  values.resize(parts_.size());
  for (std::size_t k = 0; k < parts_.size(); ++k) {
    const Part& part = parts_[k];
    const double square = squared_distance(part, x);
    values[k] = part.log_scale -
                0.5 * (part.is_t ? (k_nu + static_cast<double>(x.size())) * std::log1p(square / k_nu) : square);
    largest = std::max(largest, values[k]);
  }
  return largest;
}

/// One sweep; returns ln g of all points before it. All points at once: this is what a fit spends its time on.
double NormalMixture::improve(const Eigen::MatrixXd& points) {
  Eigen::ArrayXXd shares(points.rows(), components());
  for (Eigen::Index k = 0; k < components(); ++k) {
    const Part& part = parts_[static_cast<std::size_t>(k)];
    const Eigen::MatrixXd whitened = (points.rowwise() - part.mean.transpose()) * part.inverse.transpose();
    shares.col(k) = part.log_scale - 0.5 * whitened.rowwise().squaredNorm().array();
  }
  const Eigen::ArrayXd largest = shares.rowwise().maxCoeff();
  shares = (shares.colwise() - largest).exp();
  const Eigen::ArrayXd sums = shares.rowwise().sum();
  shares.colwise() /= sums;
  const double borrowed = static_cast<double>(points.cols()) + 2.0;  // particles' worth of the common shape
  Eigen::MatrixXd common = Eigen::MatrixXd::Zero(points.cols(), points.cols());
  for (Eigen::Index k = 0; k < components(); ++k) {
    Part& part = parts_[static_cast<std::size_t>(k)];
    const double count = shares.col(k).sum();
    part.weight = (count + 1.0) / static_cast<double>(points.rows() + components());
    if (count > 1e-6) part.mean = points.transpose() * shares.col(k).matrix() / count;
    part.covariance = covariance_of(points, part.mean, shares.col(k).matrix());
    common += part.covariance / static_cast<double>(points.rows());
  }
  for (Eigen::Index k = 0; k < components(); ++k) {
    Part& part = parts_[static_cast<std::size_t>(k)];
    part.covariance = (part.covariance + borrowed * common) / (shares.col(k).sum() + borrowed);
    factorise(part);
  }
  return (largest + sums.log()).sum();
}

void NormalMixture::widen() {
  for (Part& part : parts_) {
    part.weight *= 1.0 - k_wide_weight;
    part.covariance *= k_inflation;
    factorise(part);
  }
  parts_.push_back({.weight = k_wide_weight, .mean = mean_, .covariance = covariance_});
  parts_.back().is_t = true;
  factorise(parts_.back());
}

double NormalMixture::log_density(const Eigen::Ref<const Eigen::VectorXd>& x) const {
  std::vector<double> logs;
  const double largest = log_parts(x, logs);
  double sum = 0.0;
  for (const double value : logs) sum += std::exp(value - largest);
  return largest + std::log(sum);
}

Eigen::Index NormalMixture::component_of(const Eigen::Ref<const Eigen::VectorXd>& x, double uniform) const {
  std::vector<double> logs;
  const double largest = log_parts(x, logs);
  double sum = 0.0;
  for (double& value : logs) sum += value = std::exp(value - largest);
  double rest = uniform * sum;
  std::size_t chosen = 0;
  while (chosen + 1 < logs.size() && rest > logs[chosen]) rest -= logs[chosen++];
  return static_cast<Eigen::Index>(chosen);
}

Eigen::Index NormalMixture::draw_component(double uniform) const {
  std::size_t chosen = 0;
  while (chosen + 1 < parts_.size() && uniform > parts_[chosen].weight) uniform -= parts_[chosen++].weight;
  return static_cast<Eigen::Index>(chosen);
}

Eigen::VectorXd NormalMixture::draw(Eigen::Index component, RandomStream& random) const {
  const Part& part = parts_[static_cast<std::size_t>(component)];
  const Eigen::VectorXd spread = part.factor * standard_normals(random, part.mean.size());
  if (!part.is_t) return part.mean + spread;
  return part.mean + std::sqrt(k_degrees_of_freedom / chi_squared(random, k_degrees_of_freedom)) * spread;
}

Eigen::VectorXd NormalMixture::move(Eigen::Index component, const Eigen::Ref<const Eigen::VectorXd>& x,
                                    RandomStream& random, double step) const {
  const Part& part = parts_[static_cast<std::size_t>(component)];
  Eigen::VectorXd spread = part.factor * standard_normals(random, x.size());
  if (part.is_t) {
    spread *= std::sqrt((k_degrees_of_freedom + squared_distance(part, x)) /
                        chi_squared(random, k_degrees_of_freedom + x.size()));
  }
  return part.mean + std::sqrt(std::max(0.0, 1.0 - step * step)) * (x - part.mean) + step * spread;
}

}  // namespace mottle::updating
