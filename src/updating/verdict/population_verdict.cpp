// Whether a fitted population can be right: what the specimens' residuals say.
#include <algorithm>
#include <cmath>
#include <map>

#include "mottle/core/error.hpp"
#include "mottle/stats/moments/descriptive.hpp"
#include "mottle/updating/methods/iteration.hpp"
#include "updating/methods/mean_limits.hpp"
#include "updating/population/population_report.hpp"
#include "updating/population/specimen_residuals.hpp"
#include "updating/verdict/cloud_agreement.hpp"
#include "updating/verdict/scatter_tests.hpp"
#include "updating/verdict/unknown_noise.hpp"

namespace mottle::updating {
namespace {

/// How an output's own scatter shows in the directions.
ResidualLeverage leverage_of(const UpdatingProblem& problem, const PopulationFit& fit, const MeanResiduals& residuals) {
  const Eigen::MatrixXd design = fit.noise.cwiseSqrt().asDiagonal() * residuals.mean_design;
  return {residuals.directions.rowwise().squaredNorm().cwiseQuotient(fit.noise),
          (design * fit.effects.covariance * design.transpose()).diagonal() + fit.noise, output_names(problem)};
}

/// Whether the noise of every output is more than the last digits to which specimens are fitted: identical ones leave
/// an estimate of these.
bool has_noise_everywhere(const UpdatingProblem& problem, const PopulationFit& fit) {
  const Eigen::ArrayXd size = k_last_digits * means_of_tests(problem.tests.values).transpose().array();
  return (fit.noise.array() > size.square()).all();
}

/// Entries of the covariance that the groups hold at zero, and what Box's factor takes off the specimens' number.
struct Restriction {
  double entries = 0.0;
  double correction = 0.0;
};

/// 1/2 + (q^3 - sum q_g^3) / (3 (q^2 - sum q_g^2)) for groups of q_g parameters [Box1949].
Restriction restriction_of(const std::vector<int>& groups) {
  std::map<int, double> sizes;
  for (const int group : groups) sizes[group] += 1.0;
  const auto q = static_cast<double>(groups.size());
  double squares = q * q;
  double cubes = q * q * q;
  for (const auto& [group, size] : sizes) {
    squares -= size * size;
    cubes -= size * size * size;
  }
  return {0.5 * squares, squares > 0.0 ? 0.5 + cubes / (3.0 * squares) : 0.0};
}

/// Likelihood ratio of correlations between the groups, with the factor that brings its mean to that of chi-squared:
/// the number of degrees of freedom of the covariance, n - 1, less Box's correction, over what the likelihood counts,
/// n - 1 where it is restricted and n where it is not.
void plan_correlations(const UpdatingProblem& problem, const PopulationFit& fit, TestPlan& plan) {
  const Restriction restriction = restriction_of(fit.settings.covariance_groups);
  if (!(restriction.entries > 0.0)) return;
  const auto q = static_cast<double>(fit.effects.mean.size());
  const double degrees_of_freedom = static_cast<double>(fit.units.size()) - 1.0;
  if (degrees_of_freedom <= q) {
    plan.leave_untested(Aspect::scatter,
                        fmt::format("The correlations that are left out (covariance) were not tested: {} specimens are "
                                    "too few, at least {:.0f} are needed.",
                                    fit.units.size(), q + 2.0));
    return;
  }
  RandomEffectsSettings full = fit.settings;
  full.covariance_groups.clear();
  const RandomEffectsFit free = fit_random_effects(fit.units, start_beside(problem, fit), full);
  const double counted = fit.settings.is_restricted ? degrees_of_freedom : degrees_of_freedom + 1.0;
  const double effective = degrees_of_freedom - restriction.correction;
  const double gain = std::max(free.log_likelihood - fit.effects.log_likelihood, 0.0);
  PlannedTest test = chi_squared_test("correlations", 2.0 * effective / counted * gain, restriction.entries);
  test.aspect = Aspect::scatter;
  test.meaning = fmt::format(
      "Likelihood ratio with {:.0f} degrees of freedom: are the parameters that may not be correlated uncorrelated in "
      "the tests?",
      restriction.entries);
  test.power = [=](double level) {
    constexpr double k_nearly_one = 0.95;
    const double found = chi_squared_detectable(restriction.entries, level) / effective;
    const double correlation = std::sqrt(-std::expm1(-found));
    return Power{fmt::format("a correlation of {:.2f}", correlation), correlation <= k_nearly_one};
  };
  plan.add(std::move(test));
}

/// Tests without noise that no parameters give: further off than a hundredth of the tests' scatter.
void plan_reproduction(const UpdatingProblem& problem, const PopulationFit& fit, TestPlan& plan) {
  constexpr double k_small = 0.01;
  const Eigen::VectorXd scatter = test_moments(problem.tests).covariance.diagonal().cwiseSqrt();
  std::vector<std::string> lost;
  for (Eigen::Index s = 0; s < fit.specimens.outputs.rows(); ++s) {
    const Eigen::ArrayXd off = (problem.tests.values.row(s) - fit.specimens.outputs.row(s)).transpose().array().abs();
    const bool is_off = (off > k_small * scatter.array()).any();
    if (is_off && !fit.specimens.converged[static_cast<std::size_t>(s)]) {
      lost.push_back(fmt::format("{}", problem.tests.number_of(s)));
    }
  }
  plan.add({.name = "reproduction",
            .statistic = static_cast<double>(lost.size()),
            .p_value = lost.empty() ? 1.0 : 0.0,
            .critical = [](double) { return 0.0; },
            .meaning = fmt::format("Number of specimens, of {}, whose test no parameters reproduce{}.",
                                   fit.specimens.converged.size(), lost.empty() ? "" : ": " + join(lost)),
            .share = 0.0,
            .is_listed_where_it_passes = false});
}

void plan_cloud_agreement(const UpdatingProblem& problem, const PopulationFit& fit, const UpdatingResult& result,
                          TestPlan& plan) {
  const TestMoments tests = test_moments(problem.tests);
  std::vector<bool> is_whole;
  for (const double variance : fit.noise) is_whole.push_back(variance > 0.0);
  const IterationRecord& last = result.history.back();
  plan.add(
      cloud_agreement_test({tests.covariance.diagonal(), last.output_covariance.diagonal() + fit.noise,
                            last.cloud.valid().outputs, counts_with_scatter(tests), is_whole, output_names(problem)}));
}

MeanResiduals residuals_of(const UpdatingProblem& problem, const PopulationFit& fit, const RunContext& context,
                           std::int64_t& evaluations) {
  if (!fit.model_error) return mean_residuals(problem.tests.values, fit.units, fit.noise);
  const Eigen::VectorXd& error = fit.model_error->std;
  if (is_noise_estimated(fit)) return mean_residuals(problem.tests.values, fit.units, fit.noise, error);
  return specimen_residuals(problem, {fit.mean, fit.covariance, fit.noise}, fit.specimens, fit.map, error, context,
                            evaluations);
}

}  // namespace

void plan_mean_residuals(const MeanResiduals& residuals, TestPlan& plan) {
  const double d = residuals.mean_degrees_of_freedom;
  const auto n = static_cast<double>(residuals.values.rows());
  PlannedTest test = chi_squared_test("mean-residuals", residuals.mean_squares, d);
  test.aspect = Aspect::means;
  const bool has_error = residuals.largest_variance > 1.0;
  test.meaning = fmt::format(
      "Mean residuals of {:.0f} specimens in {} that no parameter moves: are they no more than the measurement's "
      "noise{}?",
      n, directions_text(d), has_error ? " and the model's stated error" : "");
  // In units of the noise and the model's error of one test together, in the direction where the mean shows least.
  const double per_mean = residuals.largest_variance / (n + residuals.largest_variance - 1.0);
  test.power = [=, own = residuals.own_noncentrality](double level) {
    const double needed = chi_squared_detectable(d, level);
    const double shift = std::sqrt(needed * per_mean);
    // A stated error may be so large that any model agrees within it.
    const bool hides_all = has_error && std::sqrt(needed / own.maxCoeff()) > k_gross_error;
    return Power{fmt::format("means that are off by {:.2g} standard deviations of {} in one of them", shift,
                             has_error ? "the noise and the model's stated error" : "the noise"),
                 shift <= k_gross_error && !hides_all};
  };
  plan.add(std::move(test));
}

void plan_residual_tests(const UpdatingProblem& problem, const PopulationFit& fit, const RunContext& context,
                         TestPlan& plan, std::int64_t& evaluations) {
  const bool is_noise_known = !is_noise_estimated(fit);
  const bool has_noise = has_noise_everywhere(problem, fit);
  const auto do_differ = [&] {
    const TestMoments moments = test_moments(problem.tests);
    return (moments.count.array() < 2).all() || (counts_with_scatter(moments).array() > 0).any();
  };
  const bool has_level = fit.noise_of_residuals.degrees_of_freedom > 0.0;
  if (!is_noise_known && (!has_noise || !has_level || !do_differ())) {
    plan.leave_untested(
        Aspect::means,
        fmt::format("The means were not tested: {}, so that the level of the noise cannot be estimated. Give [test] "
                    "repeatability.",
                    !do_differ() ? "the specimens are the same to the last digits"
                    : !has_noise ? "the parameters reproduce every test to rounding"
                                 : "no specimen has more outputs than the parameters move"));
    plan.leave_untested(Aspect::scatter, "The scatter was not tested for the same reason.");
    return;
  }
  MeanResiduals residuals = has_noise ? residuals_of(problem, fit, context, evaluations) : MeanResiduals{};
  if (residuals.own_noncentrality.size() > 0) {  // off by the tests' standard deviation, not by 1
    residuals.own_noncentrality.array() *= test_moments(problem.tests).covariance.diagonal().array();
  }
  const bool has_scatter = residuals.degrees_of_freedom > 0.0;
  if (!has_noise || residuals.mean_degrees_of_freedom == 0.0 || (!is_noise_known && !has_scatter)) {
    const auto measured = (!problem.tests.values.array().isNaN()).rowwise().count();
    plan.leave_untested_for_lack_of_outputs(
        Aspect::means, fmt::format("The means were not tested: {} outputs are no more than the {} identifiable "
                                   "combinations of parameters, which can match any means. {}",
                                   measured.maxCoeff(), fit.seen.cols(), k_more_outputs));
    plan.leave_untested(Aspect::scatter,
                        fmt::format("The scatter was not tested: the covariance of the parameters is free to match any "
                                    "covariance of the tests. {}",
                                    k_more_outputs));
    return;
  }
  if (fit.settings.levels > 0) {
    plan.leave_untested(
        Aspect::means,
        "The means were not tested: the level of the model's error was estimated from the differences of the "
        "means. Give the model's error (model_error) as numbers: the error that you would accept.");
  } else if (is_noise_known) {
    plan_mean_residuals(residuals, plan);
  }
  if (!is_noise_known) {
    return plan_tests_of_unknown_noise(problem.tests.values, fit, residuals, problem.level, plan);
  }
  if (!has_scatter) {
    plan.leave_untested(Aspect::scatter, fmt::format("The scatter was not tested: one specimen alone has more outputs "
                                                     "than the parameters move. Measure more outputs of the others."));
    return;
  }
  const auto d = static_cast<double>(residuals.directions.cols());
  plan.add(residual_scatter_test(residuals.squares, residuals.degrees_of_freedom / d, d,
                                 leverage_of(problem, fit, residuals)));
}

void test_population(const UpdatingProblem& problem, const PopulationFit& fit, const RunContext& context,
                     UpdatingResult& result) {
  TestPlan plan;
  plan_residual_tests(problem, fit, context, plan, result.model_evaluations);
  plan_correlations(problem, fit, plan);
  plan_cloud_agreement(problem, fit, result, plan);
  if (!(fit.noise.array() > 0.0).all()) plan_reproduction(problem, fit, plan);
  const PopulationEvidence evidence = evidence_without_bounds(problem, fit);
  const Eigen::VectorXd degrees_of_freedom = evidence.degrees_of_freedom.diagonal();
  const double least = (degrees_of_freedom.array() > 0.0).select(degrees_of_freedom.array(), 1e9).minCoeff();
  plan_bound_test(problem, {evidence.mean, evidence.mean_covariance, least}, plan);
  plan_prior_shift(problem, fit.mean, evidence.mean_covariance, plan);
  plan.make(problem.level, result);
}

}  // namespace mottle::updating
