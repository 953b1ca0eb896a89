// Draws of new specimens' parameters from an estimated normal population, with what is not known of it.
#pragma once

#include <Eigen/Core>

#include "mottle/core/random.hpp"
#include "mottle/layers.hpp"
#include "mottle/updating/estimate/normal_estimates.hpp"

namespace mottle::updating {

/// The symmetric square root of what is positive in a matrix, in units of `scale`: an elastic modulus and a thickness
/// have variances twenty-five orders of magnitude apart.
Eigen::MatrixXd scaled_root(const Eigen::MatrixXd& matrix, const Eigen::VectorXd& scale);

/// The next `count` standard normals of a stream.
Eigen::VectorXd standard_normals(RandomStream& stream, Eigen::Index count);

/// Mean degrees of freedom of the variances that the specimens determine; 0 where they determine none.
double joint_degrees_of_freedom(const PopulationEvidence& evidence);

/// Draws t ~ N(mean, covariance), the estimate taken as exact [draw x parameter].
Eigen::MatrixXd draw_exact(const Eigen::VectorXd& mean, const Eigen::MatrixXd& covariance,
                           const SpecimenDrawing& drawing);

/// Draws t of new specimens from what the evidence leaves open [draw x parameter]; the equations are those of
/// predict().
Eigen::MatrixXd draw_uncertain(const PopulationOnScales& population, const SpecimenDrawing& drawing);

}  // namespace mottle::updating
