#include "fem/elements/material_coefficients.hpp"

#include <cmath>

namespace mottle::fem {

Coefficient young_coefficient(const FiniteElementModel& model, const Material& material) {
  if (material.young != k_no_field) return {1.0, {{material.young, 1}}, {}};
  return {2.0 * (1.0 + model.value(material.poisson)), {{material.shear, 1}}, {material.poisson}};
}

Coefficient shear_coefficient(const FiniteElementModel& model, const Material& material) {
  if (material.shear != k_no_field) return {1.0, {{material.shear, 1}}, {}};
  if (material.poisson == k_no_field) return {0.0, {}, {}};
  return {0.5 / (1.0 + model.value(material.poisson)), {{material.young, 1}}, {material.poisson}};
}

double poisson_ratio(const FiniteElementModel& model, const Material& material) {
  if (material.poisson != k_no_field) return model.value(material.poisson);
  if (material.shear == k_no_field || material.young == k_no_field) return 0.0;
  const double shear = model.value(material.shear);
  return shear > 0.0 ? model.value(material.young) / (2.0 * shear) - 1.0 : 0.0;
}

std::vector<FieldIndex> poisson_fields(const Material& material) {
  if (material.poisson != k_no_field) return {material.poisson};
  if (material.shear == k_no_field || material.young == k_no_field) return {};
  return {material.young, material.shear};
}

Coefficient times(Coefficient coefficient, FieldIndex field, int power) {
  if (field == k_no_field) {
    coefficient.factor = 0.0;
    return coefficient;
  }
  for (FieldPower& known : coefficient.fields) {
    if (known.field == field) {
      known.power += power;
      return coefficient;
    }
  }
  coefficient.fields.push_back({field, power});
  return coefficient;
}

double value_of(const FiniteElementModel& model, const Coefficient& coefficient) {
  double value = coefficient.factor;
  for (const FieldPower& factor : coefficient.fields) value *= std::pow(model.value(factor.field), factor.power);
  return value;
}

}  // namespace mottle::fem
