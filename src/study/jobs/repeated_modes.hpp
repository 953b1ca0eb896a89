// Modes of one frequency, of which any combination is a mode too.
#pragma once

#include <Eigen/Core>
#include <vector>

#include "mottle/layers.hpp"

namespace mottle::study {

/// Neighbouring modes, counted from 0.
struct ModeGroup {
  Eigen::Index first = 0;
  Eigen::Index count = 1;

  bool contains(Eigen::Index mode) const { return mode >= first && mode < first + count; }
};

/// Modes solved beyond those asked for, so that a repeated frequency is not cut.
inline constexpr int k_modes_beyond = 4;

/// The groups of more than one mode whose neighbours differ by a part in a million at most; rigid-body modes, of
/// frequency 0, are one too.
///
/// @param frequencies  ascending
std::vector<ModeGroup> modes_of_one_frequency(const Eigen::VectorXd& frequencies);

/// How many modes to show where `asked` are asked for: the others of a repeated frequency go with its first, but those
/// of rigid-body modes.
Eigen::Index with_whole_group(Eigen::Index asked, const Eigen::VectorXd& frequencies,
                              const std::vector<ModeGroup>& groups);

/// Sums phi_i + phi_j of every two modes of a group, from which a quadratic form has its mixed values:
///   phi_i' A phi_j = (q(phi_i + phi_j) - q(phi_i) - q(phi_j)) / 2
///
/// @param shapes  [degree of freedom x mode]
/// @return        [degree of freedom x pair], the pairs in the order in which principal_values() reads them
Eigen::MatrixXd sums_of_pairs(const Eigen::MatrixXd& shapes, const std::vector<ModeGroup>& groups);

/// Of a quadratic form: its values for the modes, and in each group its extremes over all combinations of length 1 in
/// ascending order (the eigenvalues of phi_i' A phi_j), which do not depend on the combinations that the solver gave.
///
/// @param values  [mode, then pair of sums_of_pairs()]
/// @param modes   how many of the values are of modes
Eigen::RowVectorXd principal_values(const Eigen::RowVectorXd& values, Eigen::Index modes,
                                    const std::vector<ModeGroup>& groups);

}  // namespace mottle::study
