// What the outputs of a population are, at its mean and over points of a rule.
#include <Eigen/Core>
#include <cmath>
#include <limits>

#include "mottle/core/error.hpp"
#include "mottle/stats/moments/covariance_axes.hpp"
#include "mottle/stats/sampling/gaussian_rules.hpp"
#include "updating/methods/moment_iteration.hpp"

namespace mottle::updating {
namespace {

/// Symmetric root: it moves smoothly with the covariance.
Eigen::MatrixXd symmetric_root(const Eigen::MatrixXd& covariance, const Eigen::VectorXd& standard_deviation) {
  return CovarianceAxes(covariance, standard_deviation).symmetric_root();
}

/// Terms of a surface over the points: 1 and w, and with `is_quadratic` all w_i w_j.
Eigen::MatrixXd surface_terms(const Eigen::MatrixXd& points, bool is_quadratic) {
  const Eigen::Index q = points.cols();
  Eigen::MatrixXd terms(points.rows(), is_quadratic ? 1 + q + q * (q + 1) / 2 : 1 + q);
  terms.leftCols(q + 1) << Eigen::VectorXd::Ones(points.rows()), points;
  Eigen::Index column = q + 1;
  for (Eigen::Index i = 0; i < q && is_quadratic; ++i) {
    for (Eigen::Index j = 0; j <= i; ++j) terms.col(column++) = points.col(i).cwiseProduct(points.col(j));
  }
  return terms;
}

/// Rows of `outputs` that are not finite become those of the surface that fits the others best: of degree 2 where there
/// are points enough, else a plane.
void fill_by_surface(const GaussianRule& rule, Eigen::MatrixXd& outputs) {
  std::vector<Eigen::Index> known;
  std::vector<Eigen::Index> missing;
  for (Eigen::Index s = 0; s < outputs.rows(); ++s) (outputs.row(s).allFinite() ? known : missing).push_back(s);
  if (missing.empty()) return;
  const Eigen::Index q = rule.points.cols();
  const bool is_quadratic = static_cast<Eigen::Index>(known.size()) >= (q + 1) * (q + 2);
  const Eigen::MatrixXd terms = surface_terms(rule.points, is_quadratic);
  const Eigen::VectorXd root = rule.weights(known).cwiseAbs().cwiseSqrt();
  const Eigen::MatrixXd surface =
      PivotedQr(root.asDiagonal() * terms(known, Eigen::all)).solve(root.asDiagonal() * outputs(known, Eigen::all));
  outputs(missing, Eigen::all) = terms(missing, Eigen::all) * surface;
}

void require_enough_runs(const Cloud& cloud, const Eigen::VectorXd& weights, double max_failed) {
  double failed = 0.0;
  for (const FailedRun& failure : cloud.failures) failed += weights(failure.sample);
  if (failed <= max_failed) return;
  throw ModelFailure(fmt::format(
      "{} model run{}, {:.3g} % of the population, failed, at most {:.3g} % may (max_failed); the first: {}",
      cloud.failures.size(), cloud.failures.size() == 1 ? "" : "s", 100.0 * failed, 100.0 * max_failed,
      cloud.failures.front().reason));
}

}  // namespace

bool evaluate_at_mean(const UpdatingProblem& problem, const ScaledParameters& parameters, MomentState& state,
                      Eigen::VectorXd& outputs, const RunContext& context, std::int64_t& evaluations) {
  const Eigen::MatrixXd point = state.mean.transpose();
  const Evaluation evaluation = problem.model.evaluate(parameters.to_variables(point), context);
  ++evaluations;
  if (!evaluation.failures.empty() || !evaluation.outputs.allFinite()) return false;
  outputs = evaluation.outputs.row(0).transpose();
  state.sensitivity = scaled_jacobians(problem, parameters, point, evaluation.outputs, context, evaluations).front();
  return state.sensitivity.allFinite();
}

bool evaluate_by_rule(const UpdatingProblem& problem, const ScaledParameters& parameters, const GaussianRule& rule,
                      MomentState& state, const RunContext& context, std::int64_t& evaluations) {
  const Eigen::MatrixXd root = symmetric_root(state.covariance, parameters.standard_deviation());
  const Eigen::MatrixXd points = (rule.points * root.transpose()).rowwise() + state.mean.transpose();
  const Eigen::MatrixXd variables = parameters.to_variables(points);
  std::vector<Eigen::Index> possible;
  double impossible = 0.0;
  const double whole = rule.weights.cwiseAbs().sum();
  for (Eigen::Index s = 0; s < points.rows(); ++s) {
    if (problem.space.is_possible(variables.row(s))) {
      possible.push_back(s);
    } else {
      impossible += std::abs(rule.weights(s)) / whole;
    }
  }
  if (impossible > problem.cloud.max_failed) return false;
  state.cloud = evaluate_points(problem.model, variables(possible, Eigen::all), 1.0, context);
  evaluations += static_cast<std::int64_t>(possible.size());
  require_enough_runs(state.cloud, rule.weights(possible).cwiseAbs() / whole, problem.cloud.max_failed);
  Eigen::MatrixXd outputs =
      Eigen::MatrixXd::Constant(points.rows(), state.cloud.outputs.cols(), std::numeric_limits<double>::quiet_NaN());
  outputs(possible, Eigen::all) = state.cloud.outputs;
  fill_by_surface(rule, outputs);
  state.output_mean = outputs.transpose() * rule.weights;
  const Eigen::MatrixXd centred = outputs.rowwise() - state.output_mean.transpose();
  const Eigen::MatrixXd covariance = centred.transpose() * rule.weights.asDiagonal() * centred;
  state.output_covariance = 0.5 * (covariance + covariance.transpose());
  return true;
}

}  // namespace mottle::updating
