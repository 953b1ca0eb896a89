// Shape functions and incompatible modes of the solids, tabulated once at their integration points.
#pragma once

#include <Eigen/Core>
#include <vector>

#include "mottle/layers.hpp"

namespace mottle::fem::solid_shapes {

/// An integration point in an element's natural coordinates, with shape functions and gradients there.
template <int nodes, int modes>
struct SolidPoint {
  double weight = 0.0;
  Eigen::Matrix<double, nodes, 1> values;
  Eigen::Matrix<double, 3, nodes> gradients;       ///< [own coordinate x node]
  Eigen::Matrix<double, 3, modes> mode_gradients;  ///< [own coordinate x mode], of zero mean over the element
};

template <int nodes, int modes>
struct Table {
  using Points = std::vector<SolidPoint<nodes, modes>>;
  Points stiffness;  ///< integration points of the stiffness
  Points mass;       ///< of mass and volume
  Points corners;    ///< of weight 0
  SolidPoint<nodes, modes> centre;
};

using HexahedronTable = Table<8, 3>;
using WedgeTable = Table<6, 4>;
using PyramidTable = Table<5, 0>;
using TetrahedronTable = Table<4, 0>;
using QuadraticTetrahedronTable = Table<10, 0>;

const HexahedronTable& hexahedron();
const WedgeTable& wedge();
const PyramidTable& pyramid();
const TetrahedronTable& tetrahedron();
const QuadraticTetrahedronTable& quadratic_tetrahedron();

}  // namespace mottle::fem::solid_shapes
