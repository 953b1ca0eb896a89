// Fisher's information on a population's covariance.
#include <Eigen/Core>
#include <cmath>

#include "mottle/linalg/dense/decompositions.hpp"
#include "mottle/stats/population/random_effects.hpp"
#include "stats/population/random_effects_step.hpp"

namespace mottle::stats {
namespace {

using Entries = std::vector<std::pair<Eigen::Index, Eigen::Index>>;

/// left E right' for E = e_i e_j' + e_j e_i', or e_i e_i'; left and right have columns of effects.
Eigen::MatrixXd sandwich(const Eigen::MatrixXd& left, const Eigen::MatrixXd& right,
                         const std::pair<Eigen::Index, Eigen::Index>& entry) {
  const auto [i, j] = entry;
  Eigen::MatrixXd product = left.col(i) * right.col(j).transpose();
  if (i != j) product += left.col(j) * right.col(i).transpose();
  return product;
}

/// tr(m E), m symmetric.
double trace_with(const Eigen::MatrixXd& m, const std::pair<Eigen::Index, Eigen::Index>& entry) {
  const auto [i, j] = entry;
  return i == j ? m(i, i) : 2.0 * m(i, j);
}

Eigen::MatrixXd expected_information(const RandomEffectsPass& pass, const Entries& entries) {
  const Eigen::Index q = pass.mean.size();
  const Eigen::Index common = pass.information.rows();
  const bool removes = pass.removed_variance.size() > 0;
  const auto count = static_cast<Eigen::Index>(entries.size());
  Eigen::MatrixXd information = Eigen::MatrixXd::Zero(count, count);
  std::vector<Eigen::MatrixXd> sums(entries.size(), Eigen::MatrixXd::Zero(common, common));
  for (const RandomEffectsPass::Unit& unit : pass.units) {
    Eigen::MatrixXd twice = Eigen::MatrixXd::Zero(q, q);
    if (removes) twice = unit.seen_common() * pass.removed_variance * unit.common_seen();
    for (Eigen::Index a = 0; a < count; ++a) {
      const auto& entry = entries[static_cast<std::size_t>(a)];
      Eigen::MatrixXd product = sandwich(unit.seen, unit.seen, entry);
      sums[static_cast<std::size_t>(a)] +=
          unit.has_shared ? sandwich(unit.shared_seen, unit.shared_seen, entry) : product;
      const Eigen::MatrixXd mixed = sandwich(unit.seen, twice, entry);
      product -= mixed + mixed.transpose();
      for (Eigen::Index b = 0; b <= a; ++b) {
        information(a, b) += 0.5 * trace_with(product, entries[static_cast<std::size_t>(b)]);
      }
    }
  }
  if (removes) {
    for (Eigen::MatrixXd& sum : sums) sum = (pass.removed_variance * sum).eval();
    for (Eigen::Index a = 0; a < count; ++a) {
      for (Eigen::Index b = 0; b <= a; ++b) {
        const Eigen::MatrixXd& other = sums[static_cast<std::size_t>(b)];
        information(a, b) += 0.5 * sums[static_cast<std::size_t>(a)].cwiseProduct(other.transpose()).sum();
      }
    }
  }
  information.triangularView<Eigen::StrictlyUpper>() = information.transpose();
  return information;
}

/// Inverse of a positive semi-definite matrix; what it does not determine gets a variance of 1e12.
Eigen::MatrixXd inverse_of(const Eigen::MatrixXd& information) {
  constexpr double k_unseen = 1e-12;
  const Eigen::VectorXd scale = information.diagonal().cwiseMax(1e-300).cwiseSqrt().cwiseInverse();
  const SymmetricEigen solver(scale.asDiagonal() * information * scale.asDiagonal());
  const Eigen::VectorXd inverse = solver.eigenvalues().cwiseMax(k_unseen).cwiseInverse();
  const Eigen::MatrixXd turned = scale.asDiagonal() * solver.eigenvectors();
  return turned * inverse.asDiagonal() * turned.transpose();
}

}  // namespace

double RandomEffectsInformation::variance_of(const Eigen::Ref<const Eigen::VectorXd>& a,
                                             const Eigen::Ref<const Eigen::VectorXd>& b) const {
  Eigen::VectorXd weights(static_cast<Eigen::Index>(entries.size()));
  for (std::size_t k = 0; k < entries.size(); ++k) {
    const auto [i, j] = entries[k];
    weights(static_cast<Eigen::Index>(k)) = i == j ? a(i) * b(i) : a(i) * b(j) + a(j) * b(i);
  }
  return weights.dot(entry_covariance * weights);
}

RandomEffectsInformation random_effects_information(const std::vector<RandomEffectsUnit>& units,
                                                    const RandomEffectsFit& fit,
                                                    const RandomEffectsSettings& settings) {
  const RandomEffectsPass pass(units, fit.covariance, fit.noise_factors, at_levels(settings, fit.levels));
  const Eigen::Index q = fit.mean.size();
  RandomEffectsInformation result;
  Eigen::MatrixXd from_effects = Eigen::MatrixXd::Zero(pass.information.rows(), pass.information.rows());
  Eigen::MatrixXd from_noise = from_effects;
  for (const RandomEffectsPass::Unit& unit : pass.units) {
    from_effects += unit.common_seen() * fit.covariance * unit.seen_common();
    from_noise += unit.common_weighted() * unit.noise.asDiagonal() * unit.common_weighted().transpose();
  }
  const Eigen::MatrixXd& m = pass.common_variance;
  result.mean_from_effects = (m * from_effects * m).topLeftCorner(q, q);
  result.mean_from_noise = (m * from_noise * m).topLeftCorner(q, q);
  for (Eigen::Index i = 0; i < q; ++i) {
    for (Eigen::Index j = 0; j <= i; ++j) {
      if (may_be_correlated(settings, i, j)) result.entries.emplace_back(i, j);
    }
  }
  result.entry_covariance = inverse_of(expected_information(pass, result.entries));
  return result;
}

}  // namespace mottle::stats
