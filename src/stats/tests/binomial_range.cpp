#include "mottle/stats/tests/binomial_range.hpp"

#include <boost/math/distributions/binomial.hpp>

#include "mottle/core/error.hpp"

namespace mottle::stats {

CountRange binomial_range(int count, double p, double level) {
  require(count >= 0, "count: {} must not be negative", count);
  require(p > 0.0 && p < 1.0, "p: {} is outside (0, 1)", p);
  require(level > 0.0 && level < 1.0, "level: {} is outside (0, 1)", level);
  const double tail = 0.5 * (1.0 - level);
  const boost::math::binomial successes(count, p);
  CountRange range{0, count};
  while (range.min_successes < count && !(cdf(successes, range.min_successes) > tail)) ++range.min_successes;
  range.max_successes = range.min_successes;
  while (range.max_successes < count && !(cdf(successes, range.max_successes) >= 1.0 - tail)) ++range.max_successes;
  return range;
}

}  // namespace mottle::stats
