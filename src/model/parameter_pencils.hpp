// The pencils K = sum a_t K_t, M = sum b_t M_t of one structure for any coefficients, those of no parameters included.
#pragma once

#include <Eigen/Core>
#include <memory>
#include <string>

#include "mottle/layers.hpp"
#include "mottle/model/structures/structure.hpp"

namespace mottle::model {

/// Lowest eigenvalues of one pencil.
struct PencilEigenvalues {
  Eigen::VectorXd values;  ///< ascending [mode]; nan: there are none
  Eigen::VectorXd errors;  ///< bound on what rounding and the solver's tolerance make of each
};

class ParameterPencils {
 public:
  virtual ~ParameterPencils() = default;

  /// Powers of the parameters that each term is multiplied by; the constant term is one with zeros [term x parameter].
  const Eigen::MatrixXi& stiffness_powers() const { return powers_of_stiffness; }
  const Eigen::MatrixXi& mass_powers() const { return powers_of_mass; }
  /// Name of a matrix that is not known to be positive semidefinite, "a term of the stiffness"; empty: all are.
  const std::string& indefinite_term() const { return indefinite; }

  /// Of any coefficients [term]; by several threads at once.
  virtual PencilEigenvalues solve(const Eigen::VectorXd& stiffness, const Eigen::VectorXd& mass, int modes) const = 0;

 protected:
  Eigen::MatrixXi powers_of_stiffness, powers_of_mass;
  std::string indefinite;
};

/// Of a structure whose matrices are sums of known powers of the parameters; null where they are not.
std::unique_ptr<const ParameterPencils> make_parameter_pencils(const Structure& structure);

}  // namespace mottle::model
