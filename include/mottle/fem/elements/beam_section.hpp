// Cross-section numbers of PBARL and PBEAML from the dimensions on the card.
#pragma once

#include <span>
#include <string>
#include <string_view>
#include <vector>

#include "mottle/fem/elements/beam.hpp"
#include "mottle/layers.hpp"

namespace mottle::fem {

/// Names of the sections that beam_section knows, in alphabetical order.
std::vector<std::string> beam_section_names();

/// Number of dimensions (DIM1...) of a section; 0 where the name is unknown.
int beam_section_dimensions(std::string_view name);

/// Area, inertias, torsion constant and shear factors of a named section about its centroid.
///
/// Dimensions as on Nastran's PBARL (y up, z to the right); the axis of the beam runs through the centroid, the shear
/// centre is taken to lie there too. Area and inertias are those of the outline with sharp corners, exactly.
///
///   name   DIM1, DIM2...                                                       torsion constant J
///   BAR    width, height                                                       a b^3 (1/3 - 0.21 b/a (1 - b^4/12a^4))
///   BOX    width, height, thickness of top and bottom, of the sides            Bredt: 4 Am^2 / integral of ds / t
///   CHAN   flange width, height, web thickness, flange thickness               open: sum of b t^3 / 3
///   CHAN1  flange width beyond the web, web thickness, clear height, height    open
///   CROSS  both arms' length, stem thickness, stem height, arm thickness       open
///   H      clear web length, both flanges' thickness, height, web thickness    open
///   HAT    height, thickness, top width, brim width (one)                      open
///   I      height, bottom width, top width, web, bottom and top thickness      open
///   I1     flange width beyond the web, web thickness, clear height, height    open
///   L      width, height, thickness of the lying leg, of the standing leg      open
///   ROD    radius                                                              polar inertia
///   T, T2  flange width, height, flange thickness, stem thickness              open
///   TUBE   outer radius, inner radius                                          polar inertia
///   TUBE2  outer radius, thickness                                             polar inertia
///
/// Lengths b of open sections are taken along the centre lines; BAR is within 0.5 % of the exact series. Shear factors
/// K are 9/10 for ROD, 1/2 for TUBE, 5/6 for BAR; otherwise the clear area of the walls that run along the shear /
/// area, times 5/6 where these stand free at both ends (flanges of I, T, H; CROSS).
///
/// @param name        in capitals
/// @param dimensions  lengths > 0 (TUBE: the inner radius may be 0)
/// @throws InvalidInput  an unknown name (with the known ones), a wrong count, dimensions that do not fit together
/// Source: [Young2002], table 10.1 (torsion), ch. 8.10 (shear factors).
BeamSection beam_section(std::string_view name, std::span<const double> dimensions);

}  // namespace mottle::fem
