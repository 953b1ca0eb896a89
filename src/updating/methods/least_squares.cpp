#include "updating/methods/least_squares.hpp"

#include <cmath>
#include <limits>
#include <vector>

#include "mottle/linalg/dense/decompositions.hpp"
#include "mottle/updating/methods/deterministic.hpp"

namespace mottle::updating {
namespace {

constexpr int k_max_halvings = 12;

/// Central differences by all parameters at once: a model whose runs are long may do them side by side. Where one side
/// fails, differences from the middle.
Eigen::MatrixXd difference_quotients(const UpdatingProblem& problem, const Eigen::VectorXd& parameters,
                                     const Eigen::VectorXd& steps, const RunContext& context,
                                     std::int64_t& evaluations) {
  const Eigen::Index q = parameters.size();
  Eigen::MatrixXd points = parameters.transpose().replicate(2 * q, 1);
  points.topRows(q).diagonal() += steps;
  points.bottomRows(q).diagonal() -= steps;
  const Eigen::MatrixXd y = problem.model.evaluate(points, context).outputs.transpose();
  evaluations += points.rows();
  std::optional<Eigen::VectorXd> centre;
  if (!y.allFinite()) centre = evaluate_one(problem, parameters, context, evaluations);
  Eigen::MatrixXd quotients(y.rows(), q);
  for (Eigen::Index i = 0; i < q; ++i) {
    const bool has_ahead = y.col(i).allFinite();
    const bool has_behind = y.col(q + i).allFinite();
    if (has_ahead && has_behind) {
      quotients.col(i) = (y.col(i) - y.col(q + i)) / (2.0 * steps(i));
    } else if (centre && (has_ahead || has_behind)) {
      const Eigen::VectorXd side = y.col(has_ahead ? i : q + i);
      quotients.col(i) = (side - *centre) / (has_ahead ? steps(i) : -steps(i));
    } else {
      throw ModelFailure("the model fails at all points around the current parameters, so there is no derivative");
    }
  }
  return quotients;
}

/// Gauss-Newton step over the parameters that no bound holds.
Eigen::VectorXd free_step(const Eigen::MatrixXd& hessian, const Eigen::VectorXd& descent,
                          const Eigen::VectorXi& active) {
  std::vector<Eigen::Index> free;
  for (Eigen::Index i = 0; i < descent.size(); ++i) {
    const bool is_held = (active(i) < 0 && descent(i) < 0.0) || (active(i) > 0 && descent(i) > 0.0);
    if (!is_held) free.push_back(i);
  }
  Eigen::VectorXd step = Eigen::VectorXd::Zero(descent.size());
  if (free.empty()) return step;
  const Eigen::MatrixXd free_hessian = hessian(free, free);
  const Eigen::VectorXd free_descent = descent(free);
  const Eigen::VectorXd solved = solve_semidefinite(free_hessian, free_descent);
  step(free) = solved;
  return step;
}

/// The step, halved until the cost does not rise (a failed run counts as a rise); `outputs` become those of the new
/// point. Where no part of the step helps the point stays where it is.
Eigen::VectorXd accepted_step(const UpdatingProblem& problem, const LeastSquares& setup, const Eigen::VectorXd& x,
                              const Eigen::VectorXd& step, Eigen::VectorXd& outputs, const RunContext& context,
                              std::int64_t& evaluations) {
  const double old_cost = cost(setup, x, outputs);
  double length = 1.0;
  for (int halving = 0; halving <= k_max_halvings; ++halving, length *= 0.5) {
    Eigen::VectorXd next = problem.space.clamp(x + length * step);
    const auto trial = evaluate_one(problem, next, context, evaluations);
    if (!trial || cost(setup, next, *trial) > old_cost) continue;
    outputs = *trial;
    return next;
  }
  return x;
}

}  // namespace

std::optional<Eigen::VectorXd> evaluate_one(const UpdatingProblem& problem, const Eigen::VectorXd& parameters,
                                            const RunContext& context, std::int64_t& evaluations) {
  const Evaluation evaluation = problem.model.evaluate(parameters.transpose(), context);
  ++evaluations;
  if (!evaluation.failures.empty()) return std::nullopt;
  return evaluation.outputs.row(0).transpose();
}

Eigen::MatrixXd model_jacobian(const UpdatingProblem& problem, const Eigen::VectorXd& parameters,
                               const Eigen::VectorXd& scale, const RunContext& context, std::int64_t& evaluations) {
  const auto outputs = static_cast<Eigen::Index>(problem.model.outputs().size());
  Eigen::MatrixXd jacobian =
      Eigen::MatrixXd::Constant(outputs, parameters.size(), std::numeric_limits<double>::quiet_NaN());
  try {
    if (problem.derivatives != nullptr) jacobian = problem.derivatives->jacobian(parameters);
  } catch (const ModelFailure&) {  // NOLINT(bugprone-empty-catch): differences may do
  }
  if (jacobian.allFinite()) return jacobian;
  const Eigen::MatrixXd differences =
      difference_quotients(problem, parameters, problem.model.difference_step() * scale, context, evaluations);
  return jacobian.array().isFinite().select(jacobian, differences);
}

double cost(const LeastSquares& setup, const Eigen::VectorXd& parameters, const Eigen::VectorXd& outputs) {
  const Eigen::VectorXd residual = setup.target - outputs;
  const Eigen::VectorXd shift = parameters - setup.start;
  return residual.cwiseAbs2().dot(setup.weight) + shift.dot(setup.prior * shift);
}

bool has_full_rank(const LeastSquares& setup, const Eigen::MatrixXd& g) {
  if (!setup.prior.isZero(0.0)) return true;
  return determined_combinations(setup, g) == g.cols();
}

Eigen::Index determined_combinations(const LeastSquares& setup, const Eigen::MatrixXd& g) {
  return PivotedQr(setup.weight.cwiseSqrt().asDiagonal() * g * setup.prior_std.asDiagonal()).rank();
}

double step_down(const UpdatingProblem& problem, const LeastSquares& setup, LeastSquaresPoint& point,
                 const RunContext& context, std::int64_t& evaluations) {
  const Eigen::MatrixXd gw = point.sensitivity.transpose() * setup.weight.asDiagonal();
  const Eigen::VectorXd descent = gw * (setup.target - point.outputs) - setup.prior * (point.parameters - setup.start);
  const Eigen::VectorXd step =
      free_step(gw * point.sensitivity + setup.prior, descent, problem.space.active_bounds(point.parameters));
  const Eigen::VectorXd next =
      accepted_step(problem, setup, point.parameters, step, point.outputs, context, evaluations);
  const double movement = ((next - point.parameters).cwiseAbs().array() / setup.prior_std.array()).maxCoeff();
  point.parameters = next;
  point.sensitivity = model_jacobian(problem, next, setup.prior_std, context, evaluations);
  return movement;
}

}  // namespace mottle::updating
