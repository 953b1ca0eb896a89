// Moduli of a material as products of the fields that its card gives.
#pragma once

#include "fem/elements/element_pieces.hpp"
#include "mottle/layers.hpp"

namespace mottle::fem {

/// factor * product of fields, with the fields on which the factor rests.
struct Coefficient {
  double factor = 1.0;
  std::vector<FieldPower> fields = {};
  std::vector<FieldIndex> matrix_fields = {};
};

/// Young's modulus; 2 G (1 + nu) where the card leaves it out.
Coefficient young_coefficient(const FiniteElementModel& model, const Material& material);

/// Shear modulus; E / (2 (1 + nu)) where the card leaves it out, 0 where it leaves out nu too (as Nastran).
Coefficient shear_coefficient(const FiniteElementModel& model, const Material& material);

/// Poisson's ratio; E / 2G - 1 where the card leaves it out, 0 where it leaves out G too.
double poisson_ratio(const FiniteElementModel& model, const Material& material);

/// The fields that determine Poisson's ratio.
std::vector<FieldIndex> poisson_fields(const Material& material);

/// coefficient * field^power; nothing where the field is absent.
Coefficient times(Coefficient coefficient, FieldIndex field, int power = 1);

/// Product of everything at the card's values.
double value_of(const FiniteElementModel& model, const Coefficient& coefficient);

}  // namespace mottle::fem
