// Whether one population that is normal on other scales explains specimens that look like several batches.
#pragma once

#include <functional>
#include <optional>
#include <string>
#include <vector>

#include "mottle/layers.hpp"
#include "updating/methods/mixture_report.hpp"
#include "updating/population/solved_population.hpp"

namespace mottle::updating {

/// Parameters on other scales, on which the specimens look like one normal population.
struct ExplainingScales {
  std::vector<std::string> names = {};          ///< of the parameters
  std::vector<ParameterTransform> scales = {};  ///< of each of them
  double p_value = 1.0;                         ///< of one batch against two there
};

/// Looks for one population on other scales that explains the specimens as well as several batches do.
///
/// The scales are those on which the specimens' estimates look most normal. One population is fitted there, and stands
/// for the batches where all of these hold:
/// - the tests are ten times as probable as under one population on the study's scales, so that scales which hardly
///   differ over the specimens explain nothing;
/// - its BIC is no larger than that of the batches: 2 (l_other - l_own) >= sum of T - k ln n, T the likelihood ratios
///   that led to the batches and k their additional free numbers;
/// - on these scales one batch is not refused against two.
///
/// @param solved   one population on the study's scales, with the settings to fit another one
/// @param number   how the batches came about: by tests
/// @param choose   the number of batches of a problem by tests, its population given
/// @param evaluations  raised by the model runs that were needed
/// @return         nothing where batches are the better explanation, or the number was given
std::optional<ExplainingScales> explaining_scales(
    const UpdatingProblem& problem, const SolvedPopulation& solved, const MixtureNumber& number,
    const RunContext& context, const std::function<MixtureNumber(const UpdatingProblem&, const PopulationFit&)>& choose,
    std::int64_t& evaluations);

/// Why the batches that the tests found are not believed.
std::string explaining_scales_note(const ExplainingScales& found, const MixtureNumber& number);

}  // namespace mottle::updating
