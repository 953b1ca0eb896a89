// Tapered beams: from the fields of their stations to pieces.
#pragma once

#include "fem/elements/element_pieces.hpp"
#include "mottle/layers.hpp"

namespace mottle::fem {

/// Adds stiffness and mass of a beam whose property has stations; its degrees of freedom are there already.
/// @throws InvalidInput  as tapered_beam_stiffness
void add_tapered_beam(const FiniteElementModel& model, const BeamElement& element, PieceSelection selection,
                      ElementPieces& result);

}  // namespace mottle::fem
