// Mode shapes of a finite-element model as the page draws them.
#pragma once

#include <string>
#include <vector>

#include "mottle/layers.hpp"
#include "mottle/model/structures/structure.hpp"
#include "study/results/result_json.hpp"

namespace mottle::study {

/// One shape to draw.
struct ShownMode {
  int number = 0;          ///< as the user counts
  double frequency = 0.0;  ///< in the unit of the outputs
  double residual = 0.0;   ///< nan: not known
  std::string note;
  Eigen::VectorXd shape;  ///< [equation]
  /// Nodes where it was measured, and their displacements in the size of `shape` [node x xyz]; empty: not measured.
  std::vector<int> measured_nodes = {};
  Eigen::MatrixX3d measured = {};
};

/// Displacements of every node in basic axes [node x xyz].
///
/// @param structure  has a mesh
Eigen::MatrixX3d node_displacements(const Structure& structure, const Eigen::Ref<const Eigen::VectorXd>& shape);

/// Surface, lines and shapes; arrays as base64 of 32-bit numbers, shapes scaled to a largest displacement of 1.
///
/// @param structure       has a mesh
/// @param frequency_unit  of the modes' frequencies
Json drawing_json(const Structure& structure, const std::vector<ShownMode>& modes,
                  const std::string& frequency_unit = "Hz");

/// What each parameter acts on, in the nodes of that drawing: `name`, `triangles`, `edges`, `points`; empty where the
/// structure is none of finite elements with parameters on its cards.
Json parameter_parts_json(const Structure& structure, const std::vector<std::string>& names);

}  // namespace mottle::study
