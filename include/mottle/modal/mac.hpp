// Modal assurance criterion, and tracking of modes by it.
#pragma once

#include <Eigen/Core>
#include <vector>

namespace mottle {

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

/// Which mode of a sample is which mode of the reference.
struct TrackedModes {
  std::vector<int> mode;    ///< for each reference mode: column of `shapes`
  std::vector<double> mac;  ///< its MAC with the reference mode
};

/// Pairs reference modes with a sample's modes by MAC and optimal assignment, whatever their order in frequency.
///
/// @param reference  [degree of freedom x reference mode]
/// @param shapes     [degree of freedom x mode], at least as many modes as the reference has
TrackedModes track_modes(const Eigen::Ref<const Eigen::MatrixXd>& reference,
                         const Eigen::Ref<const Eigen::MatrixXd>& shapes);

}  // namespace mottle
