#include "updating/population/mixture_fit.hpp"

#include <algorithm>
#include <cmath>
#include <map>

#include "mottle/linalg/dense/decompositions.hpp"
#include "mottle/stats/moments/descriptive.hpp"
#include "mottle/updating/methods/iteration.hpp"
#include "updating/fits/scaled_parameters.hpp"
#include "updating/methods/linear_units.hpp"

namespace mottle::updating {
namespace {

/// Tests less the model's error as one population has it.
Eigen::MatrixXd own_values(const UpdatingProblem& problem, const PopulationFit& one) {
  if (!one.model_error) return problem.tests.values;
  return problem.tests.values.rowwise() - one.model_error->shift.transpose();
}

std::vector<RandomEffectsUnit> units_of(const UpdatingProblem& problem, const PopulationFit& one,
                                        const SpecimenFits& specimens, const Eigen::VectorXd& origin,
                                        const Eigen::MatrixXd& map) {
  return linear_units(own_values(problem, one), {}, mean_jacobian(specimens.jacobians), {}, specimens,
                      known_noise(one.noise), origin, map);
}

/// Number of the set of outputs that each specimen lacks.
std::vector<int> kinds_of(const Eigen::MatrixXd& values) {
  std::map<std::vector<bool>, int> known;
  std::vector<int> kinds;
  for (Eigen::Index s = 0; s < values.rows(); ++s) {
    std::vector<bool> missing;
    for (const double value : values.row(s)) missing.push_back(std::isnan(value));
    const int next = static_cast<int>(known.size());
    kinds.push_back(known.try_emplace(std::move(missing), next).first->second);
  }
  return kinds;
}

void linearise(const UpdatingProblem& problem, const PopulationFit& one, MixturePopulationFit& fit) {
  const auto units = units_of(problem, one, fit.specimens, fit.frame.origin, fit.frame.map);
  fit.data = mixture_data(units);
  fit.alike = mixture_data(units, kinds_of(problem.tests.values));
}

/// Standard deviation of the specimens' own effects with their noise.
Eigen::VectorXd spread_of(const MixtureData& data, const Eigen::VectorXd& reach) {
  const Eigen::MatrixXd wide = 1e6 * Eigen::MatrixXd(reach.cwiseAbs2().asDiagonal());
  return sample_standard_deviation(held_points(data, Eigen::VectorXd::Zero(reach.size()), wide));
}

void take_rows(const SpecimenFits& from, const std::vector<Eigen::Index>& rows, SpecimenFits& to) {
  for (std::size_t r = 0; r < rows.size(); ++r) {
    const auto s = static_cast<std::size_t>(rows[r]);
    to.points.row(rows[r]) = from.points.row(static_cast<Eigen::Index>(r));
    to.outputs.row(rows[r]) = from.outputs.row(static_cast<Eigen::Index>(r));
    to.jacobians[s] = from.jacobians[r];
    to.converged[s] = from.converged[r];
  }
}

/// Every specimen that is no outlier fitted anew, held by its most probable batch.
void fit_in_batches(const UpdatingProblem& problem, const PopulationFit& one, const RunContext& context,
                    MixturePopulationFit& fit) {
  const MixtureFit& mixture = fit.mixture;
  const auto batches = static_cast<Eigen::Index>(mixture.components.size());
  const Eigen::MatrixXd values = own_values(problem, one);
  for (Eigen::Index k = 0; k < batches; ++k) {
    std::vector<Eigen::Index> rows;
    std::vector<Eigen::MatrixXd> jacobians;
    for (Eigen::Index s = 0; s < values.rows(); ++s) {
      if (mixture.component_of(s) != k || mixture.probabilities(s, batches) > k_outlying) continue;
      rows.push_back(s);
      jacobians.push_back(fit.specimens.jacobians[static_cast<std::size_t>(s)]);
    }
    if (rows.empty()) continue;
    const BatchOnScales batch = fit.frame.on_scales(mixture.components[static_cast<std::size_t>(k)]);
    const SpecimenFits again =
        fit_specimens(problem, values(rows, Eigen::all), {batch.mean, batch.covariance, one.noise},
                      {fit.specimens.points(rows, Eigen::all), jacobians}, context, fit.evaluations);
    take_rows(again, rows, fit.specimens);
  }
}

/// The largest movement of a mean or standard deviation of any batch.
double movement(const MixturePopulationFit& fit, const MixtureFit& before, const Eigen::VectorXd& prior_std) {
  double largest = 0.0;
  for (std::size_t k = 0; k < before.components.size(); ++k) {
    const BatchOnScales was = fit.frame.on_scales(before.components[k]);
    const BatchOnScales is = fit.frame.on_scales(fit.mixture.components[k]);
    largest = std::max(largest, largest_movement(prior_std, was.mean, was.covariance, is.mean, is.covariance));
  }
  return largest;
}

}  // namespace

BatchOnScales MixtureFrame::on_scales(const MixtureComponent& component) const {
  BatchOnScales batch{component.weight, origin + map * component.mean, map * component.covariance * map.transpose()};
  batch.covariance = (0.5 * (batch.covariance + batch.covariance.transpose())).eval();
  repair_covariance(batch.covariance);
  return batch;
}

MixturePopulationFit begin_mixture(const UpdatingProblem& problem, const PopulationFit& one) {
  constexpr double k_alike = 1e-9;  // of what an effect may be in the prior
  MixturePopulationFit fit;
  fit.specimens = one.specimens;
  const Eigen::VectorXd prior_std = prior_on_scales(problem.space).covariance.diagonal().cwiseSqrt();
  const bool are_parameters = one.map.cols() == one.mean.size();
  const Eigen::VectorXd reach = are_parameters ? prior_std : Eigen::VectorXd(Eigen::VectorXd::Ones(one.map.cols()));
  fit.frame.origin = one.mean;
  const MixtureData raw = mixture_data(units_of(problem, one, fit.specimens, one.mean, one.map * reach.asDiagonal()));
  const Eigen::VectorXd spread = spread_of(raw, Eigen::VectorXd::Ones(reach.size()));
  if (!(spread.maxCoeff() > k_alike)) {
    fit.frame.unit = Eigen::VectorXd::Zero(reach.size());
    return fit;
  }
  fit.frame.unit = reach.cwiseProduct(spread.cwiseMax(k_alike));
  fit.frame.map = one.map * fit.frame.unit.asDiagonal();
  linearise(problem, one, fit);
  return fit;
}

std::function<Eigen::VectorXd(const Eigen::VectorXd&, const Eigen::MatrixXd&)> within_bounds(
    const UpdatingProblem& problem, const MixtureFrame& frame) {
  return [parameters = ScaledParameters(problem.space), frame](const Eigen::VectorXd& mean,
                                                               const Eigen::MatrixXd& information) {
    Eigen::VectorXd confined = mean;
    std::vector<Eigen::Index> held;
    for (Eigen::Index round = 0; round < mean.size(); ++round) {
      const Eigen::VectorXd t = frame.origin + frame.map * confined;
      const Eigen::VectorXd clamped = parameters.clamp(t);
      const auto before = held.size();
      for (Eigen::Index i = 0; i < t.size(); ++i) {
        const bool is_new = std::find(held.begin(), held.end(), i) == held.end();
        if (is_new && std::abs(clamped(i) - t(i)) > 1e-12 * std::abs(t(i))) held.push_back(i);
      }
      if (held.size() == before) break;
      // The nearest mean in the metric of the information, with what is held at its bounds.
      const Eigen::MatrixXd rows = frame.map(held, Eigen::all);
      const Eigen::VectorXd level = clamped(held) - frame.origin(held);
      const Eigen::MatrixXd across = semidefinite_pseudo_inverse(information) * rows.transpose();
      confined = mean + across * LeastNormSolver(rows * across).solve(level - rows * mean);
    }
    return confined;
  };
}

void iterate_mixture(const UpdatingProblem& problem, const PopulationFit& one, const MixtureSearch& search,
                     const RunContext& context, MixturePopulationFit& fit,
                     const std::function<bool(const MixturePopulationFit&)>& each) {
  const Eigen::VectorXd prior_std = prior_on_scales(problem.space).covariance.diagonal().cwiseSqrt();
  for (fit.iterations = 0; fit.iterations < problem.iterations && !fit.converged;) {
    const MixtureFit before = fit.mixture;
    const std::optional<MixtureFit> next = fit_mixture(fit.data, before, search.settings_for(fit.data));
    if (!next) break;
    fit.mixture = *next;
    ++fit.iterations;
    fit.converged = movement(fit, before, prior_std) <= problem.tolerance && fit.iterations > 1;
    if (!each(fit)) break;
    if (fit.converged) break;
    fit_in_batches(problem, one, context, fit);
    linearise(problem, one, fit);
  }
  fit.mixture = reordered(fit.mixture, mixture_order(fit.mixture));
}

PopulationFit as_one_population(const UpdatingProblem& problem, const PopulationFit& one,
                                const MixturePopulationFit& fit) {
  PopulationFit whole = one;
  whole.specimens = fit.specimens;
  whole.sensitivity = mean_jacobian(fit.specimens.jacobians);
  whole.units = units_of(problem, one, fit.specimens, one.mean - one.map * one.effects.mean, one.map);
  whole.effects.mean += fit.frame.unit.asDiagonal() * fit.mixture.mean();
  whole.effects.covariance = fit.frame.unit.asDiagonal() * fit.mixture.covariance() * fit.frame.unit.asDiagonal();
  const BatchOnScales all = fit.frame.on_scales({1.0, fit.mixture.mean(), fit.mixture.covariance()});
  whole.mean = all.mean;
  whole.covariance = all.covariance;
  whole.settings.covariance_groups.clear();
  return whole;
}

}  // namespace mottle::updating
