// Static (Guyan) reduction of the mass of degrees of freedom that a deck omits.
#pragma once

#include <functional>
#include <string>
#include <vector>

#include "mottle/fem/assembly/separable_matrix.hpp"
#include "mottle/layers.hpp"

namespace mottle::fem {

/// Whether a mass stands on omitted rows at any parameters; where none does, the reduction is exact and changes
/// nothing.
bool has_omitted_mass(const SeparableMatrix& mass, const std::vector<bool>& is_omitted);

/// K and M of the statically reduced model among all degrees of freedom, in one pattern:
///
///   M^ = [ T' M T  0 ]     T = [       I       ]
///        [    0    0 ],        [ -K_oo^-1 K_oa ],   K as it is
///
/// The omitted rows of K phi = lambda M^ phi are K_oa phi_a + K_oo phi_o = 0, so that (T' K T) phi_a = lambda (T' M T)
/// phi_a: frequencies are those of the reduced matrices, and the shapes have the omitted degrees of freedom as Nastran
/// recovers them.
///
/// @param stiffness, mass  lower triangles; on return K with the zeros that the common pattern needs, and M^
/// @param is_omitted       by row
/// @param name             of a row, for messages
/// @throws InvalidInput    K_oo is singular (a mechanism among the omitted), more are kept than k_most_kept
/// Source: [Guyan1965].
void reduce_statically(SparseMatrix& stiffness, SparseMatrix& mass, const std::vector<bool>& is_omitted,
                       const std::function<std::string(int)>& name);

/// What the omitted degrees of freedom add to the derivatives of an eigenvalue:
///
///   d lambda = phi' (dK - lambda dM) phi + 2 lambda w' dK phi,   w_o = K_oo^-1 (M phi)_o,   w = 0 elsewhere
///
/// since T changes with K.
///
/// @param stiffness, mass  lower triangles before the reduction
/// @param shapes           of the reduced model, phi' M phi = 1 [row x mode]
/// @return                 w [row x mode]
/// @throws InvalidInput    K_oo is singular
Eigen::MatrixXd static_followers(const SparseMatrix& stiffness, const SparseMatrix& mass,
                                 const std::vector<bool>& is_omitted, const Eigen::MatrixXd& shapes);

inline constexpr int k_most_kept = 4000;  ///< degrees of freedom: M^ is a dense matrix of theirs

}  // namespace mottle::fem
