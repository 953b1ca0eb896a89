#include "mottle/stats/population/residual_noise.hpp"

#include <algorithm>
#include <cmath>

#include "mottle/core/error.hpp"
#include "mottle/linalg/dense/decompositions.hpp"

namespace mottle::stats {
namespace {

/// Of what all units see of a direction of the means with all of their rows. Effects reach all of it but for the change
/// of the designs from unit to unit: that change, the curvature of outputs, is no knowledge of the means, and least
/// squares would fit the noise by it.
constexpr double k_unseen = 0.05;

using OutputsOfUnits = std::vector<std::vector<Eigen::Index>>;

/// What units of one design, one noise and the same outputs have in common, in units of their noise.
struct WhitenedDesign {
  std::size_t unit = 0;              // one of them
  double count = 0.0;                // of them
  Eigen::MatrixXd reached = {};      // what their effects reach, orthonormal [row x rank]
  Eigen::VectorXd root = {};         // of the noise R
  Eigen::VectorXd unexplained = {};  // diagonal of R^1/2 P R^1/2: what of a row's noise shows in the residuals

  /// R^1/2 P_s R^1/2 of whitened columns.
  Eigen::MatrixXd unreached(const Eigen::MatrixXd& columns) const {
    return columns - reached * (reached.transpose() * columns);
  }
};

class ResidualIteration {
 public:
  ResidualIteration(const std::vector<RandomEffectsUnit>& units, const OutputsOfUnits& outputs,
                    const OutputLevels& levels)
      : units_(units), outputs_(outputs), levels_(levels) {
    for (std::size_t s = 0; s < units.size(); ++s) {
      const auto is_alike = [&](const WhitenedDesign& other) {
        const RandomEffectsUnit& first = units[other.unit];
        return outputs[s] == outputs[other.unit] && units[s].noise == first.noise && units[s].design == first.design;
      };
      const auto found = std::ranges::find_if(designs_, is_alike);
      design_of_.push_back(static_cast<std::size_t>(found - designs_.begin()));
      if (found == designs_.end()) designs_.push_back({.unit = s});
      designs_[design_of_.back()].count += 1.0;
    }
  }

  /// The next levels.
  Eigen::VectorXd improve(const Eigen::VectorXd& now) {
    for (WhitenedDesign& own : designs_) whiten(now, own);
    weigh_means();
    const Eigen::VectorXd mean = find_mean();
    Eigen::VectorXd sum = levels_.weight * levels_.expected;
    Eigen::VectorXd rows = Eigen::VectorXd::Constant(now.size(), levels_.weight);
    for (std::size_t s = 0; s < units_.size(); ++s) {
      const WhitenedDesign& own = designs_[design_of_[s]];
      const std::vector<Eigen::Index>& which = outputs_[s];
      const Eigen::VectorXd about = (units_[s].response - mean(which)).cwiseQuotient(own.root);
      const Eigen::VectorXd error = own.unreached(about);
      for (std::size_t k = 0; k < which.size(); ++k) {
        const int level = levels_.of_output[static_cast<std::size_t>(which[k])];
        if (level < 0) continue;
        const auto row = static_cast<Eigen::Index>(k);
        sum(level) += now(level) * error(row) * error(row);
        rows(level) += own.unexplained(row);
      }
    }
    constexpr double k_seen = 1e-9;       // rows that show in the residuals
    constexpr double k_rounding = 1e-16;  // of copies of one unit, whose residuals are nothing else
    return (rows.array() > k_seen).select(sum.array() / rows.array(), now.array()).max(k_rounding);
  }

  /// Rows less effects less means, after improve().
  double degrees_of_freedom() const {
    double count = 0.0;
    for (const WhitenedDesign& own : designs_) {
      count += own.count * static_cast<double>(own.reached.rows() - own.reached.cols());
    }
    return count - static_cast<double>(seen_.cols());
  }

 private:
  void whiten(const Eigen::VectorXd& now, WhitenedDesign& own) const {
    const RandomEffectsUnit& unit = units_[own.unit];
    Eigen::VectorXd factor = Eigen::VectorXd::Ones(unit.noise.size());
    for (std::size_t k = 0; k < outputs_[own.unit].size(); ++k) {
      const int level = levels_.of_output[static_cast<std::size_t>(outputs_[own.unit][k])];
      if (level >= 0) factor(static_cast<Eigen::Index>(k)) = now(level);
    }
    own.root = unit.noise.cwiseProduct(factor).cwiseSqrt();
    own.reached = reached_by(own.root.cwiseInverse().asDiagonal() * unit.design);
  }

