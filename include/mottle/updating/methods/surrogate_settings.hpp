// How an update by surrogate is made.
#pragma once

#include "mottle/layers.hpp"
#include "mottle/stats/surrogates/surrogate.hpp"

namespace mottle::updating {

struct SurrogateSettings {
  SurrogateKind kind = SurrogateKind::kriging;
  int runs = 0;            ///< of the first design; 0: ten a parameter, more where the kind needs them
  double spread = 3.0;     ///< half the first design's width, in deviations of the prior
  int rounds = 3;          ///< most refinements
  double tolerance = 0.1;  ///< error that is good enough: of values as a fraction of the tests' scatter, of
                           ///< standard deviations as one of the model's
};

}  // namespace mottle::updating
