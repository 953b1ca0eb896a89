#include "mottle/dynamics/modes/mode_set.hpp"

#include <cmath>
#include <limits>
#include <numbers>

namespace mottle::dynamics {

double natural_frequency_hz(double eigenvalue, double scale) {
  if (eigenvalue >= 0.0) return std::sqrt(eigenvalue) / (2.0 * std::numbers::pi);
  return eigenvalue >= -k_eigenvalue_rounding * scale ? 0.0 : std::numeric_limits<double>::quiet_NaN();
}

Eigen::VectorXd natural_frequencies_hz(const Eigen::Ref<const Eigen::VectorXd>& eigenvalues) {
  if (eigenvalues.size() == 0) return {};
  const double scale = eigenvalues.cwiseAbs().maxCoeff();
  return eigenvalues.unaryExpr([&](double eigenvalue) { return natural_frequency_hz(eigenvalue, scale); });
}

}  // namespace mottle::dynamics
