// The nearest point of a polyhedron.
#pragma once

#include <Eigen/Core>

#include "mottle/layers.hpp"

namespace mottle::updating {

/// The nearest point to the origin of a polyhedron, and the weights that hold it there.
struct LeastDistance {
  bool is_feasible = false;
  Eigen::VectorXd point;     ///< x [column]
  Eigen::VectorXd pressure;  ///< mu >= 0, x = A' mu, mu_j = 0 where (A x)_j > b_j [row]
};

/// min |x| such that A x >= b, by a least-squares problem with non-negative unknowns and an active set: finite, and
/// exact to rounding.
///
/// @param matrix  A [row x column]
/// @param right   b [row]
/// @return        `is_feasible` false where the polyhedron is empty
/// Source: [LawsonHanson1974], ch. 23, algorithms NNLS and LDP.
LeastDistance least_distance(const Eigen::Ref<const Eigen::MatrixXd>& matrix,
                             const Eigen::Ref<const Eigen::VectorXd>& right);

/// min |E u - f| over u >= 0.
/// Source: [LawsonHanson1974], algorithm NNLS.
Eigen::VectorXd non_negative_least_squares(const Eigen::MatrixXd& matrix, const Eigen::VectorXd& right);

}  // namespace mottle::updating
