#include "updating/fits/specimen_fit.hpp"

#include <Eigen/Core>
#include <algorithm>
#include <cmath>
#include <limits>
#include <numeric>

#include "mottle/core/error.hpp"
#include "mottle/linalg/dense/decompositions.hpp"
#include "updating/fits/batched_search.hpp"
#include "updating/fits/measured_outputs.hpp"
#include "updating/fits/scaled_parameters.hpp"

namespace mottle::updating {
namespace {

constexpr int k_max_steps = 40;
constexpr double k_min_length = 1e-4;      // of a step, below which it is given up
constexpr double k_nearly_at_rest = 1e-3;  // where a model that answers within a tolerance may stay
constexpr int k_patience = 6;              // steps that small

/// Where the model fails all around a specimen, its derivative there is what its steps have made of the one at its
/// start, at the start the mean of the other specimens'; its fit has then not converged.
void replace_failed(const std::vector<Eigen::MatrixXd>& until_now, SpecimenFits& fits) {
  Eigen::MatrixXd sum;
  double count = 0.0;
  for (const Eigen::MatrixXd& jacobian : fits.jacobians) {
    if (!jacobian.allFinite()) continue;
    sum = count > 0.0 ? Eigen::MatrixXd(sum + jacobian) : jacobian;
    count += 1.0;
  }
  for (std::size_t s = 0; s < fits.jacobians.size(); ++s) {
    Eigen::MatrixXd& jacobian = fits.jacobians[s];
    if (jacobian.allFinite()) continue;
    if (until_now.empty() && count == 0.0) throw ModelFailure("the model fails at all points around the specimens");
    const Eigen::MatrixXd other = until_now.empty() ? Eigen::MatrixXd(sum / count) : until_now[s];
    jacobian = jacobian.array().isFinite().select(jacobian, other);
    fits.converged[s] = false;
  }
}

/// The Jacobians of all specimens where they are.
void differentiate(const UpdatingProblem& problem, const ScaledParameters& parameters, const RunContext& context,
                   std::int64_t& evaluations, SpecimenFits& fits) {
  const std::vector<Eigen::MatrixXd> until_now = std::move(fits.jacobians);
  fits.jacobians = scaled_jacobians(problem, parameters, fits.points, fits.outputs, context, evaluations);
  replace_failed(until_now, fits);
}

/// Specimens whose Jacobians at the start are good where they are now.
std::vector<bool> keeps_jacobian(const UpdatingProblem& problem, const ScaledParameters& parameters,
                                 const SpecimenStart& start, const Eigen::MatrixXd& points) {
  std::vector<bool> keeps(static_cast<std::size_t>(points.rows()), false);
  const bool is_by_differences = problem.derivatives == nullptr || !problem.derivatives->has_cheap_jacobian();
  if (!is_by_differences || start.differentiated.size() == 0) return keeps;
  for (Eigen::Index s = 0; s < points.rows(); ++s) {
    const Eigen::VectorXd moved = (points.row(s) - start.differentiated.row(s)).transpose();
    keeps[static_cast<std::size_t>(s)] =
        moved.cwiseQuotient(parameters.standard_deviation()).cwiseAbs().maxCoeff() <= problem.model.difference_step();
  }
  return keeps;
}

/// The Jacobians where the specimens are now: those of the start where they are good, else new ones.
void differentiate_again(const UpdatingProblem& problem, const ScaledParameters& parameters, const SpecimenStart& start,
                         const RunContext& context, std::int64_t& evaluations, SpecimenFits& fits) {
  const std::vector<bool> keeps = keeps_jacobian(problem, parameters, start, fits.points);
  fits.differentiated = fits.points;
  std::vector<Eigen::Index> anew;
  for (std::size_t s = 0; s < keeps.size(); ++s) {
    const auto row = static_cast<Eigen::Index>(s);
    if (!keeps[s]) {
      anew.push_back(row);
      continue;
    }
    fits.jacobians[s] = start.jacobians[s];
    fits.differentiated.row(row) = start.differentiated.row(row);
  }
  if (anew.empty()) return;
  SpecimenFits moved{.points = fits.points(anew, Eigen::all), .outputs = fits.outputs(anew, Eigen::all)};
  for (const Eigen::Index s : anew) {
    moved.jacobians.push_back(fits.jacobians[static_cast<std::size_t>(s)]);
    moved.converged.push_back(fits.converged[static_cast<std::size_t>(s)]);
  }
  differentiate(problem, parameters, context, evaluations, moved);
  for (std::size_t k = 0; k < anew.size(); ++k) {
    const auto s = static_cast<std::size_t>(anew[k]);
    fits.jacobians[s] = std::move(moved.jacobians[k]);
    fits.converged[s] = moved.converged[k];
  }
}

/// What is minimised for one specimen, and the Gauss-Newton step towards it.
class HeldSpecimen {
 public:
  HeldSpecimen(const Eigen::RowVectorXd& values, const HoldingPopulation& population, const Eigen::VectorXd& floor)
      : rows_(measured_outputs(values, 0)), values_(values.transpose()(rows_)), population_(population) {
    noise_ = population.noise(rows_);
    weight_ = noise_.cwiseMax(floor(rows_)).cwiseInverse();
  }

