// Beams and their properties as the cards describe them; their matrices are in beam.hpp.
#pragma once

#include <Eigen/Core>
#include <array>
#include <string>
#include <vector>

#include "mottle/fem/card_field.hpp"
#include "mottle/fem/elements/element_traits.hpp"
#include "mottle/layers.hpp"

namespace mottle::fem {

/// A section behind end A of a PBEAM or PBEAML. Numbers that are left out vary linearly from end A to end B.
struct BeamStation {
  double position = 1.0;  ///< X/XB, fraction of the length
  FieldIndex area = k_no_field, inertia_1 = k_no_field, inertia_2 = k_no_field, inertia_12 = k_no_field,
             torsion = k_no_field, nonstructural_mass = k_no_field;
  std::vector<FieldIndex> dimensions = {};  ///< as many as at end A
};

/// PBAR, PBEAM, PBARL and PBEAML (numbers follow from the dimensions).
struct BeamProperty {
  std::string card;  ///< "PBAR", "PBARL", ...
  int id = 0;
  int material = -1;
  FieldIndex area = k_no_field, inertia_1 = k_no_field, inertia_2 = k_no_field, inertia_12 = k_no_field,
             torsion = k_no_field, nonstructural_mass = k_no_field;
  double shear_1 = 0.0, shear_2 = 0.0;  ///< K1, K2: shear area / area; 0: rigid in shear
  std::string section;                  ///< "ROD", "BAR", "TUBE", ... of PBARL; empty: the numbers above are given
  std::vector<FieldIndex> dimensions;   ///< DIM1...
  /// N1, N2 and M1, M2: y and z of the neutral axis and of the nonstructural mass, from the shear centre.
  Eigen::Vector2d neutral_axis = Eigen::Vector2d::Zero(), nonstructural_center = Eigen::Vector2d::Zero();
  std::vector<BeamStation> stations = {};  ///< ascending, the last at end B; empty: the section is constant
};

/// CBAR, CBEAM.
struct BeamElement {
  std::string card;
  int id = 0;
  std::array<int, 2> nodes = {};
  int property = -1;
  Eigen::Vector3d orientation = Eigen::Vector3d::UnitZ();  ///< v, basic: plane 1 is spanned by the axis and v
  std::array<Eigen::Vector3d, 2> offsets = {Eigen::Vector3d::Zero(), Eigen::Vector3d::Zero()};  ///< WA, WB, basic
  std::array<Components, 2> pins = {};  ///< released components at ends A and B, in element axes
  bool has_torsional_inertia = true;    ///< about its axis; Nastran gives a CBAR none

  static const ElementTraits<BeamElement> k_traits;
};

}  // namespace mottle::fem
