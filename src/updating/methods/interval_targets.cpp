#include "updating/methods/interval_targets.hpp"

#include <algorithm>
#include <limits>

#include "mottle/core/error.hpp"
#include "mottle/core/text.hpp"

namespace mottle::updating {
namespace {

constexpr double k_reach = 10.0;  // prior standard deviations
constexpr double k_infinity = std::numeric_limits<double>::infinity();

Eigen::VectorXd prior_deviations(const UpdatingProblem& problem) {
  return problem.space.prior().covariance().diagonal().cwiseSqrt();
}

/// Parameters of which an end of the box is at a limit of the search.
struct Held {
  std::vector<std::string> by_reach;  ///< by k_reach, inside of bounds and physical limits
  bool is_any_by_bounds = false;
};

Held held_parameters(const UpdatingProblem& problem, const IntervalResult& found) {
  constexpr double k_at_end = 1e-3;  // widths: targets are a little inside what the limits reach
  const Eigen::Index q = found.allowed.lower.size();
  const Eigen::VectorXd slack = k_at_end * found.allowed.width();
  const Eigen::VectorXd lowest = problem.space.clamp(Eigen::VectorXd::Constant(q, -k_infinity));
  const Eigen::VectorXd highest = problem.space.clamp(Eigen::VectorXd::Constant(q, k_infinity));
  bool is_any_left_out = false;  // then the box itself did not go to the limits
  for (Eigen::Index k = 0; k < found.asked.rows(); ++k) is_any_left_out = is_any_left_out || is_left_out(found, k);
  Held held;
  for (Eigen::Index i = 0; i < q; ++i) {
    const bool is_at_lower = is_any_left_out || found.box.lower(i) <= found.allowed.lower(i) + slack(i);
    const bool is_at_upper = is_any_left_out || found.box.upper(i) >= found.allowed.upper(i) - slack(i);
    const bool is_by_reach =
        (is_at_lower && found.allowed.lower(i) > lowest(i)) || (is_at_upper && found.allowed.upper(i) < highest(i));
    if (is_by_reach) held.by_reach.push_back(problem.space.parameters()[static_cast<std::size_t>(i)].name);
    held.is_any_by_bounds = held.is_any_by_bounds || (is_at_lower && found.allowed.lower(i) <= lowest(i)) ||
                            (is_at_upper && found.allowed.upper(i) >= highest(i));
  }
  return held;
}

}  // namespace

CoverTask cover_task(const UpdatingProblem& problem, const Eigen::MatrixXd& limits, const ParameterBox& hull) {
  CoverTask task;
  task.targets = limits;
  task.scale = limits.col(1) - limits.col(0);
  for (Eigen::Index k = 0; k < task.scale.size(); ++k) {
    const double size = limits.row(k).cwiseAbs().maxCoeff();
    task.scale(k) = std::max(task.scale(k), size > 0.0 ? 1e-6 * size : 1.0);
  }
  task.unit = prior_deviations(problem);
  const Eigen::VectorXd mean = problem.space.prior().mean();
  const Eigen::VectorXd reach = k_reach * task.unit;
  task.allowed = {problem.space.clamp((mean - reach).cwiseMin(hull.lower - reach)),
                  problem.space.clamp((mean + reach).cwiseMax(hull.upper + reach))};
  task.max_iterations = std::max(1, problem.iterations);
  task.tolerance = 1e-3 * problem.tolerance;
  return task;
}

Eigen::MatrixXd keep_what_is_possible(BoxImage& image, CoverTask& task) {
  std::vector<OutputRange> most;
  try {
    most = image.ranges(task.allowed);
  } catch (const ModelFailure&) {  // far from the tests: the targets stay, and what is not covered is said
    return {};
  }
  Eigen::MatrixXd reachable(task.targets.rows(), 2);
  for (Eigen::Index k = 0; k < reachable.rows(); ++k) {
    reachable.row(k) << most[static_cast<std::size_t>(k)].lower, most[static_cast<std::size_t>(k)].upper;
  }
  const Eigen::ArrayXd width = (reachable.col(1) - reachable.col(0)).array();
  const Eigen::ArrayXd asked = (task.targets.col(1) - task.targets.col(0)).array();
  const bool is_any_wide = (width >= asked && width > 0.0).any();
  for (Eigen::Index k = 0; k < reachable.rows(); ++k) {
    const double inside = 1e-6 * std::min(task.scale(k), width(k));  // the corner itself need not be reached
    if (!(inside > 0.0) || (is_any_wide && width(k) < asked(k))) {
      task.targets.row(k) << k_infinity, -k_infinity;
    } else {
      task.targets(k, 0) = std::max(task.targets(k, 0), reachable(k, 0) + inside);
      task.targets(k, 1) = std::min(task.targets(k, 1), reachable(k, 1) - inside);
    }
  }
  return reachable;
}

bool is_left_out(const IntervalResult& found, Eigen::Index output) {
  return found.asked(output, 0) == k_infinity;
}

std::string limits_of_search(const UpdatingProblem& problem, const IntervalResult& found) {
  const Held held = held_parameters(problem, found);
  std::string bounds = "the bounds of the parameters";
  if (held.by_reach.empty()) return bounds;
  return fmt::format("{}{:.0f} prior standard deviations of {} about prior and specimens (where the search ends)",
                     held.is_any_by_bounds ? bounds + " and " : "", k_reach, join(held.by_reach));
}

std::string advice_on_limits(const UpdatingProblem& problem, const IntervalResult& found) {
  const Held held = held_parameters(problem, found);
  if (held.by_reach.empty()) return "";
  return fmt::format(" Where it may go further, give a wider distribution to {}.", join(held.by_reach));
}

}  // namespace mottle::updating
