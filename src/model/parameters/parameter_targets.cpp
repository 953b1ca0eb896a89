#include "mottle/model/parameters/parameter_targets.hpp"

#include <algorithm>

namespace mottle::model {

PhysicalLimit physical_limit(const ParameterTargets& parameter) {
  const bool is_damping_only = std::all_of(parameter.targets.begin(), parameter.targets.end(),
                                           [](const std::string& target) { return target.rfind("damper:", 0) == 0; });
  return {.lower = 0.0, .excludes_lower = !is_damping_only};
}

}  // namespace mottle::model
