// The linear models at the specimens of a fit: sensitivities of every candidate, and what a candidate gains in them.
#include <algorithm>
#include <cmath>
#include <numeric>

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

std::vector<Eigen::MatrixXd> CandidateFits::derivatives_at(const Eigen::MatrixXd& samples) {
  std::vector<Eigen::Index> all(static_cast<std::size_t>(problem_.space.count()));
  std::iota(all.begin(), all.end(), Eigen::Index{0});
  std::vector<Parameter> parameters = problem_.space.parameters();
  for (Parameter& parameter : parameters) parameter.transform = {};
  const ParameterSpace space(std::move(parameters), problem_.space.prior());
  const FixedParameterModel model(problem_, problem_.space.prior().mean(), std::move(all), signs_);
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

std::vector<Eigen::MatrixXd> CandidateFits::derivatives_at(const SetFit& base, const ParameterSet& set) {
  const std::vector<ParameterTransform> scales = problem_.space.transforms();
  Eigen::MatrixXd samples = problem_.space.prior().mean().transpose().replicate(specimens(), 1);
  for (std::size_t i = 0; i < set.members.size(); ++i) {
    samples.col(set.members[i]) = to_variables({scales[static_cast<std::size_t>(set.members[i])]},
                                               base.fit.specimens.points.col(static_cast<Eigen::Index>(i)));
  }
  return derivatives_at(samples);
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
                                            bool is_random, const std::vector<Eigen::MatrixXd>& derivatives) const {
  LinearProblem problem = linear_problem(base, set);
  for (Eigen::Index s = 0; s < specimens(); ++s) {
    RandomEffectsUnit& unit = problem.units[static_cast<std::size_t>(s)];
    const std::vector<Eigen::Index> rows = measured_outputs(tests_.values, s);
    unit.design.conservativeResize(Eigen::NoChange, unit.design.cols() + 1);
    unit.design.rightCols(1) = derivatives[static_cast<std::size_t>(s)].col(candidate)(rows);
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
  const Eigen::VectorXd nominal = problem_.space.prior().mean();
  Eigen::VectorXd moved = nominal;
  moved(candidate) += std::clamp(shift, -farthest, farthest);
  return problem_.space.clamp(moved)(candidate) - nominal(candidate);
}

double CandidateFits::linear_gain(const SetFit& base, const ParameterSet& set, Eigen::Index candidate,
                                  const std::vector<Eigen::MatrixXd>& derivatives) const {
  LinearProblem problem = linear_problem(base, set, candidate, true, derivatives);
  for (const RandomEffectsUnit& unit : problem.units) {
    if (!unit.design.allFinite()) return -1.0;
  }
  RandomEffectsFit fit = fit_random_effects(problem.units, problem.start, problem.settings);
  const Eigen::Index effects = fit.mean.size();
  const double shift = fit.mean(effects - 1);
  // What the outputs hardly see would explain anything, at a negative mass or thousandfold stiffness.
  if (const double reachable = reachable_shift(candidate, shift); std::abs(reachable) < std::abs(shift)) {
    hold_last_mean(problem.settings, effects, reachable);
    fit = fit_random_effects(problem.units, problem.start, problem.settings);
  }
  return fit.log_likelihood - base.fit.effects.log_likelihood;
}

}  // namespace mottle::updating
