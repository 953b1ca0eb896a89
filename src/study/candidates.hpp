// The candidates of a diagnosis: what the study names, or everything in the model that may sensibly be wrong.
#pragma once

#include <vector>

#include "mottle/study/study.hpp"

namespace mottle {

/// Candidates with name, nominal value and spread. By default every spring of a mass-spring system, and of a deck the
/// numbers of materials, properties, springs and point masses that are not zero; what a parameter acts on is left out.
///
/// A candidate whose nominal value is zero takes its scale from the median of the others of its kind.
///
/// @throws InvalidInput  a target that the model does not have or that a parameter acts on, no candidate at all
std::vector<StudyParameter> resolve_candidates(const Study& study);

/// The study with the candidates put after its parameters.
Study with_candidates(const Study& study);

}  // namespace mottle
