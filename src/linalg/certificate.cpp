#include "certificate.hpp"

#include <algorithm>
#include <cmath>
#include <limits>

namespace mottle {
namespace {

// A residual this large says that the space does not know the spectrum there, and a bound this large that it does not
// know the mode: what seems to keep away may hide another mode.
constexpr double k_largest_residual = 0.1;  // squared
constexpr double k_largest_bound = 0.01;

/// By how much of itself an eigenvalue may lie below its Ritz value when all that is known is its residual: the smaller
/// of the linear bound and the quadratic one with a gap of a quarter; all of it where the residual is large.
double hidden_part(double squared_residual) {
  constexpr double k_gap = 0.25;
  if (!(squared_residual <= k_largest_residual)) return 1.0;
  return std::min(std::sqrt(squared_residual), squared_residual / k_gap);
}

}  // namespace

Eigen::VectorXd error_bounds(const Eigen::Ref<const Eigen::VectorXd>& values,
                             const Eigen::Ref<const Eigen::MatrixXd>& gram, Eigen::Index wanted) {
  const Eigen::Index known = values.size();
  Eigen::VectorXd bounds = Eigen::VectorXd::Constant(wanted, std::numeric_limits<double>::infinity());
  for (Eigen::Index k = 0; k < wanted; ++k) {
    const double own = gram(k, k) / values(k);
    double coupling = 0.0;  // with modes that are closer than they are coupled, for a gap of one
    double squares = 0.0;   // with the others, second order
    const auto couple = [&](Eigen::Index j) {
      const double c = std::abs(gram(k, j)) * std::sqrt(values(k) / values(j)) / values(j);
      const double distance = std::abs(1.0 - values(k) / values(j));
      if (c < distance) {
        squares += c * c / distance;
      } else {
        coupling += c;
      }
    };
    for (Eigen::Index j = 0; j < k; ++j) couple(j);
    for (Eigen::Index p = k; p + 1 < known; ++p) {
      if (p > k) couple(p);
      const double next = values(p + 1) * (1.0 - hidden_part(gram(p + 1, p + 1) / values(p + 1)));
      const double gap = 1.0 - values(k) / next;
      if (!(next > values(k))) continue;
      const double bound = (own + coupling + squares / gap) / gap;
      if (bound <= k_largest_bound) bounds(k) = std::min(bounds(k), bound);
    }
  }
  return bounds;
}

}  // namespace mottle
