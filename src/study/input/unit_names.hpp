// Names of units in each system of units, as printed.
#pragma once

#include <string>

#include "mottle/layers.hpp"

namespace mottle::study {

/// Units of one system.
struct UnitNames {
  const char* stiffness;
  const char* mass;
  const char* damping;
  const char* frequency;
  const char* shape;
  const char* length;
  const char* pressure;
  const char* density;
};

/// @param units  "SI", "mm-t-s", "mm-kg-ms", "in-lbf-s"
UnitNames unit_names(const std::string& units);

/// SI units in one unit of the system.
struct UnitSizes {
  double length = 1.0, mass = 1.0, frequency = 1.0;
};
UnitSizes unit_sizes(const std::string& units);

}  // namespace mottle::study
