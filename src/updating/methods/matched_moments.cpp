#include "updating/methods/matched_moments.hpp"

#include <Eigen/Core>
#include <algorithm>
#include <cmath>
#include <limits>
#include <optional>

#include "mottle/core/error.hpp"
#include "mottle/linalg/dense/decompositions.hpp"
#include "mottle/updating/methods/iteration.hpp"
#include "updating/methods/least_change.hpp"
#include "updating/methods/scatter_curvature.hpp"
#include "updating/population/mean_intervals.hpp"
#include "updating/population/population_report.hpp"
#include "updating/population/specimen_residuals.hpp"
#include "updating/verdict/cloud_agreement.hpp"
#include "updating/verdict/scatter_tests.hpp"

namespace mottle::updating {
namespace {

constexpr const char* k_curvature_unknown =
    "The means were not tested: the model fails one standard deviation of the specimens' scatter away from the "
    "mean, so the effect of that scatter on the means of curved outputs is not known.";

using Scatter = MatchedEstimate::Scatter;

/// What every test of the estimate needs.
struct Comparison {
  const UpdatingProblem& problem;
  const MatchedEstimate& estimate;
  const IterationRecord& state;
  MatchedResiduals residuals;
  Eigen::MatrixXd of_cloud;               // C / N, of the cloud's mean
  double specimens = 0.0;                 // with the output that was tested least
  bool is_noise_known = false;            // of every output
  bool has_gaps = false;                  // entries are missing
  bool has_error = false;                 // of the model, stated
  bool is_scattered = true;               // every output, among the tests
  bool needs_own = false;                 // residuals of each specimen in its own unmoved directions ...
  std::optional<MeanResiduals> own = {};  // ... which are not known where the model fails at one

