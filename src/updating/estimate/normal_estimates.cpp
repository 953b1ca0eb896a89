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

/// The population's variables, one a parameter.
std::vector<TransformedNormal> marginals_of(const std::vector<ParameterTransform>& scales,
                                            const PopulationOnScales& population) {
  std::vector<TransformedNormal> marginals;
  for (std::size_t i = 0; i < scales.size(); ++i) {
    marginals.push_back({scales[i], population.moments(static_cast<Eigen::Index>(i))});
  }
  return marginals;
}

/// Variables of these moments that are normal on the scales; on their own axes where there is none such.
std::vector<TransformedNormal> matched_marginals(const std::vector<ParameterTransform>& scales,
                                                 const Eigen::VectorXd& mean, const Eigen::MatrixXd& covariance) {
  std::vector<TransformedNormal> marginals;
  for (Eigen::Index i = 0; i < mean.size(); ++i) {
    const double std = std::sqrt(std::max(covariance(i, i), 0.0));
    const ParameterTransform& scale = scales[static_cast<std::size_t>(i)];
    const std::optional<TransformedMoments> matched = moments_of_transformed(scale, mean(i), std);
    marginals.push_back(matched ? TransformedNormal{scale, *matched} : TransformedNormal{{}, {mean(i), std}});
  }
  return marginals;
}

std::vector<Eigen::MatrixXd> region_of_pair(const TransformedPair& pair, double correlation, double probability,
                                            Eigen::Index points) {
  if (!std::isfinite(correlation) || !pair.first.has_width() || !pair.second.has_width()) return {};
  return {pair_outline(pair, correlation, reach_of_pair(probability), points)};
}

}  // namespace

double reach_of_pair(double probability) {
  return std::sqrt(-2.0 * std::log1p(-probability));
}

Eigen::MatrixXd pair_outline(const TransformedPair& pair, double correlation, double reach, Eigen::Index points) {
  const double rest = std::sqrt(std::max(0.0, 1.0 - correlation * correlation));
  Eigen::MatrixXd outline(points, 2);
  for (Eigen::Index k = 0; k < points; ++k) {
    const double angle = 2.0 * std::numbers::pi * static_cast<double>(k) / static_cast<double>(points - 1);
    const double u = reach * std::cos(angle);
    const double v = reach * std::sin(angle);
    const auto at = [](const TransformedNormal& variable, double z) {
      return variable.transform.to_variable(variable.moments.mean + variable.moments.std * z);
    };
    outline(k, 0) = at(pair.first, u);
    outline(k, 1) = at(pair.second, correlation * u + rest * v);
  }
  outline.row(points - 1) = outline.row(0);
  return outline;
}

TransformedMoments PopulationOnScales::moments(Eigen::Index parameter) const {
  return {mean(parameter), std::sqrt(std::max(covariance(parameter, parameter), 0.0))};
}

bool TransformedNormal::has_width() const {
  return moments.std > 0.0 && std::isfinite(moments.std);
}

NormalEstimate::NormalEstimate(JointDistribution distribution, std::vector<TransformedNormal> marginals)
    : distribution_(std::move(distribution)), marginals_(std::move(marginals)) {}

Eigen::MatrixXd NormalEstimate::from_uniform(const Eigen::Ref<const Eigen::MatrixXd>& uniforms) const {
  return distribution_.from_uniform(uniforms);
}

Eigen::VectorXd NormalEstimate::density(Eigen::Index parameter, const Eigen::Ref<const Eigen::VectorXd>& points) const {
  const TransformedNormal& variable = marginal(parameter);
  return points.unaryExpr([&](double x) { return density_of_variable(variable.transform, variable.moments, x); });
}

Eigen::VectorXd NormalEstimate::density_points(Eigen::Index parameter, Eigen::Index count) const {
  const TransformedNormal& variable = marginal(parameter);
  return variable.has_width() ? points_of_variable(variable.transform, variable.moments, k_reach, count)
                              : Eigen::VectorXd();
}

double NormalEstimate::quantile(Eigen::Index parameter, double probability) const {
  const TransformedNormal& variable = marginal(parameter);
  return variable.transform.to_variable(variable.moments.mean +
                                        variable.moments.std * standard_normal_quantile(probability));
}

NormalPopulation::NormalPopulation(std::vector<ParameterTransform> scales, PopulationOnScales population,
                                   Eigen::Index specimens)
    : NormalEstimate{JointDistribution::transformed_normal(scales, population.mean, population.covariance),
                     marginals_of(scales, population)},
      scales_(std::move(scales)),
      population_(std::move(population)),
      specimens_(specimens) {}

Eigen::VectorXd NormalPopulation::location() const {
  return to_variables(scales_, population_.mean.transpose()).row(0);
}

std::vector<Eigen::MatrixXd> NormalPopulation::region(Eigen::Index first, Eigen::Index second, double probability,
                                                      Eigen::Index points) const {
  return region_of_pair({marginal(first), marginal(second)}, correlation()(first, second), probability, points);
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

MomentEstimate::MomentEstimate(const std::vector<ParameterTransform>& scales, const Eigen::VectorXd& mean,
                               const Eigen::MatrixXd& covariance)
    : NormalEstimate{JointDistribution::multivariate_normal(mean, covariance),
                     matched_marginals(scales, mean, covariance)} {}

std::vector<Eigen::MatrixXd> MomentEstimate::region(Eigen::Index first, Eigen::Index second, double probability,
                                                    Eigen::Index points) const {
  const Eigen::VectorXd centre = mean();
  const Eigen::MatrixXd spread = covariance();
  const auto own = [&](Eigen::Index i) { return TransformedNormal{{}, {centre(i), std::sqrt(spread(i, i))}}; };
  const double rho = std::clamp(correlation()(first, second), -1.0, 1.0);
  return region_of_pair({own(first), own(second)}, rho, probability, points);
}

Eigen::MatrixXd MomentEstimate::draw_specimens(const SpecimenDrawing& drawing) const {
  return draw_exact(mean(), covariance(), drawing);
}

std::string MomentEstimate::prediction_note() const {
  return "Prediction: this method does not estimate the scatter of specimens; the predicted intervals take its "
         "covariance as known.";
}

}  // namespace mottle::updating
