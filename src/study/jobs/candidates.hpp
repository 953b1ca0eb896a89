// The candidate parameters of a diagnosis: those that the study names, or all numbers of the model that are uncertain
// as a rule.
#pragma once

#include <Eigen/Core>
#include <vector>

#include "mottle/layers.hpp"
#include "mottle/study/input/study.hpp"

namespace mottle::study {

/// Candidates with name, nominal value and spread. By default every spring of a mass-spring system, and of a deck the
/// numbers of materials, properties, springs and point masses that are not zero; what a parameter acts on is left out.
///
/// A candidate whose nominal value is zero takes its scale from the median of the others of its kind.
///
/// @throws InvalidInput  a target that the model does not have or that a parameter acts on, no candidate at all
std::vector<StudyParameter> resolve_candidates(const Study& study);

/// The candidates for fits whose reference is the model as it is: each about the model's own value, as wide as its
/// distribution. About the distribution's mean where the model's value is not known, differs among the targets, or is
/// none that the candidate may have. Bounds keep within the distribution's support.
std::vector<StudyParameter> about_model_values(const Study& study, std::vector<StudyParameter> candidates);

/// Numbers of a model that no parameter moves, as candidates.
struct FixedNumbers {
  std::vector<StudyParameter> list;  ///< the first of them, in the order of the model
  Eigen::VectorXd sizes;  ///< of relative changes: each number itself, of a zero the median of its kind, else 1
  std::size_t total = 0;
};

/// The numbers of a model that an error could hide in: springs and masses (dampers where damping ratios are outputs),
/// parts of matrices, those that are zero too; of a deck what `resolve_candidates` takes by default.
///
/// @param max_count  how many are listed
/// @throws InvalidInput  a model by command, whose numbers are not known
FixedNumbers fixed_numbers(const Study& study, std::size_t max_count);

/// The study with `candidates` put after its parameters.
Study with_candidates(const Study& study, const std::vector<StudyParameter>& candidates);

}  // namespace mottle::study
