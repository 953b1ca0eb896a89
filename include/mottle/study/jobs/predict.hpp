// Results of a study's [predict] block, which runs at the end of an update.
#pragma once

#include <optional>
#include <string>
#include <vector>

#include "mottle/layers.hpp"
#include "mottle/updating/prediction/prediction.hpp"

namespace mottle::study {

/// What a study's prediction says.
struct PredictionOutcome {
  PredictionSettings settings;
  Prediction prediction = {};
  std::optional<HeldOutCheck> check = std::nullopt;
  std::vector<std::string> notes = {};  ///< sentences
};

}  // namespace mottle::study
