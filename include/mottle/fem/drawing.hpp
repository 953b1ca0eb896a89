// The drawn parts of a finite-element model: its surface, lines and point masses.
#pragma once

#include <array>
#include <cstdint>
#include <vector>

#include "mottle/fem/finite_element_model.hpp"
#include "mottle/layers.hpp"

namespace mottle::fem {

/// Indices of triangles, edges and points count the drawn nodes.
struct Drawing {
  std::vector<int> nodes;  ///< index into the model's nodes of each drawn node, ascending
  std::vector<std::array<std::uint32_t, 3>> triangles;
  std::vector<std::array<std::uint32_t, 2>> edges;
  std::vector<std::uint32_t> points;
};

/// Faces that belong to one solid only, shells, their edges; beams, rods, bushes and springs between nodes that lie
/// apart; concentrated masses. Quadrilaterals are split along their shorter diagonal; mid-edge nodes are left out.
Drawing drawing_of(const FiniteElementModel& model);

/// The same of only those elements whose matrices depend on one of the fields of a group, for each group. Elements that
/// have neither faces nor lines (springs between nodes at one place) are drawn as points.
///
/// @throws InvalidInput  an element whose form or section cannot be
std::vector<Drawing> drawings_of_fields(const FiniteElementModel& model,
                                        const std::vector<std::vector<FieldIndex>>& groups);

}  // namespace mottle::fem
