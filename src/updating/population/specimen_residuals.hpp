// Residuals of specimens that an error of the model moves further than it is linear.
#pragma once

#include <Eigen/Core>
#include <cstdint>
#include <optional>

#include "mottle/layers.hpp"
#include "updating/fits/specimen_fit.hpp"
#include "updating/population/mean_residuals.hpp"

namespace mottle::updating {

/// Residuals of specimens that share an error d of the model, linear about its most probable value: the specimens'
/// unmoved directions are those where their fits lie, and with an error of many times the noise the fits lie elsewhere
/// than without it. Gauss-Newton steps in d, each with fits to z - E[d | residuals], as long as the squares refuse the
/// noise at 5 %; of these the smallest, mean and rest together. What the mean's part has become larger by than it was
/// where the fits lie counts among the rest: the estimate is judged by a mean that it was to match, and an error that
/// would be seen there must not explain the scatter.
///
/// @param population   what holds the fits; its noise > 0
/// @param fits         of the specimens, for any error
/// @param map          parameters of effects [parameter x effect]
/// @param error        standard deviation of d [output]
/// @param evaluations  raised by the model runs that were needed
MeanResiduals specimen_residuals(const UpdatingProblem& problem, const HoldingPopulation& population, SpecimenFits fits,
                                 const Eigen::MatrixXd& map, const Eigen::VectorXd& error, const RunContext& context,
                                 std::int64_t& evaluations);

/// The same of fits held about a centre by the prior's covariance, with the stated noise and error; nothing: the model
/// fails at a specimen.
///
/// @param centre  on the parameters' scales [parameter]
std::optional<MeanResiduals> residuals_about(const UpdatingProblem& problem, const Eigen::VectorXd& centre,
                                             const RunContext& context, std::int64_t& evaluations);

}  // namespace mottle::updating
