// General elements: a stiffness between any degrees of freedom, given as a matrix.
#pragma once

#include <Eigen/Core>
#include <vector>

#include "mottle/fem/elements/element_traits.hpp"
#include "mottle/layers.hpp"

namespace mottle::fem {

/// GENEL: forces K (u_i - S u_d) on the degrees of freedom u_i, in balance with those on u_d.
struct GeneralElement {
  int id = 0;
  std::vector<int> nodes = {};        ///< by degree of freedom: those of u_i (UI), then those of u_d (UD)
  std::vector<int> components = {};   ///< 0..5, in the same order
  Eigen::MatrixXd stiffness = {};     ///< K, symmetric [u_i x u_i]
  Eigen::MatrixXd rigid_motion = {};  ///< S [u_i x u_d]; empty: follows from the positions of the six u_d

  static const ElementTraits<GeneralElement> k_traits;
};

}  // namespace mottle::fem
