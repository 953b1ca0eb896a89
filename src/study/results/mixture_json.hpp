// Batches of specimens in result.json.
#pragma once

#include "mottle/layers.hpp"
#include "study/results/result_json.hpp"

namespace mottle::study {

/// Adds what docs/reference/result-json.md calls `components`, `assignments` and `mixture`; null and empty where the
/// method looks for no batches.
void add_mixture(const UpdatingResult& result, const TestData& tests, Json& json);

}  // namespace mottle::study
