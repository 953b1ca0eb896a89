#include "updating/methods/inversion_fit.hpp"

#include <algorithm>
#include <cmath>

#include "mottle/core/error.hpp"
#include "updating/fits/batched_search.hpp"
#include "updating/fits/measured_outputs.hpp"
#include "updating/methods/least_change.hpp"

namespace mottle::updating {
namespace {

constexpr double k_max_damping = 1e6;

/// One specimen's residuals over what is measured.
struct Whitened {
  Eigen::MatrixXd sensitivity;
  Eigen::VectorXd residual;
};

class BatchFit {
 public:
  BatchFit(const UpdatingProblem& problem, const ScaledParameters& parameters,
           const Eigen::Ref<const Eigen::MatrixXd>& targets, const Eigen::Ref<const Eigen::VectorXd>& sigma,
           const Eigen::Ref<const Eigen::MatrixXd>& start, const RunContext& context)
      : problem_(problem),
        parameters_(parameters),
        context_(context),
        targets_(targets),
        sigma_(sigma),
        damping_(Eigen::VectorXd::Zero(targets.rows())),
        has_moved_(static_cast<std::size_t>(targets.rows()), true) {
    const auto specimens = static_cast<std::size_t>(targets.rows());
    fit.points = start;
    const Evaluation evaluation = problem.model.evaluate(parameters.to_variables(start), context);
    fit.evaluations = targets.rows();
    if (!evaluation.failures.empty()) {
      throw ModelFailure(
          fmt::format("the model fails where the fit of a specimen starts: {}", evaluation.failures.front().reason));
    }
    fit.outputs = evaluation.outputs;
    fit.endings.assign(specimens, InversionFit::Ending::moving);
    fit.ranks.assign(specimens, 0);
    fit.jacobians.assign(specimens, {});
  }

  /// One step of every specimen that is not at rest.
  void step() {
    update_jacobians();
    std::vector<Eigen::Index> moving = moving_specimens();
    try_once(
        {[&](Eigen::Index s) { return proposed(s); },
         [&](const Eigen::MatrixXd& trials) { return outputs_on_scales(problem_, trials, context_, fit.evaluations); },
         [&](Eigen::Index s, const Eigen::VectorXd& trial, const Eigen::VectorXd& outputs) {
           judge(s, trial, outputs);
           return fit.endings[static_cast<std::size_t>(s)] == InversionFit::Ending::moving;
         }},
        moving);
  }

  std::vector<Eigen::Index> moving_specimens() const {
    std::vector<Eigen::Index> moving;
    for (std::size_t s = 0; s < fit.endings.size(); ++s) {
      if (fit.endings[s] == InversionFit::Ending::moving) moving.push_back(static_cast<Eigen::Index>(s));
    }
    return moving;
  }

  InversionFit fit;

 private:
  double cost(Eigen::Index specimen, const Eigen::VectorXd& outputs) const {
    const Eigen::ArrayXd residual = (targets_.row(specimen).transpose() - outputs).array() / sigma_.array();
    return residual.isNaN().select(0.0, residual).matrix().squaredNorm();
  }

  Whitened whitened(Eigen::Index specimen) const {
    const std::vector<Eigen::Index> measured = measured_outputs(targets_, specimen);
    const Eigen::VectorXd weight = sigma_(measured).cwiseInverse();
    const Eigen::VectorXd residual = (targets_.row(specimen) - fit.outputs.row(specimen)).transpose()(measured);
    const Eigen::MatrixXd& jacobian = fit.jacobians[static_cast<std::size_t>(specimen)];
    return {weight.asDiagonal() * jacobian(measured, Eigen::all), weight.cwiseProduct(residual)};
  }

  /// Of the specimens that moved; an entry that the model does not give stays what it was.
  void update_jacobians() {
    std::vector<Eigen::Index> moved;
    for (const Eigen::Index s : moving_specimens()) {
      if (has_moved_[static_cast<std::size_t>(s)]) moved.push_back(s);
    }
    if (moved.empty()) return;
    const Eigen::MatrixXd points = fit.points(moved, Eigen::all);
    const Eigen::MatrixXd outputs = fit.outputs(moved, Eigen::all);
    std::vector<Eigen::MatrixXd> jacobians =
        scaled_jacobians(problem_, parameters_, points, outputs, context_, fit.evaluations);
    for (std::size_t i = 0; i < moved.size(); ++i) {
      const auto s = static_cast<std::size_t>(moved[i]);
      if (!jacobians[i].allFinite()) {
        if (fit.jacobians[s].size() == 0)
          throw ModelFailure("the model fails at all points around the current parameters, so there is no derivative");
        jacobians[i] = jacobians[i].array().isNaN().select(fit.jacobians[s], jacobians[i]).eval();
      }
      fit.jacobians[s] = std::move(jacobians[i]);
      has_moved_[s] = false;
    }
  }

