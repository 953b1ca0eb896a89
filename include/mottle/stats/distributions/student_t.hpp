// Student's distribution at standard normal scores: priors of scatters and of levels of noise, sampled as normals.
#pragma once

#include "mottle/layers.hpp"

namespace mottle::stats {

/// Student's quantile t of the probability Phi(score).
///
/// @param degrees_of_freedom  > 0
/// @return                    t; infinite beyond the largest number
double student_t_of_score(double score, double degrees_of_freedom);

/// x with P(|t| <= x) = Phi(score) for Student's t, of which a half-t prior is made; all digits are kept near zero too.
///
/// @param degrees_of_freedom  > 0
/// @return                    x >= 0; infinite beyond the largest number
double half_t_of_score(double score, double degrees_of_freedom);

}  // namespace mottle::stats
