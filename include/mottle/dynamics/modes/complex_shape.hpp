// A complex mode shape as the real one that it is nearest to.
#pragma once

#include <Eigen/Core>

#include "mottle/layers.hpp"

namespace mottle::dynamics {

/// A shape turned to the phase of best fit, and how well one phase fits it.
struct RealShape {
  Eigen::VectorXd shape;
  double collinearity = 1.0;  ///< modal phase collinearity, within [0, 1]: 1 where all components lie on one line
};

/// Turns a complex shape so that its real part is largest, and takes that part.
///
///   shape = Re(psi e^-it),   tan 2t = 2 Sxy / (Sxx - Syy)
///   MPC   = ((Sxx - Syy)^2 + 4 Sxy^2) / (Sxx + Syy)^2
///
/// with the sums Sxx, Syy, Sxy over squares and products of real and imaginary parts.
///
/// @param shape  psi [degree of freedom]; a zero shape is collinear
/// Source: [Pappa1993].
RealShape nearest_real_shape(const Eigen::Ref<const Eigen::VectorXcd>& shape);

}  // namespace mottle::dynamics
