#include "mottle/updating/estimate/mixture_population.hpp"

#include <algorithm>
#include <cmath>
#include <limits>
#include <numbers>

#include "mottle/core/error.hpp"
#include "mottle/stats/distributions/standard_normal.hpp"
#include "mottle/updating/estimate/normal_estimates.hpp"

namespace mottle::updating {
namespace {

/// A batch as a pair of parameters sees it, on their scales.
struct PairBatch {
  double weight = 0.0;
  Eigen::Vector2d mean;
  Eigen::Vector2d std;
  double correlation = 0.0;

  /// Square of the distance of a point in standard deviations.
  double square(const Eigen::Vector2d& point) const {
    const Eigen::Array2d z = (point - mean).array() / std.array();
    const double rest = std::max(1.0 - correlation * correlation, 1e-12);
    return (z(0) * z(0) - 2.0 * correlation * z(0) * z(1) + z(1) * z(1)) / rest;
  }
  Eigen::Vector2d at(double radius, double angle) const {
    const double u = radius * std::cos(angle);
    const double v =
        correlation * u + std::sqrt(std::max(0.0, 1.0 - correlation * correlation)) * radius * std::sin(angle);
    return {mean(0) + std(0) * u, mean(1) + std(1) * v};
  }
};

/// Probability of the union of the ellipses of one reach, by points of equal probability of each batch.
double covered(const std::vector<PairBatch>& batches, double reach) {
  constexpr int k_radii = 48;
  constexpr int k_angles = 32;
  double sum = 0.0;
  for (const PairBatch& own : batches) {
    int inside = 0;
    for (int r = 0; r < k_radii; ++r) {
      const double radius = reach_of_pair((r + 0.5) / k_radii);
      for (int a = 0; a < k_angles; ++a) {
        const Eigen::Vector2d point = own.at(radius, 2.0 * std::numbers::pi * (a + 0.5 * (r % 2)) / k_angles);
        inside += std::any_of(batches.begin(), batches.end(),
                              [&](const PairBatch& other) { return other.square(point) <= reach * reach; })
                      ? 1
                      : 0;
      }
    }
    sum += own.weight * inside / static_cast<double>(k_radii * k_angles);
  }
  return sum;
}

/// The reach at which that is `probability`: no more than that of one batch alone.
double reach_of(const std::vector<PairBatch>& batches, double probability) {
  double high = reach_of_pair(probability);
  if (batches.size() == 1) return high;
  double low = 0.0;
  for (int step = 0; step < 12; ++step) {
    const double middle = 0.5 * (low + high);
    (covered(batches, middle) < probability ? low : high) = middle;
  }
  return high;
}

}  // namespace

MixturePopulation::MixturePopulation(std::vector<ParameterTransform> scales, std::vector<BatchOnScales> batches)
    : scales_(std::move(scales)), batches_(std::move(batches)) {
  require(!batches_.empty(), "a mixture of populations needs at least one batch");
  const auto q = static_cast<Eigen::Index>(scales_.size());
  mean_ = Eigen::VectorXd::Zero(q);
  covariance_ = Eigen::MatrixXd::Zero(q, q);
  for (const BatchOnScales& batch : batches_) {
    distributions_.push_back(JointDistribution::transformed_normal(scales_, batch.mean, batch.covariance));
    mean_ += batch.weight * distributions_.back().mean();
  }
  for (std::size_t k = 0; k < batches_.size(); ++k) {
    const Eigen::VectorXd beside = distributions_[k].mean() - mean_;
    covariance_ += batches_[k].weight * (distributions_[k].covariance() + beside * beside.transpose());
  }
  covariance_ = (0.5 * (covariance_ + covariance_.transpose())).eval();
}

TransformedMoments MixturePopulation::moments(const BatchOnScales& batch, Eigen::Index parameter) const {
  return {batch.mean(parameter), std::sqrt(std::max(batch.covariance(parameter, parameter), 0.0))};
}

Eigen::MatrixXd MixturePopulation::from_uniform(const Eigen::Ref<const Eigen::MatrixXd>& uniforms) const {
  constexpr double k_end = std::numeric_limits<double>::epsilon();
  Eigen::MatrixXd samples(uniforms.rows(), uniforms.cols());
  std::vector<std::vector<Eigen::Index>> rows(batches_.size());
  Eigen::MatrixXd own = uniforms;
  for (Eigen::Index s = 0; s < own.rows(); ++s) {
    std::size_t k = 0;
    double place = own(s, 0);
    while (k + 1 < batches_.size() && place > batches_[k].weight) place -= batches_[k++].weight;
    own(s, 0) = std::clamp(place / batches_[k].weight, k_end, 1.0 - k_end);
    rows[k].push_back(s);
  }
  for (std::size_t k = 0; k < batches_.size(); ++k) {
    if (!rows[k].empty()) samples(rows[k], Eigen::all) = distributions_[k].from_uniform(own(rows[k], Eigen::all));
  }
  return samples;
}

Eigen::VectorXd MixturePopulation::density(Eigen::Index parameter,
                                           const Eigen::Ref<const Eigen::VectorXd>& points) const {
  const ParameterTransform& scale = scales_[static_cast<std::size_t>(parameter)];
  return points.unaryExpr([&](double x) {
    double sum = 0.0;
    for (const BatchOnScales& batch : batches_) {
      sum += batch.weight * density_of_variable(scale, moments(batch, parameter), x);
    }
    return sum;
  });
}

Eigen::VectorXd MixturePopulation::density_points(Eigen::Index parameter, Eigen::Index count) const {
  constexpr double k_reach = 4.0;
  const ParameterTransform& scale = scales_[static_cast<std::size_t>(parameter)];
  std::vector<double> points;
  const auto batches = static_cast<Eigen::Index>(batches_.size());
  for (Eigen::Index k = 0; k < batches; ++k) {
    const TransformedMoments own = moments(batches_[static_cast<std::size_t>(k)], parameter);
    if (!(own.std > 0.0) || !std::isfinite(own.std)) return {};
    // A batch's curve has the same shape whatever its width: points are shared out evenly.
    const Eigen::Index share = count * (k + 1) / batches - count * k / batches;
    for (const double x : points_of_variable(scale, own, k_reach, share)) points.push_back(x);
  }
  std::sort(points.begin(), points.end());
  return Eigen::Map<const Eigen::VectorXd>(points.data(), static_cast<Eigen::Index>(points.size()));
}

double MixturePopulation::quantile(Eigen::Index parameter, double probability) const {
  constexpr int k_halvings = 200;
  double low = std::numeric_limits<double>::infinity();
  double high = -low;
  for (const BatchOnScales& batch : batches_) {
    const TransformedMoments own = moments(batch, parameter);
    const double end = own.mean + own.std * standard_normal_quantile(probability);
    low = std::min(low, end);
    high = std::max(high, end);
  }
  for (int step = 0; step < k_halvings; ++step) {
    const double middle = 0.5 * (low + high);
    if (!(middle > low && middle < high)) break;
    double below = 0.0;
    for (const BatchOnScales& batch : batches_) {
      const TransformedMoments own = moments(batch, parameter);
      const double z = own.std > 0.0 ? (middle - own.mean) / own.std : (middle < own.mean ? -40.0 : 40.0);
      below += batch.weight * 0.5 * std::erfc(-z / std::numbers::sqrt2);
    }
    (below < probability ? low : high) = middle;
  }
  return scales_[static_cast<std::size_t>(parameter)].to_variable(0.5 * (low + high));
}

std::vector<Eigen::MatrixXd> MixturePopulation::region(Eigen::Index first, Eigen::Index second, double probability,
                                                       Eigen::Index points) const {
  std::vector<PairBatch> pairs;
  for (const BatchOnScales& batch : batches_) {
    const TransformedMoments a = moments(batch, first);
    const TransformedMoments b = moments(batch, second);
    if (!(a.std > 0.0) || !(b.std > 0.0)) return {};
    pairs.push_back({batch.weight,
                     {a.mean, b.mean},
                     {a.std, b.std},
                     std::clamp(batch.covariance(first, second) / a.std / b.std, -1.0, 1.0)});
  }
  const double reach = reach_of(pairs, probability);
  std::vector<Eigen::MatrixXd> outlines;
  for (const PairBatch& own : pairs) {
    const TransformedPair pair{{scales_[static_cast<std::size_t>(first)], {own.mean(0), own.std(0)}},
                               {scales_[static_cast<std::size_t>(second)], {own.mean(1), own.std(1)}}};
    outlines.push_back(pair_outline(pair, own.correlation, reach, points));
  }
  return outlines;
}

std::string MixturePopulation::prediction_note() const {
  return "Prediction: batches and their shares are taken as known; that they are estimated is not in the predicted "
         "intervals.";
}

Eigen::Index MixtureFindings::batch_of(Eigen::Index specimen) const {
  const Eigen::Index last = probabilities.cols() - 1;
  if (probabilities(specimen, last) > k_outlying) return -1;
  Eigen::Index place = 0;
  probabilities.row(specimen).head(last).maxCoeff(&place);
  return place;
}

}  // namespace mottle::updating
