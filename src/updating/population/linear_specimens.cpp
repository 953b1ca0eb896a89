#include "updating/population/linear_specimens.hpp"

#include <algorithm>
#include <cmath>
#include <limits>
#include <numbers>

#include "mottle/linalg/dense/decompositions.hpp"
#include "mottle/stats/distributions/standard_normal.hpp"
#include "updating/fits/measured_outputs.hpp"
#include "updating/fits/scaled_parameters.hpp"

namespace mottle::updating {
namespace {

const double k_log_two_pi = std::log(2.0 * std::numbers::pi);

/// Test less linear model, of one of the rows.
double residual_of(const LinearSpecimen& specimen, const PopulationAt& population,
                   const Eigen::Ref<const Eigen::VectorXd>& parameters, Eigen::Index row) {
  double residual = specimen.residual(row) - population.model_error(specimen.outputs[static_cast<std::size_t>(row)]);
  for (Eigen::Index i = 0; i < parameters.size(); ++i) {
    residual -= specimen.design(row, i) * (parameters(i) - specimen.point(i));
  }
  return residual;
}

}  // namespace

/// Reflects the rows of w_j and of the test so that column j of the test's becomes zero. The diagonal stays positive:
/// draws must not jump from one population to the next.
void SpecimenAlgebra::reflect(Eigen::Index j) {
  const Eigen::Index q = factor_.cols();
  const double square = design_.col(j).squaredNorm();
  const double norm = std::sqrt(1.0 + square);
  factor_(j, j) = norm;
  if (square == 0.0) return;
  const double first = -square / (1.0 + norm);  // 1 - norm
  const double scale = 2.0 / (first * first + square);
  for (Eigen::Index k = j + 1; k < q; ++k) {
    const double along = scale * design_.col(j).dot(design_.col(k));
    factor_(j, k) = -first * along;
    design_.col(k) -= along * design_.col(j);
  }
  const double along = scale * design_.col(j).dot(residual_);
  projected_(j) = -first * along;
  residual_ -= along * design_.col(j);
}

double SpecimenAlgebra::condition(const LinearSpecimen& specimen, const PopulationAt& population, double power) {
  constexpr double k_no_digits = 1e24;
  const Eigen::Index rows = specimen.design.rows();
  const Eigen::Index q = population.mean.size();
  design_.resize(rows, q);
  residual_.resize(rows);
  factor_.setZero(q, q);
  projected_.setZero(q);
  double log_noise = 0.0;
  for (Eigen::Index k = 0; k < rows; ++k) {
    const double noise = population.noise(specimen.outputs[static_cast<std::size_t>(k)]);
    const double weight = std::sqrt(power / noise);
    residual_(k) = weight * residual_of(specimen, population, population.mean, k);
    for (Eigen::Index j = 0; j < q; ++j) {
      double sum = 0.0;
      for (Eigen::Index i = j; i < q; ++i) sum += specimen.design(k, i) * population.factor(i, j);
      design_(k, j) = weight * sum;
    }
    log_noise += std::log(noise);
  }
  if (!(design_.squaredNorm() < k_no_digits)) return -std::numeric_limits<double>::infinity();
  double log_determinant = 0.0;
  for (Eigen::Index j = 0; j < q; ++j) {
    reflect(j);
    log_determinant += std::log(factor_(j, j));
  }
  return -0.5 * (static_cast<double>(rows) * k_log_two_pi + log_noise + residual_.squaredNorm()) - log_determinant;
}

Eigen::VectorXd SpecimenAlgebra::scores(const Eigen::Ref<const Eigen::VectorXd>& normals) const {
  const Eigen::Index q = normals.size();
  Eigen::VectorXd scores = projected_ + normals;
  for (Eigen::Index i = q - 1; i >= 0; --i) {
    for (Eigen::Index j = i + 1; j < q; ++j) scores(i) -= factor_(i, j) * scores(j);
    scores(i) /= factor_(i, i);
  }
  return scores;
}

double SpecimenAlgebra::log_density(const Eigen::Ref<const Eigen::VectorXd>& scores) const {
  double log = 0.0;
  for (Eigen::Index i = 0; i < scores.size(); ++i) {
    double apart = -projected_(i);
    for (Eigen::Index j = i; j < scores.size(); ++j) apart += factor_(i, j) * scores(j);
    log += std::log(factor_(i, i)) - 0.5 * apart * apart;
  }
  return log;
}

SpecimenDraw DefensiveDraws::draw(const LinearSpecimen& specimen, const PopulationAt& population,
                                  const Eigen::Ref<const Eigen::VectorXd>& scores) {
  constexpr std::array<double, k_components> k_power = {1.0, 0.25, 0.0};
  constexpr std::array<double, k_components> k_share = {0.8, 0.1, 0.1};
  const Eigen::Index q = scores.size() - 1;
  const double probability = standard_normal_cdf(scores(q));
  const std::size_t chosen = probability < k_share[0] ? 0 : (probability < k_share[0] + k_share[1] ? 1 : 2);
  for (std::size_t k = 0; k < k_components; ++k) components_[k].condition(specimen, population, k_power[k]);
  const Eigen::VectorXd w = components_[chosen].scores(scores.head(q));
  std::array<double, k_components> log_density{};
  for (std::size_t k = 0; k < k_components; ++k) log_density[k] = components_[k].log_density(w);
  const double largest = *std::max_element(log_density.begin(), log_density.end());
  double sum = 0.0;
  for (std::size_t k = 0; k < k_components; ++k) sum += k_share[k] * std::exp(log_density[k] - largest);
  return {.parameters = population.mean + population.factor.triangularView<Eigen::Lower>() * w,
          .log_ratio = log_density.front() - largest - std::log(sum)};
}

double log_density_linear(const LinearSpecimen& specimen, const PopulationAt& population,
                          const Eigen::Ref<const Eigen::VectorXd>& parameters) {
  double sum = 0.0;
  for (Eigen::Index k = 0; k < specimen.design.rows(); ++k) {
    const double noise = population.noise(specimen.outputs[static_cast<std::size_t>(k)]);
    const double residual = residual_of(specimen, population, parameters, k);
    sum += k_log_two_pi + std::log(noise) + residual * residual / noise;
  }
  return -0.5 * sum;
}

double log_ratio_to_linear(const LinearSpecimen& specimen, const PopulationAt& population,
                           const Eigen::Ref<const Eigen::VectorXd>& parameters,
                           const Eigen::Ref<const Eigen::VectorXd>& outputs,
                           const Eigen::Ref<const Eigen::VectorXd>& values) {
  double sum = 0.0;
  for (Eigen::Index k = 0; k < specimen.design.rows(); ++k) {
    const Eigen::Index output = specimen.outputs[static_cast<std::size_t>(k)];
    const double linear = residual_of(specimen, population, parameters, k);
    const double residual = values(output) - outputs(output) - population.model_error(output);
    sum += (residual - linear) * (residual + linear) / population.noise(output);
  }
  return -0.5 * sum;
}

SpecimenFits fits_to_linearise(const UpdatingProblem& problem, const Eigen::VectorXd& scale,
                               const Eigen::VectorXd& noise, const RunContext& context, std::int64_t& evaluations) {
  constexpr int k_max_rounds = 20;
  constexpr double k_at_rest = 0.02;       // of the scale of the scatter: the sampler makes up for the rest
  constexpr double k_small_scatter = 0.1;  // of that scale
  const PriorOnScales prior = prior_on_scales(problem.space);
  const Eigen::MatrixXd& values = problem.tests.values;
  const auto n = static_cast<double>(values.rows());
  const Eigen::MatrixXd identity = Eigen::MatrixXd::Identity(scale.size(), scale.size());
  const Eigen::VectorXd total_noise = noise + problem.tests.model_error_variance();
  HoldingPopulation population{prior.mean, Eigen::MatrixXd(scale.cwiseAbs2().asDiagonal()), total_noise};
  SpecimenStart start{.points = prior.mean.transpose().replicate(values.rows(), 1), .tolerance = 1e-4};
  SpecimenFits fits;
  for (int round = 0; round < k_max_rounds; ++round) {
    fits = fit_specimens(problem, values, population, start, context, evaluations);
    const double moved = ((fits.points - start.points) * scale.cwiseInverse().asDiagonal()).cwiseAbs().maxCoeff();
    start.points = fits.points;
    start.jacobians = fits.jacobians;
    if (moved < k_at_rest) break;
    population.mean = fits.points.colwise().mean();
    Eigen::MatrixXd sum = (k_small_scatter * scale).cwiseAbs2().asDiagonal();
    const Eigen::MatrixXd precision = solve_semidefinite(population.covariance, identity);
    for (Eigen::Index s = 0; s < values.rows(); ++s) {
      const std::vector<Eigen::Index> rows = measured_outputs(values, s);
      const Eigen::MatrixXd g = fits.jacobians[static_cast<std::size_t>(s)](rows, Eigen::all);
      const Eigen::MatrixXd information = g.transpose() * total_noise(rows).cwiseInverse().asDiagonal() * g + precision;
      const Eigen::VectorXd apart = fits.points.row(s).transpose() - population.mean;
      sum += apart * apart.transpose() + solve_semidefinite(information, identity);
    }
    population.covariance = 0.5 / (n + 1.0) * (sum + sum.transpose());
  }
  return fits;
}

std::vector<LinearSpecimen> linear_specimens(const Eigen::Ref<const Eigen::MatrixXd>& values,
                                             const SpecimenFits& fits) {
  std::vector<LinearSpecimen> specimens;
  for (Eigen::Index s = 0; s < values.rows(); ++s) {
    const std::vector<Eigen::Index> rows = measured_outputs(values, s);
    const Eigen::VectorXd residual = (values.row(s) - fits.outputs.row(s)).transpose();
    specimens.push_back(
        {rows, fits.points.row(s), fits.jacobians[static_cast<std::size_t>(s)](rows, Eigen::all), residual(rows)});
  }
  return specimens;
}

}  // namespace mottle::updating
