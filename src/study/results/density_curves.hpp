// Densities of parameters for the page: the prior's, and envelopes from intervals of mean and standard deviation.
#pragma once

#include <Eigen/Core>

#include "mottle/layers.hpp"
#include "mottle/stats/distributions/distribution.hpp"
#include "mottle/stats/distributions/parameter_transform.hpp"

namespace mottle::study {

struct DensityCurve {
  Eigen::VectorXd x;  ///< ascending; empty: nothing to draw
  Eigen::VectorXd density;
};

struct DensityBand {
  Eigen::VectorXd x;  ///< ascending; empty: nothing to draw
  Eigen::VectorXd lower;
  Eigen::VectorXd upper;
};

/// Density of a prior, over nearly all of its probability; a uniform one as a box.
DensityCurve prior_curve(const Distribution& prior);

/// Density of a normal distribution, four standard deviations to each side.
DensityCurve normal_curve(double mean, double std);

/// Envelope of the densities whose mean and standard deviation lie within their intervals, for variables whose
/// transform is normal. A normal's envelope is exact; for another transform it is that of 17 by 7 pairs of mean and
/// standard deviation. A standard deviation that may be zero has an infinite density: from a fiftieth of the interval's
/// upper end on it counts.
///
/// @param mean, std  lower and upper ends; nan: not known, and there is no band
DensityBand density_band(const ParameterTransform& transform, const Eigen::Vector2d& mean, const Eigen::Vector2d& std);

}  // namespace mottle::study
