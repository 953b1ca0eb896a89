// Selection of the quantities that are a model's outputs.
#pragma once

#include <map>
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

/// What is known of the size of measured mode shapes.
enum class ShapeSize {
  by_tests,         ///< data where a test gives a modal mass; else the shape is not used
  mass_normalised,  ///< data of every shape
  free,             ///< unknown for each mode and specimen: only directions are compared
};

/// Forces that act together, and where their static displacements are outputs: K(x) u = f.
struct StaticLoad {
  std::map<std::string, double> forces = {};         ///< by degree of freedom; on rotations moments
  std::vector<std::string> degrees_of_freedom = {};  ///< of the outputs
};

/// Ratio of two components of one mode shape.
struct ShapeRatio {
  int mode = 1;
  std::string numerator = {}, denominator = {};  ///< degrees of freedom
};

/// Which quantities are outputs. Mode numbers count from 1, in the order of the reference structure.
struct OutputSelection {
  std::vector<int> frequencies = {};
  std::vector<int> shape_modes = {};
  std::vector<std::string> shape_degrees_of_freedom = {};
  ShapeSize shape_size = ShapeSize::mass_normalised;
  std::vector<int> damping = {};
  std::vector<StaticLoad> static_loads = {};
  std::vector<int> eigenvalues = {};
  std::vector<ShapeRatio> shape_ratios = {};
  ModeTracking tracking = ModeTracking::order;
  UnitNames units = {};
  /// A tracked mode with less, alone and with those it mixed with, is lost: its sample fails.
  double minimum_mac = 0.5;
};

}  // namespace mottle::model
