// Static solutions K u = f, accepted only where they are accurate.
#pragma once

#include <Eigen/Core>
#include <functional>
#include <string>

#include "mottle/layers.hpp"

namespace mottle::model {

/// u of every load [equation x load]; where `failure` is not empty it says why there is none.
struct StaticSolution {
  Eigen::MatrixXd displacements = {};
  std::string failure = {};
};

inline constexpr const char* k_no_static_solution =
    "its stiffness matrix is singular or not positive definite: a part of it is not supported, or a stiffness is "
    "negative";

/// u = K^-1 f with one step of refinement, u += K^-1 (f - K u). The step's energy, du'K du against u'K u, is the error
/// of the factor's solution whatever the units of translations and rotations; where it is not small, K is singular to
/// working precision. Source: [Higham2002], section 12.1.
///
/// @param solve     K^-1 of columns
/// @param multiply  K times columns
StaticSolution refined_static_solution(const Eigen::MatrixXd& loads,
                                       const std::function<Eigen::MatrixXd(const Eigen::MatrixXd&)>& solve,
                                       const std::function<Eigen::MatrixXd(const Eigen::MatrixXd&)>& multiply);

}  // namespace mottle::model
