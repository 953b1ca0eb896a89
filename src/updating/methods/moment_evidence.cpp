// What the specimens show of a population that was matched to the moments of their tests.
#include <Eigen/Core>

#include "mottle/linalg/dense/decompositions.hpp"
#include "updating/fits/measured_outputs.hpp"
#include "updating/methods/moment_iteration.hpp"

namespace mottle::updating {
namespace {

/// Combinations of parameters that the outputs see, each of length one in prior deviations [parameter x combination];
/// the parameters themselves where all are seen.
Eigen::MatrixXd seen_combinations(const Eigen::MatrixXd& sensitivity, const Eigen::VectorXd& standard_deviation) {
  constexpr double k_unseen = 1e-6;  // as least_change_gain counts
  const SingularValues svd(sensitivity * standard_deviation.asDiagonal(), Eigen::ComputeThinV);
  const Eigen::VectorXd& values = svd.values();
  const Eigen::Index rank = (values.array() > k_unseen * values(0)).count();
  if (rank == standard_deviation.size()) return standard_deviation.asDiagonal();
  return standard_deviation.asDiagonal() * svd.right().leftCols(rank);
}

/// The tests as linear random effects around the state's mean.
std::vector<RandomEffectsUnit> units_around(const UpdatingProblem& problem, const MomentState& state,
                                            const Eigen::MatrixXd& map) {
  const Eigen::MatrixXd& values = problem.tests.values;
  const Eigen::MatrixXd design = state.sensitivity * map;
  std::vector<RandomEffectsUnit> units(static_cast<std::size_t>(values.rows()));
  for (Eigen::Index s = 0; s < values.rows(); ++s) {
    const std::vector<Eigen::Index> rows = measured_outputs(values, s);
    const Eigen::VectorXd residual = values.row(s).transpose() - state.output_mean;
    units[static_cast<std::size_t>(s)] = {
        design(rows, Eigen::all), residual(rows), problem.tests.repeatability_std(rows).cwiseAbs2(), {}};
  }
  return units;
}

}  // namespace

PopulationEvidence moment_evidence(const UpdatingProblem& problem, const ScaledParameters& parameters,
                                   const MomentState& state) {
  const Eigen::VectorXd& standard_deviation = parameters.standard_deviation();
  const Eigen::MatrixXd map = seen_combinations(state.sensitivity, standard_deviation);
  const Eigen::MatrixXd back = map.transpose() * standard_deviation.cwiseAbs2().cwiseInverse().asDiagonal();
  RandomEffectsSettings settings;
  if (map.cols() == map.rows()) settings.covariance_groups = problem.covariance_groups;
  RandomEffectsFit fit;
  fit.mean = Eigen::VectorXd::Zero(map.cols());
  fit.covariance = back * state.covariance * back.transpose();
  PopulationEvidence evidence = population_evidence(units_around(problem, state, map), fit, settings, map);
  // The method's own estimate stands where that of the likelihood would.
  evidence.mean = state.mean;
  evidence.total = state.covariance + evidence.noise;
  for (Eigen::Index i = 0; i < map.rows(); ++i) {
    constexpr double k_not_seen = 1e-12;
    if (map.row(i).squaredNorm() > k_not_seen * standard_deviation(i) * standard_deviation(i)) continue;
    evidence.degrees_of_freedom.row(i).setZero();
    evidence.degrees_of_freedom.col(i).setZero();
  }
  return evidence;
}

}  // namespace mottle::updating
