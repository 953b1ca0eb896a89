// Masses that are concentrated at a point.
#pragma once

#include <Eigen/Core>
#include <array>
#include <string>
#include <vector>

#include "mottle/fem/card_field.hpp"
#include "mottle/fem/elements/element_traits.hpp"
#include "mottle/layers.hpp"

namespace mottle::fem {

/// CONM2 (mass, offset, inertia about its centre of gravity) and CONM1 (a whole 6 x 6 matrix).
struct PointMassElement {
  std::string card;
  int id = 0;
  int node = -1;
  Eigen::Matrix3d axes = Eigen::Matrix3d::Identity();            ///< in which offset, inertia or matrix are given
  FieldIndex mass = k_no_field;                                  ///< CONM2
  Eigen::Vector3d offset = Eigen::Vector3d::Zero();              ///< CONM2, node to centre of gravity, in `axes`
  std::array<FieldIndex, 6> inertia = {-1, -1, -1, -1, -1, -1};  ///< CONM2: I11 I21 I22 I31 I32 I33 (as on the card)
  std::vector<FieldIndex> matrix = {};                           ///< CONM1: 21 of the lower triangle, by rows

  static const ElementTraits<PointMassElement> k_traits;
};

}  // namespace mottle::fem
