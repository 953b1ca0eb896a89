// Stiffness of shear panels as a pure function of node positions and Poisson's ratio.
#pragma once

#include <Eigen/Core>

#include "mottle/layers.hpp"

namespace mottle::fem {

using PanelNodes = Eigen::Matrix<double, 3, 4>;
using PanelMatrix = Eigen::Matrix<double, 12, 12>;

/// Stiffness against shear at unit G t, by node three translations in basic coordinates: one generalised displacement.
///
///   K = v v' / phi,   phi = integral of N : S N dA,   N = (A B' + B A') / l^3
///
/// N: the membrane forces in equilibrium that leave no normal force on the edges; A and B point from where opposite
/// edges meet (or along them), l is the distance from the line between these two points; S: plane stress compliance at
/// unit G t. v: the edges' forces, half at each end. A rectangle has the shear flow q everywhere, phi = area; of a
/// parallelogram with angle theta it is area (1 + 2 cot^2 theta / (1 + nu)). A warped panel's forces lie in its mean
/// plane, with normal forces at the nodes that balance their moments.
///
/// @param nodes    basic, around the panel
/// @param poisson  in (-1, 0.5]
/// @throws InvalidInput  nodes that enclose no area or turn inwards
/// Source: [Garvey1951].
PanelMatrix shear_panel_stiffness(const PanelNodes& nodes, double poisson);

/// Half the length of the diagonals' vector product.
double shear_panel_area(const PanelNodes& nodes);

}  // namespace mottle::fem
