// Modal damping ratios of a viscously damped structure.
#pragma once

#include <Eigen/Core>

#include "mottle/dynamics/modes/mode_set.hpp"
#include "mottle/layers.hpp"

namespace mottle::dynamics {

/// Damping ratio of each mode, from the eigenvalues mu of the damped structure, damping of any pattern.
///
///   (mu^2 M + mu C + K) psi = 0,   zeta = -Re(mu) / |mu|
///
/// Each damped mode is given to the undamped mode with which its shape has the highest MAC (optimal assignment).
///
/// @param modes    all undamped modes, mass-normalised, eigenvalues > 0
/// @param damping  C [degree of freedom x degree of freedom], N s/m
/// @return         [mode], dimensionless; nan for a mode that does not oscillate (overdamped)
Eigen::VectorXd modal_damping_ratios(const ModeSet& modes, const Eigen::Ref<const Eigen::MatrixXd>& damping);

}  // namespace mottle::dynamics