  Eigen::VectorXd proposed(Eigen::Index specimen) {
    const Whitened here = whitened(specimen);
    const Eigen::VectorXd point = fit.points.row(specimen).transpose();
    fit.ranks[static_cast<std::size_t>(specimen)] =
        least_change_gain(here.sensitivity, parameters_.standard_deviation()).rank;
    const Eigen::VectorXd step = trusted_step(parameters_, point, here.sensitivity, here.residual, damping_(specimen));
    return parameters_.clamp(point + step);
  }

  /// Takes the trial where its residuals are no larger, else makes the next step shorter.
  void judge(Eigen::Index specimen, const Eigen::VectorXd& trial, const Eigen::VectorXd& outputs) {
    const auto s = static_cast<std::size_t>(specimen);
    const double movement = length_of(trial - fit.points.row(specimen).transpose());
    const bool is_free = fit.ranks[s] < parameters_.count();
    constexpr double k_allowed = 1e-2;  // squared deviations an output: the way back to the prior is along a curve
    constexpr double k_rounding = 1e-12;
    const double before = cost(specimen, fit.outputs.row(specimen).transpose());
    const double most =
        is_free ? std::max(before, k_allowed * static_cast<double>(outputs.size())) : before * (1.0 + k_rounding);
    double& damping = damping_(specimen);
    if (outputs.allFinite() && cost(specimen, outputs) <= most) {
      fit.points.row(specimen) = trial.transpose();
      fit.outputs.row(specimen) = outputs.transpose();
      has_moved_[s] = true;
      if (movement <= problem_.tolerance && damping == 0.0) fit.endings[s] = InversionFit::Ending::at_rest;
      damping = next_damping(damping, true);
      return;
    }
    // A Gauss-Newton step this short that does not help is rounding: the fit is as good as it gets.
    if (movement <= problem_.tolerance && damping == 0.0) fit.endings[s] = InversionFit::Ending::at_rest;
    damping = next_damping(damping, false);
    if (damping > k_max_damping) {
      const bool is_done = outputs.allFinite() && is_least(specimen);
      fit.endings[s] = is_done ? InversionFit::Ending::at_rest : InversionFit::Ending::stuck;
    }
  }

  /// Whether the residuals are as small as they get within the bounds: the linear model promises no more than a
  /// hundredth of their squares. Where no parameters give the test, the way back to the prior then costs residuals.
  bool is_least(Eigen::Index specimen) const {
    constexpr double k_promising = 1e-2;
    const Whitened here = whitened(specimen);
    const Eigen::VectorXd point = fit.points.row(specimen).transpose();
    const Eigen::VectorXd step = least_change_step(parameters_, point, here.sensitivity, here.residual, 0.0);
    const double left = (here.residual - here.sensitivity * step).squaredNorm();
    return left >= (1.0 - k_promising) * here.residual.squaredNorm();
  }

  double length_of(const Eigen::VectorXd& step) const {
    return (step.array().abs() / parameters_.standard_deviation().array()).maxCoeff();
  }

  const UpdatingProblem& problem_;
  const ScaledParameters& parameters_;
  const RunContext& context_;
  Eigen::MatrixXd targets_;
  Eigen::VectorXd sigma_;
  Eigen::VectorXd damping_;
  std::vector<bool> has_moved_;
};

}  // namespace

Eigen::Index InversionFit::count(Ending ending) const {
  return std::count(endings.begin(), endings.end(), ending);
}

InversionFit invert_specimens(const UpdatingProblem& problem, const ScaledParameters& parameters,
                              const Eigen::Ref<const Eigen::MatrixXd>& targets,
                              const Eigen::Ref<const Eigen::VectorXd>& sigma,
                              const Eigen::Ref<const Eigen::MatrixXd>& start, const RunContext& context,
                              const std::function<bool(const InversionFit&)>& after_each) {
  BatchFit batch(problem, parameters, targets, sigma, start, context);
  for (int iteration = 0; iteration < problem.iterations && !batch.moving_specimens().empty(); ++iteration) {
    batch.step();
    if (!after_each(batch.fit)) break;
  }
  return batch.fit;
}

}  // namespace mottle::updating
