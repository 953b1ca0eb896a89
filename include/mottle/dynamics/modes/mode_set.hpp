// Modes of one structure and the conversions between eigenvalue and natural frequency.
#pragma once

#include <Eigen/Core>

#include "mottle/layers.hpp"

namespace mottle::dynamics {

/// Modes of K phi = lambda M phi, ascending.
struct ModeSet {
  Eigen::VectorXd eigenvalues;  ///< lambda = omega^2, (rad/s)^2 [mode]
  Eigen::MatrixXd shapes;       ///< mass-normalised [degree of freedom x mode]
};

/// Part of the scale that an eigenvalue may be off by rounding: 5e-9 is seen in matrices that a program wrote as text.
inline constexpr double k_eigenvalue_rounding = 1e-7;

/// f = sqrt(lambda) / (2 pi) in Hz. An eigenvalue that is negative by rounding alone counts as zero.
///
/// @param eigenvalue  lambda, (rad/s)^2
/// @param scale       size of a typical eigenvalue; -1e-7 scale <= lambda < 0 counts as rounding
/// @return            Hz, or nan where lambda is truly negative (the structure is unstable)
double natural_frequency_hz(double eigenvalue, double scale);
/// The same of all eigenvalues of a structure, whose largest is the scale [mode].
Eigen::VectorXd natural_frequencies_hz(const Eigen::Ref<const Eigen::VectorXd>& eigenvalues);

}  // namespace mottle::dynamics
