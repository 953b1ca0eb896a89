// What a box of parameters is asked to cover, and how far it may go.
#pragma once

#include <Eigen/Core>
#include <string>

#include "mottle/layers.hpp"
#include "mottle/updating/methods/interval.hpp"
#include "updating/methods/box_image.hpp"
#include "updating/methods/covering_box.hpp"

namespace mottle::updating {

/// All limits are to be covered, within bounds and physical limits, and ten prior deviations around prior and
/// specimens.
///
/// @param limits  of the outputs [output x 2]
/// @param hull    of the specimens' own parameters
CoverTask cover_task(const UpdatingProblem& problem, const Eigen::MatrixXd& limits, const ParameterBox& hull);

/// Targets beyond what the allowed box reaches become what it reaches. An output that the parameters cannot move by as
/// much as its tests differ is left out, where there is another one, and always one that they do not move.
///
/// @return ranges of the outputs over the allowed box [output x 2]; 0 x 0: the model fails in it, and the targets stay
Eigen::MatrixXd keep_what_is_possible(BoxImage& image, CoverTask& task);

/// Whether no target of the output is left.
bool is_left_out(const IntervalResult& found, Eigen::Index output);

/// What kept the box from covering more, as the end of a sentence: "the bounds of the parameters", ...
std::string limits_of_search(const UpdatingProblem& problem, const IntervalResult& found);

/// What to do about limits that are not the user's; empty: there are none.
std::string advice_on_limits(const UpdatingProblem& problem, const IntervalResult& found);

}  // namespace mottle::updating
