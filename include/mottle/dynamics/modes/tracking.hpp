// Mode tracking: assignment of a sample's modes to those of the reference, with veerings and crossings.
#pragma once

#include <Eigen/Core>
#include <string>
#include <vector>

#include "mottle/layers.hpp"

namespace mottle::dynamics {

/// An assignment with its MAC values, veerings and crossings.
struct TrackedModes {
  std::vector<int> mode;                ///< for each reference mode: column of the sample
  std::vector<double> mac;              ///< its MAC with the reference mode
  std::vector<double> subspace_mac;     ///< that of the mixed group it belongs to; its own MAC where it stands alone
  std::vector<std::vector<int>> mixed;  ///< groups of reference modes whose shapes have mixed, ascending
  std::vector<std::pair<int, int>> crossed;  ///< pairs (i < j) of reference modes that changed their order
};

/// Pairs reference modes with a sample's modes by MAC and optimal assignment, whatever their order in frequency.
///
/// Where modes come close, a small change mixes their shapes (veering): each alone has a poor MAC although together
/// they span what they spanned before. A mode whose MAC is below `minimum_mac` is therefore compared together with
/// those that share its shape: the square of the smallest singular value of the group's matrix of cosines is the
/// subspace MAC.
///
/// @param cosines      [reference mode x mode], at least as many columns as rows
/// @param minimum_mac  MAC below which a mode is compared by the subspace of its group
/// Source: [Allemang1982]; subspace angles [GolubVanLoan2013], section 6.4.3.
TrackedModes track_modes(const Eigen::Ref<const Eigen::MatrixXd>& cosines, double minimum_mac);

}  // namespace mottle::dynamics
