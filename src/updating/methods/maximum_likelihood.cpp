#include "mottle/updating/methods/maximum_likelihood.hpp"

#include <algorithm>
#include <cmath>
#include <limits>
#include <map>

#include "mottle/core/subject.hpp"
#include "mottle/stats/moments/distance.hpp"
#include "mottle/updating/methods/iteration.hpp"
#include "updating/fits/regional_problem.hpp"
#include "updating/population/linear_record.hpp"
#include "updating/population/model_error.hpp"
#include "updating/population/population_report.hpp"
#include "updating/population/solved_population.hpp"

namespace mottle::updating {
namespace {

using Options = MaximumLikelihoodOptions;

}  // namespace

const OptionTable<Options>& maximum_likelihood_option_table() {
  static const OptionTable<Options> table =
      OptionTable<Options>()
          .choice<Options::Likelihood>(
              "likelihood", &Options::likelihood,
              {{"restricted", Options::Likelihood::restricted}, {"plain", Options::Likelihood::plain}},
              "Restricted likelihood, whose standard deviations are not too small where specimens are few, or the "
              "plain one.")
          .choice<Options::Noise>(
              "noise", &Options::noise,
              {{"automatic", Options::Noise::automatic},
               {"given", Options::Noise::given},
               {"estimated", Options::Noise::estimated}},
              "Measurement noise: as given by [test] repeatability (zero for outputs without it), or estimated, "
              "with one level for each kind of output (for frequencies a fraction of the value). Automatic: "
              "estimated for the outputs without repeatability where there are more outputs than parameters, else "
              "given.")
          .choice<Options::Intervals>("intervals", &Options::intervals,
                                      {{"analytic", Options::Intervals::analytic},
                                       {"bootstrap", Options::Intervals::bootstrap},
                                       {"none", Options::Intervals::none}},
                                      "Confidence intervals from sampling theory, or from samples of specimens drawn "
                                      "from the estimate and updated again.")
          .integer("bootstrap_samples", &Options::bootstrap_samples, {.lower = 100.0, .upper = 100000.0}, "-",
                   "Number of bootstrap samples, each of all specimens, for the intervals.")
          .number("rank_tolerance", &Options::rank_tolerance, {.lower = 0.0, .upper = 1.0}, "-",
                  "A combination of parameters counts as not identifiable, and keeps its prior mean, if one prior "
                  "standard deviation of it moves the outputs by less than this fraction of the strongest "
                  "combination's effect.");
  return table;
}

UpdatingResult MaximumLikelihoodUpdater::update(const UpdatingProblem& problem, const RunContext& context) const {
  const Eigen::Index specimens = problem.tests.values.rows();
  require_of(specimens >= 2, {Subject::Kind::method, "maximum-likelihood"},
             "{} specimen has no scatter to explain; at least 2 are needed, or use method = "
             "\"deterministic\"",
             specimens);
  require_repeated_outputs(problem.tests, problem.model.outputs());
  const TestMoments tests = test_moments(problem.tests);
  UpdatingResult result;
  result.is_population = true;
  result.status = UpdatingStatus::max_iterations;
  const PopulationFitSettings settings{.noise = noise_model(problem, options_),
                                       .model_error = model_error_model(problem),
                                       .is_restricted = options_.likelihood == Options::Likelihood::restricted,
                                       .rank_tolerance = options_.rank_tolerance,
                                       .iterations = problem.iterations,
                                       .tolerance = problem.tolerance};
  append_state(result, record_state(problem, tests, problem.space.prior(), 0, context));
  result.mean = problem.space.prior().mean();
  result.covariance = problem.space.prior().covariance();
  result.message = "stopped on request before the first iteration";
  if (context.stop_requested()) {
    result.status = UpdatingStatus::stopped;
    return result;
  }
  begin_iteration(problem, 1, context);
  const auto record = record_iterations(problem, tests, context, result);
  const auto follow = [&](const PopulationFit& now) {
    if (context.stop_requested()) result.status = UpdatingStatus::stopped;
    return record(now);
  };
  const SolvedPopulation solved =
      solve_population(problem, settings, result.history.front().cloud, context, follow, result.model_evaluations);
  const PopulationFit& fit = solved.best();
  if (fit.converged) result.status = UpdatingStatus::converged;
  result.message =
      ending_message(result.status, static_cast<std::size_t>(fit.iterations), problem.tolerance,
                     {.at_rest = "no mean and no standard deviation moves", .moving = "means and standard deviations"});
  const bool is_stopped = result.status == UpdatingStatus::stopped;
  result.set_estimate(std::make_shared<NormalPopulation>(
      problem.space.transforms(),
      PopulationOnScales{fit.mean, fit.covariance, is_stopped ? PopulationEvidence{} : evidence_of(fit)},
      is_stopped ? 0 : problem.tests.values.rows()));
  if (is_stopped) return result;
  const RegionalProblem near(problem, fit.region);
  IterationRecord last = record_state(near.problem(), tests, *result.estimate, context);
  result.model_evaluations += last.cloud.samples.rows();
  result.history.back() = std::move(last);
  context.phase({.name = "intervals and tests of the estimate"});
  describe_population(problem, solved, options_, context, result);
  return result;
}

}  // namespace mottle::updating
