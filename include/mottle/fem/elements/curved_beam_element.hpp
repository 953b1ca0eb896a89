// Curved beams as the cards describe them; their matrices are in curved_beam.hpp.
#pragma once

#include <Eigen/Core>
#include <array>
#include <optional>

#include "mottle/fem/card_field.hpp"
#include "mottle/fem/elements/curved_beam.hpp"
#include "mottle/fem/elements/element_traits.hpp"
#include "mottle/layers.hpp"

namespace mottle::fem {

/// CBEND with PBEND.
struct CurvedBeamElement {
  int id = 0;
  std::array<int, 2> nodes = {-1, -1};
  int material = -1;
  FieldIndex area = k_no_field, inertia_1 = k_no_field, inertia_2 = k_no_field, torsion = k_no_field,
             nonstructural_mass = k_no_field;
  double shear_1 = 0.0, shear_2 = 0.0;                     ///< K1, K2: shear area / area; 0: rigid in shear
  double radius = 0.0, angle = 0.0;                        ///< RB of the centroids, THETAB in degrees
  double radial_offset = 0.0, normal_offset = 0.0;         ///< RC, ZC: from the nodes to the centroids
  std::optional<double> neutral_offset = std::nullopt;     ///< DELTAN; without it I1 / (A RB)
  ArcRule rule = ArcRule::center;                          ///< GEOM
  Eigen::Vector3d orientation = Eigen::Vector3d::UnitZ();  ///< v, basic

  static const ElementTraits<CurvedBeamElement> k_traits;
};

}  // namespace mottle::fem
