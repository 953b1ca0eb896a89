#include "mottle/dynamics/modes/mode_set.hpp"

#include <cmath>
#include <limits>
#include <numbers>

namespace mottle::dynamics {

double natural_frequency_hz(double eigenvalue, double scale) {
  constexpr double k_rounding = 1e-7;  // 5e-9 is seen in matrices that a program wrote as text
  if (eigenvalue >= 0.0) return std::sqrt(eigenvalue) / (2.0 * std::numbers::pi);
  return eigenvalue >= -k_rounding * scale ? 0.0 : std::numeric_limits<double>::quiet_NaN();
}

Eigen::VectorXd natural_frequencies_hz(const Eigen::Ref<const Eigen::VectorXd>& eigenvalues) {
  if (eigenvalues.size() == 0) return {};
  const double scale = eigenvalues.cwiseAbs().maxCoeff();
  return eigenvalues.unaryExpr([&](double eigenvalue) { return natural_frequency_hz(eigenvalue, scale); });
}

}  // namespace mottle::dynamics
