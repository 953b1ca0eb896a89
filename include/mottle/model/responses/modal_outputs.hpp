// Selection of the modal quantities that are a model's outputs.
#pragma once

#include <string>
#include <vector>

#include "mottle/layers.hpp"

namespace mottle::model {

/// How the modes of a sample are assigned to those of the reference.
enum class ModeTracking {
  order,  ///< by rank in frequency
  mac,    ///< by MAC with the reference shapes and optimal assignment
};

/// Which modal quantities are outputs. Mode numbers count from 1, in the order of the reference structure.
struct ModalOutputs {
  std::vector<int> frequencies = {};
  std::vector<int> shape_modes = {};
  std::vector<std::string> shape_degrees_of_freedom = {};
  std::vector<int> damping = {};
  ModeTracking tracking = ModeTracking::order;
  std::string frequency_unit = "Hz";      ///< of 1 / (time unit of the matrices)
  std::string shape_unit = "1/sqrt(kg)";  ///< of a mass-normalised shape
  /// A tracked mode with less, alone and with those it mixed with, is lost: its sample fails.
  double minimum_mac = 0.5;
};

}  // namespace mottle::model
