#include "updating/methods/interval_tests.hpp"

#include <algorithm>
#include <cmath>
#include <limits>

#include "mottle/core/text.hpp"
#include "mottle/stats/distributions/standard_normal.hpp"
#include "updating/methods/interval_targets.hpp"
#include "updating/verdict/test_plan.hpp"

namespace mottle::updating {
namespace {

constexpr double k_rounding = 1e-9;

bool has_known_noise(const UpdatingProblem& problem) {
  return (problem.tests.repeatability_std.array() > 0.0).all();
}

/// What of the observed bounds of an output the image leaves, in its unit.
double uncovered(const IntervalResult& found, Eigen::Index k) {
  const OutputRange& range = found.image[static_cast<std::size_t>(k)];
  const double left = std::max(range.lower - found.tests.observed(k, 0), found.tests.observed(k, 1) - range.upper);
  return left > k_rounding * found.tests.observed.row(k).cwiseAbs().maxCoeff() ? left : 0.0;
}

/// The largest of the observed bounds' distances from the image, against the largest of so many draws of noise.
void plan_cover(const UpdatingProblem& problem, const IntervalResult& found, TestPlan& plan) {
  const bool is_known = has_known_noise(problem);
  double worst = 0.0;
  Eigen::Index output = 0;
  for (Eigen::Index k = 0; k < found.excess.rows(); ++k) {
    const double size = is_known ? problem.tests.repeatability_std(k)
                                 : std::max(found.tests.observed(k, 1) - found.tests.observed(k, 0),
                                            k_rounding * std::abs(found.tests.observed(k, 1)));
    const double left = uncovered(found, k) / size;
    if (left > worst) output = k;
    worst = std::max(worst, left);
  }
  const double draws = 2.0 * static_cast<double>(problem.tests.values.rows() * found.excess.rows());
  const std::string name = problem.model.outputs()[static_cast<std::size_t>(output)].name();
  if (!is_known && worst > 0.0) {
    plan.leave_untested(
        Aspect::scatter,
        fmt::format("An observed bound of {} lies outside the image of the box, by {:.3g} of the width of its bounds: "
                    "whether that is more than noise is not known. Give [test] repeatability.",
                    name, worst));
    return;
  }
  PlannedTest test{.name = "cover", .statistic = worst};
  test.p_value = is_known ? std::min(1.0, draws * standard_normal_cdf(-worst)) : 1.0;
  test.critical = [=](double level) { return is_known ? -standard_normal_quantile(level / draws) : 0.0; };
  test.share = is_known ? 1.0 : 0.0;
  test.meaning = fmt::format(
      "Largest distance of an observed bound from the image of the box, in {}, of {}: do the outputs of the box reach "
      "the bounds of the tests?",
      is_known ? "standard deviations of the noise" : "widths of the observed bounds", name);
  plan.add(std::move(test));
}

void plan_residuals(const UpdatingProblem& problem, const SpecimenResiduals& residuals, TestPlan& plan) {
  if (residuals.degrees_of_freedom == 0) {
    plan.leave_untested_for_lack_of_outputs(
        Aspect::means, fmt::format("The outputs were not tested: parameters of its own can match every specimen, so "
                                   "that the model cannot be refused. {}",
                                   k_more_outputs));
    return;
  }
  if (!has_known_noise(problem)) {
    plan.leave_untested(Aspect::means,
                        "The outputs were not tested: the noise is not known, so that nothing says how near parameters "
                        "of its own must bring the model to a specimen. Give [test] repeatability.");
    return;
  }
  const double freedom = residuals.degrees_of_freedom;
  PlannedTest test = chi_squared_test("residuals", residuals.sum_of_squares, freedom);
  test.aspect = Aspect::means;
  test.meaning = fmt::format(
      "Chi-squared with {:.0f} degrees of freedom: does the model at parameters of its own come as near to every "
      "specimen as the noise lets it?",
      freedom);
  test.power = [=](double level) {
    const double found = std::sqrt(chi_squared_detectable(freedom, level) / freedom);
    return Power{
        fmt::format("an error of the model of {:.2g} standard deviations of the noise in every output that no "
                    "parameter takes up",
                    found)};
  };
  plan.add(std::move(test));
}

/// Bounds beyond the observed ones that no box covers are no test, but not covered.
void say_limits(const UpdatingProblem& problem, const IntervalResult& found, UpdatingResult& result) {
  std::vector<std::string> names;
  for (Eigen::Index k = 0; k < found.excess.rows(); ++k) {
    if (uncovered(found, k) > 0.0 || found.excess.row(k).minCoeff() >= 0.0) continue;
    names.push_back(problem.model.outputs()[static_cast<std::size_t>(k)].name());
  }
  if (names.empty()) return;
  result.not_tested.push_back(
      fmt::format("The tolerance limits of {} are not covered by any box within {}, the observed bounds are: whether "
                  "the population "
                  "goes so far is not known.",
                  join(names), limits_of_search(problem, found)));
}

}  // namespace

void test_box(const UpdatingProblem& problem, const IntervalResult& found, const SpecimenResiduals& residuals,
              UpdatingResult& result) {
  TestPlan plan;
  plan_cover(problem, found, plan);
  plan_residuals(problem, residuals, plan);
  plan.make(problem.level, result);
  say_limits(problem, found, result);
}

}  // namespace mottle::updating
