#include "mottle/dynamics/modes/complex_shape.hpp"

#include <cmath>
#include <complex>

namespace mottle::dynamics {

RealShape nearest_real_shape(const Eigen::Ref<const Eigen::VectorXcd>& shape) {
  const double xx = shape.real().squaredNorm();
  const double yy = shape.imag().squaredNorm();
  const double xy = shape.real().dot(shape.imag());
  if (xx + yy == 0.0) return {shape.real(), 1.0};
  const double phase = 0.5 * std::atan2(2.0 * xy, xx - yy);
  const double split = std::hypot(xx - yy, 2.0 * xy) / (xx + yy);
  return {(shape * std::polar(1.0, -phase)).real(), split * split};
}

}  // namespace mottle::dynamics
