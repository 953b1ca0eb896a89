// The smallest box of parameters whose image covers given bounds of the outputs.
#pragma once

#include <Eigen/Core>
#include <functional>
#include <vector>

#include "mottle/layers.hpp"
#include "updating/methods/box_image.hpp"

namespace mottle::updating {

/// What is asked of the box.
struct CoverTask {
  Eigen::MatrixXd targets;  ///< lower and upper bound of every output [output x 2]
  Eigen::VectorXd scale;    ///< what counts as much of an output, > 0 [output]
  ParameterBox allowed;     ///< no end beyond
  Eigen::VectorXd unit;     ///< in which widths are measured [parameter]
  int max_iterations = 30;
  double tolerance = 1e-6;  ///< at rest when no end moves by more units
  /// Called with each new box; returns whether to go on.
  std::function<bool(const ParameterBox&)> after_each;
};

/// Where the search ended.
struct CoveringBox {
  ParameterBox box;
  double measure = 0.0;    ///< sum of widths in units
  double uncovered = 0.0;  ///< sum of what is left of the targets, in scales; 0: the box covers
  bool has_converged = false;
  Eigen::MatrixXd reached;  ///< outputs at the points that cover best [output x 2]
  /// Ends that may move, with others, at no cost to first order [parameter x 2].
  Eigen::Array<bool, Eigen::Dynamic, 2> is_undetermined;
};

/// min sum_i (u_i - l_i) / unit_i such that for every output some point of the box is at or beyond each of its targets.
///
/// A target is held by one point, whose coordinates are ends of the box or fixed. All such points give one linear
/// constraint each, and the step d of all ends solves
///
///   min c'd + |d|^2 / (2 tau)   such that the linearised points reach the targets, l <= u, within `allowed`
///
/// exactly (least_distance()). It is taken where it lowers the measure plus a penalty on what is not covered; else tau
/// is cut to a quarter. What the image covers is proven by those points, whatever else the box holds. The minimum is a
/// local one.
///
/// Source: sequential linear programming with proximal steps, [NocedalWright2006], ch. 18.
CoveringBox find_covering_box(BoxImage& image, const CoverTask& task, const ParameterBox& start);

}  // namespace mottle::updating
