// What the benchmarks of large models share: clocks, and decks with one material a patch.
#pragma once

#include <fmt/format.h>

#include <ctime>
#include <string>
#include <vector>

#include "mottle/model/parameters/field_targets.hpp"

namespace mottle::benchmarks {

using namespace model;

/// Of processor time: on one thread it is the clock's time where nothing else runs, and nearly so where something does.
inline double seconds() {
  return static_cast<double>(std::clock()) / CLOCKS_PER_SEC;
}

template <typename Work>
double time_of(Work&& work) {
  const double start = seconds();
  work();
  return seconds() - start;
}

/// Best of one to five calls, as many as fit into the budget.
template <typename Work>
double best_time(double budget, Work&& work) {
  double best = 1e300;
  const double end = seconds() + budget;
  for (int call = 0; call < 5 && (call == 0 || seconds() + best < end); ++call) best = std::min(best, time_of(work));
  return best;
}

/// MAT1:1:field ... MAT1:patches:field as factors, for each of the fields ("E", "E+RHO").
inline std::vector<ParameterTargets> patch_parameters(int patches, const std::string& fields) {
  std::vector<ParameterTargets> parameters;
  for (const std::string field : {"E", "RHO"}) {
    if (fields.find(field) == std::string::npos) continue;
    for (int p = 1; p <= patches; ++p) {
      parameters.push_back({fmt::format("{}{}", field, p), {fmt::format("MAT1:{}:{}", p, field)}, true});
    }
  }
  return parameters;
}

}  // namespace mottle::benchmarks
