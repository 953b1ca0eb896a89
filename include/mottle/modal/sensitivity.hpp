// Derivatives of eigenvalues and mass-normalised shapes with respect to a parameter.
#pragma once

#include <Eigen/Core>

#include "mottle/modal/mode_set.hpp"

namespace mottle {

/// Derivative of distinct eigenvalues.
///
///   d lambda_r = phi_r' (dK - lambda_r dM) phi_r
///
/// @param modes     mass-normalised
/// @param dK, dM    derivatives of stiffness and mass [degree of freedom x degree of freedom]
/// @return          [mode], (rad/s)^2 per unit of the parameter; nan for repeated eigenvalues (relative gap below
/// 1e-10) Source: [Fox1968], Eq. 7.
Eigen::VectorXd eigenvalue_sensitivity(const ModeSet& modes, const Eigen::Ref<const Eigen::MatrixXd>& dK,
                                       const Eigen::Ref<const Eigen::MatrixXd>& dM);

/// Derivative of mass-normalised shapes with distinct eigenvalues, by expansion in all modes.
///
///   d phi_r = sum_{s != r} phi_s (phi_s' (dK - lambda_r dM) phi_r) / (lambda_r - lambda_s) - phi_r (phi_r' dM phi_r) /
///   2
///
/// @param modes  all modes of the structure (exact only then)
/// @return       [degree of freedom x mode]; columns of repeated eigenvalues (relative gap below 1e-10) are nan
/// Source: [Fox1968], second formulation.
Eigen::MatrixXd shape_sensitivity(const ModeSet& modes, const Eigen::Ref<const Eigen::MatrixXd>& dK,
                                  const Eigen::Ref<const Eigen::MatrixXd>& dM);

}  // namespace mottle
