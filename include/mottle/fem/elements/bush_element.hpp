// Bushes: springs and dampers in six directions between two points.
#pragma once

#include <Eigen/Core>
#include <array>

#include "mottle/fem/card_field.hpp"
#include "mottle/fem/elements/element_traits.hpp"
#include "mottle/layers.hpp"

namespace mottle::fem {

/// CBUSH with PBUSH; CGAP with PGAP, CVISC with PVISC.
struct BushElement {
  const char* card = "CBUSH";
  int id = 0;
  std::array<int, 2> nodes = {-1, -1};                 ///< second -1: ground
  Eigen::Matrix3d axes = Eigen::Matrix3d::Identity();  ///< element axes as columns, basic
  Eigen::Vector3d location = Eigen::Vector3d::Zero();  ///< where the springs sit, basic
  std::array<FieldIndex, 6> stiffness = {-1, -1, -1, -1, -1, -1};
  std::array<FieldIndex, 6> damping = {-1, -1, -1, -1, -1, -1};

  static const ElementTraits<BushElement> k_traits;
};

}  // namespace mottle::fem
