// Pieces of beams and rods (see element_pieces.hpp).
#pragma once

#include "fem/elements/element_pieces.hpp"
#include "mottle/fem/elements/solid.hpp"

namespace mottle {

void add_beam(const FiniteElementModel& model, const BeamElement& element, MassKind mass, PieceSelection selection,
              ElementPieces& result);

void add_rod(const FiniteElementModel& model, const RodElement& element, MassKind mass, PieceSelection selection,
             ElementPieces& result);

}  // namespace mottle
