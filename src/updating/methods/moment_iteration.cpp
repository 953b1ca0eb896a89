#include "updating/methods/moment_iteration.hpp"

#include <Eigen/Core>
#include <algorithm>
#include <cmath>
#include <optional>

#include "mottle/core/subject.hpp"
#include "mottle/linalg/dense/decompositions.hpp"
#include "mottle/stats/moments/descriptive.hpp"
#include "mottle/stats/moments/distance.hpp"
#include "updating/fits/measured_outputs.hpp"
#include "updating/methods/least_change.hpp"
#include "updating/methods/matched_moments.hpp"
#include "updating/population/model_error.hpp"
#include "updating/verdict/other_solutions.hpp"

namespace mottle::updating {
namespace {

constexpr std::size_t k_stall_window = 8;
constexpr int k_max_trials = 12;

/// What stays the same through all iterations.
struct Setup {
  const UpdatingProblem& problem;
  const ScaledParameters& parameters;
  const MomentMethod& method;
  TestMoments tests;
  Eigen::MatrixXd noise;           // R
  Eigen::MatrixXd whitening;       // W^1/2
  Eigen::MatrixXd explained;       // W^1/2 (V - R) W^1/2'
  Eigen::MatrixXd mean_whitening;  // of the mean's residuals: W^1/2 unless the model has an error of its own
};

/// The state, and how the iteration came there.
struct Progress {
  MomentState state;
  std::int64_t evaluations = 0;
  bool is_projected = false;
  int rank = 0;
  double damping = 0.0;  ///< Levenberg's; 0 where steps are Gauss-Newton's
};

/// @param added  variance beside that of the tests [output]
Eigen::MatrixXd whitening_matrix(const Setup& setup, const Eigen::VectorXd& added) {
  TestMoments tests = setup.tests;
  tests.covariance.diagonal() += added;
  if (setup.method.weighting == MomentWeighting::covariance) {
    constexpr double k_singular = 1e-12;
    const Eigen::MatrixXd correlation = correlation_from_covariance(tests.covariance);
    require_of(tests.covariance.diagonal().minCoeff() > 0.0 && semidefinite_pivots(correlation).minCoeff() > k_singular,
               {Subject::Kind::option, setup.method.name + ".weighting"},
               "the covariance of {} outputs from {} specimens is singular; give \"variance\"", tests.mean.size(),
               setup.problem.tests.values.rows());
    return CholeskyFactor(tests.covariance)
        .solve_lower(Eigen::MatrixXd::Identity(tests.covariance.rows(), tests.covariance.cols()));
  }
  Eigen::VectorXd standard_deviation = tests.covariance.diagonal().cwiseSqrt();
  for (Eigen::Index k = 0; k < standard_deviation.size(); ++k) {
    if (!(standard_deviation(k) > k_last_digits * std::abs(tests.mean(k))))
      standard_deviation(k) = std::sqrt(setup.noise(k, k));
    standard_deviation(k) = weighing_deviation(standard_deviation(k), tests.mean(k));
  }
  return standard_deviation.cwiseInverse().asDiagonal();
}

Setup prepare(const UpdatingProblem& problem, const ScaledParameters& parameters, const MomentMethod& method) {
  require_of(problem.tests.values.rows() >= 2, {Subject::Kind::method, method.name},
             "{} specimen has no scatter to explain; at least 2 are needed, or use method = "
             "\"deterministic\"",
             problem.tests.values.rows());
  require_repeated_outputs(problem.tests, problem.model.outputs());
  Setup setup{problem, parameters, method, test_moments(problem.tests), {}, {}, {}, {}};
  setup.noise = problem.tests.repeatability_std.cwiseAbs2().asDiagonal();
  setup.whitening = whitening_matrix(setup, Eigen::VectorXd::Zero(setup.tests.mean.size()));
  // What the mean is off by is V / n + D: its weights are those of V + n D.
  const auto specimens = static_cast<double>(problem.tests.values.rows());
  setup.mean_whitening = whitening_matrix(setup, specimens * problem.tests.model_error_variance());
  setup.explained = setup.whitening * (setup.tests.covariance - setup.noise) * setup.whitening.transpose();
  return setup;
}

IterationRecord record_of(const Setup& setup, const MomentState& state) {
  const VariableMoments moments = moments_of_variables(setup.parameters.scales(), state.mean, state.covariance);
  IterationRecord record;
  record.parameter_mean = moments.mean;
  record.parameter_covariance = moments.covariance;
  record.output_mean = state.output_mean;
  record.output_covariance = state.output_covariance;
  set_distances(record, setup.tests);
  record.cloud = state.cloud;
  record.failures = state.cloud.failures;
  record.notes = state.cloud.notes;
  return record;
}

double misfit(const Setup& setup, const MomentState& state) {
  return (setup.mean_whitening * (setup.tests.mean - state.output_mean)).norm();
}

/// The state that one step leads to; its outputs are still to be evaluated. Raises the damping where it must.
MomentState proposed(const Setup& setup, Progress& progress) {
  const MomentState& state = progress.state;
  const std::vector<int>& groups = setup.problem.covariance_groups;
  const Eigen::VectorXd& standard_deviation = setup.parameters.standard_deviation();
  const Eigen::MatrixXd whitened = setup.whitening * state.sensitivity;
  const Eigen::VectorXd residual = setup.mean_whitening * (setup.tests.mean - state.output_mean);
  const Eigen::VectorXd step =
      trusted_step(setup.parameters, state.mean, setup.mean_whitening * state.sensitivity, residual, progress.damping);

  MomentState next;
  next.mean = setup.parameters.clamp(state.mean + step);
  const Gain gain = least_change_gain(whitened, standard_deviation, progress.damping);
  progress.rank = gain.rank;
  const bool is_whole = std::all_of(groups.begin(), groups.end(), [&](int group) { return group == groups.front(); });
  if (setup.method.replaces_covariance && is_whole) {
    const Eigen::MatrixXd kept = Eigen::MatrixXd::Identity(step.size(), step.size()) - gain.matrix * whitened;
    next.covariance =
        kept * state.covariance * kept.transpose() + gain.matrix * setup.explained * gain.matrix.transpose();
  } else {
    const Eigen::MatrixXd missing =
        setup.explained - setup.whitening * state.output_covariance * setup.whitening.transpose();
    next.covariance =
        state.covariance + least_change_covariance(whitened, standard_deviation, missing, groups, progress.damping);
  }
  next.covariance = (0.5 * (next.covariance + next.covariance.transpose())).eval();
  progress.is_projected = project_to_covariance(next.covariance, standard_deviation, groups);
  return next;
}

/// Goes one step, damped until the outputs' mean is no further from the tests' than it was of late; returns how far an
/// accepted step moved (see largest_movement), or nothing where none helps.
std::optional<double> advance(const Setup& setup, const std::vector<double>& misfits, Progress& progress) {
  constexpr std::size_t k_memory = 4;
  constexpr double k_small = 0.1;  // of a test deviation: so near, curvature and Monte-Carlo error decide
  const std::size_t from = misfits.size() - std::min(misfits.size(), k_memory);
  const double most = *std::max_element(misfits.begin() + static_cast<std::ptrdiff_t>(from), misfits.end()) +
                      k_small * std::sqrt(static_cast<double>(setup.tests.mean.size()));
  for (int trial = 0; trial < k_max_trials; ++trial) {
    MomentState next = proposed(setup, progress);
    if (setup.method.evaluate(next, progress.evaluations) && misfit(setup, next) <= most) {
      const double movement = largest_movement(setup.parameters.standard_deviation(), progress.state.mean,
                                               progress.state.covariance, next.mean, next.covariance);
      progress.state = std::move(next);
      return movement;
    }
    progress.damping = next_damping(progress.damping, false);
  }
  return std::nullopt;
}

void add_notes(const Setup& setup, const Progress& progress, UpdatingResult& result) {
  result.notes.push_back("The standard deviations of this method estimate the scatter of the specimens. " +
                         setup.method.note);
  if (progress.rank < setup.parameters.count()) {
    result.notes.push_back(fmt::format(
        "{} outputs determine only {} combinations of the {} parameters: the others keep the prior's mean and "
        "scatter (least change in prior standard deviations).",
        setup.tests.mean.size(), progress.rank, setup.parameters.count()));
  }
  if (progress.is_projected) {
    result.notes.emplace_back(
        "The tests' covariance minus the noise gives a negative variance of some combination of parameters; it was "
        "set to zero. The reason may be a stated noise that is too large, too few specimens, or outputs that the "
        "parameters cannot explain.");
  }
  if (setup.noise.isZero(0.0)) {
    result.notes.emplace_back(
        "No measurement noise is given (repeatability): any noise counts as scatter of the parameters.");
  }
}

void finish(const Setup& setup, const Progress& progress, const RunContext& context, UpdatingResult& result) {
  const MomentState& state = progress.state;
  const PopulationOnScales population{state.mean, state.covariance,
                                      moment_evidence(setup.problem, setup.parameters, state)};
  result.set_estimate(
      std::make_shared<NormalPopulation>(setup.parameters.scales(), population, setup.problem.tests.values.rows()));
  IterationRecord last = record_state(setup.problem, setup.tests, *result.estimate, context);
  result.model_evaluations =
      progress.evaluations + result.history.front().cloud.samples.rows() + last.cloud.samples.rows();
  if (result.history.size() > 1) result.history.pop_back();
  result.history.push_back(std::move(last));
  context.phase({.name = "tests of the estimate"});
  result.sensitivity = state.sensitivity * setup.parameters.slopes(state.mean).cwiseInverse().asDiagonal();
  result.noise_covariance = setup.noise;
  test_matched_moments(setup.problem,
                       {.method = setup.method.name,
                        .mean = state.mean,
                        .sensitivity = state.sensitivity,
                        .scatter = MatchedEstimate::Scatter::without_noise},
                       context, result);
  const Eigen::MatrixXd whitened = setup.mean_whitening * state.sensitivity;
  const Eigen::MatrixXd gain =
      least_change_gain(whitened, setup.parameters.standard_deviation()).matrix * setup.mean_whitening;
  result.model_error = given_model_error(setup.problem, gain);
  note_model_error(setup.problem, setup.method.name,
                   "is included in the weights of the outputs' mean, not in the standard deviations.", result);
  add_notes(setup, progress, result);
}

}  // namespace

UpdatingResult iterate_moments(const UpdatingProblem& problem, const ScaledParameters& parameters,
                               const MomentMethod& method, const RunContext& context) {
  const Setup setup = prepare(problem, parameters, method);
  UpdatingResult result;
  append_state(result, record_state(problem, setup.tests, problem.space.prior(), 0, context));
  Progress progress;
  const PriorOnScales start = start_at_best(problem, context, progress.evaluations, result).start;
  progress.state.mean = parameters.clamp(start.mean);
  progress.state.covariance = start.covariance;
  keep_groups(progress.state.covariance, problem.covariance_groups);
  if (!method.evaluate(progress.state, progress.evaluations))
    throw ModelFailure(
        "the model fails at the parameters' prior means, or too much of the prior is physically impossible, so "
        "there is no starting point");

  result.status = UpdatingStatus::max_iterations;
  std::vector<double> misfits{misfit(setup, progress.state)};
  std::vector<double> movements;
  std::size_t updates = 0;
  while (updates < static_cast<std::size_t>(problem.iterations)) {
    if (context.stop_requested()) {
      result.status = UpdatingStatus::stopped;
      break;
    }
    begin_iteration(problem, static_cast<std::int64_t>(updates) + 1, context);
    const std::optional<double> movement = advance(setup, misfits, progress);
    if (movement) movements.push_back(*movement);
    if (!movement || is_stalled(movements, k_stall_window)) {
      result.status = UpdatingStatus::stalled;
      break;
    }
    misfits.push_back(misfit(setup, progress.state));
    append_state(result, record_of(setup, progress.state));
    ++updates;
    if (*movement <= problem.tolerance && progress.damping == 0.0) {
      result.status = UpdatingStatus::converged;
      break;
    }
    progress.damping = next_damping(progress.damping, true);
  }
  result.message = ending_message(
      result.status, updates, problem.tolerance,
      {.stalled = "no further step is possible: none brings the outputs nearer to the tests within the range in which "
                  "the model can be computed"});
  if (progress.rank == 0) progress.rank = static_cast<int>(parameters.count());  // stopped before the first step
  finish(setup, progress, context, result);
  return result;
}

}  // namespace mottle::updating
