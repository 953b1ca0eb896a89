#include "updating/population/linear_specimens.hpp"

#include <cmath>
#include <numbers>

#include "mottle/linalg/dense/decompositions.hpp"
#include "updating/methods/measured_outputs.hpp"
#include "updating/methods/scaled_parameters.hpp"

namespace mottle::updating {
namespace {

const double k_log_two_pi = std::log(2.0 * std::numbers::pi);

/// Lower factor of a small positive definite matrix in place: only its lower triangle is read and written. The
/// matrices are of the size of the parameters, and there are millions.
void factorise_in_place(Eigen::MatrixXd& matrix) {
  const Eigen::Index n = matrix.rows();
  for (Eigen::Index j = 0; j < n; ++j) {
    for (Eigen::Index k = 0; k < j; ++k) {
      for (Eigen::Index i = j; i < n; ++i) matrix(i, j) -= matrix(i, k) * matrix(j, k);
    }
    const double root = std::sqrt(matrix(j, j));
    for (Eigen::Index i = j; i < n; ++i) matrix(i, j) /= root;
  }
}

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

double SpecimenAlgebra::condition(const LinearSpecimen& specimen, const PopulationAt& population) {
  population_ = &population;
  const Eigen::Index rows = specimen.design.rows();
  const Eigen::Index q = population.mean.size();
  design_.resize(rows, q);
  factor_.resize(q, q);
  whitened_.resize(q);
  factor_.setIdentity();
  whitened_.setZero();
  double square = 0.0;
  double log_noise = 0.0;
  for (Eigen::Index k = 0; k < rows; ++k) {
    const double noise = population.noise(specimen.outputs[static_cast<std::size_t>(k)]);
    const double weight = 1.0 / std::sqrt(noise);
    const double residual = weight * residual_of(specimen, population, population.mean, k);
    for (Eigen::Index j = 0; j < q; ++j) {
      double sum = 0.0;
      for (Eigen::Index i = j; i < q; ++i) sum += specimen.design(k, i) * population.factor(i, j);
      design_(k, j) = weight * sum;
      whitened_(j) += design_(k, j) * residual;
    }
    square += residual * residual;
    log_noise += std::log(noise);
  }
  for (Eigen::Index k = 0; k < rows; ++k) {
    for (Eigen::Index j = 0; j < q; ++j) {
      for (Eigen::Index i = j; i < q; ++i) factor_(i, j) += design_(k, i) * design_(k, j);
    }
  }
  factorise_in_place(factor_);
  double log_determinant = 0.0;
  for (Eigen::Index i = 0; i < q; ++i) {
    for (Eigen::Index j = 0; j < i; ++j) whitened_(i) -= factor_(i, j) * whitened_(j);
    whitened_(i) /= factor_(i, i);
    square -= whitened_(i) * whitened_(i);
    log_determinant += 2.0 * std::log(factor_(i, i));
  }
  return -0.5 * (static_cast<double>(rows) * k_log_two_pi + log_noise + log_determinant + square);
}

Eigen::VectorXd SpecimenAlgebra::parameters(const Eigen::Ref<const Eigen::VectorXd>& normals) const {
  const Eigen::Index q = normals.size();
  Eigen::VectorXd scores = whitened_ + normals;
  for (Eigen::Index i = q - 1; i >= 0; --i) {
    for (Eigen::Index j = i + 1; j < q; ++j) scores(i) -= factor_(j, i) * scores(j);
    scores(i) /= factor_(i, i);
  }
  Eigen::VectorXd found = population_->mean;
  for (Eigen::Index i = 0; i < q; ++i) {
    for (Eigen::Index j = 0; j <= i; ++j) found(i) += population_->factor(i, j) * scores(j);
  }
  return found;
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
