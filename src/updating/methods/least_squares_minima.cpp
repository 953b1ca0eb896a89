#include "updating/methods/least_squares_minima.hpp"

#include <algorithm>
#include <cmath>
#include <optional>
#include <vector>

#include "mottle/core/error.hpp"
#include "mottle/stats/distributions/chi_squared.hpp"
#include "mottle/updating/methods/deterministic.hpp"
#include "updating/fits/mean_solutions.hpp"

namespace mottle::updating {
namespace {

constexpr double k_apart = 0.1;  // prior deviations: nearer minima are one for every purpose

struct Minimum {
  LeastSquaresPoint point;
  double cost = 0.0;
  bool is_from_prior = false;
};

/// The minimum that a descent from `start` ends in; nothing: it fails or does not end.
std::optional<Minimum> descend(const UpdatingProblem& problem, const LeastSquares& setup, const Eigen::VectorXd& start,
                               const RunContext& context, std::int64_t& evaluations) {
  LeastSquaresPoint point{problem.space.clamp(start), {}, {}};
  const auto outputs = evaluate_one(problem, point.parameters, context, evaluations);
  if (!outputs) return std::nullopt;
  point.outputs = *outputs;
  try {
    point.sensitivity = model_jacobian(problem, point.parameters, setup.prior_std, context, evaluations);
    for (int index = 0; index < problem.iterations && !context.stop_requested(); ++index) {
      if (!has_full_rank(setup, point.sensitivity)) return std::nullopt;
      const double movement = step_down(problem, setup, point, context, evaluations);
      if (movement > problem.tolerance) continue;
      const double least = cost(setup, point.parameters, point.outputs);
      return Minimum{std::move(point), least};
    }
  } catch (const ModelFailure&) {  // NOLINT(bugprone-empty-catch): a start that leads nowhere
  }
  return std::nullopt;
}

/// Whether the outputs of the linear model at one minimum differ beyond doubt at the other.
bool are_apart(const LeastSquares& setup, const Minimum& a, const Minimum& b, double doubt) {
  const Eigen::VectorXd between = b.point.parameters - a.point.parameters;
  const Eigen::VectorXd moved = a.point.sensitivity * between;
  return between.cwiseQuotient(setup.prior_std).cwiseAbs().maxCoeff() >= k_apart &&
         moved.cwiseAbs2().dot(setup.weight) > doubt;
}

void name_others(const LeastSquares& setup, const std::vector<Minimum>& minima, double doubt, UpdatingResult& result) {
  std::vector<const Minimum*> kept{&minima.front()};
  double sum = 1.0;
  for (const Minimum& one : minima) {
    if (one.cost > minima.front().cost + doubt) break;
    const bool is_new =
        std::ranges::all_of(kept, [&](const Minimum* other) { return are_apart(setup, *other, one, doubt); });
    if (!is_new) continue;
    kept.push_back(&one);
    const double weight = std::exp(0.5 * (minima.front().cost - one.cost));
    sum += weight;
    result.other_solutions.push_back({.mean = one.point.parameters, .weight = weight});
  }
  for (OtherSolution& other : result.other_solutions) other.weight /= sum;
}

}  // namespace

Eigen::VectorXd start_at_lowest(const UpdatingProblem& problem, const LeastSquares& setup, const RunContext& context,
                                UpdatingResult& result) {
  const Eigen::VectorXd variance = setup.weight.cwiseInverse();
  const MeanSearchSettings settings{.starts = problem.starts,
                                    .noise = variance,
                                    .variance = variance,
                                    .expected_residual = generous_residual(problem)};
  Eigen::VectorXd prior = problem.space.clamp(setup.start);
  if (problem.starts == 0) result.search = SolutionSearch{};
  if (problem.starts == 0 || context.stop_requested()) return prior;
  const MeanSolutions found = find_mean_solutions(problem, setup.target.transpose(), settings,
                                                  result.history.front().cloud, context, result.model_evaluations);
  result.search = SolutionSearch{.starts = found.starts, .is_settled = found.solutions.front().met >= 2};
  std::vector<Minimum> minima;
  const auto add = [&](const Eigen::VectorXd& start, bool is_from_prior) {
    std::optional<Minimum> minimum = descend(problem, setup, start, context, result.model_evaluations);
    if (!minimum) return;
    minimum->is_from_prior = is_from_prior;
    minima.push_back(std::move(*minimum));
  };
  add(prior, true);
  const std::vector<ParameterTransform> scales = problem.space.transforms();
  for (const MeanSolution& solution : found.solutions)
    add(to_variables(scales, solution.point.transpose()).row(0), false);
  if (minima.empty()) return prior;
  const double doubt = chi_squared_quantile(1.0 - problem.level, static_cast<double>(setup.start.size()));
  // The descent from the prior comes first among equals.
  constexpr double k_equal = 1e-6;
  std::ranges::stable_sort(minima,
                           [&](const Minimum& a, const Minimum& b) { return a.cost < b.cost - k_equal * doubt; });
  name_others(setup, minima, doubt, result);
  return minima.front().is_from_prior ? prior : minima.front().point.parameters;
}

}  // namespace mottle::updating
