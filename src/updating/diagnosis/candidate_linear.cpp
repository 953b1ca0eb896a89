// The linear models at the specimens of a fit: sensitivities of every candidate, and what a candidate gains in them.
#include <algorithm>
#include <cmath>
#include <limits>
#include <numeric>

#include "mottle/core/error.hpp"
#include "mottle/stats/distributions/chi_squared.hpp"
#include "updating/diagnosis/candidate_fits.hpp"
#include "updating/fits/measured_outputs.hpp"
#include "updating/fits/scaled_parameters.hpp"

namespace mottle::updating {
namespace {

constexpr Eigen::Index k_batch = 4096;  // model runs of differences by hundreds of candidates that are held at once
constexpr double k_farthest = 5.0;      // prior standard deviations that a linear model is trusted to reach

/// Holds the mean of the last effect.
void hold_last_mean(RandomEffectsSettings& rules, Eigen::Index effects, double mean) {
  if (rules.mean_origin.size() == 0) {
    rules.mean_origin = Eigen::VectorXd::Zero(effects);
    rules.mean_directions = Eigen::MatrixXd::Identity(effects, effects - 1);
  } else {
    rules.mean_directions.conservativeResize(Eigen::NoChange, rules.mean_directions.cols() - 1);
  }
  rules.mean_origin(effects - 1) = mean;
}

}  // namespace

std::vector<Eigen::MatrixXd> CandidateFits::derivatives_at(const Eigen::MatrixXd& samples,
                                                           const std::vector<Eigen::Index>& members) {
  const ParameterSpace part = part_of(problem_.space, members);
  std::vector<Parameter> parameters = part.parameters();
  for (Parameter& parameter : parameters) parameter.transform = {};
  const ParameterSpace space(std::move(parameters), part.prior());
  const FixedParameterModel model(problem_, problem_.space.prior().mean(), members, signs_);
  const UpdatingProblem whole{.model = model, .derivatives = model.derivatives(), .space = space};
  const ScaledParameters axes(space);
  std::vector<Eigen::MatrixXd> derivatives;
  const Eigen::Index at_once = std::max<Eigen::Index>(k_batch / (2 * space.count()), 1);
  for (Eigen::Index begin = 0; begin < samples.rows(); begin += at_once) {
    context_.throw_if_stopped();
    const Eigen::MatrixXd points = samples.middleRows(begin, std::min(at_once, samples.rows() - begin));
    const Eigen::MatrixXd outputs = outputs_on_scales(whole, points, context_, evaluations_);
    for (Eigen::MatrixXd& one : scaled_jacobians(whole, axes, points, outputs, context_, evaluations_))
      derivatives.push_back(std::move(one));
  }
  return derivatives;
}

Eigen::MatrixXd CandidateFits::slope_at(const SetFit& base, const ParameterSet& set) {
  std::vector<Eigen::Index> all(static_cast<std::size_t>(problem_.space.count()));
  std::iota(all.begin(), all.end(), Eigen::Index{0});
  Eigen::RowVectorXd x = problem_.space.prior().mean().transpose();
  x(set.members) = base.mean.transpose();
  return derivatives_at(x, all).front();
}

CandidateEffects CandidateFits::effects_at_specimens(const SetFit& base, const ParameterSet& set,
                                                     Eigen::Index candidate) {
  const ParameterSet more = set.with(candidate, false);
  const std::vector<ParameterTransform> scales = problem_.space.transforms();
  Eigen::MatrixXd samples(specimens(), static_cast<Eigen::Index>(more.members.size()));
  for (std::size_t i = 0; i < set.members.size(); ++i) {
    const auto column = static_cast<Eigen::Index>(i);
    samples.col(column) =
        to_variables({scales[static_cast<std::size_t>(set.members[i])]}, base.fit.specimens.points.col(column));
  }
  samples.rightCols(1).setConstant(problem_.space.prior().mean()(candidate));
  CandidateEffects effects;
  for (const Eigen::MatrixXd& one : derivatives_at(samples, more.members)) effects.emplace_back(one.rightCols(1));
  return effects;
}

LinearProblem CandidateFits::linear_problem(const SetFit& base, const ParameterSet& set) const {
  const PriorOnScales prior = prior_on_scales(part_of(problem_.space, set.members));
  LinearProblem problem{base.fit.units, prior.covariance, base.fit.settings};
  for (std::size_t i = 0; i < set.has_scatter.size(); ++i) {
    if (set.has_scatter[i]) continue;
    problem.start.row(static_cast<Eigen::Index>(i)).setZero();
    problem.start.col(static_cast<Eigen::Index>(i)).setZero();
  }
  return problem;
}

LinearProblem CandidateFits::linear_problem(const SetFit& base, const ParameterSet& set, Eigen::Index candidate,
                                            bool is_random, const CandidateEffects& effects) const {
  LinearProblem problem = linear_problem(base, set);
  for (Eigen::Index s = 0; s < specimens(); ++s) {
    RandomEffectsUnit& unit = problem.units[static_cast<std::size_t>(s)];
    const std::vector<Eigen::Index> rows = measured_outputs(tests_.values, s);
    unit.design.conservativeResize(Eigen::NoChange, unit.design.cols() + 1);
    unit.design.rightCols(1) = effects[static_cast<std::size_t>(s)](rows);
  }
  const Eigen::Index q = base.fit.mean.size();
  RandomEffectsSettings& rules = problem.settings;
  rules.covariance_groups = groups_of(set.with(candidate, is_random));
  if (rules.mean_origin.size() > 0) {
    rules.mean_origin.conservativeResize(q + 1);
    rules.mean_origin(q) = 0.0;
    const Eigen::Index columns = rules.mean_directions.cols();
    rules.mean_directions.conservativeResize(q + 1, columns + 1);
    rules.mean_directions.row(q).setZero();
    rules.mean_directions.col(columns) = Eigen::VectorXd::Unit(q + 1, q);
  }
  problem.start.conservativeResize(q + 1, q + 1);
  problem.start.row(q).setZero();
  problem.start.col(q).setZero();
  if (is_random) problem.start(q, q) = problem_.space.prior().covariance()(candidate, candidate);
  return problem;
}

double CandidateFits::reachable_shift(Eigen::Index candidate, double shift) const {
  const double farthest = k_farthest * std::sqrt(problem_.space.prior().covariance()(candidate, candidate));
  const double nominal = problem_.space.prior().mean()(candidate);
  return within_limits(candidate, nominal + std::clamp(shift, -farthest, farthest)) - nominal;
}

double CandidateFits::within_limits(Eigen::Index candidate, double mean) const {
  Eigen::VectorXd asked = problem_.space.prior().mean();
  asked(candidate) = mean;
  return problem_.space.clamp(asked)(candidate);
}

bool CandidateFits::is_at_limit(Eigen::Index candidate, double needed, double mean) const {
  constexpr double k_beyond = 1e-6;  // prior standard deviations
  const double tolerance = k_beyond * std::sqrt(problem_.space.prior().covariance()(candidate, candidate));
  const double limit = within_limits(candidate, needed);
  return std::abs(limit - needed) > tolerance && std::abs(limit - mean) <= tolerance;
}

void CandidateFits::note_limit(double needed, double cost, CandidateFit& fit) {
  constexpr double k_level = 0.05;
  fit.needed = needed;
  fit.is_possible = 2.0 * cost <= chi_squared_quantile(1.0 - k_level, 1.0);
}

CandidateFit CandidateFits::linear_fit(const SetFit& base, const ParameterSet& set, Eigen::Index candidate,
                                       bool is_random, const CandidateEffects& effects) const {
  constexpr double k_fresh = 0.01;  // of the start: off the border of the covariance
  LinearProblem problem = linear_problem(base, set, candidate, is_random, effects);
  auto start = problem.start.topLeftCorner(base.fit.effects.covariance.rows(), base.fit.effects.covariance.cols());
  start = ((1.0 - k_fresh) * base.fit.effects.covariance + k_fresh * start).eval();
  RandomEffectsFit fit = fit_random_effects(problem.units, problem.start, problem.settings);
  const Eigen::Index last = fit.mean.size() - 1;
  const double nominal = problem_.space.prior().mean()(candidate);
  const double shift = fit.mean(last);
  const double unbounded = fit.log_likelihood;
  CandidateFit result;
  result.is_random = is_random;
  // What the outputs hardly see would explain anything, at a negative mass or thousandfold stiffness.
  if (const double reachable = reachable_shift(candidate, shift); std::abs(reachable) < std::abs(shift)) {
    hold_last_mean(problem.settings, fit.mean.size(), reachable);
    fit = fit_random_effects(problem.units, problem.start, problem.settings);
    const double needed = nominal + shift;
    if (is_at_limit(candidate, needed, within_limits(candidate, needed)))
      note_limit(needed, unbounded - fit.log_likelihood, result);
  }
  note_increase(fit.log_likelihood - base.fit.effects.log_likelihood, specimens(), result);
  result.mean = nominal + fit.mean(last);
  result.standard_deviation = is_random ? std::sqrt(std::max(fit.covariance(last, last), 0.0)) : 0.0;
  result.residuals = residuals_of(problem.units, fit);
  result.converged = fit.converged;
  return result;
}

CandidateFit CandidateFits::linear_answer(const SetFit& base, const ParameterSet& set, Eigen::Index candidate,
                                          const Eigen::VectorXd& effect) const {
  CandidateFit none;
  none.bic = std::numeric_limits<double>::infinity();
  if (!effect.allFinite() || effect.isZero(0.0)) {
    none.failure =
        effect.allFinite() ? "no effect on any output" : "the model fails on both sides of its nominal value";
    return none;
  }
  const CandidateEffects effects(static_cast<std::size_t>(specimens()), effect);
  try {
    const CandidateFit fixed = linear_fit(base, set, candidate, false, effects);
    const CandidateFit random = linear_fit(base, set, candidate, true, effects);
    return random.bic < fixed.bic ? random : fixed;
  } catch (const ModelFailure& error) {
    none.failure = error.what();
    return none;
  }
}

Eigen::VectorXd CandidateFits::residuals_of(const std::vector<RandomEffectsUnit>& units,
                                            const RandomEffectsFit& fit) const {
  const TestMoments moments = test_moments(tests_);
  Eigen::VectorXd sum = Eigen::VectorXd::Zero(moments.mean.size());
  for (Eigen::Index s = 0; s < specimens(); ++s) {
    const RandomEffectsUnit& unit = units[static_cast<std::size_t>(s)];
    Eigen::VectorXd residual = unit.response - unit.design * fit.mean;
    if (unit.shared.cols() > 0 && unit.shared.cols() == fit.shared.size()) residual -= unit.shared * fit.shared;
    const std::vector<Eigen::Index> rows = measured_outputs(tests_.values, s);
    sum(rows) += residual;
  }
  for (Eigen::Index k = 0; k < sum.size(); ++k) {
    const double variance = std::max(moments.covariance(k, k), std::pow(tests_.repeatability_std(k), 2));
    const auto count = static_cast<double>(moments.count(k));
    sum(k) /= weighing_deviation(std::sqrt(variance), moments.mean(k)) * std::sqrt(count);
  }
  return sum;
}

}  // namespace mottle::updating
