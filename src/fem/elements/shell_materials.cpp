#include "fem/elements/shell_materials.hpp"

#include <Eigen/LU>

#include "fem/elements/shell_flat.hpp"
#include "mottle/core/error.hpp"
#include "mottle/fem/elements/laminate.hpp"

namespace mottle::fem {
namespace {

enum Mat8 : std::size_t { e1, e2, nu12, g12, g1z, g2z };
enum Mat2 : std::size_t { g11, g12_of_mat2, g13, g22, g23, g33 };

/// Of a number on the card.
Coefficient times_field(FieldIndex field) {
  return times({}, field);
}

Eigen::Matrix3d anisotropic(const FiniteElementModel& model, const Material& material) {
  const auto at = [&](std::size_t i) { return model.value(material.moduli[i]); };
  Eigen::Matrix3d matrix;
  matrix << at(g11), at(g12_of_mat2), at(g13), at(g12_of_mat2), at(g22), at(g23), at(g13), at(g23), at(g33);
  return matrix;
}

}  // namespace

PlaneStress plane_stress_of(const FiniteElementModel& model, const Material& material) {
  PlaneStress result;
  switch (material.kind) {
    case Material::Kind::isotropic:
      result.modulus = young_coefficient(model, material);
      for (const FieldIndex field : poisson_fields(material)) result.modulus.matrix_fields.push_back(field);
      result.unit = shell::plane_stress(poisson_ratio(model, material));
      result.drilling = shear_coefficient(model, material);
      break;
    case Material::Kind::orthotropic_shell: {
      const auto at = [&](std::size_t i) { return model.value(material.moduli[i]); };
      result.unit = orthotropic_plane_stress(at(e1), at(e2), at(nu12), at(g12));
      result.modulus.matrix_fields.assign(material.moduli.begin(), material.moduli.begin() + g1z);
      result.drilling = times_field(material.moduli[g12]);
      break;
    }
    case Material::Kind::anisotropic_shell:
      result.unit = anisotropic(model, material);
      result.modulus.matrix_fields = material.moduli;
      result.drilling = times_field(material.moduli[g33]);
      break;
    case Material::Kind::anisotropic_solid:
      throw InvalidInput("a MAT9 is a material of solids; shells need MAT1, MAT2 or MAT8");
  }
  return result;
}

std::optional<TransverseShear> transverse_shear_of(const FiniteElementModel& model, const Material& material) {
  if (material.kind == Material::Kind::isotropic) return TransverseShear{shear_coefficient(model, material)};
  if (material.kind == Material::Kind::anisotropic_shell)
    return TransverseShear{{1.0, {}, material.moduli}, anisotropic(model, material).topLeftCorner<2, 2>()};
  const FieldIndex along = material.moduli[g1z], across = material.moduli[g2z];
  const Eigen::Vector2d moduli(model.value(along), model.value(across));
  if (moduli.isZero(0.0)) return std::nullopt;
  require(moduli.minCoeff() > 0.0,
          "material {} gives one of G1Z and G2Z; give both, or neither for a shell that is rigid in shear",
          material.id);
  return TransverseShear{{1.0, {}, {along, across}}, moduli.asDiagonal()};
}

Eigen::Matrix2d shear_flexibility_of(const FiniteElementModel& model, const Material& material) {
  if (material.kind == Material::Kind::anisotropic_shell) return Eigen::Matrix2d::Zero();  // none given
  const auto inverse = [](double modulus) { return modulus > 0.0 ? 1.0 / modulus : 0.0; };
  if (material.kind == Material::Kind::isotropic)
    return inverse(value_of(model, shear_coefficient(model, material))) * Eigen::Matrix2d::Identity();
  return Eigen::Vector2d(inverse(model.value(material.moduli[g1z])), inverse(model.value(material.moduli[g2z])))
      .asDiagonal();
}

std::vector<FieldIndex> fields_of(const Material& material) {
  std::vector<FieldIndex> fields = material.moduli;
  for (const FieldIndex field : {material.young, material.shear, material.poisson}) {
    if (field != k_no_field) fields.push_back(field);
  }
  return fields;
}

}  // namespace mottle::fem
