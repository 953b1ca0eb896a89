// [surrogate] of a study and of its results.
#pragma once

#include "mottle/layers.hpp"
#include "mottle/updating/methods/surrogate_update.hpp"
#include "study/results/result_json.hpp"

namespace mottle::study {

/// `surrogate` of result.json: the rounds of an update by surrogate.
Json surrogate_json(const SurrogateSettings& settings, const SurrogateUpdate& update);

}  // namespace mottle::study
