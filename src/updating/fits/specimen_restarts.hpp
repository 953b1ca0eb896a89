// Fits of specimens begun again from other places, since a specimen may lie in another basin than the others.
#pragma once

#include <cstdint>

#include "mottle/layers.hpp"
#include "updating/fits/specimen_fit.hpp"

namespace mottle::updating {

/// Fits the specimens whose fit leaves more than it does by chance in four of five (chi-squared with as many degrees of
/// freedom as outputs were measured) again from 2 q points about the population's mean, 1.5 standard deviations along
/// each principal axis of its covariance, a twentieth of the prior's deviations at least, and keeps what is lower than
/// its fit so far: outputs by rank have a kink where two modes cross, which no step by derivatives passes.
///
/// @param fits  of `values`; where a lower minimum is found, that
/// @return      number of specimens that are better now, by more than 0.1 of what is minimised
std::int64_t restart_specimens(const UpdatingProblem& problem, const Eigen::Ref<const Eigen::MatrixXd>& values,
                               const HoldingPopulation& population, double tolerance, const RunContext& context,
                               std::int64_t& evaluations, SpecimenFits& fits);

}  // namespace mottle::updating
