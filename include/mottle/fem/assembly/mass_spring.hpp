// Point masses tied to one another and to ground by springs and dampers: one degree of freedom a mass.
#pragma once

#include <Eigen/Core>
#include <string>
#include <vector>

#include "mottle/layers.hpp"

namespace mottle::fem {

/// A mass and its degree of freedom.
struct PointMass {
  std::string name;
  double mass = 0.0;  ///< kg (in the study's units), > 0
};

/// A spring or damper from one mass to another or to ground.
struct Connector {
  std::string name;
  int first = -1;      ///< index of a mass, or k_ground
  int second = -1;     ///< index of another mass, or k_ground
  double value = 0.0;  ///< stiffness in N/m, or damping in N s/m, >= 0
};

inline constexpr int k_ground = -1;

/// The whole structure.
struct MassSpringSystem {
  std::vector<PointMass> masses;
  std::vector<Connector> springs;
  std::vector<Connector> dampers;

  /// Throws InvalidInput: no mass, a repeated or empty name, mass <= 0, negative stiffness or damping, a connector
  /// with both ends on the same mass or on ground, a value that is not finite.
  void validate() const;
};

/// Stiffness (or damping) matrix of one connector of unit value: +1 on the diagonal at both ends, -1 between them.
///
/// @param degrees_of_freedom  number of masses
/// @return                    [degree of freedom x degree of freedom]
Eigen::MatrixXd unit_connector_matrix(const Connector& connector, Eigen::Index degrees_of_freedom);

/// Mass matrix of one unit mass at degree of freedom `index`.
Eigen::MatrixXd unit_mass_matrix(Eigen::Index index, Eigen::Index degrees_of_freedom);

}  // namespace mottle::fem