  bool are_means_by_specimen() const { return needs_own && estimate.is_by_specimen; }
};

Comparison compare(const UpdatingProblem& problem, const MatchedEstimate& estimate, const UpdatingResult& result) {
  const IterationRecord& state = result.history.back();
  Eigen::MatrixXd of_test = state.output_covariance;
  of_test.diagonal() += problem.tests.repeatability_std.cwiseAbs2();
  Comparison c{problem,
               estimate,
               state,
               MatchedResiduals::between(
                   test_moments(problem.tests), estimate.means.size() > 0 ? estimate.means : state.output_mean, of_test,
                   estimate.sensitivity, prior_on_scales(problem.space).covariance.diagonal().cwiseSqrt()),
               {}};
  c.has_gaps = problem.tests.values.array().isNaN().any();
  c.of_cloud =
      state.output_covariance / static_cast<double>(std::max<Eigen::Index>(state.cloud.valid().outputs.rows(), 1));
  c.specimens = c.residuals.tests.count.minCoeff();
  c.is_noise_known = (problem.tests.repeatability_std.array() > 0.0).all();
  c.has_error = (problem.tests.model_error_variance().array() > 0.0).any();
  c.needs_own = c.is_noise_known && c.residuals.directions.cols() > 0 && (estimate.is_by_specimen || c.has_error);
  c.is_scattered = (counts_with_scatter(c.residuals.tests).array() > 0).all();
  return c;
}

/// Each specimen's residuals in its own unmoved directions; nothing: the model fails at one.
std::optional<MeanResiduals> residuals_by_specimen(const Comparison& c, const RunContext& context,
                                                   std::int64_t& evaluations) {
  std::optional<MeanResiduals> own = residuals_about(c.problem, c.estimate.mean, context, evaluations);
  if (c.estimate.other_centre.size() == 0) return own;
  std::optional<MeanResiduals> other = residuals_about(c.problem, c.estimate.other_centre, context, evaluations);
  return other && (!own || other->mean_squares < own->mean_squares) ? other : own;
}

Power mean_power(double noncentrality, double specimens) {
  const double shift = std::sqrt(noncentrality / specimens);
  return {
      fmt::format("means that are off by {:.2g} standard deviations of a test in a direction that no parameter moves",
                  shift),
      shift <= k_gross_error};
}

constexpr const char* k_own_unknown =
    "the model fails at the parameters of a specimen, so that its residuals are not known.";

/// Means of the specimens' residuals, each in its own unmoved directions.
void plan_own_means(const Comparison& c, TestPlan& plan) {
  if (!c.own || c.own->mean_degrees_of_freedom <= 0.0) {
    plan.leave_untested(Aspect::means, fmt::format("The means were not tested: {}", k_own_unknown));
    return;
  }
  MeanResiduals own = *c.own;
  if (own.own_noncentrality.size() > 0)
    own.own_noncentrality.array() *= c.residuals.tests.covariance.diagonal().array();
  plan_mean_residuals(own, plan);
}

void plan_mean_test(const Comparison& c, TestPlan& plan) {
  const auto d = static_cast<double>(c.residuals.directions.cols());
  const double n = c.specimens;
  if (d == 0.0) {
    plan.leave_untested_for_lack_of_outputs(
        Aspect::means,
        fmt::format("The means were not tested: {} outputs are no more than the identifiable combinations of "
                    "parameters, which can match any means. {}",
                    c.residuals.residual.size(), k_more_outputs));
    return;
  }
  if (c.are_means_by_specimen()) return plan_own_means(c, plan);
  if (c.has_gaps) {
    plan.leave_untested(Aspect::means, gaps_untested(Aspect::means, c.estimate.method));
    return;
  }
  if (!c.is_noise_known && !c.is_scattered) {
    plan.leave_untested(
        Aspect::means,
        "The means were not tested: an output is the same in all specimens, to the last digits, and its "
        "noise is not known. Give [test] repeatability of every output.");
    return;
  }
  if (!c.residuals.residual.allFinite()) {
    plan.leave_untested(Aspect::means, k_curvature_unknown);
    return;
  }
  PlannedTest test;
  if (c.is_noise_known) {
    const double squares =
        c.residuals.mean_squares(covariance_of_tests_mean(c.problem.tests, c.residuals.of_test) + c.of_cloud);
    test = chi_squared_test("mean-agreement", squares, d);
    test.power = [=](double level) { return mean_power(chi_squared_detectable(d, level), n); };
  } else {
    const double squares =
        n > d ? c.residuals.mean_squares(covariance_of_tests_mean(c.problem.tests, c.residuals.tests.covariance) +
                                         c.of_cloud)
              : -1.0;
    if (squares < 0.0) {
      plan.leave_untested(Aspect::means,
                          fmt::format("The means were not tested: {:.0f} specimens are too few for {} of the "
                                      "outputs that no parameter moves, as their noise is not known. Give [test] "
                                      "repeatability of every output, or test more specimens.",
                                      n, directions_text(d)));
      return;
    }
    test = f_test("mean-agreement", squares * (n - d) / ((n - 1.0) * d), d, n - d);
    test.power = [=](double level) { return mean_power(f_detectable(d, n - d, level), n); };
  }
  test.aspect = Aspect::means;
  test.meaning = fmt::format(
      "{} in {} of the outputs that no parameter moves: do the tests and the updated model's "
      "cloud have the same means?",
      c.is_noise_known ? "Chi-squared" : "Hotelling's T^2, as F,", directions_text(d));
  plan.add(std::move(test));
}

void plan_residual_scatter(const Comparison& c, TestPlan& plan) {
  const Eigen::MatrixXd& b = c.residuals.directions;
  if (b.cols() == 0) {
    plan.leave_untested(Aspect::scatter,
                        fmt::format("The scatter was not tested: the covariance of the parameters can match that of "
                                    "the outputs. {}",
                                    k_more_outputs));
    return;
  }
  if (!c.is_noise_known) {
    plan.leave_untested(Aspect::scatter,
                        "The scatter was not tested: what no parameter explains may be noise of the tests, which is "
                        "not known. Give [test] repeatability of every output, or update with method = "
                        "\"maximum-likelihood\", which estimates the noise.");
    return;
  }
  if (c.has_gaps && !c.estimate.is_by_specimen) {
    plan.leave_untested(Aspect::scatter, gaps_untested(Aspect::scatter, c.estimate.method));
    return;
  }
  const CholeskyFactor factor(b.transpose() * c.residuals.of_test * b);
  const Eigen::MatrixXd whitened = factor.solve_lower(b.transpose());
  const auto d = static_cast<double>(b.cols());
  double degrees_of_freedom = c.residuals.tests.count.cast<double>().mean() - 1.0;
  double squares = degrees_of_freedom * (whitened * c.residuals.tests.covariance * whitened.transpose()).trace();
  if (c.needs_own) {
    const std::optional<MeanResiduals>& own = c.own;
    if (!own || own->degrees_of_freedom <= 0.0) {
      plan.leave_untested(Aspect::scatter, fmt::format("The scatter was not tested: {}", k_own_unknown));
      return;
    }
    squares = own->squares;
    degrees_of_freedom = own->degrees_of_freedom / d;
  }
  plan.add(residual_scatter_test(
      squares, degrees_of_freedom, d,
      {whitened.colwise().squaredNorm().transpose(), c.residuals.of_test.diagonal(), output_names(c.problem)}));
}

void plan_cloud_agreement(const Comparison& c, TestPlan& plan) {
  if (c.has_gaps) return;  // the parameters match a covariance of which each entry is of other specimens
  Eigen::VectorXd model = c.residuals.of_test.diagonal();
  const Eigen::VectorXd& noise = c.problem.tests.repeatability_std;
  if (c.estimate.scatter == Scatter::with_noise) {
    // The cloud has the noise already, but for what of it no parameter takes up: R - P R P', P = G T.
    const Eigen::VectorXd weight =
        (noise.array() > 0.0).select(noise, c.residuals.tests.covariance.diagonal().cwiseSqrt());
    const Eigen::VectorXd whitening = weight.cwiseMax(1e-300).cwiseInverse();
    const Eigen::MatrixXd gain = least_change_gain(whitening.asDiagonal() * c.estimate.sensitivity,
                                                   prior_on_scales(c.problem.space).covariance.diagonal().cwiseSqrt())
                                     .matrix *
                                 whitening.asDiagonal();
    const Eigen::MatrixXd taken_up = c.estimate.sensitivity * gain * noise.asDiagonal();
    model -= taken_up.rowwise().squaredNorm().cwiseMin(noise.cwiseAbs2());
  }
  std::vector<bool> is_whole;
  for (const double sigma : noise) is_whole.push_back(sigma > 0.0);
  PlannedTest test =
      cloud_agreement_test({c.residuals.tests.covariance.diagonal(), model, c.state.cloud.valid().outputs,
                            counts_with_scatter(c.residuals.tests), is_whole, output_names(c.problem)});
  if (c.estimate.cloud_scatter.simulated.size() > 0) judge_by_studies(c.estimate.cloud_scatter, {}, test);
  plan.add(std::move(test));
}

/// The output whose scatter in the cloud differs most from that of the tests.
void say_scatter_is_not_estimated(const Comparison& c, TestPlan& plan) {
  const Eigen::ArrayXd ratio =
      (c.residuals.of_test.diagonal().array() / c.residuals.tests.covariance.diagonal().array().max(1e-300)).sqrt();
  Eigen::Index worst = 0;
  ratio.max(1e-300).log().abs().maxCoeff(&worst);
  plan.leave_untested(
      Aspect::scatter,
      fmt::format(
          "The scatter was not tested: method '{}' does not estimate it ({}'s standard deviation in the model's "
          "cloud is {:.0f} % of the tests'). Update with method = \"maximum-likelihood\", which does.",
          c.estimate.method, c.problem.model.outputs()[static_cast<std::size_t>(worst)].name(), 100.0 * ratio(worst)));
}

/// One Gauss-Newton step that no bound stops, and the sampling covariance of where it leads.
FreeMean free_mean(const Comparison& c) {
  const Eigen::MatrixXd covariance =
      covariance_of_tests_mean(c.problem.tests, c.residuals.tests.covariance) + c.of_cloud;
  const Eigen::VectorXd whitening = covariance.diagonal()
                                        .cwiseSqrt()
                                        .cwiseMax(k_last_digits * c.residuals.tests.mean.cwiseAbs())
                                        .cwiseMax(1e-300)
                                        .cwiseInverse();
  const Eigen::MatrixXd gain = least_change_gain(whitening.asDiagonal() * c.estimate.sensitivity,
                                                 prior_on_scales(c.problem.space).covariance.diagonal().cwiseSqrt())
                                   .matrix *
                               whitening.asDiagonal();
  // What curvature adds to the tests' means is no misfit of the mean that the method looks for.
  const Eigen::VectorXd residual = c.residuals.tests.mean - c.state.output_mean;
  return {c.estimate.mean + gain * residual, gain * covariance * gain.transpose(), c.specimens - 1.0};
}

}  // namespace

MatchedEstimate matched_mean(const std::string& method, const UpdatingProblem& problem, const Eigen::VectorXd& mean,
                             const Eigen::MatrixXd& sensitivity, const RunContext& context, UpdatingResult& result) {
  MatchedEstimate estimate{.method = method, .mean = mean, .sensitivity = sensitivity};
  const bool is_noise_known = (problem.tests.repeatability_std.array() > 0.0).all();
  estimate.is_by_specimen = is_noise_known && problem.derivatives != nullptr;
  if (!estimate.is_by_specimen) {
    estimate.means = means_of_scattered(problem, mean, sensitivity, context, result.model_evaluations);
  }
  return estimate;
}

std::string gaps_untested(Aspect aspect, const std::string& method) {
  return fmt::format(
      "The {} not tested: entries are missing, and method '{}' takes each output over the specimens that have it. "
      "Update "
      "with method = \"maximum-likelihood\", whose tests take each specimen by itself.",
      aspect == Aspect::means ? "means were" : "scatter was", method);
}

void test_matched_moments(const UpdatingProblem& problem, const MatchedEstimate& estimate, const RunContext& context,
                          UpdatingResult& result) {
  if (!estimate.sensitivity.allFinite() || estimate.sensitivity.size() == 0) return;  // stopped before the first step
  Comparison comparison = compare(problem, estimate, result);
  const bool is_scatter_tested = estimate.scatter != Scatter::not_estimated;
  if (comparison.needs_own && (is_scatter_tested || comparison.are_means_by_specimen())) {
    comparison.own = residuals_by_specimen(comparison, context, result.model_evaluations);
  }
  TestPlan plan;
  plan_mean_test(comparison, plan);
  if (!is_scatter_tested) {
    say_scatter_is_not_estimated(comparison, plan);
  } else {
    plan_residual_scatter(comparison, plan);
    plan_cloud_agreement(comparison, plan);
  }
  const FreeMean free = free_mean(comparison);
  plan_bound_test(problem, free, plan);
  plan_prior_shift(problem, estimate.mean, free.covariance, plan);
  plan.make(problem.level, result);
}

}  // namespace mottle::updating
