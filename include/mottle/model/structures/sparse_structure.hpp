// A structure with sparse matrices as functions of the parameters. Derived classes know what the equations mean.
#pragma once

#include <string>

#include "mottle/fem/assembly/separable_matrix.hpp"
#include "mottle/layers.hpp"
#include "mottle/model/structures/structure.hpp"

namespace mottle::model {

/// K(x) and M(x), the sums of known functions of x times constant matrices where the parameters allow it.
class SparseStructure : public Structure {
 public:
  struct Matrices {
    SparseMatrix stiffness, mass;
    bool is_mass_semidefinite = false;  ///< known from its terms
  };

  /// Where modes are numbered; its mass matrix weighs the comparison of shapes [parameter].
  virtual const Eigen::VectorXd& reference() const = 0;

  /// The terms of K(x) and M(x); where is_separable() is false they hold where terms_hold_at() says so.
  virtual const SeparableMatrix& stiffness_terms() const = 0;
  virtual const SeparableMatrix& mass_terms() const = 0;
  virtual bool is_separable() const { return true; }
  /// Whether the terms give the matrices at these parameters.
  virtual bool terms_hold_at(const Eigen::Ref<const Eigen::VectorXd>& /*parameters*/) const { return is_separable(); }
  /// Whether the terms are known functions of this parameter.
  virtual bool is_separable_in(Eigen::Index /*parameter*/) const { return is_separable(); }
  /// Whether the terms give the matrices' derivative by this parameter.
  bool terms_give_derivative(const Eigen::Ref<const Eigen::VectorXd>& parameters, Eigen::Index parameter) const {
    return is_separable_in(parameter) && terms_hold_at(parameters);
  }
  virtual Matrices matrices_at(const Eigen::Ref<const Eigen::VectorXd>& parameters) const;
  /// dK/dx and dM/dx by one parameter: from the terms where they hold, by central differences elsewhere.
  Matrices derivative_at(const Eigen::Ref<const Eigen::VectorXd>& parameters, Eigen::Index parameter) const;
  /// Relative rounding of the matrices' entries, sums over elements included.
  virtual double entry_rounding() const { return 1e-14; }
  /// What the user calls a row of the matrices.
  virtual std::string equation_name(int row) const = 0;

 protected:
  /// "exactly separable, linearly: no re-assembly"; empty where the parameter stands in no term.
  std::string separable_role(Eigen::Index parameter) const;
};

}  // namespace mottle::model
