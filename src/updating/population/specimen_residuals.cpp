#include "updating/population/specimen_residuals.hpp"

#include <algorithm>

#include "mottle/core/error.hpp"
#include "mottle/stats/distributions/chi_squared.hpp"
#include "updating/fits/scaled_parameters.hpp"
#include "updating/methods/linear_units.hpp"

namespace mottle::updating {

MeanResiduals specimen_residuals(const UpdatingProblem& problem, const HoldingPopulation& population, SpecimenFits fits,
                                 const Eigen::MatrixXd& map, const Eigen::VectorXd& error, const RunContext& context,
                                 std::int64_t& evaluations) {
  constexpr int k_steps = 4;
  constexpr double k_refused = 0.05;
  const Eigen::MatrixXd& values = problem.tests.values;
  const NoiseModel noise = known_noise(population.noise);
  const auto residuals_at = [&](const SpecimenFits& at) {
    return mean_residuals(values,
                          linear_units(values, {}, mean_jacobian(at.jacobians), {}, at, noise, population.mean, map),
                          population.noise, error);
  };
  const MeanResiduals first = residuals_at(fits);
  MeanResiduals found = first;
  MeanResiduals last = first;
  for (int step = 0; step < k_steps; ++step) {
    if (last.shared.size() == 0 || last.degrees_of_freedom <= 0.0) break;
    if (chi_squared_upper_tail(found.squares, found.degrees_of_freedom) >= k_refused) break;
    try {
      fits = fit_specimens(problem, values.rowwise() - last.shared.transpose(), population,
                           {fits.points, fits.jacobians}, context, evaluations);
    } catch (const SystemFailure&) {  // the model fails about the next fits
      break;
    }
    last = residuals_at(fits);
    if (last.squares + last.mean_squares >= found.squares + found.mean_squares) continue;
    found = last;
    const double excess = std::max(last.mean_squares - first.mean_squares, 0.0);
    found.squares += excess;
    found.mean_squares -= excess;
  }
  return found;
}

std::optional<MeanResiduals> residuals_about(const UpdatingProblem& problem, const Eigen::VectorXd& centre,
                                             const RunContext& context, std::int64_t& evaluations) {
  const Eigen::MatrixXd& values = problem.tests.values;
  const HoldingPopulation population{centre, prior_on_scales(problem.space).covariance,
                                     problem.tests.repeatability_std.cwiseAbs2()};
  const Eigen::Index q = centre.size();
  const Eigen::VectorXd error = problem.tests.model_error_variance().cwiseSqrt();
  try {
    const SpecimenFits fits = fit_specimens(problem, values, population,
                                            {centre.transpose().replicate(values.rows(), 1)}, context, evaluations);
    return specimen_residuals(problem, population, fits, Eigen::MatrixXd::Identity(q, q),
                              error.isZero(0.0) ? Eigen::VectorXd() : error, context, evaluations);
  } catch (const SystemFailure&) {
    return std::nullopt;
  }
}

}  // namespace mottle::updating
