// Parameters that may change places: like parts of a structure, with their values exchanged, often explain the same
// tests.
#pragma once

#include <Eigen/Core>
#include <vector>

#include "mottle/layers.hpp"
#include "updating/fits/scaled_parameters.hpp"

namespace mottle::updating {

/// The permutations of parameters, the identity left out, that exchange only such as have the same prior mean and
/// deviation on the same scale: all of them where they are no more than 120, else those that exchange two.
///
/// @return  of each the parameter whose value each takes [permutation][parameter]
std::vector<std::vector<Eigen::Index>> exchanges(const ScaledParameters& parameters);

}  // namespace mottle::updating
