#include "updating/methods/specimen_fit.hpp"

#include <Eigen/Core>
#include <algorithm>
#include <cmath>
#include <limits>

#include "mottle/core/error.hpp"
#include "mottle/linalg/dense/decompositions.hpp"
#include "updating/methods/measured_outputs.hpp"
#include "updating/methods/scaled_parameters.hpp"

namespace mottle::updating {
namespace {

constexpr int k_max_steps = 40;
constexpr double k_min_length = 1e-4;      // of a step, below which it is given up
constexpr double k_at_rest = 1e-8;         // of a prior deviation
constexpr double k_nearly_at_rest = 1e-3;  // where a model that answers within a tolerance may stay
constexpr int k_patience = 6;              // steps that small

/// The Jacobians of all specimens where they are.
void differentiate(const UpdatingProblem& problem, const ScaledParameters& parameters, const RunContext& context,
                   std::int64_t& evaluations, SpecimenFits& fits) {
  fits.jacobians = scaled_jacobians(problem, parameters, fits.points, fits.outputs, context, evaluations);
  for (const Eigen::MatrixXd& jacobian : fits.jacobians) {
    if (!jacobian.allFinite()) throw ModelFailure("the model fails at all points around a specimen's parameters");
  }
}

/// Gauss-Newton on one specimen, the evaluations done for it elsewhere.
class Search {
 public:
  Search(const Eigen::RowVectorXd& values, const HoldingPopulation& population, const Eigen::VectorXd& floor)
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
  Eigen::VectorXd u;    // t = mu + Sigma u
  Eigen::VectorXd aim;  // where its step leads
  double cost = 0.0;
  double length = 1.0;                                        // of the step that is tried
  double movement = std::numeric_limits<double>::infinity();  // by the last step, in prior deviations
  int small_steps = 0;
  bool is_moving = true;
};

/// The Jacobian that also explains the last step: Broyden's change, in prior deviations.
void learn(Eigen::MatrixXd& jacobian, const Eigen::VectorXd& step, const Eigen::VectorXd& change,
           const Eigen::VectorXd& prior_std) {
  const Eigen::VectorXd scaled = step.cwiseQuotient(prior_std);
  const double square = scaled.squaredNorm();
  if (!(square > 0.0)) return;
  jacobian += (change - jacobian * step) * scaled.cwiseQuotient(prior_std).transpose() / square;
}

}  // namespace

SpecimenFits fit_specimens(const UpdatingProblem& problem, const Eigen::Ref<const Eigen::MatrixXd>& values,
                           const HoldingPopulation& population, const SpecimenStart& start, const RunContext& context,
                           std::int64_t& evaluations) {
  const Eigen::Index n = values.rows();
  const ScaledParameters parameters(problem.space);
  const Eigen::VectorXd& prior_std = parameters.standard_deviation();
  SpecimenFits fits{start.points, outputs_on_scales(problem, start.points, context, evaluations), start.jacobians,
                    std::vector<bool>(static_cast<std::size_t>(n), false)};
  if (!fits.outputs.allFinite()) throw ModelFailure("the model fails where the fit of a specimen starts");
  std::vector<Eigen::Index> moving;
  for (Eigen::Index s = 0; s < n; ++s) moving.push_back(s);
  if (fits.jacobians.empty()) differentiate(problem, parameters, context, evaluations, fits);

  // The least noise that a cost counts with: a thousandth of what a prior deviation moves an output. Less would forbid
  // steps along the curved set of points that give a test; its last digits come from steps that shrink by themselves.
  Eigen::MatrixXd moved = Eigen::MatrixXd::Zero(values.cols(), prior_std.size());
  for (const Eigen::MatrixXd& g : fits.jacobians) moved = moved.cwiseMax((g * prior_std.asDiagonal()).cwiseAbs());
  const Eigen::VectorXd floor = 1e-6 * moved.rowwise().squaredNorm();
  const LeastNormSolver coordinates(population.covariance);
  std::vector<Search> searches;
  std::vector<Iterate> iterates(static_cast<std::size_t>(n));
  for (Eigen::Index s = 0; s < n; ++s) searches.emplace_back(values.row(s), population, floor);
  const auto aim = [&](Eigen::Index s) {
    const auto place = static_cast<std::size_t>(s);
    Iterate& iterate = iterates[place];
    iterate.aim = searches[place].target(fits.points.row(s), fits.outputs.row(s), fits.jacobians[place]);
    if (iterate.u.size() == 0) {
      iterate.u = coordinates.solve(fits.points.row(s).transpose() - population.mean);
      iterate.cost = searches[place].cost(iterate.u, fits.outputs.row(s));
    }
    iterate.length = 1.0;
  };
  for (const Eigen::Index s : moving) aim(s);
  for (int iteration = 0; iteration < k_max_steps && !moving.empty(); ++iteration) {
    context.throw_if_stopped();
    Eigen::MatrixXd trial(static_cast<Eigen::Index>(moving.size()), prior_std.size());
    for (std::size_t w = 0; w < moving.size(); ++w) {
      const Iterate& iterate = iterates[static_cast<std::size_t>(moving[w])];
      const Eigen::VectorXd goal = population.mean + population.covariance * iterate.aim;
      const Eigen::VectorXd from = fits.points.row(moving[w]);
      trial.row(static_cast<Eigen::Index>(w)) = (from + iterate.length * (goal - from)).transpose();
    }
    const Eigen::MatrixXd y = outputs_on_scales(problem, trial, context, evaluations);
    std::vector<Eigen::Index> advanced;
    for (std::size_t w = 0; w < moving.size(); ++w) {
      const Eigen::Index s = moving[w];
      const auto place = static_cast<std::size_t>(s);
      Iterate& iterate = iterates[place];
      const auto row = static_cast<Eigen::Index>(w);
      const Eigen::VectorXd u = iterate.u + iterate.length * (iterate.aim - iterate.u);
      const double cost =
          y.row(row).allFinite() ? searches[place].cost(u, y.row(row)) : std::numeric_limits<double>::infinity();
      const double movement =
          ((trial.row(row) - fits.points.row(s)).cwiseAbs().transpose().array() / prior_std.array()).maxCoeff();
      const bool is_contracting = iterate.length == 1.0 && movement < 0.5 * iterate.movement;
      const bool is_better = cost <= iterate.cost * (1.0 + 1e-9) + 1e-12;
      if (!is_better && !(is_contracting && std::isfinite(cost)) && movement > k_at_rest) {
        iterate.length *= 0.5;
        iterate.is_moving = iterate.length > k_min_length;
        continue;
      }
      if (!y.row(row).allFinite()) {
        iterate.is_moving = false;
        continue;
      }
      learn(fits.jacobians[place], (trial.row(row) - fits.points.row(s)).transpose(),
            (y.row(row) - fits.outputs.row(s)).transpose(), prior_std);
      fits.points.row(s) = trial.row(row);
      fits.outputs.row(s) = y.row(row);
      iterate.u = u;
      iterate.cost = cost;
      iterate.movement = movement;
      iterate.small_steps += movement <= k_nearly_at_rest ? 1 : 0;
      iterate.is_moving = movement > k_at_rest && iterate.small_steps < k_patience;
      fits.converged[place] = !iterate.is_moving;
      if (iterate.is_moving) advanced.push_back(s);
    }
    std::erase_if(moving, [&](Eigen::Index s) { return !iterates[static_cast<std::size_t>(s)].is_moving; });
    for (const Eigen::Index s : advanced) aim(s);
  }
  differentiate(problem, parameters, context, evaluations, fits);
  return fits;
}

}  // namespace mottle::updating
