// Shape functions and incompatible modes of the solids, tabulated once at their integration points.
#pragma once

#include <Eigen/Core>
#include <vector>

#include "mottle/fem/elements/solid.hpp"
#include "mottle/layers.hpp"

namespace mottle::fem::solid_shapes {

/// An integration point in an element's natural coordinates, with shape functions and gradients there.
struct SolidPoint {
  double weight = 0.0;
  Eigen::VectorXd values;           ///< [node]
  Eigen::Matrix3Xd gradients;       ///< [own coordinate x node]
  Eigen::Matrix3Xd mode_gradients;  ///< [own coordinate x mode], of zero mean over the element
};

struct Table {
  std::vector<SolidPoint> stiffness;  ///< integration points of the stiffness
  std::vector<SolidPoint> mass;       ///< of mass and volume
  std::vector<SolidPoint> corners;    ///< of weight 0
  SolidPoint centre;

  Eigen::Index nodes() const { return centre.gradients.cols(); }
  Eigen::Index modes() const { return centre.mode_gradients.cols(); }
};

constexpr int k_most_nodes = 20;  ///< of any shape, and of its nodes and modes together

const Table& hexahedron();
const Table& wedge();
const Table& pyramid();
const Table& tetrahedron();
const Table& quadratic_hexahedron();
const Table& quadratic_wedge();
const Table& quadratic_pyramid();
const Table& quadratic_tetrahedron();

const Table& table_of(SolidShape shape);

}  // namespace mottle::fem::solid_shapes
