#include "updating/methods/other_minima.hpp"

#include <algorithm>
#include <cmath>
#include <optional>
#include <vector>

#include "mottle/core/error.hpp"
#include "mottle/stats/distributions/chi_squared.hpp"
#include "mottle/updating/methods/deterministic.hpp"

namespace mottle::updating {
namespace {

constexpr double k_apart = 0.1;  // prior deviations: nearer minima are one for every purpose

/// [start x parameter]
Eigen::MatrixXd draw_starts(const UpdatingProblem& problem, int starts, const RunContext& context) {
  constexpr double k_spread = 2.0;  // minima within the prior's tails are reached from beyond them too
  const StreamKey key{.seed = context.seed, .purpose = StreamPurpose::design_permutation, .iteration = 2};
  const Eigen::VectorXd mean = problem.space.prior().mean();
  Eigen::MatrixXd points =
      problem.space.draw(problem.space.prior(), SamplingDesign::latin_hypercube, starts, key).samples;
  for (Eigen::Index s = 0; s < points.rows(); ++s) {
    const Eigen::VectorXd inside = problem.space.clamp(mean + k_spread * (points.row(s).transpose() - mean));
    if (problem.space.is_possible(inside.transpose())) points.row(s) = inside.transpose();
  }
  return points;
}

/// Largest difference of a parameter, in its prior standard deviations.
double prior_distance(const LeastSquares& setup, const Eigen::VectorXd& a, const Eigen::VectorXd& b) {
  return ((a - b).cwiseAbs().array() / setup.prior_std.array()).maxCoeff();
}

/// The minimum that a descent from `start` ends in; nothing: it fails, does not end, or comes to one of `known`.
std::optional<LeastSquaresPoint> descend(const UpdatingProblem& problem, const LeastSquares& setup,
                                         const Eigen::VectorXd& start, const std::vector<LeastSquaresPoint>& known,
                                         const RunContext& context, std::int64_t& evaluations) {
  LeastSquaresPoint point{start, {}, {}};
  const auto outputs = evaluate_one(problem, start, context, evaluations);
  if (!outputs) return std::nullopt;
  point.outputs = *outputs;
  try {
    point.sensitivity = model_jacobian(problem, start, setup.prior_std, context, evaluations);
    for (int index = 0; index < problem.iterations && !context.stop_requested(); ++index) {
      if (!has_full_rank(setup, point.sensitivity)) return std::nullopt;
      const double movement = step_down(problem, setup, point, context, evaluations);
      const bool is_known = std::any_of(known.begin(), known.end(), [&](const LeastSquaresPoint& minimum) {
        return prior_distance(setup, point.parameters, minimum.parameters) < k_apart;
      });
      if (is_known) return std::nullopt;
      if (movement <= problem.tolerance) return point;
    }
  } catch (const ModelFailure&) {
  }
  return std::nullopt;
}

/// Whether the outputs of the linear model at one minimum differ beyond doubt at the other.
bool are_apart(const LeastSquares& setup, const LeastSquaresPoint& a, const LeastSquaresPoint& b, double doubt) {
  const Eigen::VectorXd moved = a.sensitivity * (b.parameters - a.parameters);
  return prior_distance(setup, a.parameters, b.parameters) >= k_apart && moved.cwiseAbs2().dot(setup.weight) > doubt;
}

}  // namespace

void find_other_minima(const UpdatingProblem& problem, const LeastSquares& setup, const LeastSquaresPoint& estimate,
                       int starts, const RunContext& context, UpdatingResult& result) {
  if (starts == 0) return;
  const double doubt = chi_squared_quantile(1.0 - problem.level, static_cast<double>(setup.start.size()));
  const auto cost_of = [&](const LeastSquaresPoint& point) { return cost(setup, point.parameters, point.outputs); };
  const double found_cost = cost_of(estimate);
  std::vector<LeastSquaresPoint> known{estimate};
  const Eigen::MatrixXd points = draw_starts(problem, starts, context);
  for (Eigen::Index s = 0; s < points.rows(); ++s) {
    std::optional<LeastSquaresPoint> point =
        descend(problem, setup, points.row(s).transpose(), known, context, result.model_evaluations);
    const bool is_new = point && std::all_of(known.begin(), known.end(), [&](const LeastSquaresPoint& other) {
                          return are_apart(setup, other, *point, doubt);
                        });
    if (is_new) known.push_back(std::move(*point));
  }
  const auto best = std::min_element(known.begin(), known.end(),
                                     [&](const auto& a, const auto& b) { return cost_of(a) < cost_of(b); });
  if (cost_of(*best) < found_cost - doubt) {
    result.better_solution = best->parameters;
    result.message += fmt::format(
        "; but this is a local minimum: from another start the weighted sum of squares falls to {:.4g} instead of "
        "{:.4g}",
        cost_of(*best), found_cost);
    return;
  }
  std::erase_if(known, [&](const LeastSquaresPoint& one) { return cost_of(one) > found_cost + doubt; });
  std::sort(known.begin() + 1, known.end(), [&](const auto& a, const auto& b) {
    return prior_distance(setup, a.parameters, estimate.parameters) <
           prior_distance(setup, b.parameters, estimate.parameters);
  });
  for (std::size_t k = 1; k < known.size(); ++k) result.other_solutions.push_back(known[k].parameters);
}

}  // namespace mottle::updating
