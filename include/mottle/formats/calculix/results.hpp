// Modes as CalculiX writes them: frequencies from .dat, shapes from .frd.
#pragma once

#include <Eigen/Core>
#include <map>
#include <string>
#include <string_view>
#include <vector>

#include "mottle/layers.hpp"

namespace mottle::formats {

/// Eigenvalues, (rad/time)^2, of the first table of a .dat file [mode]; 7 digits.
///
/// @throws FormatError  no table, modes that are not numbered one by one, a number that is none
Eigen::VectorXd parse_calculix_eigenvalues(std::string_view bytes, const std::string& file);

/// One mode of an .frd file.
struct CalculixShape {
  double frequency = 0.0;                        ///< cycles/time, 10 digits
  std::map<int, Eigen::Vector3d> displacements;  ///< by node; 6 digits
};

/// Displacements of all modes of a text .frd file, whose columns have fixed width and may touch.
///
/// @throws FormatError  a block that is cut off, a number that is none, an .frd in binary
std::vector<CalculixShape> parse_calculix_shapes(std::string_view bytes, const std::string& file);

}  // namespace mottle::formats
