// Selection of the quantities that are a model's outputs.
#pragma once

#include <string>
#include <vector>

#include "mottle/layers.hpp"
#include "mottle/model/units.hpp"

namespace mottle::model {

/// How the modes of a sample are assigned to those of the reference.
enum class ModeTracking {
  order,  ///< by rank in frequency
  mac,    ///< by MAC with the reference shapes and optimal assignment
};

/// Which quantities are outputs. Mode numbers count from 1, in the order of the reference structure.
struct OutputSelection {
  std::vector<int> frequencies = {};
  std::vector<int> shape_modes = {};
  std::vector<std::string> shape_degrees_of_freedom = {};
  std::vector<int> damping = {};
  ModeTracking tracking = ModeTracking::order;
  UnitNames units = {};
  /// A tracked mode with less, alone and with those it mixed with, is lost: its sample fails.
  double minimum_mac = 0.5;
};

}  // namespace mottle::model
