// Regions of highest density of points in the plane, whatever their shape.
#pragma once

#include <Eigen/Core>
#include <vector>

#include "mottle/layers.hpp"

namespace mottle::stats {

/// Closed outlines of the region of highest density that contains a part of weighted points.
///
/// The density is that of normal kernels of bandwidths h on axes on which the points have covariance I:
///
///   h_i = n^(-1/6) exp(H_i - H_normal) exp((H - H_1 - H_2) / 2),   n = effective points
///
/// the normal reference rule in two dimensions, shrunk by the entropies of the points on either axis (H_i) and in both
/// (H), which several modes and curved ridges lower; entropies from the distances to the eighth nearest of 500 of them.
/// The level is that which holds `probability` of the points themselves. Loops smaller than two kernels are left out.
///
/// @param points       [point x 2]
/// @param weights      >= 0, of sum 1 [point]
/// @param effective    independent points that they are worth, >= 1
/// @param probability  in (0, 1)
/// @return             outlines [vertex x 2], the first vertex repeated at the end; none where the points have no area
/// Source: [Scott2015], Eq. 6.44, for h; [Kozachenko1987] for the entropy.
std::vector<Eigen::MatrixXd> highest_density_outlines(const Eigen::Ref<const Eigen::MatrixXd>& points,
                                                      const Eigen::Ref<const Eigen::VectorXd>& weights,
                                                      double effective, double probability);

}  // namespace mottle::stats
