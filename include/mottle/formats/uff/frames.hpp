// Conversion of a universal file's numbers to SI units and to directions in the global frame.
#pragma once

#include <Eigen/Core>
#include <map>

#include "mottle/formats/uff/uff.hpp"
#include "mottle/layers.hpp"

namespace mottle::formats {

/// Turns all numbers into SI by dataset 164; without one nothing is changed. A number is divided by the factor of its
/// unit; shapes are ratios: translations stay, rotations are per metre, modal mass is a mass (force s^2 / length).
///
/// @return  what was done, a sentence; empty where the file states no units
std::string convert_to_si(UffFile& contents);

/// Directions of the components at every node.
class UffFrames {
 public:
  /// @throws FormatError  a system or node given twice with other content, a system that is not there or is its own
  ///                      reference, one that is defined within a curvilinear one
  explicit UffFrames(const UffFile& contents);

  /// Directions of the components at a node as columns, in the global frame; global where the file has no such node.
  Eigen::Matrix3d directions_at(int node) const;

 private:
  const CoordinateSystem& resolve(const UffFile& contents, int id, int line, int depth);

  std::map<int, const UffCoordinateSystem*> given_;
  std::map<int, CoordinateSystem> resolved_;
  std::map<int, Eigen::Matrix3d> directions_;
};

}  // namespace mottle::formats
