// The linear random-effects problem that the specimens' fits make.
#pragma once

#include <Eigen/Core>
#include <vector>

#include "mottle/layers.hpp"
#include "updating/population/population_fit.hpp"

namespace mottle::updating {

/// Mean of the specimens' Jacobians [output x parameter].
Eigen::MatrixXd mean_jacobian(const std::vector<Eigen::MatrixXd>& jacobians);

/// How the parameters give way to an error of the outputs, K d: least squares in the directions that the outputs see,
/// weights by the variance of each output's mean.
///
/// @param directions  [parameter x seen]
Eigen::MatrixXd absorbed_errors(const Eigen::MatrixXd& sensitivity, const Eigen::MatrixXd& directions,
                                const Eigen::VectorXd& variance);

/// The linear random-effects problem at the specimens' fits.
///
/// An error d that all specimens share moves their tests by d + (G_s - G) K d, G the mean of the G_s: where the
/// parameters give way to it they do so alike. Else differences of the G_s, which curved outputs correlate with the
/// specimens' parameters, would count as evidence on d: with as many outputs as parameters there is none.
///
/// @param sensitivity  G [output x parameter]
/// @param absorbed     K [parameter x output]; empty: no error is shared
std::vector<RandomEffectsUnit> linear_units(const Eigen::Ref<const Eigen::MatrixXd>& values,
                                            const Eigen::VectorXd& shift, const Eigen::MatrixXd& sensitivity,
                                            const Eigen::MatrixXd& absorbed, const SpecimenFits& fits,
                                            const NoiseModel& noise, const Eigen::VectorXd& origin,
                                            const Eigen::MatrixXd& map);

}  // namespace mottle::updating
