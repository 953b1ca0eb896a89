// Identifies K(x) and M(x) of another program as polynomials in its parameters, from a few of its runs.
#pragma once

#include <functional>
#include <string>
#include <vector>

#include "mottle/core/error.hpp"
#include "mottle/layers.hpp"
#include "mottle/model/structures/matrix_structure.hpp"

namespace mottle::drivers {

/// The matrices are no such polynomials of the parameters; the message says of which, and why.
class NotSeparable : public InvalidInput {
 public:
  using InvalidInput::InvalidInput;
};

/// K and M at one parameter vector, and the names of their rows.
struct MatrixRun {
  SymmetricMatrix stiffness, mass;
};

/// One parameter of the fit.
struct FitAxis {
  std::string name;           ///< for messages
  double nominal = 1.0;       ///< != 0
  bool is_thickness = false;  ///< powers -1, 0 and 1 are tried at once
};

struct SeparableFit {
  SeparablePencil pencil;
  int runs = 0;        ///< matrices that were asked for
  double error = 0.0;  ///< at the point of verification, relative to the diagonal
};

/// The separable form of K(x) and M(x):
///
///   A(x) = A_0 + sum_i sum_k l_ik(x_i) (A_ik - A_0) + sum_{i<j} sum_kl l_ik(x_i) l_jl(x_j) (A_ik,jl - A_ik - A_jl +
///   A_0)
///
/// A_ik the matrix with parameter i at its node k and the others nominal, l_ik the Lagrange basis of the powers that
/// parameter i enters by. First every parameter is taken to enter linearly (thickness: by powers -1, 0, 1) and none
/// with another: q + 1 runs. One more run, with all parameters moved, must agree to 1e-8 of the diagonal,
/// |A_ab| <= 1e-8 sqrt(A_aa A_bb). Where it does not, each parameter is examined alone and gets the powers
/// {0, 1}, {-1, 0, 1} or {-1, ..., 3} that it needs, pairs that enter together get their products, and the run is
/// compared again.
///
/// @param run  called once for each point
/// @throws NotSeparable  a parameter, or three together, that no such form fits; rows that change with the parameters
/// @throws InvalidInput  stiffness and mass with other rows
SeparableFit fit_separable(const std::vector<FitAxis>& axes,
                           const std::function<MatrixRun(const Eigen::VectorXd&)>& run);

}  // namespace mottle::drivers
