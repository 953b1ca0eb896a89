#include "mottle/updating/methods/deterministic.hpp"

#include <Eigen/Core>
#include <cmath>

#include "mottle/core/subject.hpp"
#include "mottle/core/text.hpp"
#include "mottle/linalg/dense/decompositions.hpp"
#include "mottle/stats/moments/distance.hpp"
#include "mottle/updating/methods/iteration.hpp"
#include "updating/fits/scaled_parameters.hpp"
#include "updating/methods/deterministic_tests.hpp"
#include "updating/methods/least_squares.hpp"
#include "updating/methods/least_squares_minima.hpp"
#include "updating/methods/matched_moments.hpp"
#include "updating/population/mean_intervals.hpp"
#include "updating/population/model_error.hpp"

namespace mottle::updating {
namespace {

const Subject k_method{Subject::Kind::method, "deterministic"};

/// "1 to 4, 6".
std::string numbers_text(const TestData& tests) {
  std::vector<std::string> ranges;
  for (Eigen::Index s = 0, end = 0; s < tests.values.rows(); s = end) {
    end = s + 1;
    while (end < tests.values.rows() && tests.number_of(end) == tests.number_of(end - 1) + 1) ++end;
    ranges.push_back(end == s + 1 ? fmt::format("{}", tests.number_of(s))
                                  : fmt::format("{} to {}", tests.number_of(s), tests.number_of(end - 1)));
  }
  return join(ranges);
}

LeastSquares prepare(const UpdatingProblem& problem, const DeterministicOptions& options) {
  const Subject specimen{Subject::Kind::option, "deterministic.specimen"};
  const Eigen::Index row = options.specimen == 0 ? 0 : problem.tests.find(options.specimen);
  require_of(row >= 0, specimen, "{} is not there; the tests have {} (0 means their mean)", options.specimen,
             numbers_text(problem.tests));
  require_repeated_outputs(problem.tests, problem.model.outputs());
  LeastSquares setup;
  setup.target = options.specimen == 0 ? test_moments(problem.tests).mean
                                       : Eigen::VectorXd(problem.tests.values.row(row).transpose());
  require_of(setup.target.allFinite(), specimen,
             "specimen {} has missing values; choose another or "
             "leave the outputs out",
             options.specimen);
  Eigen::VectorXd sigma = options.measurement_error * setup.target.cwiseAbs();
  const Eigen::VectorXd error = problem.tests.model_error_variance();
  for (Eigen::Index k = 0; k < sigma.size(); ++k) {
    if (problem.tests.repeatability_std(k) > 0.0) sigma(k) = problem.tests.repeatability_std(k);
    if (error(k) > 0.0) sigma(k) = std::sqrt(sigma(k) * sigma(k) + error(k));
    require_of(sigma(k) > 0.0, {Subject::Kind::repeatability}, "needed for output {}, whose tested value is 0",
               problem.model.outputs()[static_cast<std::size_t>(k)].name());
  }
  setup.weight = sigma.cwiseAbs2().cwiseInverse();
  const Eigen::MatrixXd covariance = problem.space.prior().covariance();
  setup.start = problem.space.prior().mean();
  setup.prior_std = covariance.diagonal().cwiseSqrt();
  setup.prior = Eigen::MatrixXd::Zero(setup.start.size(), setup.start.size());
  if (options.regularisation == DeterministicOptions::Regularisation::bayesian) setup.prior = inverse_by_lu(covariance);
  if (options.regularisation == DeterministicOptions::Regularisation::tikhonov) {
    setup.prior.diagonal() = (options.tikhonov_parameter * setup.prior_std.cwiseInverse()).cwiseAbs2();
  }
  require_of(!setup.prior.isZero(0.0) || setup.target.size() >= setup.start.size(), k_method,
             "{} parameters are more unknowns than the {} measured outputs can determine; set the option "
             "regularisation to \"tikhonov\" or \"bayesian\", or update fewer parameters",
             setup.start.size(), setup.target.size());
  return setup;
}

IterationRecord record_point(const Eigen::VectorXd& parameters, const Eigen::MatrixXd& covariance,
                             const Eigen::VectorXd& outputs, const Eigen::MatrixXd& g, const LeastSquares& setup) {
  IterationRecord record;
  record.parameter_mean = parameters;
  record.parameter_covariance = covariance;
  record.output_mean = outputs;
  record.output_covariance = g * covariance * g.transpose();
  record.distance_euclidean = euclidean_distance(outputs, setup.target);
  record.distance_mahalanobis = std::sqrt((setup.target - outputs).cwiseAbs2().dot(setup.weight));
  return record;
}

bool is_of_many(const UpdatingProblem& problem, const DeterministicOptions& options) {
  return options.specimen == 0 && problem.tests.values.rows() > 1;
}

/// How the estimate follows the tests, K = (G' W G + Q)^-1 G' W; a prior that is knowledge adds its own error.
MeanEstimator estimator_at(const LeastSquares& setup, const Eigen::VectorXd& x, const Eigen::MatrixXd& g,
                           DeterministicOptions::Regularisation regularisation) {
  const Eigen::MatrixXd gw = g.transpose() * setup.weight.asDiagonal();
  const Eigen::MatrixXd unit = Eigen::MatrixXd::Identity(x.size(), x.size());
  const Eigen::MatrixXd inverse = solve_semidefinite(gw * g + setup.prior, unit);
  const bool is_knowledge = regularisation == DeterministicOptions::Regularisation::bayesian;
  const Eigen::MatrixXd of_prior = inverse * setup.prior * inverse.transpose();
  return {x, inverse * gw, is_knowledge ? of_prior : Eigen::MatrixXd(0.0 * unit)};
}

/// Of one structure's parameters, by the noise of its test, or of the specimens' mean, by their scatter.
Eigen::MatrixXd estimate_covariance(const UpdatingProblem& problem, const LeastSquares& setup,
                                    const DeterministicOptions& options, const MeanEstimator& estimator) {
  if (is_of_many(problem, options)) return covariance_of_mean(problem.tests, estimator);
  const Eigen::VectorXd noise = setup.weight.cwiseInverse();
  const Eigen::MatrixXd covariance =
      estimator.gain * noise.asDiagonal() * estimator.gain.transpose() + estimator.prior_covariance;
  return 0.5 * (covariance + covariance.transpose());
}

/// The Gauss-Newton step that no bound stops.
Eigen::VectorXd unbounded_step(const LeastSquares& setup, const Eigen::VectorXd& x, const Eigen::VectorXd& outputs,
                               const Eigen::MatrixXd& g) {
  const Eigen::MatrixXd gw = g.transpose() * setup.weight.asDiagonal();
  return solve_semidefinite(gw * g + setup.prior, gw * (setup.target - outputs) - setup.prior * (x - setup.start));
}

/// Tests of the mean of many specimens.
void test_mean(const UpdatingProblem& problem, const LeastSquaresPoint& point, const RunContext& context,
               UpdatingResult& result) {
  const Eigen::VectorXd on_scales = from_variables(problem.space.transforms(), point.parameters.transpose()).row(0);
  const Eigen::MatrixXd sensitivity =
      point.sensitivity * ScaledParameters(problem.space).slopes(on_scales).asDiagonal();
  test_matched_moments(problem, matched_mean("deterministic", problem, on_scales, sensitivity, context, result),
                       context, result);
}

}  // namespace

const OptionTable<DeterministicOptions>& deterministic_option_table() {
  using D = DeterministicOptions;
  static const OptionTable<D> table =
      OptionTable<D>()
          .choice<D::Regularisation>("regularisation", &D::regularisation,
                                     {{"bayesian", D::Regularisation::bayesian},
                                      {"tikhonov", D::Regularisation::tikhonov},
                                      {"none", D::Regularisation::none}},
                                     "Regularisation of parameters that the test does not determine: the prior's "
                                     "covariance, a common factor on the prior's standard deviations, or none.")
          .number("tikhonov_parameter", &D::tikhonov_parameter, {.lower = 0.0, .excludes_lower = true}, "-",
                  "Weight lambda of a shift by one prior standard deviation relative to a residual of one "
                  "measurement standard deviation.")
          .integer("specimen", &D::specimen, {.lower = 0.0}, "-",
                   "Number of the specimen to update to, counted from 1; 0 means the mean of all.")
          .number("measurement_error", &D::measurement_error, {.lower = 0.0, .excludes_lower = true},
                  "fraction of the value",
                  "Measurement standard deviation of an output as a fraction of its tested value, used where "
                  "[test] repeatability does not give it.");
  return table;
}

UpdatingResult DeterministicUpdater::update(const UpdatingProblem& problem, const RunContext& context) const {
  const LeastSquares setup = prepare(problem, options_);
  const TestMoments tests = test_moments(problem.tests);
  UpdatingResult result;
  result.status = UpdatingStatus::max_iterations;
  append_state(result, record_state(problem, tests, problem.space.prior(), 0, context));

  LeastSquaresPoint point;
  auto& [x, y, g] = point;
  x = start_at_lowest(problem, setup, context, result);
  const auto at_start = evaluate_one(problem, x, context, result.model_evaluations);
  if (!at_start) throw ModelFailure("the model fails at the parameters' prior means, so there is no starting point");
  y = *at_start;
  g = model_jacobian(problem, x, setup.prior_std, context, result.model_evaluations);
  for (int index = 1; index <= problem.iterations; ++index) {
    if (context.stop_requested()) {
      result.status = UpdatingStatus::stopped;
      break;
    }
    begin_iteration(problem, index, context);
    require_of(has_full_rank(setup, g), k_method,
               "the outputs determine only {} combinations of the {} parameters; set the option regularisation to "
               "\"tikhonov\" or \"bayesian\"",
               determined_combinations(setup, g), g.cols());
    const double movement = step_down(problem, setup, point, context, result.model_evaluations);
    const MeanEstimator estimator = estimator_at(setup, x, g, options_.regularisation);
    append_state(result, record_point(x, estimate_covariance(problem, setup, options_, estimator), y, g, setup));
    if (movement <= problem.tolerance) {
      result.status = UpdatingStatus::converged;
      break;
    }
  }
  const MeanEstimator estimator = estimator_at(setup, x, g, options_.regularisation);
  result.set_estimate(std::make_shared<MomentEstimate>(problem.space.transforms(), x,
                                                       estimate_covariance(problem, setup, options_, estimator)));
  const bool is_of_many_specimens = is_of_many(problem, options_);
  if (is_of_many_specimens) result.intervals = intervals_of_mean(problem.tests, estimator);
  result.sensitivity = g;
  IterationRecord last = record_state(problem, tests, *result.estimate, context);
  last.output_mean = y;  // the method's own point; the cloud shows the uncertainty around it
  last.distance_euclidean = euclidean_distance(y, setup.target);
  result.model_evaluations += last.cloud.samples.rows();
  const std::size_t updates = result.history.size() - 1;
  if (updates > 0) result.history.pop_back();
  result.history.push_back(std::move(last));
  result.message = ending_message(result.status, updates, problem.tolerance);
  if (is_of_many_specimens) {
    test_mean(problem, point, context, result);
  } else {
    test_structure(problem,
                   {.residual = setup.target - y,
                    .measurement_std = setup.weight.cwiseSqrt().cwiseInverse(),
                    .free_step = unbounded_step(setup, x, y, g)},
                   result);
  }
  note_model_error(problem, "deterministic",
                   "is added to the measurement error in weights, standard deviations "
                   "and residuals.",
                   result);
  result.notes.push_back(fmt::format(
      "The standard deviations of this method say how well the {} known; they do not describe the scatter of "
      "specimens.",
      is_of_many_specimens ? "specimens' mean is" : "parameters of one structure are"));
  return result;
}

}  // namespace mottle::updating
