// Modal assurance criterion and optimal assignment by it.
#pragma once

#include <Eigen/Core>
#include <vector>

#include "mottle/layers.hpp"

namespace mottle::dynamics {

/// Modal assurance criterion of every pair of real shapes.
///
///   MAC_ij = (a_i' b_j)^2 / ((a_i' a_i) (b_j' b_j))
///
/// @param a, b  shapes [degree of freedom x mode], same degrees of freedom
/// @return      [mode of a x mode of b], within [0, 1]; 0 where a shape is zero
/// Source: [Allemang1982].
Eigen::MatrixXd modal_assurance_criterion(const Eigen::Ref<const Eigen::MatrixXd>& a,
                                          const Eigen::Ref<const Eigen::MatrixXd>& b);

/// The assignment of rows to distinct columns that maximises the sum of the chosen entries.
///
/// @param score  [row x column], rows <= columns
/// @return       column of each row
/// Source: [Kuhn1955], in the shortest-augmenting-path form of [Jonker1987].
std::vector<int> optimal_assignment(const Eigen::Ref<const Eigen::MatrixXd>& score);

/// Cosine of the angle between every pair of real shapes; its square is the modal assurance criterion.
///
/// @return  [mode of a x mode of b], within [-1, 1]; 0 where a shape is zero
Eigen::MatrixXd shape_cosines(const Eigen::Ref<const Eigen::MatrixXd>& a, const Eigen::Ref<const Eigen::MatrixXd>& b);

}  // namespace mottle::dynamics
