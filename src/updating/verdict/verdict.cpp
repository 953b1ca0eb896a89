#include "mottle/updating/verdict/verdict.hpp"

#include <algorithm>
#include <cmath>
#include <limits>

#include "mottle/core/error.hpp"
#include "mottle/core/text.hpp"
#include "mottle/updating/methods/iteration.hpp"

namespace mottle::updating {
namespace {

/// Solutions that the tests do not tell apart, and those that may not have been found.
void say_what_is_open(const UpdatingResult& result, Verdict& verdict) {
  double others = 0.0;
  for (const OtherSolution& other : result.other_solutions) others += other.weight;
  if (others > verdict.level) {
    verdict.not_tested.push_back(fmt::format(
        "Which of {} solutions is the structure's was not decided: the others have a probability of {:.2g} % together. "
        "Measure an output that differs between them (a shape at a place that tells like parts apart, a frequency with "
        "a known mass added), or state a prior or bounds that leave one of them.",
        result.other_solutions.size() + 1, 100.0 * others));
  }
  if (result.search && result.search->starts > 0 && !result.search->is_settled) {
    verdict.not_tested.push_back(fmt::format(
        "Whether further parameters explain the tests was not decided: the search for solutions ended after {} starts "
        "and had met some of them only once. Give it more starts (update.starts).",
        result.search->starts));
  }
}

/// Whether the tests speak of the method's own answer: where the iteration was cut off, of a point that hardly moves.
bool is_at_rest(const UpdatingProblem& problem, const UpdatingResult& result) {
  constexpr double k_hardly = 0.1;  // of a prior deviation, by the last step
  if (result.status == UpdatingStatus::converged) return true;
  const std::size_t states = result.history.size();
  if (states < 3) return false;
  const IterationRecord& before = result.history[states - 2];
  const IterationRecord& last = result.history[states - 1];
  return largest_movement(problem.space.prior().covariance().diagonal().cwiseSqrt(), before.parameter_mean,
                          before.parameter_covariance, last.parameter_mean, last.parameter_covariance) <= k_hardly;
}

void say_tests(const UpdatingResult& result, Verdict& verdict) {
  for (const VerdictTest& test : result.tests) {
    verdict.reasons.push_back(
        fmt::format("{} {} (statistic {:.4g}, critical value {:.4g}, p = {:.3g}).", test.meaning,
                    test.passed ? "They agree as well as chance allows." : "They differ by more than chance allows.",
                    test.statistic, test.critical, test.p_value));
  }
}

/// "mean", or "median" of a population that is normal on another scale, with its mean, which no bound holds for.
std::string bounded_quantity(const UpdatingProblem& problem, const UpdatingResult& result, Eigen::Index i) {
  const Parameter& parameter = problem.space.parameters()[static_cast<std::size_t>(i)];
  const bool is_median = result.is_population && parameter.transform.kind != ParameterTransform::Kind::identity;
  if (!is_median) return fmt::format("The mean of {}", parameter.name);
  return fmt::format("The median of {} (its mean is {:.4g}; bounds hold for the median)", parameter.name,
                     result.mean(i));
}

/// Means on their bounds or physical limits. That they lie there is no reason by itself: the test of bounds decides.
void say_bounds(const UpdatingProblem& problem, const UpdatingResult& result, Verdict& verdict) {
  constexpr double k_on_limit = 1e-9;
  const auto test = std::find_if(result.tests.begin(), result.tests.end(),
                                 [](const VerdictTest& made) { return made.name == "bounds"; });
  const bool is_refused = test != result.tests.end() && !test->passed;
  const double infinity = std::numeric_limits<double>::infinity();
  const Eigen::VectorXd location = result.location();
  const Eigen::VectorXd lowest = problem.space.clamp(Eigen::VectorXd::Constant(result.mean.size(), -infinity));
  const Eigen::VectorXi active = problem.space.active_bounds(location);
  for (Eigen::Index i = 0; i < active.size(); ++i) {
    const bool is_on_limit = location(i) <= lowest(i) + k_on_limit * std::abs(lowest(i));
    if (active(i) == 0 && !is_on_limit) continue;
    const char* kind = active(i) > 0 ? "upper bound" : active(i) < 0 ? "lower bound" : "physical limit";
    verdict.reasons.push_back(fmt::format(
        "{} ended on its {}, {:.6g}: {}", bounded_quantity(problem, result, i), kind, location(i),
        is_refused ? "within the bounds the chosen parameters cannot explain the tests, so something else in the model "
                     "is wrong or missing."
                   : "the tests do not speak against it, and do not determine it either."));
  }
}

/// "k1 = 1.2, k2 = 0.9".
std::string values_text(const UpdatingProblem& problem, const Eigen::VectorXd& parameters) {
  std::vector<std::string> values;
  for (Eigen::Index i = 0; i < parameters.size(); ++i) {
    values.push_back(
        fmt::format("{} = {:.4g}", problem.space.parameters()[static_cast<std::size_t>(i)].name, parameters(i)));
  }
  return join(values);
}

/// " (k1 lies outside the range of its prior, [1, 2])"; a solution of the fit, which knows the prior's moments alone,
/// need not lie where the prior does.
std::string beyond_priors_text(const UpdatingProblem& problem, const Eigen::VectorXd& parameters) {
  std::vector<std::string> beyond;
  const std::vector<Distribution>& priors = problem.space.prior().marginals();
  for (std::size_t i = 0; i < priors.size(); ++i) {
    const double value = parameters(static_cast<Eigen::Index>(i));
    if (value >= priors[i].lower() && value <= priors[i].upper()) continue;
    beyond.push_back(fmt::format("{} lies outside the range of its prior, [{:.4g}, {:.4g}]",
                                 problem.space.parameters()[i].name, priors[i].lower(), priors[i].upper()));
  }
  return beyond.empty() ? "" : fmt::format(" ({})", join(beyond, "; "));
}

void say_specimens_and_solutions(const UpdatingProblem& problem, const UpdatingResult& result, Verdict& verdict) {
  for (const Outlier& outlier : result.outliers) {
    verdict.reasons.push_back(fmt::format(
        "Specimen {} lies {:.1f} standard deviations from the others (p = {:.2g} among all of them): check its "
        "test before trusting means and standard deviations.",
        problem.tests.number_of(outlier.sample), outlier.distance, outlier.p_value));
  }
  for (const OtherSolution& other : result.other_solutions) {
    verdict.reasons.push_back(
        fmt::format("Other parameters explain the tests as well, with a probability of {:.2g} %: {}{}.",
                    100.0 * other.weight, values_text(problem, other.mean), beyond_priors_text(problem, other.mean)));
  }
}

}  // namespace

std::string conclusion_text(Conclusion conclusion) {
  switch (conclusion) {
    case Conclusion::adequate:
      return "adequate";
    case Conclusion::inadequate:
      return "inadequate";
    default:
      return "undecided";
  }
}

Verdict judge(const UpdatingProblem& problem, const UpdatingResult& result) {
  Verdict verdict;
  verdict.level = problem.level;
  verdict.tests = result.tests;
  verdict.not_tested = result.not_tested;
  verdict.lacks_outputs = result.lacks_outputs;
  say_tests(result, verdict);
  say_bounds(problem, result, verdict);
  say_specimens_and_solutions(problem, result, verdict);
  say_what_is_open(result, verdict);
  const bool has_failed =
      std::any_of(result.tests.begin(), result.tests.end(), [](const VerdictTest& test) { return !test.passed; });
  // A failed test counts where a better solution is not likely to be left.
  const bool is_searched = !result.search || result.search->starts == 0 || result.search->is_settled ||
                           result.search->starts >= k_more_starts * problem.starts;
  const bool counts = is_at_rest(problem, result) && is_searched;
  if (result.status != UpdatingStatus::converged) {
    verdict.not_tested.push_back(
        fmt::format("The iteration did not converge: {}. {}", result.message,
                    counts ? "Its last step was small, so tests that failed count; tests that passed do not."
                           : "Tests of an unfinished update say nothing about the model. Allow more iterations, or "
                             "start nearer to the solution."));
  }
  const bool is_tested = !result.tests.empty() && verdict.not_tested.empty();
  verdict.conclusion = has_failed && counts ? Conclusion::inadequate
                       : is_tested          ? Conclusion::adequate
                                            : Conclusion::undecided;
  return verdict;
}

}  // namespace mottle::updating
