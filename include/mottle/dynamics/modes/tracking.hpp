// Which mode of a sample is which mode of the reference, and what happened on the way.
#pragma once

#include <Eigen/Core>
#include <string>
#include <vector>

#include "mottle/layers.hpp"

namespace mottle::dynamics {

/// A pairing with the story behind it.
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
/// they span what they spanned before. A mode whose MAC is below `minimum_mac` is therefore judged with those that
/// share its shape: of the group's matrix of cosines the least singular value squared is the subspace MAC.
///
/// @param cosines      [reference mode x mode], at least as many columns as rows
/// @param minimum_mac  below, a mode is not the reference's by itself
/// Source: [Allemang1982]; subspace angles [GolubVanLoan2013], section 6.4.3.
TrackedModes track_modes(const Eigen::Ref<const Eigen::MatrixXd>& cosines, double minimum_mac);

}  // namespace mottle::dynamics
