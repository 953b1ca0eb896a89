#include "updating/methods/interval_specimens.hpp"

#include <cmath>
#include <limits>

#include "updating/methods/inversion_fit.hpp"

namespace mottle::updating {
namespace {

ParameterBox hull_of(const Eigen::MatrixXd& points) {
  return {points.colwise().minCoeff().transpose(), points.colwise().maxCoeff().transpose()};
}

ParameterSpace without_bounds(const ParameterSpace& space) {
  std::vector<Parameter> parameters = space.parameters();
  for (Parameter& parameter : parameters) {
    parameter.lower_bound = -std::numeric_limits<double>::infinity();
    parameter.upper_bound = std::numeric_limits<double>::infinity();
  }
  return {std::move(parameters), space.prior()};
}

/// Residuals that the model is judged by. The bounds are those of the box: a specimen beyond them by chance or by noise
/// says nothing against the model, and whether a box within them covers the tests is a test of its own.
Eigen::MatrixXd unbounded_residuals(const IntervalSetup& setup, const Eigen::MatrixXd& points,
                                    const Eigen::MatrixXd& residuals, const Eigen::VectorXd& sigma,
                                    std::int64_t& evaluations) {
  const UpdatingProblem& problem = setup.problem;
  const ScaledParameters bounded(problem.space);
  const Eigen::MatrixXd variables = bounded.to_variables(points);
  std::vector<Eigen::Index> held;
  for (Eigen::Index s = 0; s < points.rows(); ++s) {
    if ((problem.space.active_bounds(variables.row(s).transpose()).array() != 0).any()) held.push_back(s);
  }
  if (held.empty()) return residuals;
  const ParameterSpace space = without_bounds(problem.space);
  const InversionFit fit = invert_specimens(problem, ScaledParameters(space), problem.tests.values(held, Eigen::all),
                                            sigma, points(held, Eigen::all), setup.context,
                                            [&](const InversionFit&) { return !setup.context.stop_requested(); });
  evaluations += fit.evaluations;
  setup.context.throw_if_stopped();
  Eigen::MatrixXd found = residuals;
  found(held, Eigen::all) = problem.tests.values(held, Eigen::all) - fit.outputs;
  return found;
}

}  // namespace

OwnParameters fit_own_parameters(const IntervalSetup& setup, std::int64_t& evaluations) {
  const UpdatingProblem& problem = setup.problem;
  const ScaledParameters parameters(problem.space);
  const Eigen::Index n = problem.tests.values.rows();
  Eigen::MatrixXd targets(n + 2, problem.tests.values.cols());
  targets << problem.tests.values, setup.bounds.limits.transpose();
  Eigen::VectorXd sigma = problem.tests.repeatability_std;
  for (Eigen::Index k = 0; k < sigma.size(); ++k) {
    if (!(sigma(k) > 0.0)) sigma(k) = std::sqrt(setup.tests.covariance(k, k));
    sigma(k) = weighing_deviation(sigma(k), setup.tests.mean(k));
  }
  const auto goes_on = [&](const InversionFit&) { return !setup.context.stop_requested(); };
  const Eigen::VectorXd prior = parameters.clamp(parameters.start());
  const InversionFit middle = invert_specimens(problem, parameters, setup.tests.mean.transpose(), sigma,
                                               prior.transpose(), setup.context, goes_on);
  const InversionFit fit = invert_specimens(problem, parameters, targets, sigma,
                                            middle.points.row(0).replicate(n + 2, 1), setup.context, goes_on);
  evaluations += middle.evaluations + fit.evaluations;
  setup.context.throw_if_stopped();
  const Eigen::MatrixXd points = parameters.to_variables(fit.points);
  const Eigen::MatrixXd residuals = problem.tests.values - fit.outputs.topRows(n);
  return {points.topRows(n),
          hull_of(points.topRows(n)),
          hull_of(points.bottomRows(2)),
          residuals,
          unbounded_residuals(setup, fit.points.topRows(n), residuals, sigma, evaluations),
          std::vector<int>(fit.ranks.begin(), fit.ranks.begin() + n)};
}

}  // namespace mottle::updating
