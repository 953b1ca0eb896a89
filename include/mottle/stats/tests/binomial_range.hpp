// The range of a count that chance explains.
#pragma once

#include "mottle/layers.hpp"

namespace mottle::stats {

struct CountRange {
  int min_successes = 0;
  int max_successes = 0;
};

/// Fewest and most successes among `count` trials of probability p that lie within `level`: outside of the range lies
/// (1 - level) / 2 of the probability on each side at most.
///
/// @param count  >= 0
/// @param p      in (0, 1)
/// @param level  in (0, 1)
/// @throws InvalidInput  an argument outside its range
CountRange binomial_range(int count, double p, double level);

}  // namespace mottle::stats
