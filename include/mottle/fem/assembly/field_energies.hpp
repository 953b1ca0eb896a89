// Energies of modes in the elements that use a number of a card, and what the number changes in them.
#pragma once

#include <Eigen/Core>

#include "mottle/fem/finite_element_model.hpp"
#include "mottle/layers.hpp"

namespace mottle::fem {

/// Of modes phi with the strain energy U = phi' K phi / 2 and T = phi' M phi / 2 (kinetic energy over omega^2).
struct FieldEnergies {
  Eigen::VectorXi elements;  ///< that use the field [field]
  Eigen::MatrixXd strain;    ///< U of the elements whose stiffness depends on it [field x mode]
  Eigen::MatrixXd kinetic;   ///< T of the elements whose mass depends on it [field x mode]
  /// d U / d ln p and d T / d ln p at fixed shape [field x mode]; so that, with U and T of the whole model,
  ///   d ln f / d ln p = (dU/dlnp / U - dT/dlnp / T) / 2
  Eigen::MatrixXd strain_derivative, kinetic_derivative;
  Eigen::RowVectorXd total_strain, total_kinetic;  ///< of the whole model [mode]
};

/// Exact for numbers that a matrix is a power of; central differences of the elements for others (those that shape a
/// section, for example). Numbers that are zero have derivatives of zero.
///
/// @param displacements  of the modes in the nodes' displacement systems [6 node + component x mode], see
///                       AssembledModel::expansion
/// @throws InvalidInput  an element that cannot be made
FieldEnergies field_energies(const FiniteElementModel& model, const Eigen::MatrixXd& displacements);

}  // namespace mottle::fem
