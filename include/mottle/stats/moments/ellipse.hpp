// Ellipses of equal Mahalanobis distance, for scatter plots of two outputs or two parameters.
#pragma once

#include <Eigen/Core>
#include <vector>

#include "mottle/layers.hpp"

namespace mottle::stats {

/// Ellipse in the plane of two variables.
struct Ellipse {
  int first = 0;   ///< index of the variable on the horizontal axis
  int second = 1;  ///< index of the variable on the vertical axis
  Eigen::Vector2d centre = Eigen::Vector2d::Zero();
  double semi_major = 0.0;
  double semi_minor = 0.0;
  double angle = 0.0;  ///< rad, of the major axis from the first coordinate, in (-pi/2, pi/2]; 0 for a circle
};

/// The points at Mahalanobis distance `sigmas` from the mean: (y - mean)' covariance^-1 (y - mean) = sigmas^2.
///
/// @param mean        [2]
/// @param covariance  [2 x 2], positive semi-definite; a singular one gives a semi-minor axis of 0
/// @param sigmas      > 0; 2 encloses 86.5 % of a bivariate normal
/// @throws InvalidInput  wrong size, sigmas not positive, an entry not finite, or a covariance that is not positive
///                       semi-definite
Ellipse sigma_ellipse(const Eigen::Ref<const Eigen::VectorXd>& mean,
                      const Eigen::Ref<const Eigen::MatrixXd>& covariance, double sigmas);

/// The ellipse of every pair of variables first < second, by first, then by second.
///
/// @param mean        [variable]
/// @param covariance  [variable x variable]
std::vector<Ellipse> pairwise_ellipses(const Eigen::Ref<const Eigen::VectorXd>& mean,
                                       const Eigen::Ref<const Eigen::MatrixXd>& covariance, double sigmas);

}  // namespace mottle::stats
