// Whether a mass matrix is positive semidefinite beyond rounding, and where it is not.
#pragma once

#include <optional>
#include <string>
#include <vector>

#include "mottle/linalg/sparse/symmetric_factor.hpp"

namespace mottle::linalg {

/// A direction x in which x' M x is negative.
struct NegativeMass {
  enum class Kind {
    diagonal,  ///< x is one row alone: `value` is its diagonal entry, the most negative of all
    coupling,  ///< x has two rows: `value` is the entry of both, larger than the diagonal entries allow
    pivot,     ///< x is 1 in the row and 0 in those eliminated after it: `value` is x' M x, the pivot of the row
  };

  Kind kind = Kind::diagonal;
  int row = -1;
  double value = 0.0;
  double diagonal = 0.0;  ///< entry of the row
};

/// A direction in which M is negative beyond rounding; none where M is positive semidefinite.
///
///   M + 1e-8 D has no negative pivot,   D_ii = max(|M_ii|, 1e-5 K_ii / median(K_jj / M_jj))
///
/// (Sylvester's law of inertia). A diagonal M is judged by its entries. Neither units nor the scale of a row change the
/// answer. Rows without mass are allowed; a negative mass whose eigenvalue is 1e13 times the median in size counts as
/// none.
///
/// @param stiffness, mass  lower triangles, compressed
/// @param order            of elimination, if known; empty: one is computed
/// Source: [GolubVanLoan2013], section 8.1.5.
std::optional<NegativeMass> find_negative_mass(const SparseMatrix& stiffness, const SparseMatrix& mass,
                                               const std::vector<int>& order = {});

/// "the mass matrix is not positive semidefinite: the diagonal entry of row 101:+Z is -0.2".
std::string describe(const NegativeMass& negative, const std::string& row_name);

}  // namespace mottle::linalg
