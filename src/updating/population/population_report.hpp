// What a fitted population says beyond its moments: noise, intervals, specimens, and notes in words.
#pragma once

#include "mottle/layers.hpp"
#include "mottle/stats/population/population_intervals.hpp"
#include "mottle/updating/methods/maximum_likelihood.hpp"
#include "updating/population/mean_residuals.hpp"
#include "updating/population/solved_population.hpp"
#include "updating/verdict/test_plan.hpp"

namespace mottle::updating {

inline constexpr double k_confidence = 0.95;  // of intervals

/// The noise that a fit works with. Where it is to be estimated: one factor for each kind of the outputs without
/// repeatability, on the square of a hundredth of the tests' root mean square: of each output where the kind's noise is
/// relative, of all outputs of the kind else.
/// @param method  whose option `noise` it is, for errors
/// Throws InvalidInput: noise is to be estimated but there are no more outputs than parameters.
NoiseModel noise_model(const UpdatingProblem& problem, const MaximumLikelihoodOptions& options,
                       const std::string& method = "maximum-likelihood");

/// What the fit knows of each specimen.
SpecimenEstimates estimate_specimens(const UpdatingProblem& problem, const PopulationFit& fit);

/// The model with one level to estimate for each unit of the outputs that are open, on those squares.
NoiseModel with_levels(const UpdatingProblem& problem, NoiseModel model, const std::vector<bool>& is_open);

/// Puts sensitivity, noise, intervals, specimens, other solutions and notes of the best solution into the result.
void describe_population(const UpdatingProblem& problem, const SolvedPopulation& solved,
                         const MaximumLikelihoodOptions& options, const RunContext& context, UpdatingResult& result);

/// 95 % intervals of the population's moments by sampling theory.
ParameterIntervals analytic_intervals(const UpdatingProblem& problem, const PopulationFit& fit);

/// What the specimens show of the population, on the parameters' scales, with no bound on its mean: that of the fit, or
/// of its last linear problem solved again without bounds where they hold a mean.
PopulationEvidence evidence_without_bounds(const UpdatingProblem& problem, const PopulationFit& fit);

/// A covariance of the effects to start an estimate from: beside that of the fit, off the border where it would stay.
Eigen::MatrixXd start_beside(const UpdatingProblem& problem, const PopulationFit& fit);

/// Every specimen's most probable parameters and whitened residuals, from the fits, linear problem, effects, noise and
/// model error of a fit.
SpecimenEstimates estimate_specimens(const UpdatingProblem& problem, const PopulationFit& fit);

/// Plans the test mean-residuals of known noise; `own_noncentrality` in units of the tests' standard deviations.
void plan_mean_residuals(const MeanResiduals& residuals, TestPlan& plan);

/// Plans the tests of residuals among test_population()'s, from the same and the directions that the outputs see.
void plan_residual_tests(const UpdatingProblem& problem, const PopulationFit& fit, const RunContext& context,
                         TestPlan& plan, std::int64_t& evaluations);

/// Tests of what the estimate leaves over, at a level that is the false-alarm rate of all of them together:
///
///   mean-residuals: n |v|^2 against chi-squared (noise known) or simulated studies (noise estimated), v the mean of
///   the
///     specimens' whitened residuals in the directions that no parameter moves;
///   scatter-of-residuals: the rest of their squares against chi-squared (noise known), or their largest variance
///     against simulated studies (noise estimated);
///   correlations: likelihood ratio of a full covariance where groups restrict it, with Box's factor;
///   reproduction: every test without noise must be reproduced by some parameters;
///   scatter-agreement, bounds, prior-shift: see cloud_agreement.hpp, mean_limits.hpp.
///
/// What is not tested is said in result.not_tested.
void test_population(const UpdatingProblem& problem, const PopulationFit& fit, const RunContext& context,
                     UpdatingResult& result);

/// Intervals from populations drawn from the estimate and estimated again: see docs/theory/maximum-likelihood.md.
/// `evidence` is that of `fit`. Samples whose model runs fail are left out.
/// @throws SystemFailure  more than half of the samples fail
ParameterIntervals bootstrap_intervals(const UpdatingProblem& problem, const PopulationFit& fit,
                                       const PopulationEvidence& evidence, const PopulationFitSettings& settings,
                                       int samples, const RunContext& context, std::int64_t& evaluations);

}  // namespace mottle::updating
