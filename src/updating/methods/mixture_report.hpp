// What a fitted mixture says: batches with intervals, assignments, outliers, notes in words.
#pragma once

#include <string>
#include <vector>

#include "mottle/layers.hpp"
#include "mottle/updating/methods/iteration.hpp"
#include "updating/population/mixture_fit.hpp"
#include "updating/population/solved_population.hpp"

namespace mottle::updating {

/// How the number of batches came about.
struct MixtureNumber {
  bool is_given = false;
  bool is_alike = false;  ///< no effect differs from specimen to specimen
  int most = 1;           ///< batches that so many specimens could show
  std::vector<ComponentsTest> tests = {};
  std::string not_believed = {};  ///< why one batch is reported although tests refuse it; empty: it is not so
};

/// Puts the estimate of several batches, or of one with outliers, its last cloud, and what follows from it into the
/// result. The verdict's tests are those of one population of the same moments (population_report.hpp): they look at
/// what no parameter moves, and at variances, and none of them at the number of batches.
void describe_mixture(const UpdatingProblem& problem, const TestMoments& tests, const SolvedPopulation& solved,
                      const MixtureSearch& search, const MixtureNumber& number, const RunContext& context,
                      const MixturePopulationFit& fit, UpdatingResult& result);

/// Adds to the result of one population that it is one batch.
void describe_one_batch(const UpdatingProblem& problem, const MixtureSearch& search, const MixtureNumber& number,
                        const RunContext& context, const MixturePopulationFit& fit, UpdatingResult& result);

}  // namespace mottle::updating
