// Which residuals of the training samples enlarge the basis, and which of its directions are kept.
#include <Eigen/Eigenvalues>
#include <algorithm>
#include <cmath>

#include "blas.hpp"
#include "reduced_model_parts.hpp"

namespace mottle {
namespace {

constexpr double k_guard_residual = 0.1;  // relative residual that is good enough for a guard mode

/// How far each (mode, sample) is from what is wanted: above 1 it needs more. [mode and guards x sample]
Eigen::MatrixXd shortfalls(const Eigen::MatrixXd& bounds, const Eigen::MatrixXd& residuals, double target) {
  constexpr double k_most = 100.0;
  const Eigen::Index modes = residuals.cols() / bounds.cols();
  Eigen::MatrixXd result(modes, bounds.cols());
  for (Eigen::Index s = 0; s < bounds.cols(); ++s) {
    for (Eigen::Index k = 0; k < modes; ++k) {
      result(k, s) = k < bounds.rows() ? std::min(std::sqrt(bounds(k, s) / target), k_most)
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

/// K(s) u - lambda M(s) u of the picked modes [equation x pick].
Eigen::MatrixXd full_residuals(const FullPencils& full, const TermCoefficients& samples, const std::vector<Pick>& picks,
                               const Eigen::MatrixXd& shapes, const Eigen::VectorXd& values) {
  const auto count = static_cast<Eigen::Index>(picks.size());
  const VectorRows u = to_rows(shapes);
  VectorRows result = VectorRows::Zero(u.rows(), u.cols());
  const auto add = [&](const std::vector<SupportedMatrix>& terms, const Eigen::MatrixXd& coefficients, bool is_mass) {
    for (std::size_t t = 0; t < terms.size(); ++t) {
      if (terms[t].is_empty()) continue;
      Eigen::VectorXd scales = Eigen::VectorXd::Zero(u.cols());
      for (Eigen::Index c = 0; c < count; ++c) {
        const Eigen::Index s = picks[static_cast<std::size_t>(c)].sample;
        scales(c) = t == 0 ? 1.0 : coefficients(static_cast<Eigen::Index>(t) - 1, s);
        if (is_mass) scales(c) *= -values(c);
      }
      terms[t].add_scaled_product(u, scales, result);
    }
  };
  add(full.stiffness, samples.stiffness, false);
  add(full.mass, samples.mass, true);
  return result.leftCols(count);
}

}  // namespace

void ReducedModel::train(const TermCoefficients& samples, int threads) {
  constexpr Eigen::Index k_first_samples = 64;
  constexpr int k_rounds = 30;
  constexpr double k_good_enough = 1.3;  // times half the tolerance, squared: within it, and no more rounds for a few
  constexpr Eigen::Index k_most_picks = 48;
  Parts& parts = *parts_;
  const double target = 0.5 * parts.options.tolerance;
  const Eigen::Index most_picks = std::min<Eigen::Index>(k_most_picks, Eigen::Index{4} * parts.options.modes);
  parts.raise_floor(samples, threads);
  Eigen::Index used = std::min(samples.samples(), k_first_samples);
  for (int round = 0; round < k_rounds; ++round) {
    const TermCoefficients now = samples.range(0, used);
    const Parts::Solution solution = parts.solve(now, true, threads);
    const Eigen::MatrixXd wants = shortfalls(solution.bounds, solution.residuals, target);
    const Eigen::Index room = parts.options.most_vectors - parts.basis.cols();
    const std::vector<Pick> picks = pick_residuals(solution.residuals, wants, std::min(most_picks, room));
    const bool is_good = used == samples.samples() && wants.maxCoeff() < k_good_enough;
    if (is_good) parts.compress(solution, wants);
    if (is_good || (picks.empty() && used == samples.samples()) || room <= 0) break;
    used = std::min(2 * used, samples.samples());
    if (picks.empty()) continue;
    Eigen::MatrixXd coordinates(parts.basis.cols(), static_cast<Eigen::Index>(picks.size()));
    Eigen::VectorXd values(coordinates.cols());
    for (Eigen::Index c = 0; c < values.size(); ++c) {
      const Pick& pick = picks[static_cast<std::size_t>(c)];
      values(c) = solution.values(pick.mode, pick.sample);
      coordinates.col(c) =
          solution.vectors.col(pick.sample).segment(pick.mode * parts.basis.cols(), parts.basis.cols());
    }
    const Eigen::MatrixXd shapes = product(parts.basis, coordinates);
    const Eigen::MatrixXd residuals = full_residuals(*parts.full, now, picks, shapes, values);
    Eigen::MatrixXd answers = residuals;
    parts.full->solver.factor().solve(answers);
    parts.append(std::move(answers), residuals);
  }
}

/// Drops the directions that no training sample needs: the basis grew by what was missing at the time.
void ReducedModel::Parts::compress(const Solution& solution, const Eigen::MatrixXd& wants) {
  constexpr Eigen::Index k_worth = 10;  // a tenth fewer pay for the turning
  constexpr double k_neglect = 0.3;     // of the residual that would be just good enough
  const Eigen::Index vectors = basis.cols();
  const Eigen::Index columns = wants.size();
  Eigen::MatrixXd weighted(vectors, columns + floor_modes.cols());
  weighted.rightCols(floor_modes.cols()) = floor_modes / k_guard_residual;
  for (Eigen::Index s = 0; s < wants.cols(); ++s) {
    for (Eigen::Index k = 0; k < wants.rows(); ++k) {
      const Eigen::Index c = s * wants.rows() + k;
      const double allowed = solution.residuals.col(c).norm() / std::max(wants(k, s), 1e-3);
      const double length = std::sqrt(std::max(solution.values(k, s) - full->shift, 0.0));
      const auto y = solution.vectors.col(s).segment(k * vectors, vectors);
      weighted.col(c) = y / std::max(length * allowed, 1e-300);
    }
  }
  const Eigen::MatrixXd transposed = weighted.transpose();
  const Eigen::SelfAdjointEigenSolver<Eigen::MatrixXd> solver(transposed_product(transposed, transposed));
  const Eigen::MatrixXd parts = transposed_product(solver.eigenvectors(), weighted).cwiseAbs2();
  Eigen::RowVectorXd neglected = Eigen::RowVectorXd::Zero(weighted.cols());
  Eigen::Index dropped = 0;
  for (; dropped + solved_modes() < vectors; ++dropped) {
    neglected += parts.row(dropped);
    if (neglected.maxCoeff() > k_neglect * k_neglect) break;
  }
  if (k_worth * dropped > vectors) rotate(solver.eigenvectors().rightCols(vectors - dropped));
}

}  // namespace mottle
