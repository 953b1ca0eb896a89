// Pieces of scalar elements, bushes and point masses (see element_pieces.hpp).
#pragma once

#include "fem/elements/element_pieces.hpp"

namespace mottle {

/// "CELAS 12"
std::string scalar_name(const ScalarElement& element);

void add_scalar(const FiniteElementModel& model, const ScalarElement& element, PieceSelection selection,
                ElementPieces& result);

void add_bush(const FiniteElementModel& model, const BushElement& element, PieceSelection selection,
              ElementPieces& result);

void add_point_mass(const FiniteElementModel& model, const PointMassElement& element, ElementPieces& result);

}  // namespace mottle
