#include "mottle/updating/estimate/sample_estimate.hpp"

#include <algorithm>
#include <cmath>
#include <numbers>
#include <numeric>

#include "mottle/core/error.hpp"
#include "mottle/stats/moments/density_region.hpp"
#include "mottle/updating/estimate/normal_estimates.hpp"

namespace mottle::updating {
namespace {

constexpr double k_kernel_reach = 4.0;  // in bandwidths
constexpr double k_tail = 1e-4;         // of the weight on each side, beyond which a density is not drawn

Eigen::VectorXd weighted_mean(const Eigen::MatrixXd& samples, const Eigen::VectorXd& weights) {
  return samples.transpose() * weights;
}

Eigen::MatrixXd weighted_covariance(const Eigen::MatrixXd& samples, const Eigen::VectorXd& weights) {
  const Eigen::MatrixXd apart = samples.rowwise() - weighted_mean(samples, weights).transpose();
  // No factor 1 / (1 - sum w^2): where one sample has nearly all weight it would make a wide scatter of rounding.
  const Eigen::MatrixXd spread = apart.transpose() * weights.asDiagonal() * apart;
  return 0.5 * (spread + spread.transpose());
}

Eigen::VectorXd normalised(const Eigen::VectorXd& weights, Eigen::Index samples) {
  if (weights.size() == 0) return Eigen::VectorXd::Constant(samples, 1.0 / static_cast<double>(samples));
  require(weights.size() == samples, "weights: {} of {} samples", weights.size(), samples);
  require(weights.allFinite() && weights.minCoeff() >= 0.0 && weights.maxCoeff() > 0.0,
          "weights: must be finite, not negative and not all zero");
  return weights / weights.sum();
}

/// At most `count` rows, the first and the last among them.
Eigen::MatrixXd some_rows(const Eigen::MatrixXd& all, Eigen::Index count) {
  if (all.rows() <= count) return all;
  Eigen::MatrixXd some(count, all.cols());
  for (Eigen::Index k = 0; k < count; ++k) some.row(k) = all.row(k * (all.rows() - 1) / (count - 1));
  return some;
}

}  // namespace

double weighted_quantile(const Eigen::Ref<const Eigen::VectorXd>& values,
                         const Eigen::Ref<const Eigen::VectorXd>& weights, double probability) {
  std::vector<Eigen::Index> order(static_cast<std::size_t>(values.size()));
  std::iota(order.begin(), order.end(), Eigen::Index{0});
  std::stable_sort(order.begin(), order.end(), [&](Eigen::Index a, Eigen::Index b) { return values(a) < values(b); });
  double below = 0.0;
  double last_place = 0.0;
  double last_value = 0.0;
  bool is_first = true;
  for (const Eigen::Index k : order) {
    if (!(weights(k) > 0.0)) continue;
    const double place = below + 0.5 * weights(k);
    if (place >= probability) {
      if (is_first) return values(k);
      return last_value + (values(k) - last_value) * (probability - last_place) / (place - last_place);
    }
    below += weights(k);
    last_place = place;
    last_value = values(k);
    is_first = false;
  }
  return last_value;
}

SampleEstimate::SampleEstimate(std::vector<ParameterTransform> scales, Eigen::MatrixXd samples,
                               const Eigen::VectorXd& weights, std::optional<double> log_evidence,
                               std::optional<double> effective)
    : scales_(std::move(scales)), samples_(std::move(samples)), log_evidence_(log_evidence) {
  require(samples_.rows() > 0, "samples: there is none");
  require(static_cast<Eigen::Index>(scales_.size()) == samples_.cols(), "{} scales for {} parameters", scales_.size(),
          samples_.cols());
  require(samples_.allFinite(), "samples: an entry is not finite");
  weights_ = normalised(weights, samples_.rows());
  effective_ = std::min(effective.value_or(1.0 / weights_.squaredNorm()), 1.0 / weights_.squaredNorm());
  scaled_ = from_variables(scales_, samples_);
  require(scaled_.allFinite(), "samples: an entry is outside its parameter's scale");
  cumulative_.resize(weights_.size());
  std::partial_sum(weights_.begin(), weights_.end(), cumulative_.begin());
  mean_ = weighted_mean(samples_, weights_);
  covariance_ = weighted_covariance(samples_, weights_);
  scaled_mean_ = weighted_mean(scaled_, weights_);
  scaled_covariance_ = weighted_covariance(scaled_, weights_);
}

Eigen::MatrixXd SampleEstimate::from_uniform(const Eigen::Ref<const Eigen::MatrixXd>& uniforms) const {
  require(uniforms.cols() == samples_.cols(), "uniforms: {} columns for {} parameters", uniforms.cols(),
          samples_.cols());
  Eigen::MatrixXd drawn(uniforms.rows(), samples_.cols());
  const double total = cumulative_(cumulative_.size() - 1);  // 1 but for rounding
  for (Eigen::Index s = 0; s < drawn.rows(); ++s) {
    const auto found = std::upper_bound(cumulative_.begin(), cumulative_.end(), uniforms(s, 0) * total);
    const auto index = std::min<Eigen::Index>(std::distance(cumulative_.begin(), found), samples_.rows() - 1);
    drawn.row(s) = samples_.row(index);
  }
  return drawn;
}

double SampleEstimate::bandwidth(Eigen::Index parameter) const {
  constexpr double k_quartiles_of_normal = 1.34;  // between them, in deviations
  const Eigen::VectorXd values = scaled_.col(parameter);
  const double standard_deviation = std::sqrt(scaled_covariance_(parameter, parameter));
  const double quartiles = weighted_quantile(values, weights_, 0.75) - weighted_quantile(values, weights_, 0.25);
  // Where half of the weight is on one value the quartiles say nothing of the width.
  const double spread =
      quartiles > 0.0 ? std::min(standard_deviation, quartiles / k_quartiles_of_normal) : standard_deviation;
  return 0.9 * spread * std::pow(*effective_samples(), -0.2);
}

Eigen::VectorXd SampleEstimate::density(Eigen::Index parameter, const Eigen::Ref<const Eigen::VectorXd>& points) const {
  const ParameterTransform& scale = scales_[static_cast<std::size_t>(parameter)];
  const double width = bandwidth(parameter);
  Eigen::VectorXd density = Eigen::VectorXd::Zero(points.size());
  if (!(width > 0.0)) return density;
  for (Eigen::Index k = 0; k < points.size(); ++k) {
    const double t = scale.from_variable(points(k));
    if (!std::isfinite(t)) continue;
    const Eigen::ArrayXd z = (scaled_.col(parameter).array() - t) / width;
    const double kernels = (weights_.array() * (-0.5 * z.square()).exp()).sum();
    density(k) = kernels / (width * std::sqrt(2.0 * std::numbers::pi) * scale.slope(t));
  }
  return density;
}

Eigen::VectorXd SampleEstimate::density_points(Eigen::Index parameter, Eigen::Index count) const {
  const double width = bandwidth(parameter);
  if (!(width > 0.0)) return {};
  const Eigen::VectorXd values = scaled_.col(parameter);
  Eigen::VectorXd points =
      Eigen::VectorXd::LinSpaced(count, weighted_quantile(values, weights_, k_tail) - k_kernel_reach * width,
                                 weighted_quantile(values, weights_, 1.0 - k_tail) + k_kernel_reach * width);
  for (double& point : points) point = scales_[static_cast<std::size_t>(parameter)].to_variable(point);
  return points;
}

double SampleEstimate::quantile(Eigen::Index parameter, double probability) const {
  return weighted_quantile(samples_.col(parameter), weights_, probability);
}

std::vector<Eigen::MatrixXd> SampleEstimate::region(Eigen::Index first, Eigen::Index second, double probability,
                                                    Eigen::Index points) const {
  const double a = std::sqrt(scaled_covariance_(first, first));
  const double b = std::sqrt(scaled_covariance_(second, second));
  if (!(a > 0.0) || !(b > 0.0)) return {};
  const std::vector<Eigen::Index> both{first, second};
  std::vector<Eigen::MatrixXd> outlines =
      highest_density_outlines(scaled_(Eigen::all, both), weights_, *effective_samples(), probability);
  for (Eigen::MatrixXd& outline : outlines) {
    outline = some_rows(outline, points);
    for (Eigen::Index axis = 0; axis < 2; ++axis) {
      const ParameterTransform& scale = scales_[static_cast<std::size_t>(both[static_cast<std::size_t>(axis)])];
      for (double& value : outline.col(axis)) value = scale.to_variable(value);
    }
  }
  if (!outlines.empty()) return outlines;
  const double rho = std::clamp(scaled_covariance_(first, second) / (a * b), -1.0, 1.0);
  constexpr double k_min = 1e-12;  // samples on a line: the outline is the line
  const Eigen::ArrayXd u = (scaled_.col(first).array() - scaled_mean_(first)) / a;
  const Eigen::ArrayXd v = (scaled_.col(second).array() - scaled_mean_(second)) / b;
  const Eigen::VectorXd distance =
      (u.square() + (v - rho * u).square() / std::max(1.0 - rho * rho, k_min)).sqrt().matrix();
  const TransformedPair pair{{scales_[static_cast<std::size_t>(first)], {scaled_mean_(first), a}},
                             {scales_[static_cast<std::size_t>(second)], {scaled_mean_(second), b}}};
  return {pair_outline(pair, rho, weighted_quantile(distance, weights_, probability), points)};
}

std::string SampleEstimate::prediction_note() const {
  return "Prediction: draws from the posterior of one structure's parameters; the predicted intervals contain no "
         "scatter of specimens.";
}

}  // namespace mottle::updating
