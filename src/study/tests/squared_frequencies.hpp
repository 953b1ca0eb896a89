// Tests that give eigenvalues where frequencies are expected, or the other way round.
#pragma once

#include <vector>

#include "mottle/layers.hpp"

namespace mottle::study {

/// A function of a frequency that is easily taken for it.
struct MistakenPower {
  const char* name;    ///< what the tests seem to be
  const char* remedy;  ///< a sentence
  /// ln of the frequency in cycles that a test's value stands for, from ln of the value.
  double (*log_frequency)(double log_value);
};

/// (2 pi f)^2, f^2, or for tests of eigenvalues f: the function under which the tests are the model's frequencies;
/// null: none. Three quarters of them must lie within a factor of 1.5 (of one value 1.2) of the model's, and as a whole
/// three times nearer than as they are, and nearer than by a factor between units.
///
/// @param tested, computed  ln of frequencies, equally many: what parameters that are to be updated may be off by is
///                          left between them
/// @param unit_misfit       mean square of ln of what a factor between units leaves; infinite: there is none
const MistakenPower* find_mistaken_power(const std::vector<double>& tested, const std::vector<double>& computed,
                                         bool are_eigenvalues, double unit_misfit);

}  // namespace mottle::study
