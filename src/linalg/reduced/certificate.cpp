#include "linalg/reduced/certificate.hpp"

#include <algorithm>
#include <cmath>
#include <limits>

namespace mottle::linalg {
namespace {

// Above these limits the space does not resolve the spectrum (residual) or the mode (bound): a Ritz value then proves
// nothing about the next eigenvalue.
constexpr double k_largest_residual = 0.1;  // squared
constexpr double k_largest_bound = 0.01;
constexpr double k_infinite = std::numeric_limits<double>::infinity();

/// Lower bound of the eigenvalue p + 1, from its Ritz value with squared residual and from the complement's bound: the
/// smaller of the two, less the effect of their coupling, which is at most the residual's norm, or its square over the
/// gap between them. The gap is taken as at most a quarter, for further modes of the complement.
double next_eigenvalue(double value, double square, double complement_bound) {
  constexpr double k_gap = 0.25;
  if (!(square <= k_largest_residual)) return 0.0;
  const double lowest = std::min(value, complement_bound);
  const double gap = std::min(k_gap, 1.0 - lowest / std::max(value, complement_bound));
  const double hidden = std::min(std::sqrt(square), gap > 0.0 ? square / gap : k_infinite);
  return lowest * (1.0 - hidden);
}

/// The root e of sum w_j / (e + d_j) = 1, d_0 = 0, from above: e <- sum w_j e / (e + d_j) falls towards it.
double secular_root(const Eigen::Ref<const Eigen::ArrayXd>& weights,
                    const Eigen::Ref<const Eigen::ArrayXd>& distances) {
  constexpr int k_steps = 6;
  double root = weights.sum();
  for (int step = 0; step < k_steps && root > 0.0 && root < k_infinite; ++step) {
    const double next = (weights * root / (root + distances)).sum();
    if (next > 0.99 * root) break;
    root = next;
  }
  return root;
}

}  // namespace

Eigen::VectorXd error_bounds(const Eigen::Ref<const Eigen::VectorXd>& values,
                             const Eigen::Ref<const Eigen::VectorXd>& squares, double complement_bound,
                             Eigen::Index wanted, double enough) {
  const Eigen::Index known = values.size();
  Eigen::VectorXd bounds = Eigen::VectorXd::Constant(wanted, k_infinite);
  Eigen::ArrayXd weights(known);
  Eigen::ArrayXd distances(known);
  for (Eigen::Index p = 0; p + 1 < known; ++p) {
    const double next = next_eigenvalue(values(p + 1), squares(p + 1), complement_bound);
    if (!(next > values(p))) continue;
    for (Eigen::Index k = 0; k <= std::min(p, wanted - 1); ++k) {
      if (!(values(k) > 0.0) || bounds(k) < enough) continue;
      // The mode's own weight: the root is no less.
      if (!(squares(k) / (1.0 - values(k) / next) < std::min(bounds(k), k_largest_bound))) continue;
      const Eigen::Index count = p - k + 1;
      for (Eigen::Index j = 0; j < count; ++j) {
        const double near = std::min(values(k) / values(k + j), 1.0);  // equal values may be out of order by rounding
        weights(j) = near * squares(k + j) / (1.0 - values(k + j) / next);
        distances(j) = 1.0 - near;
      }
      const double bound = secular_root(weights.head(count), distances.head(count));
      if (bound <= k_largest_bound) bounds(k) = std::min(bounds(k), bound);
    }
  }
  return bounds;
}

}  // namespace mottle::linalg
