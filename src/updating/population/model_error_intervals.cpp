#include "updating/population/model_error_intervals.hpp"

#include <cmath>

#include "updating/fits/scaled_parameters.hpp"
#include "updating/population/population_report.hpp"

namespace mottle::updating {
namespace {

/// Halves of the linear intervals on the parameters' scales.
Eigen::VectorXd linear_halves(const PopulationEvidence& evidence) {
  const std::vector<ParameterTransform> scales(static_cast<std::size_t>(evidence.mean.size()));
  const Eigen::MatrixXd ends = population_intervals(evidence, scales, k_confidence).mean;
  return 0.5 * (ends.col(1) - ends.col(0));
}

/// How far the mean of the specimens moves where their tests are off by the rows of a matrix; nan where no parameters
/// give them.
Eigen::MatrixXd moved_means(const UpdatingProblem& problem, const PopulationFit& fit, const Eigen::MatrixXd& errors,
                            const RunContext& context, std::int64_t& evaluations) {
  constexpr double k_loose = 1e-6;  // of the noise: the prior hardly holds, outputs weigh as they do in the mean
  const PriorOnScales prior = prior_on_scales(problem.space);
  const Eigen::Index n = fit.specimens.points.rows();
  Eigen::MatrixXd values(n * errors.rows(), errors.cols());
  SpecimenStart start{Eigen::MatrixXd(values.rows(), fit.mean.size()), {}};
  for (Eigen::Index row = 0; row < values.rows(); ++row) {
    values.row(row) = fit.specimens.outputs.row(row % n) - errors.row(row / n);
    start.points.row(row) = fit.specimens.points.row(row % n);
    start.jacobians.push_back(fit.specimens.jacobians[static_cast<std::size_t>(row % n)]);
  }
  const SpecimenFits fits =
      fit_specimens(problem, values, {fit.mean, prior.covariance, k_loose * fit.noise}, start, context, evaluations);
  Eigen::MatrixXd moves = Eigen::MatrixXd::Zero(errors.rows(), fit.mean.size());
  for (Eigen::Index row = 0; row < values.rows(); ++row) {
    const double weight = fits.converged[static_cast<std::size_t>(row)] ? 1.0 / static_cast<double>(n) : std::nan("");
    moves.row(row / n) += weight * (fits.points.row(row) - start.points.row(row));
  }
  return moves;
}

}  // namespace

void curve_by_model_error(const UpdatingProblem& problem, const PopulationFit& fit, const PopulationEvidence& evidence,
                          const Eigen::VectorXd& centre, const RunContext& context, std::int64_t& evaluations,
                          Eigen::MatrixXd& intervals) {
  if (!fit.model_error || evidence.mean_shared.size() == 0) return;
  PopulationEvidence without = evidence;
  without.mean_covariance -= evidence.mean_shared;
  without.mean_shared.resize(0, 0);
  without.levels.clear();
  const Eigen::VectorXd half = linear_halves(evidence);
  const Eigen::VectorXd own = linear_halves(without);
  const ModelError& error = *fit.model_error;
  std::vector<Eigen::Index> moved;  // parameters that the error moves
  Eigen::MatrixXd errors(2 * half.size(), error.shift.size());
  for (Eigen::Index i = 0; i < half.size(); ++i) {
    const Eigen::VectorXd along = error.covariance * error.gain.row(i).transpose();
    const double variance = error.gain.row(i).dot(along);
    if (!(half(i) > own(i)) || !(variance > 0.0)) continue;
    const auto row = 2 * static_cast<Eigen::Index>(moved.size());
    errors.row(row + 1) = std::sqrt(half(i) * half(i) - own(i) * own(i)) / variance * along.transpose();
    errors.row(row) = -errors.row(row + 1);
    moved.push_back(i);
  }
  if (moved.empty()) return;
  errors.conservativeResize(2 * static_cast<Eigen::Index>(moved.size()), Eigen::NoChange);
  const Eigen::MatrixXd moves = moved_means(problem, fit, errors, context, evaluations);
  for (std::size_t place = 0; place < moved.size(); ++place) {
    const Eigen::Index i = moved[place];
    for (Eigen::Index side = 0; side < 2; ++side) {
      const double beyond = moves(2 * static_cast<Eigen::Index>(place) + side, i);
      const double factor = std::hypot(own(i), beyond) / half(i);
      if (!std::isfinite(factor) || (side == 0) != (beyond < 0.0)) continue;
      intervals(i, side) = centre(i) + factor * (intervals(i, side) - centre(i));
    }
  }
}

}  // namespace mottle::updating
