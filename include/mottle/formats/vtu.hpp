// Writes mode shapes as a VTK unstructured grid (.vtu), which ParaView opens.
#pragma once

#include <Eigen/Core>
#include <string>
#include <vector>

#include "mottle/fem/finite_element_model.hpp"
#include "mottle/layers.hpp"

namespace mottle::formats {

/// One vector field over the model's nodes.
struct VtuField {
  std::string name;          ///< "mode 3, 15.18 Hz"
  Eigen::MatrixX3d vectors;  ///< [node x xyz], basic
};

/// All nodes, all solids, shells, beams, rods and springs as cells with their element ids, and the fields as point
/// data. Arrays are inline base64 with 32-bit lengths. Source: the VTK file formats document, XML unstructured grid.
std::string format_vtu(const FiniteElementModel& model, const std::vector<VtuField>& fields);

}  // namespace mottle::formats
