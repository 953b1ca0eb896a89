// A sparse symmetric matrix that depends on the parameters through known powers, kept as its terms.
#pragma once

#include <Eigen/Core>
#include <vector>

#include "mottle/layers.hpp"
#include "mottle/linalg/reduced/reduced_model.hpp"

namespace mottle::fem {

/// One factor of a coefficient: the parameter raised to a power.
struct ParameterPower {
  int parameter = 0;
  int power = 1;

  bool operator==(const ParameterPower&) const = default;
  auto operator<=>(const ParameterPower&) const = default;
};

/// A(x) = sum over terms of (product of x_i^p_i) A_t; all terms within one pattern, lower triangle.
/// Source: [Mares2006], Eq. 2, with products of powers as the functions g_i.
struct SeparableMatrix {
  struct Term {
    std::vector<ParameterPower> coefficient = {};  ///< ascending in parameter; empty: the constant term
    std::vector<int> positions = {};               ///< into the values of the pattern, ascending
    std::vector<double> values = {};
    bool is_semidefinite = false;  ///< known from its elements, see PencilTerms
  };

  SparseMatrix pattern;  ///< lower triangle, compressed, all values zero
  std::vector<Term> terms;

  /// The matrix at `parameters`; the same pattern whatever the values.
  SparseMatrix at(const Eigen::Ref<const Eigen::VectorXd>& parameters) const;

  /// Whether terms that are known to be semidefinite, with coefficients that are not negative, make it so.
  bool is_semidefinite_at(const Eigen::Ref<const Eigen::VectorXd>& parameters) const;

  /// One term as a matrix without entries that are not its own.
  SparseMatrix matrix_of(const Term& term) const;

  /// Its derivative with respect to one parameter, in the same pattern.
  SparseMatrix derivative(const Eigen::Ref<const Eigen::VectorXd>& parameters, int parameter) const;
};

/// The terms of K(x) and M(x) as matrices of their own.
PencilTerms pencil_terms(const SeparableMatrix& stiffness, const SeparableMatrix& mass);

/// Their coefficients at samples [sample x parameter].
TermCoefficients term_coefficients(const SeparableMatrix& stiffness, const SeparableMatrix& mass,
                                   const Eigen::Ref<const Eigen::MatrixXd>& samples);

}  // namespace mottle::fem
