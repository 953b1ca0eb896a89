#include "updating/population/population_fit.hpp"

#include <Eigen/Core>
#include <algorithm>
#include <cmath>

#include "mottle/core/error.hpp"
#include "mottle/core/subject.hpp"
#include "mottle/linalg/dense/decompositions.hpp"
#include "mottle/stats/moments/descriptive.hpp"
#include "mottle/updating/methods/iteration.hpp"
#include "updating/fits/scaled_parameters.hpp"
#include "updating/fits/specimen_restarts.hpp"
#include "updating/methods/linear_units.hpp"
#include "updating/population/following_problem.hpp"

namespace mottle::updating {
namespace {

/// How far prior deviations move the outputs, each measured by what all of them together move it.
Eigen::MatrixXd scaled_movement(const Eigen::MatrixXd& sensitivity, const Eigen::VectorXd& prior_std) {
  const Eigen::MatrixXd moved = sensitivity * prior_std.asDiagonal();
  const Eigen::VectorXd scale = moved.rowwise().norm().cwiseMax(1e-300).cwiseInverse();
  return scale.asDiagonal() * moved;
}

/// Directions, in prior deviations, that the outputs see.
Eigen::MatrixXd seen_directions(const Eigen::MatrixXd& movement, double tolerance) {
  const SingularValues svd(movement, Eigen::ComputeThinV);
  Eigen::Index rank = 0;
  while (rank < svd.values().size() && svd.values()(rank) > tolerance * svd.values()(0)) ++rank;
  return svd.right().leftCols(rank);
}

/// What does not change while the estimate is iterated.
struct Frame {
  Eigen::VectorXd origin;      // t of effects zero
  Eigen::MatrixXd map;         // parameters of effects
  Eigen::MatrixXd start;       // Sigma of the effects to start from
  Eigen::MatrixXd directions;  // of the effects' mean; empty: all
  Eigen::MatrixXd movement;    // of the outputs by prior deviations, where directions are some [output x parameter]
  Eigen::VectorXd prior_std;
  double tolerance = 0.0;
};

/// Effects are seen combinations of the parameters where some are not seen and all may be correlated; else they are the
/// parameters themselves, and only their mean is confined to what is seen.
Frame make_frame(const UpdatingProblem& problem, const PriorOnScales& prior, const Eigen::MatrixXd& seen,
                 const Eigen::MatrixXd& movement, double tolerance) {
  const Eigen::Index q = prior.mean.size();
  const Eigen::VectorXd prior_std = prior.covariance.diagonal().cwiseSqrt();
  Frame frame{prior.mean, Eigen::MatrixXd::Identity(q, q), prior.covariance, {}, movement, prior_std, tolerance};
  if (seen.cols() == q) return frame;
  const Eigen::MatrixXd combinations = prior_std.asDiagonal() * seen;
  if (problem.covariance_groups.empty()) {
    frame.map = combinations;
    frame.start = Eigen::MatrixXd::Identity(seen.cols(), seen.cols());
  } else {
    frame.start = prior_std.cwiseAbs2().asDiagonal();
    frame.directions = combinations;
  }
  return frame;
}

/// Origin and directions of a mean that meets held * m = level: the nearest to zero, and what of the rest the outputs
/// see. A parameter that the bounds hold leaves its place to combinations that were not needed before.
void confine_mean(const Frame& frame, const Eigen::MatrixXd& held, const Eigen::VectorXd& level,
                  RandomEffectsSettings& settings) {
  const Eigen::Index effects = frame.map.cols();
  const bool is_partial = frame.directions.size() > 0;
  const Eigen::VectorXd unit = is_partial ? frame.prior_std : Eigen::VectorXd(Eigen::VectorXd::Ones(effects));
  const Eigen::MatrixXd scaled = held * unit.asDiagonal();
  const LeastNormSolver solver(scaled);
  const SingularValues svd(scaled, Eigen::ComputeFullV);
  const Eigen::MatrixXd free = svd.right().rightCols(effects - svd.rank());
  settings.mean_origin = unit.asDiagonal() * solver.solve(level);
  settings.mean_directions = unit.asDiagonal() * free;
  if (is_partial && free.cols() > 0)
    settings.mean_directions *= seen_directions(frame.movement * free, frame.tolerance);
}

/// The estimate with its mean kept within the bounds: parameters that would leave them are held on them.
void fit_within_bounds(const UpdatingProblem& problem, const Frame& frame, const Eigen::MatrixXd& start,
                       PopulationFit& population) {
  const Eigen::Index effects = frame.map.cols();
  RandomEffectsSettings& settings = population.settings;
  settings.mean_origin.resize(0);
  settings.mean_directions.resize(0, 0);
  if (frame.directions.size() > 0) {
    settings.mean_origin = Eigen::VectorXd::Zero(effects);
    settings.mean_directions = frame.directions;
  }
  const ScaledParameters parameters(problem.space);
  Eigen::MatrixXd held(0, effects);  // rows a with a' m = b
  Eigen::VectorXd level(0);
  RandomEffectsFit& fit = population.effects;
  fit = fit_random_effects(population.units, start, settings);
  population.unbounded_mean = frame.origin + frame.map * fit.mean;
  population.unbounded_log_likelihood = fit.log_likelihood;
  for (Eigen::Index round = 0; round < effects; ++round) {
    const Eigen::VectorXd t = frame.origin + frame.map * fit.mean;
    const Eigen::VectorXd clamped = parameters.clamp(t);
    std::vector<Eigen::Index> beyond;
    for (Eigen::Index i = 0; i < t.size(); ++i) {
      if (std::abs(clamped(i) - t(i)) > 1e-12 * std::abs(t(i))) beyond.push_back(i);
    }
    if (beyond.empty()) break;
    const auto old = held.rows();
    const auto added = static_cast<Eigen::Index>(beyond.size());
    held.conservativeResize(old + added, effects);
    level.conservativeResize(old + added);
    for (Eigen::Index k = 0; k < added; ++k) {
      const Eigen::Index i = beyond[static_cast<std::size_t>(k)];
      held.row(old + k) = frame.map.row(i);
      level(old + k) = clamped(i) - frame.origin(i);
    }
    confine_mean(frame, held, level, settings);
    fit = fit_random_effects(population.units, start, settings);
  }
}

/// The covariance with no scatter of the parameters that have none.
void take_scatter(Eigen::MatrixXd& covariance, const std::vector<bool>& has_scatter) {
  for (std::size_t i = 0; i < has_scatter.size(); ++i) {
    if (has_scatter[i]) continue;
    covariance.row(static_cast<Eigen::Index>(i)).setZero();
    covariance.col(static_cast<Eigen::Index>(i)).setZero();
  }
}

/// Weight of the belief that parameters are not correlated: a fifth of a specimen for each specimen's worth of missing
/// entries, fading where specimens are many. Chosen by replication at 5 to 50 specimens (docs/theory).
double shrinkage_for(const Eigen::Ref<const Eigen::MatrixXd>& values) {
  const double missing = static_cast<double>(values.array().isNaN().count()) / static_cast<double>(values.size());
  const auto n = static_cast<double>(values.rows());
  return 0.2 * missing * n / (1.0 + n / 50.0);
}

/// Tests without what the model's error is taken to add to them.
Eigen::MatrixXd without_shift(const Eigen::Ref<const Eigen::MatrixXd>& values, const Eigen::VectorXd& shift) {
  if (shift.size() == 0) return values;
  return values.rowwise() - shift.transpose();
}

SpecimenStart start_from(const SpecimenFits& fits, double tolerance) {
  return {.points = fits.points,
          .jacobians = fits.jacobians,
          .tolerance = tolerance,
          .differentiated = fits.differentiated};
}

/// The model's error of a linear fit.
ModelError model_error_of(const PopulationFit& fit, const NoiseModel& given) {
  const SharedErrorInformation information = shared_error_information(fit.units, fit.effects, fit.settings);
  ModelError error{.std = given.base.cwiseSqrt(),
                   .shift = fit.effects.shared,
                   .covariance = information.covariance,
                   .gain = fit.map * information.gain};
  for (std::size_t k = 0; k < given.factor.size(); ++k) {
    if (given.factor[k] >= 0) {
      error.std(static_cast<Eigen::Index>(k)) *= std::sqrt(fit.effects.levels(given.factor[k]));
    }
  }
  for (const SharedErrorLevel& level : information.levels) error.degrees_of_freedom.push_back(level.degrees_of_freedom);
  return error;
}

}  // namespace

bool is_noise_estimated(const PopulationFit& fit) {
  return fit.settings.factors > 0 || fit.noise_of_residuals.degrees_of_freedom > 0.0;
}

Eigen::RowVectorXd means_of_tests(const Eigen::Ref<const Eigen::MatrixXd>& values) {
  Eigen::RowVectorXd means(values.cols());
  for (Eigen::Index k = 0; k < values.cols(); ++k) {
    const auto is_measured = !values.col(k).array().isNaN();
    means(k) = is_measured.select(values.col(k).array(), 0.0).sum() / static_cast<double>(is_measured.count());
  }
  return means;
}

PopulationEvidence evidence_of(const PopulationFit& fit) {
  PopulationEvidence evidence = population_evidence(fit.units, fit.effects, fit.settings, fit.map);
  evidence.mean = fit.mean;
  return evidence;
}

PopulationFit fit_population(const UpdatingProblem& problem, const Eigen::Ref<const Eigen::MatrixXd>& values,
                             const PopulationFitSettings& settings, const RunContext& context,
                             const std::function<bool(const PopulationFit&)>& each) {
  PriorOnScales prior = prior_on_scales(problem.space);
  if (settings.start.size() > 0) prior.mean = settings.start;
  const Eigen::VectorXd prior_std = prior.covariance.diagonal().cwiseSqrt();
  PopulationFit fit;
  fit.noise = settings.noise.base;
  const bool has_error = settings.model_error.base.size() > 0;
  Eigen::VectorXd error = has_error ? Eigen::VectorXd(Eigen::VectorXd::Zero(values.cols())) : Eigen::VectorXd();
  // The mean of the tests first: all specimens then start near their ends.
  const Eigen::VectorXd spread = has_error ? Eigen::VectorXd(fit.noise + settings.model_error.base) : fit.noise;
  // A model that adapts to regions needs no more of it than where its region lies; until then each run is a full one.
  constexpr double k_near_enough = 1e-2;
  const double centre_tolerance = problem.model.adapts_to_regions() ? k_near_enough : settings.specimen_tolerance;
  const Eigen::VectorXd first = settings.first.size() > 0 ? settings.first : prior.mean;
  const SpecimenFits centre = fit_specimens(problem, means_of_tests(values), {prior.mean, prior.covariance, spread},
                                            {first.transpose(), {}, centre_tolerance}, context, fit.evaluations);
  fit.mean = ScaledParameters(problem.space).clamp(centre.points.row(0).transpose());
  fit.covariance = prior.covariance;
  const Eigen::MatrixXd movement = scaled_movement(centre.jacobians[0], prior_std);
  require_of(!movement.isZero(0.0), {Subject::Kind::outputs},
             "no parameter moves any of them at the prior's mean, so that tests say nothing of the parameters; choose "
             "parameters that change the outputs, or other outputs");
  fit.seen = seen_directions(movement, settings.rank_tolerance);
  Frame frame = make_frame(problem, prior, fit.seen, movement, settings.rank_tolerance);
  take_scatter(frame.start, settings.has_scatter);
  take_scatter(fit.covariance, settings.has_scatter);
  fit.map = frame.map;
  fit.settings.is_restricted = settings.is_restricted;
  fit.settings.factors = settings.noise.factors;
  fit.settings.covariance_groups = problem.covariance_groups;
  fit.settings.shrinkage = shrinkage_for(values);
  fit.settings.shared_variance = settings.model_error.base;
  fit.settings.shared_level = settings.model_error.factor;
  fit.settings.levels = settings.model_error.factors;
  if (frame.map.cols() < prior.mean.size()) {
    fit.covariance = frame.map * frame.map.transpose();
    const Eigen::VectorXd shift =
        fit.seen.transpose() * prior_std.cwiseInverse().asDiagonal() * (fit.mean - prior.mean);
    fit.mean = prior.mean + frame.map * shift;
    // What is left of it may be where the model has no modes; the fit itself is not.
    if (!outputs_on_scales(problem, fit.mean.transpose(), context, fit.evaluations).allFinite()) {
      fit.mean = centre.points.row(0);
    }
  }
  // Each estimate goes on from the last one, kept off the border where expectation-maximisation no longer moves.
  constexpr double k_fresh = 0.01;
  fit.settings.iterations = settings.inner_iterations;
  Eigen::MatrixXd start = frame.start;
  FollowingProblem following(problem, prior, fit);
  following.begin(settings.region);
  SpecimenStart from{fit.mean.transpose().replicate(values.rows(), 1),
                     std::vector<Eigen::MatrixXd>(static_cast<std::size_t>(values.rows()), centre.jacobians[0]),
                     settings.specimen_tolerance};
  int restarts = 0;
  while (fit.iterations < settings.iterations && !fit.converged) {
    for (std::size_t i = 0; i < settings.has_scatter.size(); ++i) {
      const auto column = static_cast<Eigen::Index>(i);
      if (!settings.has_scatter[i]) from.points.col(column).setConstant(fit.mean(column));
    }
    fit.specimens = fit_specimens(following.now(), without_shift(values, error), {fit.mean, fit.covariance, fit.noise},
                                  from, context, fit.evaluations);
    from = start_from(fit.specimens, settings.specimen_tolerance);
    fit.sensitivity = mean_jacobian(fit.specimens.jacobians);
    Eigen::MatrixXd absorbed;
    if (has_error) {
      const Eigen::VectorXd variance = fit.noise / static_cast<double>(values.rows()) + settings.model_error.base;
      absorbed = absorbed_errors(fit.sensitivity, prior_std.asDiagonal() * fit.seen, variance);
    }
    fit.units =
        linear_units(values, error, fit.sensitivity, absorbed, fit.specimens, settings.noise, frame.origin, frame.map);
    if (settings.noise.factors > 0 && settings.has_noise_of_residuals)
      take_noise_of_residuals(values, settings.noise, fit);
    fit_within_bounds(problem, frame, start, fit);
    start = (1.0 - k_fresh) * fit.effects.covariance + k_fresh * frame.start;
    if (has_error) error = fit.effects.shared;
    const Eigen::VectorXd mean = frame.origin + frame.map * fit.effects.mean;
    const Eigen::MatrixXd mapped = frame.map * fit.effects.covariance * frame.map.transpose();
    Eigen::MatrixXd covariance = 0.5 * (mapped + mapped.transpose());
    repair_covariance(covariance);
    const double step = largest_movement(prior_std, fit.mean, fit.covariance, mean, covariance);
    fit.converged = fit.iterations > 0 && step <= settings.tolerance;
    fit.mean = mean;
    fit.covariance = covariance;
    for (Eigen::Index k = 0; fit.settings.factors > 0 && k < fit.noise.size(); ++k) {
      const int f = settings.noise.factor[static_cast<std::size_t>(k)];
      if (f >= 0) fit.noise(k) = settings.noise.base(k) * fit.effects.noise_factors(f);
    }
    ++fit.iterations;
    if (fit.converged && restarts < settings.restarts) {
      ++restarts;
      SpecimenFits again = fit.specimens;
      fit.converged =
          restart_specimens(following.now(), without_shift(values, error), {fit.mean, fit.covariance, fit.noise},
                            settings.specimen_tolerance, context, fit.evaluations, again) == 0;
      if (!fit.converged) from = start_from(again, settings.specimen_tolerance);
    }
    if (!fit.converged) following.follow();
    if (!each(fit)) break;
  }
  if (has_error) fit.model_error = model_error_of(fit, settings.model_error);
  return fit;
}

}  // namespace mottle::updating
