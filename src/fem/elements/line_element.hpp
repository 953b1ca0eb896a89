// Functions shared by beams, rods and other elements between two points.
#pragma once

#include <array>

#include "fem/elements/element_pieces.hpp"
#include "fem/elements/material_coefficients.hpp"
#include "mottle/layers.hpp"

namespace mottle::fem {

template <typename Element>
std::span<const int> nodes_of(const Element& element) {
  return element.nodes;
}

template <typename Element>
const Topology& line_topology(const Element&) {
  static const Topology k_line = {.cell = VtkCell::line, .cell_nodes = {0, 1}, .lines = {{0, 1}}};
  return k_line;
}

inline std::array<Eigen::Vector3d, 2> ends_of(const FiniteElementModel& model, const std::array<int, 2>& nodes) {
  return {model.nodes[static_cast<std::size_t>(nodes[0])].position,
          model.nodes[static_cast<std::size_t>(nodes[1])].position};
}

/// Adds a matrix with its coefficient, unless that is zero.
template <typename Matrix>
void add_piece(ElementPieces& result, ElementPiece::Kind kind, double factor, const Coefficient& coefficient,
               const Matrix& matrix) {
  if (factor * coefficient.factor == 0.0) return;
  result.pieces.push_back({kind, factor * coefficient.factor, coefficient.fields, coefficient.matrix_fields, matrix});
}

}  // namespace mottle::fem
