#include "updating/population/population_report.hpp"

#include <Eigen/Core>
#include <algorithm>
#include <cmath>
#include <limits>
#include <map>

#include "mottle/core/subject.hpp"
#include "mottle/core/text.hpp"
#include "mottle/linalg/dense/decompositions.hpp"
#include "updating/fits/measured_outputs.hpp"
#include "updating/fits/regional_problem.hpp"
#include "updating/fits/scaled_parameters.hpp"
#include "updating/methods/curvature.hpp"
#include "updating/population/model_error.hpp"
#include "updating/population/model_error_intervals.hpp"
#include "updating/verdict/normality_report.hpp"
#include "updating/verdict/other_solutions.hpp"

namespace mottle::updating {
namespace {

constexpr double k_nan = std::numeric_limits<double>::quiet_NaN();
constexpr double k_mostly_seen = 0.1;  // part of a parameter that may be unseen before its interval means nothing

/// Length of the part of each parameter, in prior deviations, that the outputs do not see.
Eigen::VectorXd unseen_parts(const PopulationFit& fit) {
  const Eigen::VectorXd seen = fit.seen.rowwise().squaredNorm();
  return (1.0 - seen.array()).max(0.0).sqrt();
}

/// Effects are the parameters themselves, though the outputs do not see all of them.
bool are_effects_partly_unseen(const PopulationFit& fit) {
  return fit.map.cols() == fit.mean.size() && fit.seen.cols() < fit.mean.size();
}

/// Whether bounds hold the mean of a parameter, beyond its confinement to what the outputs see.
bool is_mean_held(const PopulationFit& fit) {
  const RandomEffectsSettings& settings = fit.settings;
  if (settings.mean_origin.size() == 0) return false;
  return !are_effects_partly_unseen(fit) || !settings.mean_origin.isZero(0.0) ||
         settings.mean_directions.cols() < fit.seen.cols();
}

/// What of the intervals lies within the bounds; nan where nothing does. On another scale than the identity bounds hold
/// for the median: they say nothing of the mean alone.
void cut_at_bounds(const ParameterSpace& space, Eigen::MatrixXd& intervals) {
  const double infinity = std::numeric_limits<double>::infinity();
  const Eigen::VectorXd lower = space.clamp(Eigen::VectorXd::Constant(space.count(), -infinity));
  const Eigen::VectorXd upper = space.clamp(Eigen::VectorXd::Constant(space.count(), infinity));
  for (Eigen::Index i = 0; i < intervals.rows(); ++i) {
    const Parameter& parameter = space.parameters()[static_cast<std::size_t>(i)];
    if (parameter.transform.kind != ParameterTransform::Kind::identity) continue;
    intervals(i, 0) = std::max(intervals(i, 0), lower(i));
    intervals(i, 1) = std::min(intervals(i, 1), upper(i));
    if (!(intervals(i, 0) < intervals(i, 1))) intervals.row(i).setConstant(k_nan);
  }
}

/// Takes away what the data say nothing of.
void forget_unseen(const UpdatingProblem& problem, const PopulationFit& fit, ParameterIntervals& intervals) {
  const Eigen::VectorXd unseen = unseen_parts(fit);
  const std::vector<int>& groups = problem.covariance_groups;
  for (Eigen::Index i = 0; i < unseen.size(); ++i) {
    if (unseen(i) > k_mostly_seen) {
      intervals.mean.row(i).setConstant(k_nan);
      intervals.std.row(i).setConstant(k_nan);
    }
    for (Eigen::Index j = 0; j < unseen.size(); ++j) {
      const bool is_free = groups.empty() || groups[static_cast<std::size_t>(i)] == groups[static_cast<std::size_t>(j)];
      if (i == j || (is_free && std::max(unseen(i), unseen(j)) <= k_mostly_seen)) continue;
      intervals.correlation_lower(i, j) = k_nan;
      intervals.correlation_upper(i, j) = k_nan;
    }
  }
}

void add_notes(const UpdatingProblem& problem, const PopulationFit& fit, const PopulationFitSettings& settings,
               UpdatingResult& result) {
  result.notes.push_back(
      "Mean, standard deviation and correlation are those of the population of specimens, without the measurement "
      "noise.");
  if (settings.noise.factors > 0) {
    std::vector<std::string> levels;
    for (std::size_t k = 0; k < settings.noise.factor.size(); ++k) {
      const auto place = static_cast<Eigen::Index>(k);
      if (settings.noise.factor[k] >= 0) {
        levels.push_back(fmt::format("{} {:.3g}", problem.model.outputs()[k].name(), std::sqrt(fit.noise(place))));
      }
    }
    result.notes.push_back(fmt::format("Standard deviation of the measurement, estimated: {}.", join(levels)));
  } else if (fit.noise.isZero(0.0)) {
    result.notes.push_back("The tests count as free of noise: all of their scatter is attributed to the specimens.");
  }
  if (fit.model_error) result.notes.push_back(model_error_note(problem, *fit.model_error));
  const Eigen::VectorXd unseen = unseen_parts(fit);
  std::vector<std::string> names;
  for (Eigen::Index i = 0; i < unseen.size(); ++i) {
    if (unseen(i) > k_mostly_seen) names.push_back(problem.space.parameters()[static_cast<std::size_t>(i)].name);
  }
  if (fit.seen.cols() < unseen.size()) {
    result.notes.push_back(fmt::format(
        "The outputs determine {} combinations of the {} parameters. The other combinations keep the prior's mean, "
        "without scatter; no intervals are given for parameters that take part in them: {}.",
        fit.seen.cols(), unseen.size(), names.empty() ? "none to more than a tenth" : join(names)));
  }
  if (!fit.effects.converged && problem.tests.values.array().isNaN().any()) {
    result.warnings.push_back(fmt::format(
        "The likelihood of the parameters' covariance has no clear maximum: entries of the tests are missing, and some "
        "combination of the {} parameters hardly scatters, or the model does not fit the tests. Standard deviations "
        "near 0 and their intervals are not to be relied on. Leave out parameters that the tests hardly see; state the "
        "noise of the tests.",
        problem.space.count()));
  }
}

/// Few samples may all end on the border where the estimate does not: the interval of a standard deviation holds its
/// estimate at least.
void take_in_estimates(const Eigen::MatrixXd& covariance, ParameterIntervals& intervals) {
  for (Eigen::Index i = 0; i < covariance.rows(); ++i) {
    const double std = std::sqrt(covariance(i, i));
    if (std < intervals.std(i, 0)) intervals.std(i, 0) = std;
    if (std > intervals.std(i, 1)) intervals.std(i, 1) = std;
  }
}

}  // namespace

SpecimenEstimates estimate_specimens(const UpdatingProblem& problem, const PopulationFit& fit) {
  const Eigen::MatrixXd& values = problem.tests.values;
  SpecimenEstimates estimates{to_variables(problem.space.transforms(), fit.specimens.points),
                              Eigen::MatrixXd::Constant(values.rows(), values.cols(), k_nan)};
  for (Eigen::Index s = 0; s < values.rows(); ++s) {
    const std::vector<Eigen::Index> rows = measured_outputs(values, s);
    const RandomEffectsUnit& unit = fit.units[static_cast<std::size_t>(s)];
    Eigen::MatrixXd total = unit.design * fit.effects.covariance * unit.design.transpose();
    total.diagonal() += fit.noise(rows);
    const Eigen::VectorXd standard_deviation = total.diagonal().cwiseMax(1e-300).cwiseSqrt();
    const Eigen::MatrixXd correlation =
        standard_deviation.cwiseInverse().asDiagonal() * total * standard_deviation.cwiseInverse().asDiagonal();
    const SymmetricEigen solver(correlation);
    constexpr double k_singular = 1e-10;
    const Eigen::VectorXd root =
        solver.eigenvalues().unaryExpr([](double v) { return v > k_singular ? 1.0 / std::sqrt(v) : 0.0; });
    Eigen::VectorXd misfit = unit.response - unit.design * fit.effects.mean;
    if (fit.model_error) misfit -= unit.shared * fit.model_error->shift;
    const Eigen::VectorXd residual = misfit.cwiseQuotient(standard_deviation);
    const Eigen::VectorXd whitened =
        solver.eigenvectors() * root.asDiagonal() * (solver.eigenvectors().transpose() * residual);
    for (std::size_t k = 0; k < rows.size(); ++k)
      estimates.residuals(s, rows[k]) = whitened(static_cast<Eigen::Index>(k));
  }
  return estimates;
}

ParameterIntervals analytic_intervals(const UpdatingProblem& problem, const PopulationFit& fit) {
  const PopulationEvidence evidence = evidence_without_bounds(problem, fit);
  PopulationIntervals ends = population_intervals(evidence, problem.space.transforms(), k_confidence);
  if (is_mean_held(fit)) cut_at_bounds(problem.space, ends.mean);
  return {std::move(ends.mean), std::move(ends.std), std::move(ends.correlation_lower),
          std::move(ends.correlation_upper), "analytic"};
}

Eigen::MatrixXd start_beside(const UpdatingProblem& problem, const PopulationFit& fit) {
  constexpr double k_fresh = 0.01;
  // Effects that are combinations of parameters have unit variance in the prior.
  const bool are_parameters = fit.map.cols() == fit.mean.size();
  const Eigen::VectorXd prior = are_parameters ? Eigen::VectorXd(prior_on_scales(problem.space).covariance.diagonal())
                                               : Eigen::VectorXd(Eigen::VectorXd::Ones(fit.map.cols()));
  Eigen::MatrixXd start = fit.effects.covariance;
  start.diagonal() += k_fresh * (start.diagonal() + k_fresh * prior);
  return start;
}

PopulationEvidence evidence_without_bounds(const UpdatingProblem& problem, const PopulationFit& fit) {
  if (!is_mean_held(fit)) return evidence_of(fit);
  RandomEffectsSettings settings = fit.settings;
  settings.mean_origin.resize(0);
  settings.mean_directions.resize(0, 0);
  if (are_effects_partly_unseen(fit)) {
    settings.mean_origin = Eigen::VectorXd::Zero(fit.map.cols());
    settings.mean_directions = prior_on_scales(problem.space).covariance.diagonal().cwiseSqrt().asDiagonal() * fit.seen;
  }
  const RandomEffectsFit free = fit_random_effects(fit.units, start_beside(problem, fit), settings);
  PopulationEvidence evidence = population_evidence(fit.units, free, settings, fit.map);
  evidence.mean = fit.mean + fit.map * (free.mean - fit.effects.mean);
  return evidence;
}

NoiseModel noise_model(const UpdatingProblem& problem, const MaximumLikelihoodOptions& options,
                       const std::string& method) {
  using Noise = MaximumLikelihoodOptions::Noise;
  const Eigen::VectorXd& given = problem.tests.repeatability_std;
  const Eigen::Index p = problem.tests.values.cols();
  NoiseModel model = known_noise(given.cwiseAbs2());
  const bool has_more_outputs = p > problem.space.count();
  const bool is_estimated = options.noise == Noise::estimated ||
                            (options.noise == Noise::automatic && has_more_outputs && (given.array() <= 0.0).any());
  const Subject noise_option{Subject::Kind::option, method + ".noise"};
  if (!is_estimated) {
    require_of(!has_more_outputs || (given.array() > 0.0).all(), noise_option,
               "\"given\" needs the repeatability of every output, because {} outputs are "
               "more than the {} parameters can reproduce; give it, or set noise = \"estimated\"",
               p, problem.space.count());
    return model;
  }
  require_of(has_more_outputs, noise_option,
             "cannot be estimated, {} outputs are no more than the {} parameters; give the tests' repeatability", p,
             problem.space.count());
  std::vector<bool> is_open(static_cast<std::size_t>(p), true);
  for (Eigen::Index k = 0; k < p; ++k) {
    if (options.noise == Noise::automatic && given(k) > 0.0) is_open[static_cast<std::size_t>(k)] = false;
  }
  return with_levels(problem, std::move(model), is_open);
}

NoiseModel with_levels(const UpdatingProblem& problem, NoiseModel model, const std::vector<bool>& is_open) {
  const Eigen::Index p = problem.tests.values.cols();
  constexpr double k_hundredth = 0.01;
  std::map<QuantityKind, int> factors;
  for (Eigen::Index k = 0; k < p; ++k) {
    if (!is_open[static_cast<std::size_t>(k)]) continue;
    const QuantityKind kind = problem.model.outputs()[static_cast<std::size_t>(k)].kind;
    const int next = static_cast<int>(factors.size());
    model.factor[static_cast<std::size_t>(k)] = factors.try_emplace(kind, next).first->second;
  }
  model.factors = static_cast<int>(factors.size());
  for (const auto& [kind, factor] : factors) {
    double sum = 0.0;
    double count = 0.0;
    for (Eigen::Index k = 0; k < p; ++k) {
      if (model.factor[static_cast<std::size_t>(k)] != factor) continue;
      const Eigen::ArrayXd column = problem.tests.values.col(k).array();
      const Eigen::ArrayXd squares = column.isNaN().select(0.0, column.square());
      const double measured = static_cast<double>(column.size() - column.isNaN().count());
      sum += squares.sum();
      count += measured;
      model.base(k) = k_hundredth * k_hundredth * squares.sum() / measured;
    }
    if (traits_of(kind).has_relative_noise) continue;
    for (Eigen::Index k = 0; k < p; ++k) {
      if (model.factor[static_cast<std::size_t>(k)] == factor) model.base(k) = k_hundredth * k_hundredth * sum / count;
    }
  }
  return model;
}

void describe_population(const UpdatingProblem& problem, const SolvedPopulation& solved,
                         const MaximumLikelihoodOptions& options, const RunContext& context, UpdatingResult& result) {
  const PopulationFit& fit = solved.best();
  const PopulationFitSettings& settings = solved.settings;
  using Intervals = MaximumLikelihoodOptions::Intervals;
  result.noise_covariance = fit.noise.asDiagonal();
  result.specimens = estimate_specimens(problem, fit);
  result.sensitivity = fit.sensitivity;
  result.model_error = fit.model_error;
  const std::vector<ParameterTransform> scales = problem.space.transforms();
  for (Eigen::Index i = 0; i < fit.mean.size(); ++i) {
    result.sensitivity.col(i) /= scales[static_cast<std::size_t>(i)].slope(fit.mean(i));
  }
  result.outliers = find_outliers(fit.units, fit.effects, fit.settings, fit.map, problem.level);
  name_other_solutions(problem, fit, solved.solutions, solved.starts, result);
  const PopulationEvidence& evidence = result.estimate->population()->evidence;
  const RegionalProblem near(problem, fit.region);
  if (options.intervals == Intervals::analytic) {
    result.intervals = analytic_intervals(problem, fit);
    if (!is_mean_held(fit)) {
      curve_by_model_error(near.problem(), fit, evidence, result.mean, context, result.model_evaluations,
                           result.intervals->mean);
    }
  }
  if (options.intervals == Intervals::bootstrap) {
    result.intervals = bootstrap_intervals(near.problem(), fit, evidence, settings, options.bootstrap_samples, context,
                                           result.model_evaluations);
    // A mean that a bound holds is held in every sample, which says nothing of where it may be.
    if (is_mean_held(fit)) result.intervals->mean = analytic_intervals(problem, fit).mean;
  }
  if (result.intervals) {
    take_in_estimates(result.covariance, *result.intervals);
    forget_unseen(problem, fit, *result.intervals);
  }
  add_notes(problem, fit, settings, result);
  report_normality(problem, fit, result);
  describe_curvature(near.problem(), fit, context, result);
  test_population(problem, fit, context, result);
}

}  // namespace mottle::updating
