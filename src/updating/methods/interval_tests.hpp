// What can refuse a box of parameters, and what no test can see of it.
#pragma once

#include "mottle/layers.hpp"
#include "mottle/updating/methods/interval.hpp"

namespace mottle::updating {

/// What the specimens' own fits leave.
struct SpecimenResiduals {
  double sum_of_squares = 0.0;  ///< in standard deviations of the noise
  int degrees_of_freedom = 0;   ///< measured values that no parameter of their specimen takes up
};

/// Tests, where noise is known: "cover", whether the observed bounds are covered but for noise; "residuals", whether
/// every specimen's outputs are those of the model at some parameters of its own. Without noise an observed bound that
/// is not covered refuses the model as it stands. Fills `tests`, `not_tested` and `lacks_outputs`.
void test_box(const UpdatingProblem& problem, const IntervalResult& found, const SpecimenResiduals& residuals,
              UpdatingResult& result);

}  // namespace mottle::updating
