// Quality of a solid's Jacobian, which needs its tables.
#pragma once

#include <Eigen/Core>

#include "mottle/fem/elements/solid.hpp"
#include "mottle/layers.hpp"

namespace mottle::fem {

/// SolidQuality::jacobian_ratio.
double jacobian_ratio(SolidShape shape, const Eigen::Ref<const Eigen::Matrix3Xd>& nodes);

}  // namespace mottle::fem
