// Tests whose frequencies are in another unit than the model's: found before anything is updated.
#pragma once

#include <vector>

#include "mottle/layers.hpp"
#include "mottle/study/jobs/study_objects.hpp"

namespace mottle::study {

/// A factor between two units of frequency that are easily taken for each other.
struct UnitFactor {
  double value;  ///< of the tests' frequencies over the model's
  const char* name;
  const char* remedy;
};

/// The factor that three quarters of the ratios lie within a factor 1.5 of; null: none. One ratio alone is not taken
/// for 60 or its inverse.
///
/// @param ratios  ln of tested over computed frequencies
const UnitFactor* find_unit_factor(const std::vector<double>& ratios);

/// Refuses tests whose frequencies are a common factor 2 pi, 60 or 1000, or the inverse of one, away from the model's.
///
/// With ratios r_k = mean tested f_k / f_k of the model at the prior's mean, it refuses where three quarters of the r_k
/// lie within a factor 1.5 of such a factor (what parameters that are to be updated may still be off by) and the prior
/// cannot give it: not where every parameter lies on its 0.001 or 0.999 quantile, whichever softens (stiffens) the
/// model. Solves the model again only where the first condition holds; what the model does not answer refuses nothing.
///
/// @throws InvalidInput  the test file, the ratios found, the units that they point to and what to do
void refuse_unit_errors(const Study& study, const StudyModel& made, const StudyTests& tests);

}  // namespace mottle::study
