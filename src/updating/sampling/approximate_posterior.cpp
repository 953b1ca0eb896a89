#include "mottle/updating/sampling/approximate_posterior.hpp"

#include <algorithm>
#include <cmath>
#include <limits>
#include <numeric>
#include <vector>

#include "mottle/linalg/dense/decompositions.hpp"
#include "mottle/stats/distributions/standard_normal.hpp"
#include "mottle/updating/estimate/sample_estimate.hpp"

namespace mottle::updating {
namespace {

constexpr double k_infinity = std::numeric_limits<double>::infinity();

/// Simulations that count, the nearest first, and how many of them are accepted; ties by their place.
std::vector<Eigen::Index> nearest(const SimulationTable& table, const Eigen::VectorXd& distance, double fraction) {
  std::vector<Eigen::Index> possible;
  for (Eigen::Index k = 0; k < distance.size(); ++k) {
    if (table.log_weight(k) > -k_infinity && std::isfinite(distance(k))) possible.push_back(k);
  }
  const auto fewest = 2 * static_cast<std::size_t>(table.summaries.cols() + 2);
  require(possible.size() >= fewest, "approximate posterior: {} simulations are possible, need at least {}",
          possible.size(), fewest);
  const auto wanted = static_cast<std::size_t>(std::ceil(fraction * static_cast<double>(possible.size())));
  const std::size_t kept = std::min(std::max(wanted, fewest), possible.size());
  const auto is_nearer = [&](Eigen::Index a, Eigen::Index b) {
    return distance(a) != distance(b) ? distance(a) < distance(b) : a < b;
  };
  std::partial_sort(possible.begin(), possible.begin() + static_cast<std::ptrdiff_t>(kept), possible.end(), is_nearer);
  possible.resize(kept);
  return possible;
}

void take_moments(AcceptedDraws& draws) {
  draws.mean = draws.points.transpose() * draws.weights;
  const Eigen::MatrixXd centred = draws.points.rowwise() - draws.mean.transpose();
  draws.covariance = centred.transpose() * draws.weights.asDiagonal() * centred;
  draws.effective = 1.0 / draws.weights.squaredNorm();
}

/// Weighted linear regression of the points on what their summaries are off by [summary x coordinate].
Eigen::MatrixXd regression_slopes(const AcceptedDraws& draws, const Eigen::MatrixXd& off) {
  const Eigen::RowVectorXd off_mean = draws.weights.transpose() * off;
  const Eigen::RowVectorXd mean = draws.weights.transpose() * draws.points;
  const Eigen::MatrixXd centred = off.rowwise() - off_mean;
  const Eigen::MatrixXd weighted = draws.weights.asDiagonal() * centred;
  return solve_semidefinite(Eigen::MatrixXd(weighted.transpose() * centred),
                            weighted.transpose() * (draws.points.rowwise() - mean));
}

/// 2.5 %, 50 % and 97.5 % of each coordinate [3 x coordinate].
Eigen::MatrixXd interval_of(const AcceptedDraws& draws) {
  Eigen::MatrixXd ends(3, draws.points.cols());
  for (Eigen::Index k = 0; k < ends.cols(); ++k) {
    ends.col(k) << weighted_quantile(draws.points.col(k), draws.weights, 0.025),
        weighted_quantile(draws.points.col(k), draws.weights, 0.5),
        weighted_quantile(draws.points.col(k), draws.weights, 0.975);
  }
  return ends;
}

/// What an interval must be stretched by, about its median, to reach the truth.
double needed_factor(const Eigen::Vector3d& interval, double truth) {
  const double off = truth - interval(1);
  const double reach = off > 0.0 ? interval(2) - interval(1) : interval(1) - interval(0);
  return off == 0.0 ? 0.0 : std::abs(off) / std::max(reach, 1e-300);
}

double order_statistic(std::vector<double> values) {
  constexpr double k_level = 0.95;
  std::sort(values.begin(), values.end());
  const auto place = static_cast<std::size_t>(std::ceil(k_level * static_cast<double>(values.size() + 1)));
  return values[std::min(place, values.size()) - 1];
}

/// The intervals of one trial, carried to every set of simulated data.
struct Trial {
  Eigen::MatrixXd needed;  // factor [data set x coordinate]
  double log_width = 0.0;  // mean of the real data's intervals

