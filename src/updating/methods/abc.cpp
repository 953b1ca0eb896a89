#include "mottle/updating/methods/abc.hpp"

#include <algorithm>
#include <cmath>
#include <limits>

#include "mottle/core/subject.hpp"
#include "mottle/updating/methods/iteration.hpp"
#include "mottle/updating/methods/maximum_likelihood.hpp"
#include "updating/fits/measured_outputs.hpp"
#include "updating/methods/abc_report.hpp"
#include "updating/methods/abc_verdict.hpp"
#include "updating/methods/matched_moments.hpp"
#include "updating/methods/moment_iteration.hpp"
#include "updating/population/model_error.hpp"
#include "updating/population/population_report.hpp"

namespace mottle::updating {
namespace {

NoiseModel noise_of(const UpdatingProblem& problem, const AbcOptions& options) {
  using Noise = MaximumLikelihoodOptions::Noise;
  // Noise that is not stated counts as none, whatever the number of outputs: distances do not ask for a density.
  if (options.noise == AbcOptions::Noise::given) {
    return known_noise(problem.tests.repeatability_std.cwiseAbs2());
  }
  return noise_model(
      problem, {.noise = options.noise == AbcOptions::Noise::automatic ? Noise::automatic : Noise::estimated}, "abc");
}

bool estimates_correlations(const UpdatingProblem& problem, const AbcOptions& options) {
  constexpr Eigen::Index k_specimens_a_parameter = 2;
  const Eigen::Index q = problem.space.count();
  if (q == 1 || options.correlations == AbcOptions::Correlations::none) return false;
  return options.correlations == AbcOptions::Correlations::estimated ||
         problem.tests.values.rows() >= k_specimens_a_parameter * (q + 1);
}

/// A state as the moment methods describe it, for what they know of specimens.
MomentState state_of(const NearestPopulation& nearest, const SampledPopulation& population,
                     const IterationRecord& last) {
  MomentState state;
  state.mean = population.mean;
  state.covariance = population.covariance();
  state.output_mean = last.output_mean;
  state.output_covariance = last.output_covariance;
  state.sensitivity = nearest.transport->sensitivity(population.mean);
  return state;
}

PopulationEvidence evidence_of_state(const UpdatingProblem& problem, const ScaledParameters& parameters,
                                     const MomentState& state, const Eigen::VectorXd& noise_std) {
  UpdatingProblem with_noise = problem;
  with_noise.tests.repeatability_std = noise_std;
  PopulationEvidence evidence = moment_evidence(with_noise, parameters, state);
  // Of the method's own covariance, as the total is.
  evidence.mean_covariance = evidence.total / static_cast<double>(problem.tests.values.rows());
  return evidence;
}

/// Spreads of proposals by normal theory; generous, as sampling narrows them.
RoughKnowledge rough_knowledge(const PopulationCoordinates& coordinates, const ScaledParameters& parameters,
                               const Eigen::VectorXd& at, const PopulationEvidence& evidence, double specimens) {
  constexpr double k_least = 0.01;
  constexpr double k_most_of_deviation = 1.0;
  constexpr double k_level = 0.3;
  constexpr double k_half = 0.3;  // of noise's share: below it a standard deviation hardly shows
  const Eigen::Index q = coordinates.parameters();
  RoughKnowledge known{at, Eigen::VectorXd::Constant(at.size(), k_level), Eigen::VectorXd::Zero(q)};
  const double freedom = std::max(specimens - 1.0, 1.0);
  for (Eigen::Index i = 0; i < q; ++i) {
    const double unit = parameters.standard_deviation()(i);
    const double share = std::sqrt(std::max(evidence.noise(i, i), 0.0));
    known.noise_share(i) = std::isfinite(share) ? share : 0.0;
    known.std(i) = std::sqrt(std::max(evidence.mean_covariance(i, i), 0.0)) / unit;
    if (!(known.std(i) > k_least * std::exp(at(q + i)))) known.std(i) = k_least * std::exp(at(q + i));
    const double least = std::log(std::max(k_half * known.noise_share(i) / unit, 1e-300));
    known.centre(q + i) = std::max(at(q + i) + 0.5 * std::log((freedom + 1.0) / freedom), least);
    const double own = unit * std::exp(known.centre(q + i));
    const double swollen = 1.0 + known.noise_share(i) * known.noise_share(i) / (own * own);
    known.std(q + i) = std::min(swollen / std::sqrt(2.0 * freedom), k_most_of_deviation);
  }
  const double of_fisher_z = 1.0 / std::sqrt(std::max(specimens - 3.0, 1.0));
  known.std.segment(2 * q, coordinates.correlations()).setConstant(of_fisher_z);
  return known;
}

/// Means and standard deviations are those of the nearest population, the former within bounds, the latter less their
/// bias in simulated studies; correlations and levels of noise are means of the draws. What the outputs do not
/// determine stays as it is.
Eigen::VectorXd estimated_coordinates(const AbcFit& fit, const SampledPopulations& sampled) {
  Eigen::VectorXd at = fit.nearest.coordinates;
  const Eigen::Index q = fit.coordinates.parameters();
  if (std::find(fit.is_seen.begin(), fit.is_seen.end(), false) != fit.is_seen.end()) return at;
  at.tail(at.size() - q) = sampled.draws.mean.tail(at.size() - q);
  at.segment(q, q) = sampled.log_deviation;
  return at.cwiseMax(fit.coordinates.lower()).cwiseMin(fit.coordinates.upper());
}

/// Simulates from the nearest population on, and puts what follows into the result.
void sample_and_describe(const UpdatingProblem& problem, const ScaledParameters& parameters,
                         const PopulationCoordinates& coordinates, const NearestPopulation& nearest,
                         const AbcOptions& options, const RunContext& context, UpdatingResult& result) {
  const TestMoments tests = test_moments(problem.tests);
  const auto specimens = static_cast<double>(problem.tests.values.rows());
  const SampledPopulation start = coordinates.at(nearest.coordinates);
  const MomentState first = state_of(nearest, start, result.history.back());
  const PopulationEvidence rough = evidence_of_state(problem, parameters, first, start.noise_std);
  Eigen::VectorXd unit(tests.mean.size());
  for (Eigen::Index k = 0; k < unit.size(); ++k) {
    unit(k) = weighing_deviation(std::sqrt(tests.covariance(k, k)), tests.mean(k));
  }
  const AbcFit fit{problem,
                   parameters,
                   coordinates,
                   nearest,
                   options,
                   coordinates.correlations() > 0,
                   seen_parameters(parameters, first.sensitivity, unit)};
  const SampledPopulations sampled = sample_populations(
      problem, coordinates, nearest, rough_knowledge(coordinates, parameters, nearest.coordinates, rough, specimens),
      options, context);
  const SampledPopulation population = coordinates.at(estimated_coordinates(fit, sampled));
  MomentState state = state_of(nearest, population, result.history.back());
  result.set_estimate(std::make_shared<NormalPopulation>(
      parameters.scales(),
      PopulationOnScales{state.mean, state.covariance,
                         evidence_of_state(problem, parameters, state, population.noise_std)},
      problem.tests.values.rows()));
  append_state(result, record_state(problem, tests, *result.estimate, context));
  context.phase({.name = "intervals and tests of the estimate"});
  result.sensitivity = state.sensitivity * parameters.slopes(state.mean).cwiseInverse().asDiagonal();
  result.noise_covariance = population.noise_std.cwiseAbs2().asDiagonal();
  describe_abc(fit, sampled, result);
  test_matched_moments(problem,
                       {.method = "abc",
                        .mean = state.mean,
                        .sensitivity = state.sensitivity,
                        .scatter = MatchedEstimate::Scatter::without_noise,
                        .is_by_specimen = true,
                        .cloud_scatter = studied_cloud_scatter(fit, sampled)},
                       context, result);
  if (!(problem.tests.repeatability_std.array() > 0.0).all()) {
    result.notes.emplace_back(
        "The level of the verdict's test of the means is not calibrated: the noise of an output is not stated, and the "
        "test counts the updated cloud, which has a Monte-Carlo error, as exact. Give [test] repeatability of every "
        "output.");
  }
  note_model_error(problem, "abc",
                   "is drawn anew for every simulated set of tests and every mean: intervals of means include it.",
                   result);
}

}  // namespace

const OptionTable<AbcOptions>& abc_option_table() {
  using A = AbcOptions;
  static const OptionTable<A> table =
      OptionTable<A>()
          .choice<A::Distance>(
              "distance", &A::distance,
              {{"energy", A::Distance::energy}, {"sliced-wasserstein", A::Distance::sliced_wasserstein}},
              "Distance between the model's cloud and the tests: the energy distance, on which a single specimen has a "
              "bounded influence, or Wasserstein's of order 2 over directions of the outputs, which compares means as "
              "they are.")
          .choice<A::Noise>(
              "noise", &A::noise,
              {{"automatic", A::Noise::automatic}, {"given", A::Noise::given}, {"estimated", A::Noise::estimated}},
              "Measurement noise, which is added to the cloud: as given by [test] repeatability (none for outputs "
              "without it), or estimated with one level for each kind of output. Automatic: as for maximum-likelihood.")
          .choice<A::Correlations>("correlations", &A::correlations,
                                   {{"automatic", A::Correlations::automatic},
                                    {"estimated", A::Correlations::estimated},
                                    {"none", A::Correlations::none}},
                                   "Whether parameters may be correlated in the population. Automatic: where there are "
                                   "two specimens for each parameter and two more.")
          .integer("simulations", &A::simulations, {.lower = 2000.0, .upper = 10000000.0}, "-",
                   "Number of simulated sets of tests in the last stage; the two before it have half of it each. They "
                   "need no model runs.")
          .integer("calibration_sets", &A::calibration_sets, {.lower = 100.0, .upper = 100000.0}, "-",
                   "Number of simulated studies by which intervals are stretched until they cover.");
  return table;
}

UpdatingResult AbcUpdater::update(const UpdatingProblem& problem, const RunContext& context) const {
  require_of(problem.tests.values.rows() >= 2, {Subject::Kind::method, "abc"},
             "{} specimen has no scatter to explain; at least 2 are needed, or use method = \"deterministic\"",
             problem.tests.values.rows());
  require_repeated_outputs(problem.tests, problem.model.outputs());
  const TestMoments tests = test_moments(problem.tests);
  const ScaledParameters parameters(problem.space);
  const PopulationCoordinates coordinates(problem, parameters, noise_of(problem, options_),
                                          estimates_correlations(problem, options_));
  UpdatingResult result;
  append_state(result, record_state(problem, tests, problem.space.prior(), 0, context));
  result.mean = problem.space.prior().mean();
  result.covariance = problem.space.prior().covariance();
  const NearestPopulation nearest = find_nearest_population(
      problem, parameters, coordinates,
      options_.distance == AbcOptions::Distance::energy ? SampleDistance::energy : SampleDistance::sliced_wasserstein,
      context, result);
  if (result.status == UpdatingStatus::stopped) return result;
  try {
    sample_and_describe(problem, parameters, coordinates, nearest, options_, context, result);
  } catch (const Stopped&) {
    result.status = UpdatingStatus::stopped;
    result.message = "stopped on request while sets of tests were simulated";
  }
  return result;
}

}  // namespace mottle::updating
