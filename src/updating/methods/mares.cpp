#include "updating/methods/mares.hpp"

#include <Eigen/Core>
#include <cmath>
#include <optional>

#include "mottle/core/subject.hpp"
#include "mottle/linalg/dense/decompositions.hpp"
#include "mottle/stats/moments/descriptive.hpp"
#include "mottle/updating/methods/iteration.hpp"
#include "updating/fits/scaled_parameters.hpp"
#include "updating/methods/matched_moments.hpp"
#include "updating/population/mean_intervals.hpp"
#include "updating/population/model_error.hpp"
#include "updating/verdict/other_solutions.hpp"

namespace mottle::updating {
namespace {

constexpr std::size_t k_stall_window = 8;

/// What stays the same through all iterations.
struct MaresSetup {
  TestMoments tests;
  Eigen::VectorXd prior_mean;        // x0
  Eigen::MatrixXd prior_covariance;  // S0
  Eigen::MatrixXd test_variability;  // S_M
  Eigen::MatrixXd weight;            // W
};

void require_solvable(const UpdatingProblem& problem) {
  const Eigen::Index outputs = problem.tests.values.cols();
  const Subject method{Subject::Kind::method, "mares"};
  require_of(problem.tests.values.rows() >= 2, method,
             "{} specimen has no scatter to explain; at least 2 are needed, or use method = "
             "\"deterministic\"",
             problem.tests.values.rows());
  require_of(outputs >= problem.space.count(), method,
             "{} parameters are more unknowns than the {} measured outputs can determine; update fewer parameters "
             "or measure more outputs",
             problem.space.count(), outputs);
  require_of(problem.cloud.samples > problem.space.count() + 1, {Subject::Kind::samples},
             "{} is too few for a regression on {} parameters, at least {} are needed", problem.cloud.samples,
             problem.space.count(), problem.space.count() + 2);
}

MaresSetup prepare(const UpdatingProblem& problem, const MaresOptions& options) {
  require_solvable(problem);
  MaresSetup setup;
  require_repeated_outputs(problem.tests, problem.model.outputs());
  setup.tests = test_moments(problem.tests);
  setup.prior_mean = problem.space.prior().mean();
  setup.prior_covariance = problem.space.prior().covariance();
  setup.test_variability = setup.tests.covariance;
  setup.test_variability.diagonal() += (options.model_error * setup.tests.mean).cwiseAbs2();
  if (problem.tests.has_model_error()) setup.test_variability.diagonal() += problem.tests.model_error_variance();
  const Eigen::Index outputs = setup.tests.mean.size();
  const Eigen::MatrixXd correlation = correlation_from_covariance(setup.test_variability);
  constexpr double k_singular = 1e-12;
  constexpr double k_min = 1e-8;  // standard deviation, of the mean
  const bool is_scattered =
      (setup.test_variability.diagonal().array().sqrt() > k_min * setup.tests.mean.array().abs()).all();
  // A direction without variability would leave the parameters without scatter there (Eq. 12): no cloud to regress on.
  require_of(is_scattered && correlation.allFinite() && semidefinite_pivots(correlation).minCoeff() > k_singular,
             {Subject::Kind::tests},
             "the covariance of {} outputs from {} specimens is singular; test more specimens than outputs, leave "
             "outputs out, or set the method's model_error above 0",
             outputs, problem.tests.values.rows());
  setup.weight = options.weighting == MaresOptions::Weighting::euclidean
                     ? Eigen::MatrixXd(Eigen::MatrixXd::Identity(outputs, outputs) * static_cast<double>(outputs) /
                                       setup.test_variability.trace())
                     : inverse_by_lu(setup.test_variability);
  return setup;
}

Eigen::MatrixXd estimate_sensitivity(const Cloud& cloud, MaresOptions::Regression kind) {
  const Cloud::Valid valid = cloud.valid();
  if (kind == MaresOptions::Regression::quadratic)
    return quadratic_regression(valid.samples, valid.outputs).sensitivity;
  return linear_regression(valid.samples, valid.outputs).sensitivity;
}

/// Eq. 11.
Eigen::VectorXd updated_mean(const MaresSetup& setup, const IterationRecord& state, const Eigen::MatrixXd& g,
                             const MaresOptions& options) {
  const bool is_recursive = options.covariance == MaresOptions::Covariance::recursive;
  const bool is_recentred = options.prior == MaresOptions::Prior::recentred;
  const Eigen::MatrixXd& damping = is_recentred || !is_recursive ? setup.prior_covariance : state.parameter_covariance;
  const Eigen::MatrixXd precision = inverse_by_lu(damping);
  const Eigen::MatrixXd gw = g.transpose() * setup.weight;
  Eigen::VectorXd gradient = gw * (setup.tests.mean - state.output_mean);
  if (!is_recentred) gradient -= precision * (state.parameter_mean - setup.prior_mean);
  return state.parameter_mean + solve_semidefinite(gw * g + precision, gradient);
}

/// Eq. 12.
Eigen::MatrixXd updated_covariance(const MaresSetup& setup, const IterationRecord& state, const Eigen::MatrixXd& g,
                                   const MaresOptions& options) {
  const bool is_recursive = options.covariance == MaresOptions::Covariance::recursive;
  const Eigen::MatrixXd& prior = is_recursive ? state.parameter_covariance : setup.prior_covariance;
  const Eigen::MatrixXd pg = prior * g.transpose();
  const Eigen::MatrixXd updated = prior - pg * solve_semidefinite(setup.test_variability + g * pg, pg.transpose());
  Eigen::MatrixXd covariance = 0.5 * (updated + updated.transpose());
  repair_covariance(covariance);
  return covariance;
}

/// How the fixed point of Eq. 11 follows the tests' mean.
MeanEstimator estimator_at(const UpdatingProblem& problem, const MaresSetup& setup, const IterationRecord& state,
                           const Eigen::MatrixXd& g, const MaresOptions& options) {
  const bool is_recursive = options.covariance == MaresOptions::Covariance::recursive;
  const Eigen::MatrixXd gw = g.transpose() * setup.weight;
  const Eigen::MatrixXd unit = Eigen::MatrixXd::Identity(g.cols(), g.cols());
  MeanEstimator estimator{state.parameter_mean, {}, 0.0 * unit};
  if (options.prior == MaresOptions::Prior::recentred) {
    estimator.gain = solve_semidefinite(gw * g, gw);
  } else {
    const Eigen::MatrixXd damping = inverse_by_lu(is_recursive ? state.parameter_covariance : setup.prior_covariance);
    estimator.gain = solve_semidefinite(gw * g + damping, gw);
    const Eigen::MatrixXd held_back = unit - estimator.gain * g;
    estimator.prior_covariance = held_back * setup.prior_covariance * held_back.transpose();
  }
  if (options.weighting == MaresOptions::Weighting::mahalanobis) {
    const Eigen::VectorXd residual = setup.tests.mean - state.output_mean;
    set_weighted_by_tests(problem.tests, residual.dot(setup.weight * residual), estimator);
  }
  return estimator;
}

/// With what the iteration begins instead of the prior, whose mean leads to parameters that explain the tests less
/// well; nothing: with the prior.
std::optional<VariableMoments> start_beside_prior(const UpdatingProblem& problem, const PriorOnScales& start) {
  if (start.mean == prior_on_scales(problem.space).mean) return std::nullopt;
  return moments_of_variables(problem.space.transforms(), start.mean, start.covariance);
}

}  // namespace

const OptionTable<MaresOptions>& mares_option_table() {
  using M = MaresOptions;
  static const OptionTable<M> table =
      OptionTable<M>()
          .choice<M::Weighting>("weighting", &M::weighting,
                                {{"mahalanobis", M::Weighting::mahalanobis}, {"euclidean", M::Weighting::euclidean}},
                                "Weight W of the residuals in Eq. 11: the inverse of the tests' covariance, or the "
                                "identity scaled by their mean variance.")
          .choice<M::Prior>("prior", &M::prior, {{"recentred", M::Prior::recentred}, {"fixed", M::Prior::fixed}},
                            "Centre of the prior term in Eq. 11: the current mean, so that it only damps the step, "
                            "or the prior mean, as the equation is written.")
          .choice<M::Covariance>(
              "covariance", &M::covariance,
              {{"fixed-prior", M::Covariance::fixed_prior}, {"recursive", M::Covariance::recursive}},
              "Covariance that Eq. 12 starts from: the prior's at every iteration, or the current one, as the "
              "equation is written, which uses the same tests again and collapses.")
          .choice<M::Regression>("regression", &M::regression,
                                 {{"linear", M::Regression::linear}, {"quadratic", M::Regression::quadratic}},
                                 "Regression that gives the sensitivity: linear, or with squares and interactions, "
                                 "taken at the cloud's mean.")
          .number("model_error", &M::model_error, {.lower = 0.0}, "fraction of the mean",
                  "Standard deviation of the model's own error, as a fraction of each output's tested mean, added "
                  "to the test variability.");
  return table;
}

UpdatingResult MaresUpdater::update(const UpdatingProblem& problem, const RunContext& context) const {
  const MaresSetup setup = prepare(problem, options_);
  const Eigen::VectorXd prior_std = setup.prior_covariance.diagonal().cwiseSqrt();

  UpdatingResult result;
  std::vector<double> movements;
  result.status = UpdatingStatus::max_iterations;
  append_state(result, record_state(problem, setup.tests, problem.space.prior(), 0, context));
  const BestStart best = start_at_best(problem, context, result.model_evaluations, result);
  const std::optional<VariableMoments> start = start_beside_prior(problem, best.start);
  for (int index = 1; index <= problem.iterations; ++index) {
    if (context.stop_requested()) {
      result.status = UpdatingStatus::stopped;
      break;
    }
    const IterationRecord& state = result.history.back();
    const Eigen::MatrixXd g = estimate_sensitivity(state.cloud, options_.regression);
    const bool is_moved = index == 1 && start;
    const Eigen::VectorXd mean = problem.space.clamp(is_moved ? start->mean : updated_mean(setup, state, g, options_));
    const Eigen::MatrixXd covariance = is_moved ? start->covariance : updated_covariance(setup, state, g, options_);
    const double movement =
        largest_movement(prior_std, state.parameter_mean, state.parameter_covariance, mean, covariance);
    append_state(result, record_state(problem, setup.tests, JointDistribution::multivariate_normal(mean, covariance),
                                      index, context));
    if (movement <= problem.tolerance) {
      result.status = UpdatingStatus::converged;
      break;
    }
    movements.push_back(movement);
    if (is_stalled(movements, k_stall_window)) {
      result.status = UpdatingStatus::stalled;
      break;
    }
  }
  result.set_estimate(std::make_shared<MomentEstimate>(problem.space.transforms(), result.history.back().parameter_mean,
                                                       result.history.back().parameter_covariance));
  result.message = ending_message(
      result.status, result.history.size() - 1, problem.tolerance,
      {.stalled = fmt::format("the parameters oscillate: their steps have not become smaller for {} iterations",
                              k_stall_window)});
  const Eigen::MatrixXd last_sensitivity = estimate_sensitivity(result.history.back().cloud, options_.regression);
  result.intervals =
      intervals_of_mean(problem.tests, estimator_at(problem, setup, result.history.back(), last_sensitivity, options_));
  const Eigen::VectorXd point = from_variables(problem.space.transforms(), result.mean.transpose()).row(0);
  const Eigen::MatrixXd sensitivity = last_sensitivity * ScaledParameters(problem.space).slopes(point).asDiagonal();
  MatchedEstimate matched = matched_mean("mares", problem, point, sensitivity, context, result);
  matched.other_centre = best.solution;
  test_matched_moments(problem, matched, context, result);
  note_model_error(problem, "mares",
                   "is added to the test variability S_M of Eqs. 11 and 12, in addition to the method's model_error.",
                   result);
  result.notes.push_back(
      "The standard deviations of this method (Eq. 12) say how well one specimen would be known by its test and the "
      "prior; they do not estimate the scatter of the specimens. How well the specimens' mean is known is said by its "
      "95 % intervals, which follow the scatter of the tests' mean.");
  return result;
}

}  // namespace mottle::updating
