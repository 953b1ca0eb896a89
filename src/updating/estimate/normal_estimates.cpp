#include "mottle/updating/estimate/normal_estimates.hpp"

#include <algorithm>
#include <cmath>
#include <limits>
#include <numbers>

#include "mottle/stats/distributions/standard_normal.hpp"
#include "updating/estimate/normal_draws.hpp"

namespace mottle::updating {
namespace {

constexpr double k_reach = 4.0;  // of a drawn density, in deviations

bool has_width(const ScaleMoments& moments) {
  return moments.std > 0.0 && std::isfinite(moments.std);
}

Eigen::VectorXd densities_on_scale(const NormalScale& scale, const ScaleMoments& moments,
                                   const Eigen::Ref<const Eigen::VectorXd>& points) {
  return points.unaryExpr([&](double x) { return density_on_scale(scale, moments, x); });
}

ScaleMoments scale_moments(const PopulationOnScales& population, Eigen::Index parameter) {
  return {population.mean(parameter), std::sqrt(std::max(population.covariance(parameter, parameter), 0.0))};
}

std::vector<Eigen::MatrixXd> region_of_pair(const ScaledPair& pair, double correlation, double probability,
                                            Eigen::Index points) {
  if (!std::isfinite(correlation) || !has_width(pair.first_moments) || !has_width(pair.second_moments)) return {};
  return {pair_outline(pair, correlation, reach_of_pair(probability), points)};
}

}  // namespace

double reach_of_pair(double probability) {
  return std::sqrt(-2.0 * std::log1p(-probability));
}

Eigen::MatrixXd pair_outline(const ScaledPair& pair, double correlation, double reach, Eigen::Index points) {
  const double rest = std::sqrt(std::max(0.0, 1.0 - correlation * correlation));
  Eigen::MatrixXd outline(points, 2);
  for (Eigen::Index k = 0; k < points; ++k) {
    const double angle = 2.0 * std::numbers::pi * static_cast<double>(k) / static_cast<double>(points - 1);
    const double u = reach * std::cos(angle);
    const double v = reach * std::sin(angle);
    outline(k, 0) = pair.first.to_variable(pair.first_moments.mean + pair.first_moments.std * u);
    outline(k, 1) =
        pair.second.to_variable(pair.second_moments.mean + pair.second_moments.std * (correlation * u + rest * v));
  }
  outline.row(points - 1) = outline.row(0);
  return outline;
}

NormalPopulation::NormalPopulation(std::vector<NormalScale> scales, PopulationOnScales population,
                                   Eigen::Index specimens)
    : scales_(std::move(scales)),
      population_(std::move(population)),
      specimens_(specimens),
      distribution_(JointDistribution::normal_on_scales(scales_, population_.mean, population_.covariance)) {}

Eigen::MatrixXd NormalPopulation::from_uniform(const Eigen::Ref<const Eigen::MatrixXd>& uniforms) const {
  return distribution_.from_uniform(uniforms);
}

Eigen::VectorXd NormalPopulation::density(Eigen::Index parameter,
                                          const Eigen::Ref<const Eigen::VectorXd>& points) const {
  return densities_on_scale(scales_[static_cast<std::size_t>(parameter)], scale_moments(population_, parameter),
                            points);
}

Eigen::VectorXd NormalPopulation::density_points(Eigen::Index parameter, Eigen::Index count) const {
  const ScaleMoments moments = scale_moments(population_, parameter);
  if (!has_width(moments)) return {};
  return points_on_scale(scales_[static_cast<std::size_t>(parameter)], moments, k_reach, count);
}

double NormalPopulation::quantile(Eigen::Index parameter, double probability) const {
  const ScaleMoments moments = scale_moments(population_, parameter);
  return scales_[static_cast<std::size_t>(parameter)].to_variable(moments.mean +
                                                                  moments.std * standard_normal_quantile(probability));
}

std::vector<Eigen::MatrixXd> NormalPopulation::region(Eigen::Index first, Eigen::Index second, double probability,
                                                      Eigen::Index points) const {
  const ScaledPair pair{scales_[static_cast<std::size_t>(first)], scales_[static_cast<std::size_t>(second)],
                        scale_moments(population_, first), scale_moments(population_, second)};
  return region_of_pair(pair, correlation()(first, second), probability, points);
}

Eigen::MatrixXd NormalPopulation::correlation() const {
  const Eigen::VectorXd standard_deviation = population_.covariance.diagonal().cwiseMax(0.0).cwiseSqrt();
  const Eigen::VectorXd inverse = standard_deviation.unaryExpr(
      [](double value) { return value > 0.0 ? 1.0 / value : std::numeric_limits<double>::quiet_NaN(); });
  const Eigen::MatrixXd correlation = inverse.asDiagonal() * population_.covariance * inverse.asDiagonal();
  return correlation.unaryExpr([](double rho) { return std::isnan(rho) ? rho : std::clamp(rho, -1.0, 1.0); });
}

Eigen::MatrixXd NormalPopulation::draw_specimens(const SpecimenDrawing& drawing) const {
  const bool is_exact = drawing.kind == SpecimenDrawing::Kind::population || specimens_ == 0;
  const Eigen::MatrixXd points =
      is_exact ? draw_exact(population_.mean, population_.covariance, drawing) : draw_uncertain(population_, drawing);
  return to_variables(scales_, points);
}

bool NormalPopulation::has_joint_region() const {
  return specimens_ == 0 ||
         joint_degrees_of_freedom(population_.evidence) > static_cast<double>(population_.mean.size());
}

std::string NormalPopulation::prediction_note() const {
  return specimens_ == 0 ? "Prediction: the population is taken as known." : std::string();
}

MomentEstimate::MomentEstimate(const std::vector<NormalScale>& scales, const Eigen::VectorXd& mean,
                               const Eigen::MatrixXd& covariance)
    : scales_(scales), distribution_(JointDistribution::multivariate_normal(mean, covariance)) {
  for (Eigen::Index i = 0; i < mean.size(); ++i) {
    const double std = std::sqrt(std::max(covariance(i, i), 0.0));
    const auto place = static_cast<std::size_t>(i);
    const std::optional<ScaleMoments> matched = moments_on_scale(scales_[place], mean(i), std);
    if (!matched) scales_[place] = {};
    moments_.push_back(matched.value_or(ScaleMoments{mean(i), std}));
  }
}

Eigen::MatrixXd MomentEstimate::from_uniform(const Eigen::Ref<const Eigen::MatrixXd>& uniforms) const {
  return distribution_.from_uniform(uniforms);
}

Eigen::VectorXd MomentEstimate::density(Eigen::Index parameter, const Eigen::Ref<const Eigen::VectorXd>& points) const {
  const auto place = static_cast<std::size_t>(parameter);
  return densities_on_scale(scales_[place], moments_[place], points);
}

Eigen::VectorXd MomentEstimate::density_points(Eigen::Index parameter, Eigen::Index count) const {
  const auto place = static_cast<std::size_t>(parameter);
  if (!has_width(moments_[place])) return {};
  return points_on_scale(scales_[place], moments_[place], k_reach, count);
}

double MomentEstimate::quantile(Eigen::Index parameter, double probability) const {
  const auto place = static_cast<std::size_t>(parameter);
  return scales_[place].to_variable(moments_[place].mean + moments_[place].std * standard_normal_quantile(probability));
}

std::vector<Eigen::MatrixXd> MomentEstimate::region(Eigen::Index first, Eigen::Index second, double probability,
                                                    Eigen::Index points) const {
  const Eigen::VectorXd mean = distribution_.mean();
  const Eigen::MatrixXd covariance = distribution_.covariance();
  const auto moments = [&](Eigen::Index i) { return ScaleMoments{mean(i), std::sqrt(covariance(i, i))}; };
  const double rho = std::clamp(correlation()(first, second), -1.0, 1.0);
  return region_of_pair({{}, {}, moments(first), moments(second)}, rho, probability, points);
}

Eigen::MatrixXd MomentEstimate::draw_specimens(const SpecimenDrawing& drawing) const {
  return draw_exact(mean(), covariance(), drawing);
}

std::string MomentEstimate::prediction_note() const {
  return "Prediction: this method estimates no scatter of specimens; the predicted intervals hold for its covariance "
         "as it stands, taken as known.";
}

}  // namespace mottle::updating
