// The training samples of a reduced model: their Ritz pairs and how far these are from the accuracy that is asked for.
#pragma once

#include <Eigen/Core>
#include <algorithm>
#include <cmath>
#include <vector>

#include "linalg/reduced/reduced_model_parts.hpp"

namespace mottle::linalg {

inline constexpr double k_training_target = 0.4;      // of the tolerance: later samples lie between the training's
inline constexpr double k_guard_residual = 0.1;       // relative residual that is good enough for a guard mode
inline constexpr double k_largest_shortfall = 100.0;  // larger ones are cut to this

/// Error of each (mode, sample) over the one that is allowed: above 1 the basis is not yet good enough for it.
/// [mode and guards x sample]
inline Eigen::MatrixXd shortfalls(const Eigen::MatrixXd& bounds, const Eigen::MatrixXd& residuals, double target) {
  const Eigen::Index modes = residuals.cols() / bounds.cols();
  Eigen::MatrixXd result(modes, bounds.cols());
  for (Eigen::Index s = 0; s < bounds.cols(); ++s) {
    for (Eigen::Index k = 0; k < modes; ++k) {
      result(k, s) = k < bounds.rows() ? std::min(std::sqrt(bounds(k, s) / target), k_largest_shortfall)
                                       : residuals.col(s * modes + k).norm() / k_guard_residual;
    }
  }
  return result;
}

/// Ritz pairs and shortfalls of the training samples. A sample whose shortfalls are below 1 is not solved again while
/// the basis grows: its vectors are in the larger space too, with the same residuals.
class TrainingSamples {
 public:
  TrainingSamples(const ReducedModel::Parts& parts, const TermCoefficients& samples)
      : parts_(parts), samples_(samples) {}

  const TermCoefficients& coefficients() const { return samples_; }

  /// Solves those of the first `used` samples that are new or have a shortfall above 1.
  void solve(Eigen::Index used, int threads) {
    const Eigen::Index modes = parts_.solved_modes();
    if (modes != shortfall.rows()) used_ = 0;  // a basis that held hardly more than the modes has grown
    std::vector<Eigen::Index> open;
    for (Eigen::Index s = 0; s < used; ++s) {
      if (s >= used_ || shortfall.col(s).maxCoeff() > 1.0) open.push_back(s);
    }
    resize(modes, used);
    solve(open, threads);
  }

  /// At least `enough` samples solved in a space hardly smaller than the present basis, some solved again for it:
  /// vectors from smaller spaces would keep directions that the present one does not need.
  std::vector<Eigen::Index> fresh(Eigen::Index enough, int threads) {
    constexpr double k_hardly_smaller = 0.9;
    const double limit = k_hardly_smaller * static_cast<double>(parts_.basis.cols());
    std::vector<Eigen::Index> result, stale;
    for (Eigen::Index s = 0; s < used_; ++s) {
      (static_cast<double>(solved_in_[static_cast<std::size_t>(s)]) >= limit ? result : stale).push_back(s);
    }
    const auto missing = std::max<std::ptrdiff_t>(enough - static_cast<std::ptrdiff_t>(result.size()), 0);
    stale.resize(std::min(stale.size(), static_cast<std::size_t>(missing)));
    solve(stale, threads);
    result.insert(result.end(), stale.begin(), stale.end());
    return result;
  }

  /// Whether all bounds are within the tolerance and the guards accurate enough for them.
  bool are_nearly_good() const {
    constexpr double k_bound = 1.5;  // its square times the target is within the tolerance
    constexpr double k_guard = 2.0;
    return shortfall.topRows(parts_.converged_modes()).maxCoeff() < k_bound && shortfall.maxCoeff() < k_guard;
  }
  Eigen::Index open_samples() const { return (shortfall.colwise().maxCoeff().array() > 1.0).count(); }
  /// Mean over the samples of the logarithm of the largest shortfall; 0 where about half of them are good.
  double mean_shortfall() const { return shortfall.colwise().maxCoeff().array().max(1e-3).log().mean(); }

  Eigen::MatrixXd values;       ///< Ritz values [mode and guards x sample]
  Eigen::MatrixXd coordinates;  ///< of Ritz vectors [vector x (mode and guards) * sample]
  Eigen::MatrixXd residuals;    ///< sketched [sketch row x (mode and guards) * sample]
  Eigen::MatrixXd shortfall;    ///< see shortfalls()

 private:
  void solve(const std::vector<Eigen::Index>& rows, int threads) {
    if (rows.empty()) return;
    const Eigen::Index modes = shortfall.rows();
    const TermCoefficients now{samples_.stiffness(Eigen::all, rows), samples_.mass(Eigen::all, rows)};
    const ReducedModel::Parts::Solution found = parts_.solve(now, Purpose::training, threads);
    const Eigen::MatrixXd found_shortfall =
        shortfalls(found.bounds, found.residuals, k_training_target * parts_.options.tolerance);
    for (std::size_t i = 0; i < rows.size(); ++i) {
      const auto from = static_cast<Eigen::Index>(i);
      solved_in_[static_cast<std::size_t>(rows[i])] = coordinates.rows();
      values.col(rows[i]) = found.values.col(from);
      shortfall.col(rows[i]) = found_shortfall.col(from);
      residuals.middleCols(rows[i] * modes, modes) = found.residuals.middleCols(from * modes, modes);
      coordinates.middleCols(rows[i] * modes, modes) = found.vectors.col(from).reshaped(coordinates.rows(), modes);
    }
  }

  void resize(Eigen::Index modes, Eigen::Index used) {
    const Eigen::Index vectors = parts_.basis.cols();
    const Eigen::Index before = used_ == 0 ? 0 : coordinates.rows();
    coordinates.conservativeResize(vectors, modes * used);
    coordinates.bottomRows(vectors - before).setZero();
    residuals.conservativeResize(k_sketch_rows, modes * used);
    values.conservativeResize(modes, used);
    shortfall.conservativeResize(modes, used);
    solved_in_.resize(static_cast<std::size_t>(used));
    used_ = used;
  }

  const ReducedModel::Parts& parts_;
  const TermCoefficients& samples_;
  Eigen::Index used_ = 0;
  std::vector<Eigen::Index> solved_in_;  // vectors of the basis at the time [sample]
};

}  // namespace mottle::linalg
