// Plane stress and transverse shear of the materials that shells may have, as coefficients times unit matrices.
#pragma once

#include <Eigen/Core>
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

/// A term modulus * unit of the transverse shear moduli 1z, 2z.
struct TransverseShear {
  Coefficient modulus = {};
  Eigen::Matrix2d unit = Eigen::Matrix2d::Identity();
};

/// The terms, whose sum is positive definite; none where the material is rigid in shear (G1Z, G2Z blank or zero).
/// @throws InvalidInput  a material that is rigid in one of two directions
std::vector<TransverseShear> transverse_shear_of(const FiniteElementModel& model, const Material& material);

/// Inverse of the transverse shear moduli at the card's values; zero in a direction that is rigid.
Eigen::Matrix2d shear_flexibility_of(const FiniteElementModel& model, const Material& material);

/// All fields that a shell's stiffness takes from a material.
std::vector<FieldIndex> fields_of(const Material& material);

}  // namespace mottle::fem
