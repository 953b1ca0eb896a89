// Shape functions and incompatible modes of the solids, tabulated once at their integration points.
#pragma once

#include <Eigen/Core>
#include <vector>

#include "mottle/fem/elements/solid.hpp"
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
using QuadraticHexahedronTable = Table<20, 0>;
using QuadraticWedgeTable = Table<15, 0>;
using QuadraticPyramidTable = Table<13, 0>;
using QuadraticTetrahedronTable = Table<10, 0>;

const HexahedronTable& hexahedron();
const WedgeTable& wedge();
const PyramidTable& pyramid();
const TetrahedronTable& tetrahedron();
const QuadraticHexahedronTable& quadratic_hexahedron();
const QuadraticWedgeTable& quadratic_wedge();
const QuadraticPyramidTable& quadratic_pyramid();
const QuadraticTetrahedronTable& quadratic_tetrahedron();

/// Calls `action` with the table of a shape.
template <typename Action>
auto with_table(SolidShape shape, const Action& action) {
  switch (shape) {
    case SolidShape::hexahedron8:
      return action(hexahedron());
    case SolidShape::wedge6:
      return action(wedge());
    case SolidShape::pyramid5:
      return action(pyramid());
    case SolidShape::tetrahedron4:
      return action(tetrahedron());
    case SolidShape::hexahedron20:
      return action(quadratic_hexahedron());
    case SolidShape::wedge15:
      return action(quadratic_wedge());
    case SolidShape::pyramid13:
      return action(quadratic_pyramid());
    case SolidShape::tetrahedron10:
      break;
  }
  return action(quadratic_tetrahedron());
}

}  // namespace mottle::fem::solid_shapes
