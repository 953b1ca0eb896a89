// Which residuals of the training samples enlarge the basis, and which of its directions are kept.
#include <Eigen/Core>
#include <algorithm>
#include <cmath>
#include <limits>
#include <utility>

#include "linalg/blas.hpp"
#include "linalg/reduced/reduced_model_parts.hpp"
#include "mottle/core/parallel.hpp"
#include "mottle/linalg/dense/decompositions.hpp"

namespace mottle::linalg {
namespace {

constexpr double k_guard_residual = 0.1;       // relative residual that is good enough for a guard mode
constexpr double k_largest_shortfall = 100.0;  // worse ones are not told apart

/// How far each (mode, sample) is from what is wanted: above 1 it needs more. [mode and guards x sample]
Eigen::MatrixXd shortfalls(const Eigen::MatrixXd& bounds, const Eigen::MatrixXd& residuals, double target) {
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

struct Pick {
  Eigen::Index sample = 0;
  Eigen::Index mode = 0;
};

/// Columns by pivoting: each the one that is farthest from good enough when the picked ones are taken out of all.
std::vector<Pick> pick_residuals(const Eigen::MatrixXd& residuals, const Eigen::MatrixXd& wants, Eigen::Index most) {
  constexpr double k_enough = 0.5;
  std::vector<Pick> candidates;
  for (Eigen::Index s = 0; s < wants.cols(); ++s) {
    for (Eigen::Index k = 0; k < wants.rows(); ++k) {
      if (wants(k, s) > 1.0) candidates.push_back({s, k});
    }
  }
  Eigen::MatrixXd columns(residuals.rows(), static_cast<Eigen::Index>(candidates.size()));
  for (Eigen::Index c = 0; c < columns.cols(); ++c) {
    const Pick& pick = candidates[static_cast<std::size_t>(c)];
    const auto residual = residuals.col(pick.sample * wants.rows() + pick.mode);
    columns.col(c) = residual * (wants(pick.mode, pick.sample) / std::max(residual.norm(), 1e-300));
  }
  std::vector<Pick> picks;
  Eigen::VectorXd squares = columns.colwise().squaredNorm().transpose();
  while (static_cast<Eigen::Index>(picks.size()) < std::min(most, columns.cols())) {
    Eigen::Index best = 0;
    if (squares.maxCoeff(&best) < k_enough * k_enough) break;
    picks.push_back(candidates[static_cast<std::size_t>(best)]);
    const Eigen::VectorXd direction = columns.col(best).normalized();
    const Eigen::RowVectorXd parts = direction.transpose() * columns;
    columns.noalias() -= direction * parts;
    squares = columns.colwise().squaredNorm().transpose();
  }
  return picks;
}

/// K(s) u - lambda M(s) u of the picked modes; u as rows, with their padding.
VectorRows full_residuals(const FullPencils& full, const TermCoefficients& samples, const std::vector<Pick>& picks,
                          const VectorRows& u, const Eigen::VectorXd& values) {
  std::vector<Eigen::Index> picked;
  for (const Pick& pick : picks) picked.push_back(pick.sample);
  const auto weights = [&](const Eigen::MatrixXd& coefficients) {
    Eigen::MatrixXd result(coefficients.rows() + 1, values.size());
    result.row(0).setOnes();
    result.bottomRows(coefficients.rows()) = coefficients(Eigen::all, picked);
    return result;
  };
  VectorRows result = VectorRows::Zero(u.rows(), u.cols());
  add_weighted_products(full.stiffness, weights(samples.stiffness), u, result);
  add_weighted_products(full.mass, weights(samples.mass) * (-values).asDiagonal(), u, result);
  return result;
}

/// What is known of the training samples. A sample that is good keeps its vectors while the basis grows: they are in
/// the larger space too, and leave the same residuals.
class TrainingSamples {
 public:
  TrainingSamples(const ReducedModel::Parts& parts, const TermCoefficients& samples, double target)
      : parts_(parts), samples_(samples), target_(target) {}

  /// Solves those of the first `used` samples that are new or were not good.
  void solve(Eigen::Index used, int threads) {
    const Eigen::Index modes = parts_.solved_modes();
    if (modes != wants.rows()) used_ = 0;  // a basis that held hardly more than the modes has grown
    std::vector<Eigen::Index> open;
    for (Eigen::Index s = 0; s < used; ++s) {
      if (s >= used_ || wants.col(s).maxCoeff() > 1.0) open.push_back(s);
    }
    resize(modes, used);
    solve(open, threads);
  }

  /// Samples solved in a space hardly smaller than the basis is now, at least `enough` of them: the vectors of others
  /// would keep directions that the larger space can do without.
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

  /// Whether a few more vectors would hardly matter: bounds are within the tolerance, guards known well enough for
  /// them.
  bool are_nearly_good() const {
    constexpr double k_bound = 1.4;  // its square times half the tolerance is within it
    constexpr double k_guard = 2.0;
    return wants.topRows(parts_.sharp_modes()).maxCoeff() < k_bound && wants.maxCoeff() < k_guard;
  }
  Eigen::Index open_samples() const { return (wants.colwise().maxCoeff().array() > 1.0).count(); }
  /// Mean over the samples of the logarithm of what the worst mode is short of; 0 where half of them are good or so.
  double mean_shortfall() const { return wants.colwise().maxCoeff().array().max(1e-3).log().mean(); }

  Eigen::MatrixXd values;       ///< Ritz values [mode and guards x sample]
  Eigen::MatrixXd coordinates;  ///< of Ritz vectors [vector x (mode and guards) * sample]
  Eigen::MatrixXd residuals;    ///< sketched [sketch row x (mode and guards) * sample]
  Eigen::MatrixXd wants;        ///< see shortfalls()

 private:
  void solve(const std::vector<Eigen::Index>& rows, int threads) {
    if (rows.empty()) return;
    const Eigen::Index modes = wants.rows();
    const TermCoefficients now{samples_.stiffness(Eigen::all, rows), samples_.mass(Eigen::all, rows)};
    const ReducedModel::Parts::Solution found = parts_.solve(now, Purpose::training, threads);
    const Eigen::MatrixXd shortfall = shortfalls(found.bounds, found.residuals, target_);
    for (std::size_t i = 0; i < rows.size(); ++i) {
      const auto from = static_cast<Eigen::Index>(i);
      solved_in_[static_cast<std::size_t>(rows[i])] = coordinates.rows();
      values.col(rows[i]) = found.values.col(from);
      wants.col(rows[i]) = shortfall.col(from);
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
    wants.conservativeResize(modes, used);
    solved_in_.resize(static_cast<std::size_t>(used));
    used_ = used;
  }

  const ReducedModel::Parts& parts_;
  const TermCoefficients& samples_;
  double target_;
  Eigen::Index used_ = 0;
  std::vector<Eigen::Index> solved_in_;  // vectors of the basis at the time [sample]
};

/// The directions that training samples need, orthonormal: the basis grew by what was missing at the time. Empty where
/// nearly all are.
Eigen::MatrixXd needed_directions(const ReducedModel::Parts& parts, const TrainingSamples& samples,
                                  const std::vector<Eigen::Index>& chosen) {
  constexpr Eigen::Index k_worth = 20;  // a twentieth fewer pay for the turning
  constexpr double k_neglect = 0.5;     // of the residual that would be just good enough
  constexpr double k_lost = 0.03;       // of a floor's mode
  const Eigen::Index vectors = parts.basis.cols();
  const Eigen::Index modes = samples.wants.rows();
  const Eigen::Index columns = modes * static_cast<Eigen::Index>(chosen.size());
  Eigen::MatrixXd weighted(vectors, columns + parts.floor_modes.cols());
  weighted.rightCols(parts.floor_modes.cols()) = parts.floor_modes * (k_neglect / k_lost);
  for (Eigen::Index c = 0; c < columns; ++c) {
    const Eigen::Index s = chosen[static_cast<std::size_t>(c / modes)];
    const Eigen::Index k = c % modes;
    const double allowed = samples.residuals.col(s * modes + k).norm() / std::max(samples.wants(k, s), 1e-3);
    const double length = std::sqrt(std::max(samples.values(k, s) - parts.full->shift, 0.0));
    weighted.col(c) = samples.coordinates.col(s * modes + k) / std::max(length * allowed, 1e-300);
  }
  const Eigen::MatrixXd transposed = weighted.transpose();
  const SymmetricEigen solver(transposed_product(transposed, transposed));
  const Eigen::MatrixXd shares = transposed_product(solver.eigenvectors(), weighted).cwiseAbs2();
  Eigen::RowVectorXd neglected = Eigen::RowVectorXd::Zero(weighted.cols());
  Eigen::Index dropped = 0;
  for (; dropped + parts.solved_modes() < vectors; ++dropped) {
    neglected += shares.row(dropped);
    if (neglected.maxCoeff() > k_neglect * k_neglect) break;
  }
  if (k_worth * dropped <= vectors) return {};
  return solver.eigenvectors().rightCols(vectors - dropped);
}

/// Turns the basis into the needed directions, if there are any, and these into the nominal modes.
void turn_basis(ReducedModel::Parts& parts, const Eigen::MatrixXd& needed) {
  Eigen::MatrixXd nominal = weighted_sum(parts.mass, parts.full->nominal_mass);
  if (needed.size() > 0) nominal = transposed_product(needed, product(nominal, needed));
  const Eigen::MatrixXd turn = nominal_turn(nominal);
  if (needed.size() > 0) {
    parts.rotate(turn.size() > 0 ? product(needed, turn) : needed);
  } else if (turn.size() > 0) {
    parts.rotate(turn);
  }
}

/// How the training comes on, to give up before the most expensive rounds where they would be in vain.
class Progress {
 public:
  /// Whether most samples would be far from good at the largest basis allowed even if all further vectors helped as
  /// much as the last ones; in fact each helps less than those before. A few times too much is not: refinement mends
  /// it. While nearly all samples have no bound worth the name nothing is known of that, and late it is bad enough.
  bool is_hopeless(const ReducedModel::Parts& parts, double shortfall) {
    constexpr double k_margin = 1.0;
    constexpr double k_blind = 0.97;
    const Eigen::Index vectors = parts.basis.cols();
    const double added = static_cast<double>(vectors - vectors_);
    const double room = static_cast<double>(parts.options.max_vectors - vectors);
    const double predicted = shortfall - std::max(shortfall_ - shortfall, 0.0) * room / std::max(added, 1.0);
    const double blind = k_blind * std::log(k_largest_shortfall);
    const bool knows = added > 0.0 && 2 * vectors > parts.options.max_vectors && vectors_ > 0 && shortfall_ < blind;
    const bool is_late = 4 * vectors > 3 * parts.options.max_vectors;
    vectors_ = vectors;
    shortfall_ = shortfall;
    return (knows && predicted > k_margin) || (is_late && shortfall > blind);
  }

  /// Whether the last of the rounds for a few samples hardly helped the worst: what it lacks is not vectors.
  bool stands_still(double worst) {
    constexpr double k_hardly = 0.9;
    return worst > k_hardly * std::exchange(worst_, worst);
  }

 private:
  double worst_ = std::numeric_limits<double>::infinity();
  Eigen::Index vectors_ = 0;
  double shortfall_ = 0.0;
};

/// The answers of the nominal factor to the picked residuals enlarge the basis.
void enlarge(ReducedModel::Parts& parts, const TermCoefficients& samples, const TrainingSamples& known,
             const std::vector<Pick>& picks, int threads) {
  Eigen::MatrixXd coordinates(parts.basis.cols(), static_cast<Eigen::Index>(picks.size()));
  Eigen::VectorXd values(coordinates.cols());
  for (Eigen::Index c = 0; c < values.size(); ++c) {
    const Pick& pick = picks[static_cast<std::size_t>(c)];
    values(c) = known.values(pick.mode, pick.sample);
    coordinates.col(c) = known.coordinates.col(pick.sample * known.values.rows() + pick.mode);
  }
  VectorRows answers = full_residuals(*parts.full, samples, picks, parts.shapes(coordinates), values);
  constexpr std::int64_t k_sides = 16;  // in one sweep through the factor; fewer cost more a side
  parallel_for(coordinates.cols(), k_sides, threads, [&](std::int64_t begin, std::int64_t end) {
    parts.full->factor().solve_rows(answers.middleCols(begin, end - begin));
  });
  parts.append(answers, coordinates.cols(), threads);
}

}  // namespace

void ReducedModel::train(const TermCoefficients& samples, int threads) {
  constexpr Eigen::Index k_first_samples = 64;
  constexpr Eigen::Index k_choosing_samples = 128;
  constexpr Eigen::Index k_compressing_samples = 200;
  constexpr int k_rounds = 30;
  constexpr int k_last_rounds = 3;          // for a few that are not good yet: refinement takes care of them
  constexpr Eigen::Index k_few = 50;        // one in so many samples
  constexpr Eigen::Index k_max_picks = 48;  // whole sweeps through the factor
  Parts& parts = *parts_;
  const Eigen::Index max_picks = std::min<Eigen::Index>(k_max_picks, Eigen::Index{5} * parts.options.modes);
  parts.raise_floor(samples, threads);
  Eigen::Index used = std::min(samples.samples(), k_first_samples);
  TrainingSamples known(parts, samples, 0.5 * parts.options.tolerance);
  Progress progress;
  parts.reaches_tolerance = false;
  int last_rounds = 0;
  Eigen::MatrixXd needed;
  for (int round = 0; round < k_rounds; ++round) {
    known.solve(used, threads);
    const Eigen::Index room = parts.options.max_vectors - parts.basis.cols();
    const std::vector<Pick> picks = pick_residuals(known.residuals, known.wants, std::min(max_picks, room));
    const bool is_complete = used == samples.samples();
    if (is_complete && k_few * known.open_samples() <= used) {
      last_rounds += progress.stands_still(known.wants.maxCoeff()) ? k_last_rounds : 1;
    }
    const bool is_good = is_complete && (known.are_nearly_good() || last_rounds > k_last_rounds);
    parts.reaches_tolerance = is_good || (picks.empty() && room > 0);
    if (is_good) needed = needed_directions(parts, known, known.fresh(k_compressing_samples, threads));
    if (is_good || (picks.empty() && is_complete) || room <= 0) break;
    if (progress.is_hopeless(parts, known.mean_shortfall())) break;
    // As long as no sample is good, more of them would hardly choose better.
    const bool has_good = used < k_choosing_samples || known.open_samples() < used;
    if (has_good) used = std::min(2 * used, samples.samples());
    if (!picks.empty()) enlarge(parts, samples, known, picks, threads);
  }
  turn_basis(parts, needed);
  parts.settle();
}

bool ReducedModel::reaches_tolerance() const {
  return parts_->reaches_tolerance;
}

}  // namespace mottle::linalg
