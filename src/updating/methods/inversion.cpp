#include "updating/methods/inversion.hpp"

#include <cmath>
#include <limits>

#include "mottle/core/subject.hpp"
#include "mottle/core/text.hpp"
#include "mottle/stats/moments/descriptive.hpp"
#include "mottle/stats/moments/distance.hpp"
#include "mottle/updating/methods/iteration.hpp"
#include "updating/fits/measured_outputs.hpp"
#include "updating/methods/inversion_fit.hpp"
#include "updating/methods/least_change.hpp"
#include "updating/methods/linear_units.hpp"
#include "updating/methods/matched_moments.hpp"
#include "updating/population/model_error.hpp"
#include "updating/population/normal_theory.hpp"
#include "updating/verdict/other_solutions.hpp"

namespace mottle::updating {
namespace {

using Ending = InversionFit::Ending;

/// What stays the same through all iterations.
struct Setup {
  const UpdatingProblem& problem;
  ScaledParameters parameters;
  TestMoments tests;
  Eigen::VectorXd sigma;
};

Setup prepare(const UpdatingProblem& problem) {
  require_of(problem.tests.values.rows() >= 2, {Subject::Kind::method, "inversion"},
             "{} specimen has no scatter to explain; at least 2 are needed, or use method = "
             "\"deterministic\"",
             problem.tests.values.rows());
  require_repeated_outputs(problem.tests, problem.model.outputs());
  Setup setup{problem, ScaledParameters(problem.space), test_moments(problem.tests), problem.tests.repeatability_std};
  for (Eigen::Index k = 0; k < setup.sigma.size(); ++k) {
    if (!(setup.sigma(k) > 0.0)) setup.sigma(k) = std::sqrt(setup.tests.covariance(k, k));
    setup.sigma(k) = weighing_deviation(setup.sigma(k), setup.tests.mean(k));
  }
  return setup;
}

/// Mean and covariance of the specimens' t.
struct Population {
  Eigen::VectorXd mean;
  Eigen::MatrixXd covariance;
};

Population population_of(const Setup& setup, const Eigen::MatrixXd& points) {
  Population population{sample_mean(points), sample_covariance(points)};
  // Rounding of a mean of equal values must not take it off a bound.
  for (Eigen::Index i = 0; i < points.cols(); ++i) {
    if ((points.col(i).array() == points(0, i)).all()) {
      population.mean(i) = points(0, i);
      population.covariance.row(i).setZero();
      population.covariance.col(i).setZero();
    }
  }
  keep_groups(population.covariance, setup.problem.covariance_groups);
  return population;
}

IterationRecord record_of(const Setup& setup, const InversionFit& fit) {
  const Population population = population_of(setup, fit.points);
  const VariableMoments moments =
      moments_of_variables(setup.parameters.scales(), population.mean, population.covariance);
  IterationRecord record;
  record.parameter_mean = moments.mean;
  record.parameter_covariance = moments.covariance;
  record.output_mean = sample_mean(fit.outputs);
  record.output_covariance = sample_covariance(fit.outputs);
  set_distances(record, setup.tests);
  return record;
}

/// Where all specimens start: the parameters of the tests' mean, so that all are solved on one branch of the inverse.
Eigen::VectorXd common_start(const Setup& setup, InversionOptions::Start kind, const RunContext& context,
                             std::int64_t& evaluations, UpdatingResult& result) {
  if (kind == InversionOptions::Start::prior_mean) return setup.parameters.clamp(setup.parameters.start());
  const Eigen::VectorXd start =
      setup.parameters.clamp(start_at_best(setup.problem, context, evaluations, result).start.mean);
  const InversionFit fit =
      invert_specimens(setup.problem, setup.parameters, setup.tests.mean.transpose(), setup.sigma, start.transpose(),
                       context, [&](const InversionFit&) { return !context.stop_requested(); });
  evaluations += fit.evaluations;
  return fit.points.row(0).transpose();
}

/// The step of a specimen's parameters by its residuals in units of sigma, outputs that it lacks left out.
Eigen::MatrixXd specimen_gain(const Setup& setup, const InversionFit& fit, Eigen::Index specimen) {
  Eigen::MatrixXd whitened =
      setup.sigma.cwiseInverse().asDiagonal() * fit.jacobians[static_cast<std::size_t>(specimen)];
  for (Eigen::Index k = 0; k < whitened.rows(); ++k) {
    if (std::isnan(setup.problem.tests.values(specimen, k))) whitened.row(k).setZero();
  }
  return least_change_gain(whitened, setup.parameters.standard_deviation()).matrix;
}

/// Of each parameter's variance, the part that measurement noise makes: mean of T R T' over the specimens.
Eigen::VectorXd noise_share(const Setup& setup, const InversionFit& fit, const Eigen::VectorXd& variance) {
  Eigen::VectorXd noise = Eigen::VectorXd::Zero(variance.size());
  const Eigen::VectorXd relative = setup.problem.tests.repeatability_std.cwiseQuotient(setup.sigma);
  for (Eigen::Index s = 0; s < fit.points.rows(); ++s) {
    noise += (specimen_gain(setup, fit, s) * relative.asDiagonal()).rowwise().squaredNorm();
  }
  return (noise / static_cast<double>(fit.points.rows())).cwiseQuotient(variance);
}

/// Mean of the specimens' gains: what an error that all of them share does to the mean [parameter x output].
Eigen::MatrixXd mean_gain(const Setup& setup, const InversionFit& fit) {
  Eigen::MatrixXd sum = Eigen::MatrixXd::Zero(fit.points.cols(), fit.outputs.cols());
  for (Eigen::Index s = 0; s < fit.points.rows(); ++s) {
    sum += specimen_gain(setup, fit, s);
  }
  return sum * setup.sigma.cwiseInverse().asDiagonal() / static_cast<double>(fit.points.rows());
}

/// The model's error moves the mean of the specimens' parameters, not their scatter.
void add_model_error(const Setup& setup, const InversionFit& fit, const Population& population,
                     UpdatingResult& result) {
  if (!setup.problem.tests.has_model_error()) return;
  note_model_error(setup.problem, "inversion",
                   "is included in the intervals of means, not in the standard "
                   "deviations.",
                   result);
  result.model_error = given_model_error(setup.problem, mean_gain(setup, fit));
  if (!result.model_error) return;
  const ModelError& error = *result.model_error;
  const Eigen::MatrixXd shared = error.gain * error.covariance * error.gain.transpose();
  result.intervals->mean = normal_theory_means(setup.parameters.scales(), population.mean, population.covariance,
                                               static_cast<int>(fit.points.rows()), shared);
}

void add_notes(const Setup& setup, const InversionFit& fit, const Population& population, UpdatingResult& result) {
  result.notes.emplace_back(
      "The standard deviations of this method are those of the specimens' own parameters, each solved from its "
      "tests alone: measurement noise inflates them, and where several sets of parameters give the same outputs a "
      "specimen's solution may be a set other than its own.");
  if (!setup.problem.tests.repeatability_std.isZero(0.0)) {
    const Eigen::VectorXd share = noise_share(setup, fit, population.covariance.diagonal());
    std::vector<std::string> parts;
    for (Eigen::Index i = 0; i < share.size(); ++i) {
      if (std::isfinite(share(i))) {
        parts.push_back(fmt::format("{:.2g} % of {}", 100.0 * share(i),
                                    setup.problem.space.parameters()[static_cast<std::size_t>(i)].name));
      }
    }
    if (!parts.empty())
      result.notes.push_back("Fraction of each variance that is measurement noise: " + join(parts) + ".");
  }
  Eigen::Index short_of = 0;
  for (const int rank : fit.ranks) short_of += rank < setup.parameters.count() ? 1 : 0;
  if (short_of > 0) {
    result.notes.push_back(fmt::format(
        "The measured outputs of {} of {} specimens do not determine all {} parameters: undetermined combinations "
        "were set nearest to the prior mean (in prior standard deviations), so their scatter comes out too small.",
        short_of, fit.points.rows(), setup.parameters.count()));
  }
}

void describe_ending(const InversionFit& fit, bool is_stopped, const UpdatingProblem& problem, UpdatingResult& result) {
  const Eigen::Index moving = fit.count(Ending::moving);
  const Eigen::Index stuck = fit.count(Ending::stuck);
  if (is_stopped) {
    result.status = UpdatingStatus::stopped;
    result.message = "stopped on request";
  } else if (moving > 0) {
    result.status = UpdatingStatus::max_iterations;
    result.message = fmt::format("after {} iterations the parameters of {} of {} specimens have not converged",
                                 problem.iterations, moving, fit.points.rows());
  } else if (stuck > 0) {
    result.status = UpdatingStatus::stalled;
    result.message =
        fmt::format("for {} of {} specimens no step makes the residuals smaller", stuck, fit.points.rows());
  } else {
    result.status = UpdatingStatus::converged;
    result.message =
        fmt::format("all {} specimens are solved: no parameter moves by more than {} of its prior standard deviation",
                    fit.points.rows(), problem.tolerance);
  }
}

/// Where the bounds hold all specimens of a parameter, their sample says nothing of its mean and deviation.
void forget_held_means(const Setup& setup, const Population& population, ParameterIntervals& intervals) {
  const Eigen::VectorXi held = setup.parameters.active_bounds(population.mean);
  for (Eigen::Index i = 0; i < held.size(); ++i) {
    if (held(i) == 0) continue;
    intervals.mean.row(i).setConstant(std::numeric_limits<double>::quiet_NaN());
    intervals.std.row(i).setConstant(std::numeric_limits<double>::quiet_NaN());
  }
}

void finish(const Setup& setup, const InversionFit& fit, const RunContext& context, UpdatingResult& result) {
  const Population population = population_of(setup, fit.points);
  const PopulationEvidence evidence = sample_evidence(population.mean, population.covariance, fit.points.rows());
  result.set_estimate(std::make_shared<NormalPopulation>(
      setup.parameters.scales(), PopulationOnScales{population.mean, population.covariance, evidence},
      setup.problem.tests.values.rows()));
  IterationRecord last = record_state(setup.problem, setup.tests, *result.estimate, context);
  result.model_evaluations += fit.evaluations + result.history.front().cloud.samples.rows() + last.cloud.samples.rows();
  if (result.history.size() > 1) result.history.pop_back();
  result.history.push_back(std::move(last));
  const auto specimens = static_cast<int>(fit.points.rows());
  result.intervals = normal_theory_intervals(setup.parameters.scales(), population.mean, population.covariance,
                                             specimens, setup.problem.covariance_groups);
  result.specimens =
      SpecimenEstimates{setup.parameters.to_variables(fit.points),
                        (setup.problem.tests.values - fit.outputs) * setup.sigma.cwiseInverse().asDiagonal()};
  result.noise_covariance = setup.problem.tests.repeatability_std.cwiseAbs2().asDiagonal();
  if (!fit.jacobians.front().size()) return;  // stopped before the first step
  test_matched_moments(setup.problem,
                       {.method = "inversion",
                        .mean = population.mean,
                        .sensitivity = mean_jacobian(fit.jacobians),
                        .scatter = MatchedEstimate::Scatter::with_noise},
                       context, result);
  add_model_error(setup, fit, population, result);
  forget_held_means(setup, population, *result.intervals);
  add_notes(setup, fit, population, result);
}

}  // namespace

const OptionTable<InversionOptions>& inversion_option_table() {
  using I = InversionOptions;
  static const OptionTable<I> table = OptionTable<I>().choice<I::Start>(
      "start", &I::start, {{"tests-mean", I::Start::tests_mean}, {"prior-mean", I::Start::prior_mean}},
      "Where the fit of every specimen starts: at the parameters that fit the mean of the tests, or at the prior "
      "mean.");
  return table;
}

UpdatingResult InversionUpdater::update(const UpdatingProblem& problem, const RunContext& context) const {
  const Setup setup = prepare(problem);
  UpdatingResult result;
  append_state(result, record_state(problem, setup.tests, problem.space.prior(), 0, context));
  result.model_evaluations = 0;  // counted whole at the end
  std::int64_t searched = 0;
  const Eigen::VectorXd start = common_start(setup, options_.start, context, searched, result);
  result.model_evaluations = searched;
  bool is_stopped = context.stop_requested();
  int iteration = 1;
  begin_iteration(problem, iteration, context);
  const InversionFit fit = invert_specimens(problem, setup.parameters, problem.tests.values, setup.sigma,
                                            start.transpose().replicate(problem.tests.values.rows(), 1), context,
                                            [&](const InversionFit& present) {
                                              const std::int64_t runs = result.model_evaluations;
                                              append_state(result, record_of(setup, present));
                                              result.model_evaluations = runs;
                                              is_stopped = is_stopped || context.stop_requested();
                                              const bool goes_on = !is_stopped && present.count(Ending::moving) > 0;
                                              if (goes_on && iteration < problem.iterations)
                                                begin_iteration(problem, ++iteration, context);
                                              return !is_stopped;
                                            });
  if (static_cast<double>(fit.count(Ending::stuck)) > problem.cloud.max_failed * static_cast<double>(fit.points.rows()))
    throw ModelFailure(
        fmt::format("for {} of {} specimens no step makes the residuals smaller: the model fails around them or is "
                    "not smooth",
                    fit.count(Ending::stuck), fit.points.rows()));
  describe_ending(fit, is_stopped, problem, result);
  finish(setup, fit, context, result);
  return result;
}

}  // namespace mottle::updating
