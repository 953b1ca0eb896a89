// Names of units in each system of units, as printed, and their sizes.
#pragma once

#include <string>

#include "mottle/layers.hpp"

namespace mottle::model {

/// Units of one system; nothing is computed from them.
struct UnitNames {
  const char* stiffness = "N/m";
  const char* mass = "kg";
  const char* damping = "N s/m";
  const char* frequency = "Hz";      ///< 1 / (time unit of the matrices)
  const char* shape = "1/sqrt(kg)";  ///< of a mass-normalised shape
  const char* length = "m";
  const char* pressure = "Pa";
  const char* density = "kg/m^3";
  const char* eigenvalue = "(rad/s)^2";  ///< of K phi = lambda M phi
  const char* rotational_stiffness = "N m/rad";
  const char* rotational_damping = "N m s/rad";
};

/// @param units  "SI", "mm-t-s", "mm-kg-ms", "in-lbf-s"
UnitNames unit_names(const std::string& units);

/// SI units in one unit of the system.
struct UnitSizes {
  double length = 1.0, mass = 1.0, frequency = 1.0;
};
UnitSizes unit_sizes(const std::string& units);

}  // namespace mottle::model
