// Derivatives of eigenvalues and mass-normalised shapes with respect to a parameter.
#pragma once

#include <Eigen/Core>
#include <vector>

#include "mottle/dynamics/modes/mode_set.hpp"
#include "mottle/layers.hpp"
#include "mottle/linalg/sparse/symmetric_factor.hpp"

namespace mottle::dynamics {

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

/// The same from the products dK Phi and dM Phi [degree of freedom x mode], for matrices that are not full.
Eigen::VectorXd eigenvalue_sensitivity_from_products(const ModeSet& modes,
                                                     const Eigen::Ref<const Eigen::MatrixXd>& dK_shapes,
                                                     const Eigen::Ref<const Eigen::MatrixXd>& dM_shapes);

/// The same for several parameters from the forms phi_r' dK phi_r and phi_r' dM phi_r [mode x parameter].
Eigen::MatrixXd eigenvalue_sensitivity_from_forms(const Eigen::VectorXd& eigenvalues,
                                                  const Eigen::Ref<const Eigen::MatrixXd>& dK_forms,
                                                  const Eigen::Ref<const Eigen::MatrixXd>& dM_forms);

/// Derivatives of an eigenvalue that is repeated, for one parameter: the values into which it splits.
///
///   eigenvalues of Phi' (dK - lambda dM) Phi,   Phi = the shapes that share lambda
///
/// @param modes      mass-normalised
/// @param members    the modes that share one eigenvalue
/// @param dK_shapes, dM_shapes  dK Phi and dM Phi of those modes [degree of freedom x member]
/// @return           [member], ascending, (rad/s)^2 per unit of the parameter
/// Source: [Friswell1995], section 2.6.
Eigen::VectorXd repeated_eigenvalue_sensitivity(const ModeSet& modes, const std::vector<int>& members,
                                                const Eigen::Ref<const Eigen::MatrixXd>& dK_shapes,
                                                const Eigen::Ref<const Eigen::MatrixXd>& dM_shapes);

/// Derivative of one mass-normalised shape with respect to every parameter, exact from that mode alone.
///
///   (K - lambda M) v = -(dK - lambda dM - dlambda M) phi  with v = 0 where phi is largest
///   d phi = v + c phi,   c = -phi' M v - phi' dM phi / 2
///
/// @param stiffness, mass  lower triangles [degree of freedom x degree of freedom]
/// @param modes            mass-normalised; only `mode` and, to see whether it is repeated, the eigenvalues are used
/// @param dK_shape, dM_shape  dK phi and dM phi [degree of freedom x parameter]
/// @return                 [degree of freedom x parameter]; nan for a repeated eigenvalue (relative gap below 1e-10)
/// Source: [Nelson1976].
Eigen::MatrixXd nelson_shape_sensitivity(const SparseMatrix& stiffness, const SparseMatrix& mass, const ModeSet& modes,
                                         int mode, const Eigen::Ref<const Eigen::MatrixXd>& dK_shape,
                                         const Eigen::Ref<const Eigen::MatrixXd>& dM_shape);

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

}  // namespace mottle::dynamics
