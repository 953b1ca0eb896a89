// Training of a reduced model: greedy choice of the residuals that enlarge the basis.
#include <Eigen/Core>
#include <algorithm>
#include <cmath>
#include <limits>
#include <utility>

#include "linalg/reduced/reduced_compression.hpp"
#include "linalg/reduced/reduced_model_parts.hpp"
#include "linalg/reduced/training_samples.hpp"
#include "mottle/core/parallel.hpp"
#include "mottle/linalg/dense/products.hpp"

namespace mottle::linalg {
namespace {

struct Pick {
  Eigen::Index sample = 0;
  Eigen::Index mode = 0;
};

/// Residuals by pivoted Gram-Schmidt: each has the largest component orthogonal to those picked before, weighted by its
/// shortfall.
std::vector<Pick> pick_residuals(const Eigen::MatrixXd& residuals, const Eigen::MatrixXd& shortfall,
                                 Eigen::Index max_picks) {
  constexpr double k_enough = 0.5;
  std::vector<Pick> candidates;
  for (Eigen::Index s = 0; s < shortfall.cols(); ++s) {
    for (Eigen::Index k = 0; k < shortfall.rows(); ++k) {
      if (shortfall(k, s) > 1.0) candidates.push_back({s, k});
    }
  }
  Eigen::MatrixXd columns(residuals.rows(), static_cast<Eigen::Index>(candidates.size()));
  for (Eigen::Index c = 0; c < columns.cols(); ++c) {
    const Pick& pick = candidates[static_cast<std::size_t>(c)];
    const auto residual = residuals.col(pick.sample * shortfall.rows() + pick.mode);
    columns.col(c) = residual * (shortfall(pick.mode, pick.sample) / std::max(residual.norm(), 1e-300));
  }
  std::vector<Pick> picks;
  Eigen::VectorXd squares = columns.colwise().squaredNorm().transpose();
  while (static_cast<Eigen::Index>(picks.size()) < std::min(max_picks, columns.cols())) {
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

/// K(s) u - lambda M(s) u of the picked modes; u as rows, padded.
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

/// Progress of the training, which ends it before the most expensive rounds if they cannot reach the tolerance.
class TrainingProgress {
 public:
  /// Whether the mean shortfall, extrapolated to the largest basis allowed by the rate of the last vectors (later ones
  /// help less), stays above e: refinement corrects smaller ones. While nearly all samples are at k_largest_shortfall
  /// there is no rate; if so at three quarters of the basis, the tolerance is out of reach too.
  bool is_out_of_reach(const ReducedModel::Parts& parts, double shortfall) {
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

  /// Whether the last round hardly reduced the largest shortfall: more vectors will not help.
  bool is_stagnant(double worst) {
    constexpr double k_hardly = 0.9;
    return worst > k_hardly * std::exchange(worst_, worst);
  }

 private:
  double worst_ = std::numeric_limits<double>::infinity();
  Eigen::Index vectors_ = 0;
  double shortfall_ = 0.0;
};

/// Enlarges the basis by A^-1 r of the picked residuals r.
void enlarge(ReducedModel::Parts& parts, const TermCoefficients& samples, const TrainingSamples& known,
             const std::vector<Pick>& picks, int threads) {
  Eigen::MatrixXd coordinates(parts.basis.cols(), static_cast<Eigen::Index>(picks.size()));
  Eigen::VectorXd values(coordinates.cols());
  for (Eigen::Index c = 0; c < values.size(); ++c) {
    const Pick& pick = picks[static_cast<std::size_t>(c)];
    values(c) = known.values(pick.mode, pick.sample);
    coordinates.col(c) = known.coordinates.col(pick.sample * known.values.rows() + pick.mode);
  }
  VectorRows corrections = full_residuals(*parts.full, samples, picks, parts.shapes(coordinates), values);
  constexpr std::int64_t k_sides = 16;  // in one sweep through the factor; fewer cost more a side
  parallel_for(coordinates.cols(), k_sides, threads, [&](std::int64_t begin, std::int64_t end) {
    parts.full->factor().solve_rows(corrections.middleCols(begin, end - begin));
  });
  parts.append(corrections, coordinates.cols(), threads);
}

}  // namespace

void ReducedModel::train(const TermCoefficients& samples, int threads, const std::function<void(Eigen::Index)>& each) {
  constexpr Eigen::Index k_first_samples = 64;
  constexpr Eigen::Index k_choosing_samples = 128;
  constexpr Eigen::Index k_compressing_samples = 200;
  constexpr int k_rounds = 30;
  constexpr int k_last_rounds = 3;          // once few samples are not good: refinement can solve those
  constexpr Eigen::Index k_few = 50;        // few: one in this many
  constexpr Eigen::Index k_max_picks = 48;  // a multiple of a sweep's right-hand sides
  Parts& parts = *parts_;
  const Eigen::Index max_picks = std::min<Eigen::Index>(k_max_picks, Eigen::Index{5} * parts.options.modes);
  parts.add_reference_below(samples, threads);
  Eigen::Index used = std::min(samples.samples(), k_first_samples);
  TrainingSamples known(parts, samples);
  TrainingProgress progress;
  parts.reaches_tolerance = false;
  int last_rounds = 0;
  for (int round = 0; round < k_rounds; ++round) {
    if (each) each(parts.basis.cols());
    known.solve(used, threads);
    const Eigen::Index room = parts.options.max_vectors - parts.basis.cols();
    const std::vector<Pick> picks = pick_residuals(known.residuals, known.shortfall, std::min(max_picks, room));
    const bool is_complete = used == samples.samples();
    if (is_complete && k_few * known.open_samples() <= used) {
      last_rounds += progress.is_stagnant(known.shortfall.maxCoeff()) ? k_last_rounds : 1;
    }
    const bool is_good = is_complete && (known.are_nearly_good() || last_rounds > k_last_rounds);
    parts.reaches_tolerance = is_good || (picks.empty() && room > 0);
    if (is_good) return compress(parts, known, known.fresh(k_compressing_samples, threads));
    if ((picks.empty() && is_complete) || room <= 0) break;
    if (progress.is_out_of_reach(parts, known.mean_shortfall())) break;
    // As long as no sample is good, more of them would hardly choose better.
    const bool has_good = used < k_choosing_samples || known.open_samples() < used;
    if (has_good) used = std::min(2 * used, samples.samples());
    if (!picks.empty()) enlarge(parts, samples, known, picks, threads);
  }
  const Eigen::MatrixXd rotation = nominal_rotation(weighted_sum(parts.mass, parts.full->nominal_mass));
  if (rotation.size() > 0) parts.rotate(rotation);
  parts.apply_pending();
}

bool ReducedModel::reaches_tolerance() const {
  return parts_->reaches_tolerance;
}

}  // namespace mottle::linalg
