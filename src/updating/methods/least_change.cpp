#include "updating/methods/least_change.hpp"

#include <Eigen/Core>
#include <algorithm>
#include <cmath>

#include "mottle/linalg/dense/decompositions.hpp"
#include "mottle/stats/moments/descriptive.hpp"

namespace mottle::updating {
namespace {

constexpr double k_unseen = 1e-6;       // as Identifiability counts
constexpr double k_min_damping = 1e-3;  // below, the step is Gauss-Newton's

bool is_one_group(const std::vector<int>& groups) {
  for (const int group : groups) {
    if (group != groups.front()) return false;
  }
  return true;
}

bool are_together(const std::vector<int>& groups, Eigen::Index i, Eigen::Index j) {
  return groups.empty() || groups[static_cast<std::size_t>(i)] == groups[static_cast<std::size_t>(j)];
}

/// The lower triangle by columns, entries off the diagonal times sqrt 2: its length is the Frobenius norm.
Eigen::VectorXd half_vectorised(const Eigen::Ref<const Eigen::MatrixXd>& symmetric) {
  Eigen::VectorXd vector(symmetric.rows() * (symmetric.rows() + 1) / 2);
  Eigen::Index at = 0;
  for (Eigen::Index j = 0; j < symmetric.cols(); ++j) {
    vector(at++) = symmetric(j, j);
    for (Eigen::Index i = j + 1; i < symmetric.rows(); ++i) vector(at++) = std::sqrt(2.0) * symmetric(i, j);
  }
  return vector;
}

}  // namespace

Gain least_change_gain(const Eigen::Ref<const Eigen::MatrixXd>& whitened,
                       const Eigen::Ref<const Eigen::VectorXd>& standard_deviation, double damping) {
  const SingularValues svd(whitened * standard_deviation.asDiagonal(), Eigen::ComputeThinU | Eigen::ComputeThinV);
  const Eigen::VectorXd& values = svd.values();
  Eigen::VectorXd inverse = Eigen::VectorXd::Zero(values.size());
  Gain gain;
  for (Eigen::Index i = 0; i < values.size(); ++i) {
    if (!(values(i) > k_unseen * values(0))) continue;
    ++gain.rank;
    inverse(i) = values(i) / (values(i) * values(i) + damping * damping * values(0) * values(0));
  }
  gain.matrix = standard_deviation.asDiagonal() * svd.right() * inverse.asDiagonal() * svd.left().transpose();
  return gain;
}

Eigen::VectorXd least_change_step(const ScaledParameters& parameters, const Eigen::Ref<const Eigen::VectorXd>& point,
                                  const Eigen::Ref<const Eigen::MatrixXd>& whitened,
                                  const Eigen::Ref<const Eigen::VectorXd>& residual, double damping) {
  const Eigen::VectorXi active = parameters.active_bounds(point);
  const Eigen::VectorXd descent = whitened.transpose() * residual;
  std::vector<Eigen::Index> free;
  for (Eigen::Index i = 0; i < point.size(); ++i) {
    if (active(i) * descent(i) <= 0.0) free.push_back(i);
  }
  Eigen::VectorXd step = Eigen::VectorXd::Zero(point.size());
  while (!free.empty()) {
    const Eigen::MatrixXd seen = whitened(Eigen::all, free);
    const Eigen::VectorXd standard_deviation = parameters.standard_deviation()(free);
    const Gain gain = least_change_gain(seen, standard_deviation, damping);
    Eigen::VectorXd move = gain.matrix * residual;
    if (gain.rank < seen.cols()) {
      const Eigen::VectorXd back = (parameters.start() - point)(free);
      move += (back - least_change_gain(seen, standard_deviation).matrix * (seen * back)) /
              ((1.0 + damping) * (1.0 + damping));
    }
    std::vector<Eigen::Index> inside;
    for (std::size_t k = 0; k < free.size(); ++k) {
      if (active(free[k]) * move(static_cast<Eigen::Index>(k)) <= 0.0) inside.push_back(free[k]);
    }
    if (inside.size() == free.size()) {
      step(free) = move;
      break;
    }
    free = std::move(inside);
  }
  return step;
}

Eigen::VectorXd trusted_step(const ScaledParameters& parameters, const Eigen::Ref<const Eigen::VectorXd>& point,
                             const Eigen::Ref<const Eigen::MatrixXd>& whitened,
                             const Eigen::Ref<const Eigen::VectorXd>& residual, double& damping) {
  constexpr double k_longest = 2.0;
  constexpr double k_raise = 3.0;
  constexpr double k_max = 1e6;
  while (true) {
    Eigen::VectorXd step = least_change_step(parameters, point, whitened, residual, damping);
    const double length = (step.array().abs() / parameters.standard_deviation().array()).maxCoeff();
    if (length <= k_longest) return step;
    if (damping > k_max) return step * (k_longest / length);
    damping = std::max(k_raise * damping, k_min_damping);
  }
}

double next_damping(double damping, bool has_helped) {
  if (!has_helped) return std::max(10.0 * damping, 10.0 * k_min_damping);
  return damping <= k_min_damping ? 0.0 : 0.1 * damping;
}

Eigen::MatrixXd least_change_covariance(const Eigen::Ref<const Eigen::MatrixXd>& whitened,
                                        const Eigen::Ref<const Eigen::VectorXd>& standard_deviation,
                                        const Eigen::Ref<const Eigen::MatrixXd>& change, const std::vector<int>& groups,
                                        double damping) {
  if (is_one_group(groups)) {
    const Eigen::MatrixXd gain = least_change_gain(whitened, standard_deviation, damping).matrix;
    const Eigen::MatrixXd result = gain * change * gain.transpose();
    return 0.5 * (result + result.transpose());
  }
  const Eigen::MatrixXd scaled = whitened * standard_deviation.asDiagonal();
  std::vector<std::pair<Eigen::Index, Eigen::Index>> entries;
  for (Eigen::Index i = 0; i < scaled.cols(); ++i) {
    for (Eigen::Index j = 0; j <= i; ++j) {
      if (are_together(groups, i, j)) entries.emplace_back(i, j);
    }
  }
  Eigen::MatrixXd effect(change.rows() * (change.rows() + 1) / 2, static_cast<Eigen::Index>(entries.size()));
  for (Eigen::Index k = 0; k < effect.cols(); ++k) {
    const auto [i, j] = entries[static_cast<std::size_t>(k)];
    const Eigen::MatrixXd product = scaled.col(i) * scaled.col(j).transpose();
    effect.col(k) =
        i == j ? half_vectorised(product) : half_vectorised((product + product.transpose()) / std::sqrt(2.0));
  }
  Eigen::VectorXd wanted = half_vectorised(change);
  if (damping > 0.0) {  // ridge rows
    const double largest = effect.colwise().norm().maxCoeff();
    const Eigen::Index rows = effect.rows();
    effect.conservativeResize(rows + effect.cols(), Eigen::NoChange);
    effect.bottomRows(effect.cols()) = damping * largest * Eigen::MatrixXd::Identity(effect.cols(), effect.cols());
    wanted.conservativeResize(effect.rows());
    wanted.tail(effect.cols()).setZero();
  }
  const Eigen::VectorXd solution = LeastNormSolver(effect, k_unseen * k_unseen).solve(wanted);
  Eigen::MatrixXd result = Eigen::MatrixXd::Zero(scaled.cols(), scaled.cols());
  for (Eigen::Index k = 0; k < solution.size(); ++k) {
    const auto [i, j] = entries[static_cast<std::size_t>(k)];
    result(i, j) = result(j, i) =
        standard_deviation(i) * standard_deviation(j) * (i == j ? solution(k) : solution(k) / std::sqrt(2.0));
  }
  return result;
}

void keep_groups(Eigen::MatrixXd& covariance, const std::vector<int>& groups) {
  for (Eigen::Index j = 0; j < covariance.cols(); ++j) {
    for (Eigen::Index i = 0; i < covariance.rows(); ++i) {
      if (!are_together(groups, i, j)) covariance(i, j) = 0.0;
    }
  }
}

bool project_to_covariance(Eigen::MatrixXd& covariance, const Eigen::Ref<const Eigen::VectorXd>& standard_deviation,
                           const std::vector<int>& groups) {
  constexpr double k_rounding = 1e-12;
  const Eigen::MatrixXd scaled =
      standard_deviation.cwiseInverse().asDiagonal() * covariance * standard_deviation.cwiseInverse().asDiagonal();
  const SymmetricEigen eigen(scaled);
  if (eigen.eigenvalues()(0) >= 0.0) {
    repair_covariance(covariance);
    return false;
  }
  const Eigen::VectorXd kept = eigen.eigenvalues().cwiseMax(0.0);
  const Eigen::MatrixXd rebuilt = standard_deviation.asDiagonal() *
                                  (eigen.eigenvectors() * kept.asDiagonal() * eigen.eigenvectors().transpose()).eval() *
                                  standard_deviation.asDiagonal();
  covariance = 0.5 * (rebuilt + rebuilt.transpose());
  keep_groups(covariance, groups);
  // What is rounding in prior deviations need not be so for a parameter that hardly scatters.
  repair_covariance(covariance);
  return eigen.eigenvalues()(0) < -k_rounding * eigen.eigenvalues().cwiseAbs().maxCoeff();
}

}  // namespace mottle::updating
