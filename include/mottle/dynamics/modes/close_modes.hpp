// Measured modes that are close in frequency, whose shapes are mixtures of the model's.
#pragma once

#include <Eigen/Core>
#include <map>
#include <vector>

#include "mottle/layers.hpp"

namespace mottle::dynamics {

/// Modes that are compared together.
struct CloseModes {
  std::vector<int> modes = {};  ///< of the reference, counted from 0; the first is the one that was asked for
  double mac = 0.0;             ///< squared cosine of the largest angle between what both sets of shapes span
};

/// What the shapes of one specimen and of the model are compared by.
struct ShapesAndFrequencies {
  const Eigen::MatrixXd& shapes;  ///< [component x mode]; nan: not measured, or not in the model
  const Eigen::VectorXd& frequencies;
};

/// Small differences between two structures turn the shapes of close modes within what they span together: each alone
/// has a poor MAC. The mode is compared together with those within 10 % of its frequency, the most alike first, up to
/// four, whose measured partners lie within 20 % of them, at two components or more for each mode.
///
/// @param pairs  measured mode of each reference mode, both counted from 0
/// @return       the smallest group that agrees best; no modes: there are none so close
/// Source: subspace angles [GolubVanLoan2013], section 6.4.3.
CloseModes close_modes(int mode, const std::map<int, Eigen::Index>& pairs, const ShapesAndFrequencies& reference,
                       const ShapesAndFrequencies& measured);

}  // namespace mottle::dynamics
