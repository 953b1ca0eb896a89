// Mass properties of the whole structure: mass, centre of gravity and inertia, as of Nastran's grid point weight
// generator.
#pragma once

#include <Eigen/Core>

#include "mottle/fem/finite_element_model.hpp"
#include "mottle/layers.hpp"

namespace mottle::fem {

/// Mass as the model has it, direction by direction: scalar masses may weigh in one direction only.
struct MassProperties {
  Eigen::Matrix<double, 6, 6> rigid_body = Eigen::Matrix<double, 6, 6>::Zero();  ///< R' M R about the reference point
  Eigen::Vector3d mass = Eigen::Vector3d::Zero();                                ///< along x, y, z
  Eigen::Vector3d center = Eigen::Vector3d::Zero();                              ///< of gravity, basic
  Eigen::Matrix3d inertia = Eigen::Matrix3d::Zero();                             ///< about the centre of gravity
};

/// Rigid-body mass of all elements, constraints left aside, about the node that PARAM,GRDPNT names or the basic origin.
///
///   M_rb = sum over elements of R' M_e R,   R = motion of the element's degrees of freedom for unit rigid motions
///
/// PARAM,WTMASS is taken out again, so that masses are in the units of the deck's densities.
MassProperties mass_properties(const FiniteElementModel& model);

}  // namespace mottle::fem