  /// Where the linear model says the specimen lies, in coordinates u of t = mu + Sigma u.
  Eigen::VectorXd target(const Eigen::VectorXd& t, const Eigen::VectorXd& outputs, const Eigen::MatrixXd& g) const {
    const Eigen::MatrixXd own = g(rows_, Eigen::all);
    const Eigen::MatrixXd gs = own * population_.covariance;
    Eigen::MatrixXd total = gs * own.transpose();
    total.diagonal() += noise_;
    total.diagonal() *= 1.0 + 1e-13;
    const Eigen::VectorXd residual = values_ - outputs(rows_) + own * (t - population_.mean);
    return own.transpose() * solve_semidefinite(total, residual);
  }

  double cost(const Eigen::VectorXd& u, const Eigen::VectorXd& outputs) const {
    const Eigen::VectorXd residual = values_ - outputs(rows_);
    return residual.cwiseAbs2().dot(weight_) + u.dot(population_.covariance * u);
  }

 private:
  std::vector<Eigen::Index> rows_;
  Eigen::VectorXd values_;
  Eigen::VectorXd noise_;
  Eigen::VectorXd weight_;
  const HoldingPopulation& population_;
};

/// One specimen on its way.
struct Iterate {
  Eigen::VectorXd u;       // t = mu + Sigma u
  Eigen::VectorXd target;  // where its step leads
  double cost = 0.0;
  double length = 1.0;                                        // of the step that is tried
  double movement = std::numeric_limits<double>::infinity();  // by the last step, in prior standard deviations
  int small_steps = 0;
};

/// Broyden's change of the Jacobian, which then explains the last step, in prior standard deviations.
void explain_step(Eigen::MatrixXd& jacobian, const Eigen::VectorXd& step, const Eigen::VectorXd& change,
                  const Eigen::VectorXd& prior_std) {
  const Eigen::VectorXd scaled = step.cwiseQuotient(prior_std);
  constexpr double k_least = 1e-6;  // a shorter step is explained by rounding
  const double square = scaled.squaredNorm();
  if (!(square > k_least * k_least)) return;
  jacobian += (change - jacobian * step) * scaled.cwiseQuotient(prior_std).transpose() / square;
}

/// The least noise that a cost counts with [output]: a thousandth of what a prior standard deviation moves an output.
/// Less would forbid steps along the curved set of points that give a test; its last digits come from steps that shrink
/// by themselves.
Eigen::VectorXd smallest_noise(const std::vector<Eigen::MatrixXd>& jacobians, const Eigen::VectorXd& prior_std) {
  Eigen::MatrixXd moved = Eigen::MatrixXd::Zero(jacobians[0].rows(), prior_std.size());
  for (const Eigen::MatrixXd& g : jacobians) moved = moved.cwiseMax((g * prior_std.asDiagonal()).cwiseAbs());
  return 1e-6 * moved.rowwise().squaredNorm();
}

class HeldSearches {
 public:
  HeldSearches(const Eigen::Ref<const Eigen::MatrixXd>& values, const HoldingPopulation& population,
               const Eigen::VectorXd& prior_std, double tolerance, SpecimenFits& fits)
      : population_(population),
        prior_std_(prior_std),
        tolerance_(tolerance),
        fits_(fits),
        iterates_(static_cast<std::size_t>(values.rows())) {
    const Eigen::VectorXd least_noise = smallest_noise(fits.jacobians, prior_std);
    const Eigen::MatrixXd coordinates = semidefinite_pseudo_inverse(population.covariance);
    for (Eigen::Index s = 0; s < values.rows(); ++s) {
      specimens_.emplace_back(values.row(s), population, least_noise);
      Iterate& iterate = iterates_[static_cast<std::size_t>(s)];
      iterate.u = coordinates * (fits.points.row(s).transpose() - population.mean);
      iterate.cost = specimens_.back().cost(iterate.u, fits.outputs.row(s));
      set_target(s);
    }
  }

  Eigen::VectorXd propose(Eigen::Index s) const {
    const Iterate& iterate = iterates_[static_cast<std::size_t>(s)];
    const Eigen::VectorXd target = population_.mean + population_.covariance * iterate.target;
    const Eigen::VectorXd from = fits_.points.row(s);
    return from + iterate.length * (target - from);
  }

