// Plane stress and transverse shear of the materials that shells may have, as coefficients times unit matrices.
#pragma once

#include <Eigen/Core>
#include <optional>
#include <vector>

#include "fem/elements/material_coefficients.hpp"
#include "mottle/layers.hpp"

namespace mottle::fem {

/// modulus * unit; the unit matrix depends on modulus.matrix_fields.
struct PlaneStress {
  Coefficient modulus;
  Eigen::Matrix3d unit = Eigen::Matrix3d::Zero();
  Coefficient drilling;  ///< the shear modulus in the material's axes
};

/// @throws InvalidInput  numbers that no material has
PlaneStress plane_stress_of(const FiniteElementModel& model, const Material& material);

/// Transverse shear moduli 1z, 2z as modulus * unit, as PlaneStress.
struct TransverseShear {
  Coefficient modulus = {};
  Eigen::Matrix2d unit = Eigen::Matrix2d::Identity();
};

/// None where the material is rigid in shear (G1Z and G2Z blank or zero).
/// @throws InvalidInput  a material that is rigid in one of two directions
std::optional<TransverseShear> transverse_shear_of(const FiniteElementModel& model, const Material& material);

/// Inverse of the transverse shear moduli at the card's values; zero in a direction that is rigid.
Eigen::Matrix2d shear_flexibility_of(const FiniteElementModel& model, const Material& material);

/// All fields that a shell's stiffness takes from a material.
std::vector<FieldIndex> fields_of(const Material& material);

}  // namespace mottle::fem
