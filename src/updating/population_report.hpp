// What a fitted population says beyond its moments: noise, intervals, specimens, and notes in words.
#pragma once

#include "mottle/updating/maximum_likelihood.hpp"
#include "population_fit.hpp"

namespace mottle {

/// The noise that a fit works with. Where it is to be estimated: one factor for each unit of the outputs without
/// repeatability, on the square of a hundredth of the tests' mean (frequencies) or root mean square (others).
/// Throws InvalidInput: noise is to be estimated but there are no more outputs than parameters.
NoiseModel noise_model(const UpdatingProblem& problem, const MaximumLikelihoodOptions& options);

/// Puts sensitivity, noise, intervals, specimens and notes into the result.
void describe_population(const UpdatingProblem& problem, const PopulationFit& fit,
                         const PopulationFitSettings& settings, const MaximumLikelihoodOptions& options,
                         const RunContext& context, UpdatingResult& result);

/// Tests of what the estimate leaves over, at a level that is the false-alarm rate of all of them together:
///
///   mean residuals: n |v|^2 against chi-squared (noise known) or F (noise estimated), v the mean of the specimens'
///     whitened residuals in the directions that no parameter moves;
///   scatter of residuals: the rest of their squares against chi-squared (noise known);
///   correlations: likelihood ratio of a full covariance where groups restrict it, with Bartlett's factor;
///   reproduction: every test without noise must be reproduced by some parameters.
///
/// Where there is none to make, a note says why.
void test_population(const UpdatingProblem& problem, const PopulationFit& fit, UpdatingResult& result);

/// Intervals from populations drawn from the estimate and estimated again: see docs/theory/maximum-likelihood.md.
ParameterIntervals bootstrap_intervals(const UpdatingProblem& problem, const PopulationFit& fit,
                                       const PopulationFitSettings& settings, int samples, const RunContext& context,
                                       std::int64_t& evaluations);

}  // namespace mottle
