// Prediction interval of a binomial count.
#pragma once

#include "mottle/layers.hpp"

namespace mottle::stats {

struct CountRange {
  int min_successes = 0;
  int max_successes = 0;
};

/// Range of the number of successes in `count` trials of probability p that contains at least `level` of the
/// probability, with at most (1 - level) / 2 beyond each end.
///
/// @param count  >= 0
/// @param p      in (0, 1)
/// @param level  in (0, 1)
/// @throws InvalidInput  an argument outside its range
CountRange binomial_range(int count, double p, double level);

}  // namespace mottle::stats