  Eigen::VectorXd costs() const {
    Eigen::VectorXd costs(static_cast<Eigen::Index>(iterates_.size()));
    for (Eigen::Index s = 0; s < costs.size(); ++s) costs(s) = iterates_[static_cast<std::size_t>(s)].cost;
    return costs;
  }

  bool judge(Eigen::Index s, const Eigen::VectorXd& trial, const Eigen::VectorXd& outputs) {
    const auto index = static_cast<std::size_t>(s);
    Iterate& iterate = iterates_[index];
    const Eigen::VectorXd u = iterate.u + iterate.length * (iterate.target - iterate.u);
    const double cost =
        outputs.allFinite() ? specimens_[index].cost(u, outputs) : std::numeric_limits<double>::infinity();
    const Eigen::VectorXd step = trial - fits_.points.row(s).transpose();
    const double movement = (step.cwiseAbs().array() / prior_std_.array()).maxCoeff();
    const bool is_contracting = iterate.length == 1.0 && movement < 0.5 * iterate.movement;
    const bool is_better = cost <= iterate.cost * (1.0 + 1e-9) + 1e-12;
    if (!is_better && !(is_contracting && std::isfinite(cost)) && movement > tolerance_) {
      iterate.length *= 0.5;
      return iterate.length > k_min_length;
    }
    if (!outputs.allFinite()) return false;
    explain_step(fits_.jacobians[index], step, outputs - fits_.outputs.row(s).transpose(), prior_std_);
    fits_.points.row(s) = trial.transpose();
    fits_.outputs.row(s) = outputs.transpose();
    iterate.u = u;
    iterate.cost = cost;
    iterate.movement = movement;
    iterate.small_steps += movement <= k_nearly_at_rest ? 1 : 0;
    const bool is_moving = movement > tolerance_ && iterate.small_steps < k_patience;
    fits_.converged[index] = !is_moving;
    if (is_moving) set_target(s);
    return is_moving;
  }

 private:
  void set_target(Eigen::Index s) {
    const auto index = static_cast<std::size_t>(s);
    iterates_[index].target =
        specimens_[index].target(fits_.points.row(s), fits_.outputs.row(s), fits_.jacobians[index]);
    iterates_[index].length = 1.0;
  }

  const HoldingPopulation& population_;
  const Eigen::VectorXd& prior_std_;
  double tolerance_;
  SpecimenFits& fits_;
  std::vector<HeldSpecimen> specimens_;
  std::vector<Iterate> iterates_;
};

}  // namespace

void SpecimenFits::take(Eigen::Index specimen, const SpecimenFits& other, Eigen::Index from) {
  const auto to = static_cast<std::size_t>(specimen);
  const auto index = static_cast<std::size_t>(from);
  points.row(specimen) = other.points.row(from);
  outputs.row(specimen) = other.outputs.row(from);
  jacobians[to] = other.jacobians[index];
  converged[to] = other.converged[index];
  costs(specimen) = other.costs(from);
  differentiated.row(specimen) = other.differentiated.row(from);
}

SpecimenFits fit_specimens(const UpdatingProblem& problem, const Eigen::Ref<const Eigen::MatrixXd>& values,
                           const HoldingPopulation& population, const SpecimenStart& start, const RunContext& context,
                           std::int64_t& evaluations) {
  const ScaledParameters parameters(problem.space);
  const bool is_known = start.outputs.size() > 0;
  SpecimenFits fits{start.points,
                    is_known ? start.outputs : outputs_on_scales(problem, start.points, context, evaluations),
                    start.jacobians, std::vector<bool>(static_cast<std::size_t>(values.rows()), false)};
  if (!fits.outputs.allFinite()) throw ModelFailure("the model fails where the fit of a specimen starts");
  if (fits.jacobians.empty()) differentiate(problem, parameters, context, evaluations, fits);
  HeldSearches held(values, population, parameters.standard_deviation(), start.tolerance, fits);
  const BatchedSearch searches{
      [&](Eigen::Index s) { return held.propose(s); },
      [&](const Eigen::MatrixXd& trials) { return outputs_on_scales(problem, trials, context, evaluations); },
      [&](Eigen::Index s, const Eigen::VectorXd& trial, const Eigen::VectorXd& outputs) {
        return held.judge(s, trial, outputs);
      }};
  std::vector<Eigen::Index> moving(static_cast<std::size_t>(values.rows()));
  std::iota(moving.begin(), moving.end(), 0);
  for (int iteration = 0; iteration < k_max_steps && !moving.empty(); ++iteration) {
    context.throw_if_stopped();
    try_once(searches, moving);
  }
  differentiate_again(problem, parameters, start, context, evaluations, fits);
  fits.costs = held.costs();
  return fits;
}

}  // namespace mottle::updating
