// The lowest modes of one dense symmetric pencil. For many pencils of one family see batch_eigen.hpp.
#pragma once

#include <Eigen/Core>

namespace mottle::linalg {

/// Modes of one pencil, in ascending order of the eigenvalue.
struct DenseModes {
  Eigen::VectorXd values;   ///< [mode]
  Eigen::MatrixXd vectors;  ///< [dof x mode], phi' M phi = 1, the component of largest magnitude positive (ties: first)
  bool failed = false;      ///< mass not positive definite, or an entry not finite; values and vectors are then nan
};

/// Lowest modes of one symmetric pencil by Cholesky reduction to standard form.
///
///   K phi = lambda M phi,   phi' M phi = 1
///
/// @param stiffness  [dof x dof], symmetric, may be indefinite; the lower triangle is read
/// @param mass       [dof x dof], symmetric positive definite; the lower triangle is read
/// @param modes      how many of the lowest modes, 0..dof; 0 means all
/// @return           the modes, or `failed`
/// @throws InvalidInput  shapes that do not fit, or more modes than degrees of freedom
/// Source: [GolubVanLoan2013], section 8.7.
DenseModes solve_modes(const Eigen::Ref<const Eigen::MatrixXd>& stiffness,
                       const Eigen::Ref<const Eigen::MatrixXd>& mass, int modes = 0);

}  // namespace mottle::linalg
