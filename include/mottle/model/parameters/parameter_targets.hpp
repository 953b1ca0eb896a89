// The numbers of a model that a parameter acts on, and the parameter's physical limits.
#pragma once

#include <string>
#include <vector>

#include "mottle/layers.hpp"

namespace mottle::model {

/// The numbers that one parameter acts on.
struct ParameterTargets {
  std::string parameter;             ///< its name, for messages
  std::vector<std::string> targets;  ///< "spring:k1", "mass:m1", "damper:c1"
  bool is_factor = false;            ///< the value multiplies the nominal value instead of replacing it
};

/// Whether a parameter is a stiffness or mass (must be > 0), or damping alone (must be >= 0).
struct PhysicalLimit {
  double lower = 0.0;
  bool excludes_lower = true;
};

/// The physically possible values of one parameter.
PhysicalLimit physical_limit(const ParameterTargets& parameter);

}  // namespace mottle::model
