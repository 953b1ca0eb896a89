#include "updating/fits/specimen_restarts.hpp"

#include <Eigen/Core>
#include <algorithm>
#include <vector>

#include "mottle/core/error.hpp"
#include "mottle/linalg/dense/decompositions.hpp"
#include "mottle/stats/distributions/chi_squared.hpp"

namespace mottle::updating {
namespace {

/// Points about the mean [point x parameter].
Eigen::MatrixXd points_about(const UpdatingProblem& problem, const HoldingPopulation& population) {
  constexpr double k_reach = 1.5;
  constexpr double k_least = 0.05;  // of the prior's deviations: an estimate may have no scatter
  const ScaledParameters parameters(problem.space);
  const Eigen::Index q = parameters.count();
  Eigen::MatrixXd covariance = population.covariance;
  covariance.diagonal() += (k_least * parameters.standard_deviation()).cwiseAbs2();
  const SymmetricEigen axes(covariance);
  const Eigen::MatrixXd reach =
      k_reach * axes.eigenvectors() * axes.eigenvalues().cwiseMax(0.0).cwiseSqrt().asDiagonal();
  Eigen::MatrixXd points(2 * q, q);
  for (Eigen::Index i = 0; i < q; ++i) {
    points.row(i) = parameters.clamp(population.mean + reach.col(i)).transpose();
    points.row(q + i) = parameters.clamp(population.mean - reach.col(i)).transpose();
  }
  return points;
}

/// Those whose fit leaves more than four of five would by chance.
std::vector<Eigen::Index> doubtful_specimens(const Eigen::Ref<const Eigen::MatrixXd>& values,
                                             const SpecimenFits& fits) {
  constexpr double k_usual = 0.8;
  std::vector<Eigen::Index> doubtful;
  for (Eigen::Index s = 0; s < values.rows(); ++s) {
    const auto measured = static_cast<double>((!values.row(s).array().isNaN()).count());
    if (fits.costs(s) > chi_squared_quantile(k_usual, measured)) doubtful.push_back(s);
  }
  return doubtful;
}

}  // namespace

std::int64_t restart_specimens(const UpdatingProblem& problem, const Eigen::Ref<const Eigen::MatrixXd>& values,
                               const HoldingPopulation& population, double tolerance, const RunContext& context,
                               std::int64_t& evaluations, SpecimenFits& fits) {
  constexpr double k_better = 0.1;
  const std::vector<Eigen::Index> doubtful = doubtful_specimens(values, fits);
  if (doubtful.empty()) return 0;
  const auto count = static_cast<Eigen::Index>(doubtful.size());
  const Eigen::MatrixXd own = values(doubtful, Eigen::all);
  const Eigen::MatrixXd points = points_about(problem, population);
  const Eigen::MatrixXd outputs = outputs_on_scales(problem, points, context, evaluations);
  const std::vector<Eigen::MatrixXd> jacobians =
      scaled_jacobians(problem, ScaledParameters(problem.space), points, outputs, context, evaluations);
  std::vector<bool> is_better(doubtful.size(), false);
  for (Eigen::Index k = 0; k < points.rows(); ++k) {
    const Eigen::MatrixXd& jacobian = jacobians[static_cast<std::size_t>(k)];
    if (!outputs.row(k).allFinite() || !jacobian.allFinite()) continue;
    const SpecimenStart start{points.row(k).replicate(count, 1),
                              std::vector<Eigen::MatrixXd>(doubtful.size(), jacobian), tolerance,
                              outputs.row(k).replicate(count, 1)};
    SpecimenFits again;
    try {
      again = fit_specimens(problem, own, population, start, context, evaluations);
    } catch (const ModelFailure&) {  // one of them leads to where the model fails
      continue;
    }
    for (Eigen::Index s = 0; s < count; ++s) {
      const Eigen::Index specimen = doubtful[static_cast<std::size_t>(s)];
      if (!(again.costs(s) < fits.costs(specimen) - k_better)) continue;
      is_better[static_cast<std::size_t>(s)] = true;
      fits.take(specimen, again, s);
    }
  }
  return std::count(is_better.begin(), is_better.end(), true);
}

}  // namespace mottle::updating
