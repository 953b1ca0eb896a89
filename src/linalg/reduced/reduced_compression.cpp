#include "linalg/reduced/reduced_compression.hpp"

#include <algorithm>
#include <cmath>

#include "linalg/batched/simd_kernels.hpp"
#include "mottle/linalg/dense/decompositions.hpp"
#include "mottle/linalg/dense/products.hpp"

namespace mottle::linalg {
namespace {

/// Coordinates of the samples' modes, each over its largest residual allowed [vector x mode * sample].
Eigen::MatrixXd weighted_modes(const ReducedModel::Parts& parts, const TrainingSamples& samples,
                               const std::vector<Eigen::Index>& chosen) {
  constexpr double k_exact = 1e-6;  // residuals of which nothing but rounding errors are left
  const Eigen::Index modes = samples.shortfall.rows();
  Eigen::MatrixXd weighted(parts.vectors(), modes * static_cast<Eigen::Index>(chosen.size()));
  for (Eigen::Index c = 0; c < weighted.cols(); ++c) {
    const Eigen::Index s = chosen[static_cast<std::size_t>(c / modes)];
    const Eigen::Index k = c % modes;
    const double lambda = samples.values(k, s), square = std::max(lambda - parts.full->shift, 1e-300);
    const double least =
        k_exact * std::sqrt(parts.options.tolerance * std::max(lambda, parts.smallest_size()) / square);
    const double residual = samples.residuals.col(s * modes + k).norm();
    const double allowed = std::max(residual / std::max(samples.shortfall(k, s), 1e-3), least);
    weighted.col(c) = samples.coordinates.col(s * modes + k) / (std::sqrt(square) * allowed);
  }
  return weighted;
}

/// Principal directions of vectors, those with the least of them first.
Eigen::MatrixXd principal_directions(const Eigen::MatrixXd& vectors) {
  const Eigen::MatrixXd transposed = vectors.transpose();
  return SymmetricEigen(transposed_product(transposed, transposed)).eigenvectors();
}

/// Orthonormal directions that the samples or the reference pencils need; all where hardly any is needless.
///
/// @param neglect  part of a vector that no sample misses, over the largest residual allowed
Eigen::MatrixXd needed_directions(const ReducedModel::Parts& parts, const Eigen::MatrixXd& weighted, double neglect) {
  constexpr Eigen::Index k_worth = 20;  // at least a twentieth fewer vectors, or the rotation does not pay
  constexpr double k_lost = 0.03;       // neglected part of a reference pencil's mode
  Eigen::MatrixXd vectors(weighted.rows(), weighted.cols() + parts.reference_modes.cols());
  vectors << weighted, parts.reference_modes * (neglect / k_lost);
  const Eigen::MatrixXd directions = principal_directions(vectors);
  const Eigen::MatrixXd shares = transposed_product(directions, vectors).cwiseAbs2();
  Eigen::RowVectorXd neglected = Eigen::RowVectorXd::Zero(vectors.cols());
  Eigen::Index dropped = 0;
  for (; dropped + parts.solved_modes() < directions.cols(); ++dropped) {
    neglected += shares.row(dropped);
    if (neglected.maxCoeff() > neglect * neglect) break;
  }
  return directions.rightCols(k_worth * dropped > directions.cols() ? directions.cols() - dropped : directions.cols());
}

/// Lambda up to which the remaining directions hold the modes of each reference pencil.
///
/// A vector orthogonal to these has a part of at most d_j along the mode j of which the part d_j is missing, so that
/// its Rayleigh quotient is at least L / (1 + sum_{j < q} d_j^2 L / mu_j), L = mu_q: the best q is taken.
///
/// @param lost  d_j^2, of A-length [reference mode]
Eigen::VectorXd levels_without(const ReducedModel::Parts& parts, const Eigen::RowVectorXd& lost) {
  Eigen::VectorXd levels(static_cast<Eigen::Index>(parts.reference_pencils.size()));
  Eigen::Index first = 0;
  for (Eigen::Index f = 0; f < levels.size(); ++f) {
    const ReferencePencil& pencil = parts.reference_pencils[static_cast<std::size_t>(f)];
    const Eigen::MatrixXd modes = parts.reference_modes.middleCols(first, pencil.modes);
    const auto squares = [&](const std::vector<Eigen::MatrixXd>& terms, const Eigen::VectorXd& coefficients) {
      return modes.cwiseProduct(product(weighted_sum(terms, coefficients), modes)).colwise().sum().eval();
    };
    const Eigen::RowVectorXd inertial = squares(parts.mass, pencil.mass).cwiseMax(1e-300);
    const Eigen::RowVectorXd shifted = squares(parts.stiffness, pencil.stiffness) - parts.full->shift * inertial;
    const double largest = (pencil.stiffness.array() / parts.full->nominal_stiffness.array()).maxCoeff();
    double level = 0.0, sum = 0.0;
    for (Eigen::Index q = 0; q < pencil.modes; ++q) {
      const double mu = q + 1 < pencil.modes ? shifted(q) / inertial(q) : pencil.complete_to - parts.full->shift;
      level = std::max(level, mu / (1.0 + mu * sum));
      sum += largest * lost(first + q) / shifted(q) * inertial(q) / shifted(q);
    }
    levels(f) = std::min(pencil.complete_to, level + parts.full->shift);
    first += pencil.modes;
  }
  return levels;
}

/// Chosen samples whose modes are below the bound of the complement at these levels, with a margin.
Eigen::Array<bool, Eigen::Dynamic, 1> are_below(const ReducedModel::Parts& parts, const TrainingSamples& samples,
                                                const std::vector<Eigen::Index>& chosen,
                                                const Eigen::VectorXd& levels) {
  constexpr double k_margin = 1.1;
  ReducedModel::Parts bounding;
  bounding.full = parts.full;
  bounding.reference_pencils = with_levels(parts.reference_pencils, levels);
  const TermCoefficients& all = samples.coefficients();
  const Eigen::VectorXd bounds =
      bounding.complement_bounds({all.stiffness(Eigen::all, chosen), all.mass(Eigen::all, chosen)});
  return k_margin * samples.values.row(parts.converged_modes() - 1)(chosen).transpose().array() < bounds.array();
}

/// The leading directions with which the mean cost of a sample is least, those that need the whole basis included.
struct Leading {
  Eigen::MatrixXd directions;  ///< empty where they save too little
  Eigen::VectorXd levels;      ///< see levels_without
};

/// @param whole  number of vectors of the whole basis
Leading best_leading(const ReducedModel::Parts& parts, const TrainingSamples& samples,
                     const std::vector<Eigen::Index>& chosen, const Eigen::MatrixXd& weighted, Eigen::Index whole) {
  constexpr double k_worth = 0.9;
  constexpr double k_linear = 180.0;  // vectors at which costs that grow with the square are as large as the others
  constexpr double k_missed = 3.0;    // neglected squared part that tells best which samples exceed the tolerance
  constexpr Eigen::Index k_tile = simd_kernels::k_tile;
  const auto cost = [](Eigen::Index count) {
    const Eigen::Index order = (count + k_tile - 1) / k_tile * k_tile;
    const auto size = static_cast<double>(order);
    return size * (size + k_linear);
  };
  const auto count = static_cast<Eigen::Index>(chosen.size()), modes = samples.shortfall.rows();
  const Eigen::MatrixXd directions = principal_directions(weighted);
  const Eigen::MatrixXd shares = transposed_product(directions, weighted).cwiseAbs2();
  const Eigen::MatrixXd lost = transposed_product(directions, parts.reference_modes).cwiseAbs2();
  Leading best;
  double least = k_worth * cost(whole);
  for (Eigen::Index kept = k_tile; kept < whole; kept += k_tile) {
    if (kept < parts.solved_modes() || cost(kept) >= least) continue;
    const Eigen::Index dropped = directions.cols() - kept;
    const Eigen::ArrayXd neglected =
        shares.topRows(dropped).colwise().sum().reshaped(modes, count).colwise().maxCoeff();
    const Eigen::VectorXd levels = levels_without(parts, lost.topRows(dropped).colwise().sum());
    const auto good = ((neglected <= k_missed) && are_below(parts, samples, chosen, levels)).count();
    const double others = 1.0 - static_cast<double>(good) / static_cast<double>(count);
    const double expected = cost(kept) + others * cost(whole);
    if (expected >= least) continue;
    least = expected;
    best = {directions.rightCols(kept), levels};
  }
  return best;
}

}  // namespace

void compress(ReducedModel::Parts& parts, const TrainingSamples& samples, const std::vector<Eigen::Index>& chosen) {
  const Eigen::MatrixXd weighted = weighted_modes(parts, samples, chosen);
  constexpr double k_neglect = 0.5;
  constexpr double k_neglect_of_few = 0.2;  // a basis for few samples may be larger, and spare refinements
  Eigen::MatrixXd needed = needed_directions(parts, weighted, k_neglect);
  const Leading leading = best_leading(parts, samples, chosen, weighted, needed.cols());
  if (leading.directions.size() > 0) needed = needed_directions(parts, weighted, k_neglect_of_few);
  const Eigen::MatrixXd rotation = parts.rotation_to_nominal_modes(needed);
  parts.rotate(rotation);
  if (leading.directions.size() == 0) return;
  const Eigen::MatrixXd inside = orthonormal_columns(transposed_product(rotation, leading.directions));
  parts.make_leading(parts.rotation_to_nominal_modes(inside), leading.levels);
}

}  // namespace mottle::linalg
