// What a difference of an output is compared with to be given in percent.
#pragma once

#include <Eigen/Core>
#include <vector>

#include "mottle/layers.hpp"
#include "mottle/model/quantity.hpp"

namespace mottle::model {

/// Sizes of outputs for differences in percent [output]: abs(value); of a component of a shape or of a deflection that
/// is smaller than 5 % of the largest of the same mode or load and kind, that largest. Near a node the value itself may
/// be rounding.
///
/// @param values  one for each output; those that are not finite count for no other
Eigen::VectorXd reference_sizes(const std::vector<Quantity>& outputs, const Eigen::Ref<const Eigen::VectorXd>& values);

}  // namespace mottle::model
