// Static solutions K u = f, accepted only where rounding leaves them determined.
#pragma once

#include <Eigen/Core>
#include <functional>
#include <string>
#include <vector>

#include "mottle/layers.hpp"

namespace mottle::model {

/// u of every load [equation x load]; where `failure` is not empty it says why there is none.
struct StaticSolution {
  Eigen::MatrixXd displacements = {};
  std::string failure = {};
};

inline constexpr const char* k_no_static_solution =
    "its stiffness matrix is not positive definite: a part of it is not supported, or a stiffness is negative";

/// K with its factor.
struct StaticSystem {
  std::function<Eigen::MatrixXd(const Eigen::MatrixXd&)> solve;              ///< K^-1 of columns
  std::function<Eigen::MatrixXd(const Eigen::MatrixXd&)> multiply;           ///< K times columns
  std::function<Eigen::MatrixXd(const Eigen::MatrixXd&)> multiply_absolute;  ///< |K| times columns
  Eigen::VectorXd diagonal;                                                  ///< of K, positive
};

/// u = K^-1 f with one step of refinement, u += K^-1 (f - K u).
///
/// How far rounding can move a solution is told by its energy, whatever the units of translations and rotations:
///   rho = eps |u|' |K| |u| / (u' f),
/// which K's entries may lose to rounding where they are summed and factorised. It must be small for every load, and
/// for one more load that moves all there is, w_i = sqrt(K_ii) times fixed irregular numbers: of a structure that is
/// not supported, and of a part of it that the loads do not move, K is singular, but its last pivot is a rounding error
/// that may be positive. The energy of the step against that of u is the error of the factor's solution and must be
/// small, too. Source: [Higham2002], sections 7.2 and 12.1.
StaticSolution refined_static_solution(const StaticSystem& system, const Eigen::MatrixXd& loads);

/// B du / dx = -(K^-1 B')' (dK / dx) u, of each load a matrix [observed row x parameter].
///
/// @param adjoint  K^-1 B' [equation x observed row]
/// @param forces   gives (dK / dx_i) u of every load [equation x load]
std::vector<Eigen::MatrixXd> static_sensitivity(const Eigen::MatrixXd& adjoint, Eigen::Index loads,
                                                Eigen::Index parameters,
                                                const std::function<Eigen::MatrixXd(Eigen::Index)>& forces);

}  // namespace mottle::model