  /// Sum of P_s, each output in units of its noise over all units, and what it leaves of each row's noise.
  void weigh_means() {
    const auto p = static_cast<Eigen::Index>(levels_.of_output.size());
    Eigen::VectorXd information = Eigen::VectorXd::Zero(p);
    for (const WhitenedDesign& own : designs_) {
      information(outputs_[own.unit]) += own.count * own.root.cwiseAbs2().cwiseInverse();
    }
    scale_ = information.cwiseMax(1e-300).cwiseSqrt().cwiseInverse();
    Eigen::MatrixXd weight_of_mean = Eigen::MatrixXd::Zero(p, p);
    for (const WhitenedDesign& own : designs_) {
      const std::vector<Eigen::Index>& which = outputs_[own.unit];
      const Eigen::VectorXd weight = scale_(which).cwiseQuotient(own.root);
      const Eigen::MatrixXd reached = weight.asDiagonal() * own.reached;
      Eigen::MatrixXd unreached = -reached * reached.transpose();
      unreached.diagonal() += weight.cwiseAbs2();
      weight_of_mean(which, which) += own.count * unreached;
    }
    if (seen_.rows() == 0) seen_ = scale_.asDiagonal() * seen_directions(weight_of_mean);
    const Eigen::MatrixXd seen = scale_.cwiseInverse().asDiagonal() * seen_;
    mean_ = CholeskyFactor(seen.transpose() * weight_of_mean * seen);
    for (WhitenedDesign& own : designs_) {
      const Eigen::Index rows = own.root.size();
      const std::vector<Eigen::Index>& which = outputs_[own.unit];
      const Eigen::MatrixXd unreached = own.unreached(Eigen::MatrixXd::Identity(rows, rows));
      Eigen::MatrixXd columns = Eigen::MatrixXd::Zero(p, rows);
      columns(which, Eigen::all) = scale_(which).cwiseQuotient(own.root).asDiagonal() * unreached;
      columns = (seen.transpose() * columns).eval();
      mean_.solve_lower_in_place(columns);
      own.unexplained = unreached.diagonal() - columns.colwise().squaredNorm().transpose();
    }
  }

  static Eigen::MatrixXd seen_directions(const Eigen::MatrixXd& weight_of_mean) {
    const SymmetricEigen solver(weight_of_mean);
    return solver.eigenvectors().rightCols((solver.eigenvalues().array() > k_unseen).count());
  }

  /// b of least squares.
  Eigen::VectorXd find_mean() const {
    Eigen::VectorXd right = Eigen::VectorXd::Zero(scale_.size());
    for (std::size_t s = 0; s < units_.size(); ++s) {
      const WhitenedDesign& own = designs_[design_of_[s]];
      const Eigen::VectorXd weight = scale_(outputs_[s]).cwiseQuotient(own.root);
      right(outputs_[s]) += weight.asDiagonal() * own.unreached(units_[s].response.cwiseQuotient(own.root));
    }
    return seen_ * mean_.solve(seen_.transpose() * scale_.cwiseInverse().cwiseProduct(right));
  }

  const std::vector<RandomEffectsUnit>& units_;
  const OutputsOfUnits& outputs_;
  const OutputLevels& levels_;
  std::vector<WhitenedDesign> designs_;
  std::vector<std::size_t> design_of_;  // [unit]
  Eigen::VectorXd scale_;               // of the means: noise over all units [output]
  Eigen::MatrixXd seen_;                // directions of the means that residuals see [output x direction]
  CholeskyFactor mean_;                 // of the sum of P_s in these directions
};

void require_outputs(const std::vector<RandomEffectsUnit>& units, const OutputsOfUnits& outputs,
                     const OutputLevels& levels) {
  require(units.size() == outputs.size(), "residual noise: {} units and {} lists of outputs", units.size(),
          outputs.size());
  const auto count = static_cast<Eigen::Index>(levels.of_output.size());
  for (std::size_t s = 0; s < units.size(); ++s) {
    const bool fits = static_cast<Eigen::Index>(outputs[s].size()) == units[s].response.size() &&
                      std::ranges::all_of(outputs[s], [&](Eigen::Index k) { return k >= 0 && k < count; });
    require(fits, "residual noise: unit {} has {} rows and {} outputs, of {} in all", s, units[s].response.size(),
            outputs[s].size(), count);
  }
  for (const int level : levels.of_output) {
    require(level < levels.expected.size(), "residual noise: level {} of {}", level, levels.expected.size());
  }
}

}  // namespace

Eigen::MatrixXd reached_by(const Eigen::MatrixXd& design) {
  constexpr double k_collinear = 1e-8;
  if (design.cols() == 0) return design;
  const Eigen::VectorXd scale = design.colwise().norm().transpose().cwiseMax(1e-300).cwiseInverse();
  return PivotedQr(design * scale.asDiagonal(), k_collinear).range();
}

ResidualNoise estimate_residual_noise(const std::vector<RandomEffectsUnit>& units, const OutputsOfUnits& outputs,
                                      const OutputLevels& levels, double tolerance) {
  constexpr int k_max_steps = 1000;
  require_outputs(units, outputs, levels);
  ResidualNoise noise{levels.expected};
  ResidualIteration iteration(units, outputs, levels);
  for (int step = 0; step < k_max_steps && !noise.converged; ++step) {
    const Eigen::VectorXd next = iteration.improve(noise.levels);
    const double change = (next.cwiseQuotient(noise.levels.cwiseMax(1e-300)).array() - 1.0).abs().maxCoeff();
    noise.converged = change <= tolerance;
    noise.levels = next;
  }
  noise.degrees_of_freedom = iteration.degrees_of_freedom();
  if (noise.degrees_of_freedom <= 0.0) noise.levels = levels.expected;
  return noise;
}

}  // namespace mottle::stats