  Eigen::VectorXd factors(Eigen::Index step) const {
    Eigen::VectorXd found(needed.cols());
    for (Eigen::Index k = 0; k < found.size(); ++k) {
      std::vector<double> values;
      for (Eigen::Index b = 0; b < needed.rows(); b += step) values.push_back(needed(b, k));
      found(k) = order_statistic(std::move(values));
    }
    return found;
  }
  double stretched_log_width() const { return log_width + factors(1).array().max(1e-300).log().mean(); }
};

Trial analyse(const AcceptedDraws& draws, const Eigen::Ref<const Eigen::VectorXd>& estimate,
              const Eigen::Ref<const Eigen::MatrixXd>& estimates, const Eigen::Ref<const Eigen::VectorXd>& truth,
              const ErrorCarrier& carry) {
  const Eigen::MatrixXd ends = interval_of(draws);
  Trial trial{Eigen::MatrixXd(estimates.rows(), truth.size()),
              (ends.row(2) - ends.row(0)).array().max(1e-300).log().mean()};
  const Eigen::MatrixXd about = estimate.transpose().replicate(3, 1);
  for (Eigen::Index b = 0; b < estimates.rows(); ++b) {
    const Eigen::MatrixXd carried = carry(ends, about, estimates.row(b));
    for (Eigen::Index k = 0; k < truth.size(); ++k) trial.needed(b, k) = needed_factor(carried.col(k), truth(k));
  }
  return trial;
}

}  // namespace

AcceptedDraws accept_nearest(const SimulationTable& table, const Eigen::Ref<const Eigen::VectorXd>& observed,
                             double fraction, bool adjust) {
  const Eigen::VectorXd distance = (table.summaries.rowwise() - observed.transpose()).rowwise().norm();
  const std::vector<Eigen::Index> accepted = nearest(table, distance, fraction);
  AcceptedDraws draws;
  draws.points = table.points(accepted, Eigen::all);
  draws.distances = distance(accepted);
  draws.tolerance = draws.distances(draws.distances.size() - 1);
  const Eigen::VectorXd log_weight = table.log_weight(accepted);
  // The farthest has the kernel's weight zero; all alike have one.
  const double square = draws.tolerance * draws.tolerance;
  const Eigen::ArrayXd kernel = square > 0.0 ? Eigen::ArrayXd(1.0 - draws.distances.array().square() / square)
                                             : Eigen::ArrayXd::Ones(draws.distances.size());
  draws.weights = (log_weight.array() - log_weight.maxCoeff()).exp() * kernel;
  if (!(draws.weights.sum() > 0.0)) draws.weights.setOnes();
  draws.weights /= draws.weights.sum();
  if (adjust) {
    const Eigen::MatrixXd summaries = table.summaries(accepted, Eigen::all);
    const Eigen::MatrixXd off = summaries.rowwise() - observed.transpose();
    draws.points = table.adjustment ? table.adjustment(draws.points, summaries, observed)
                                    : Eigen::MatrixXd(draws.points - off * regression_slopes(draws, off));
  }
  take_moments(draws);
  return draws;
}

Eigen::MatrixXd propose_uniformly(const Eigen::Ref<const Eigen::VectorXd>& centre,
                                  const Eigen::Ref<const Eigen::MatrixXd>& covariance, Eigen::Index count,
                                  const StreamKey& key) {
  constexpr double k_singular = 1e-10;
  const Eigen::Index dimension = centre.size();
  const double reach = 1.5 * std::sqrt(static_cast<double>(dimension)) + 1.0;
  Eigen::MatrixXd regular = covariance;
  regular.diagonal() *= 1.0 + k_singular;
  regular.diagonal().array() += 1e-300;
  CholeskyFactor factor(regular);
  if (!factor.is_positive_definite()) factor = CholeskyFactor(Eigen::MatrixXd(regular.diagonal().asDiagonal()));
  const Eigen::MatrixXd lower = reach * factor.lower();
  Eigen::MatrixXd points(count, dimension);
  for (Eigen::Index k = 0; k < count; ++k) {
    RandomStream stream(key, static_cast<std::uint32_t>(k));
    Eigen::VectorXd z(dimension);
    for (double& value : z) value = standard_normal_quantile(stream.uniform());
    z *= std::pow(stream.uniform(), 1.0 / static_cast<double>(dimension)) / z.norm();
    points.row(k) = (centre + lower * z).transpose();
  }
  return points;
}

IntervalCalibration calibrate_intervals(const std::vector<AcceptedDraws>& trials,
                                        const Eigen::Ref<const Eigen::VectorXd>& estimate,
                                        const Eigen::Ref<const Eigen::MatrixXd>& estimates,
                                        const Eigen::Ref<const Eigen::VectorXd>& truth, const ErrorCarrier& carry) {
  require(estimates.rows() >= 40 && !trials.empty(), "calibration: {} simulated data sets, need at least 40",
          estimates.rows());
  IntervalCalibration calibration;
  Trial best;
  for (std::size_t k = 0; k < trials.size(); ++k) {
    Trial trial = analyse(trials[k], estimate, estimates, truth, carry);
    if (k > 0 && !(trial.stretched_log_width() < best.stretched_log_width())) continue;
    best = std::move(trial);
    calibration.chosen = k;
  }
  calibration.factor = best.factors(1);
  calibration.coverage = (best.needed.array() <= 1.0).cast<double>().colwise().mean();
  const Eigen::RowVectorXd half = best.factors(2).transpose();
  std::vector<double> held;
  for (Eigen::Index b = 1; b < estimates.rows(); b += 2) {
    held.push_back((best.needed.row(b).array() <= half.array()).cast<double>().mean());
  }
  const auto count = static_cast<double>(held.size());
  calibration.checked_coverage = std::accumulate(held.begin(), held.end(), 0.0) / count;
  double squares = 0.0;
  for (const double share : held) squares += std::pow(share - calibration.checked_coverage, 2);
  calibration.checked_standard_error = std::sqrt(squares / (count - 1.0) / count);
  return calibration;
}

}  // namespace mottle::updating
