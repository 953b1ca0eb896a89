// Whether the matrices that CalculiX prints give the modes that it finds itself.
#pragma once

#include <Eigen/Core>
#include <string>

#include "mottle/layers.hpp"
#include "mottle/model/structures/matrix_structure.hpp"

namespace mottle::drivers {

struct OwnModesComparison {
  int compared = 0;     ///< modes that are no rigid-body motions
  double error = 0.0;   ///< largest relative difference of frequencies
  std::string failure;  ///< why the matrices are not to be used; empty where they are
};

/// Modes of the printed matrices against those of the matrices in the solver's memory. CalculiX prints 14 digits: where
/// entries are large and modes soft (thin shells, slender solids), what is cut off is a stiffness of its own, which
/// moves frequencies or makes the stiffness indefinite.
///
/// @param own  lowest eigenvalues as the solver found them [mode], of the pencil at `parameters`
OwnModesComparison compare_with_own_modes(const SeparablePencil& pencil, const Eigen::VectorXd& parameters,
                                          const Eigen::VectorXd& own);

}  // namespace mottle::drivers
