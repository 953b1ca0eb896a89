// A prediction in the files of an update.
#pragma once

#include <map>
#include <string>
#include <vector>

#include "mottle/layers.hpp"
#include "mottle/study/jobs/predict.hpp"
#include "study/results/result_json.hpp"

namespace mottle::study {

/// `prediction` of result.json.
///
/// @param outputs    that were predicted
/// @param overrides  numbers of the model that are other than in the update, as the study has them
Json prediction_json(const PredictionOutcome& outcome, const std::vector<Quantity>& outputs,
                     const std::map<std::string, double>& overrides);

/// prediction.csv: a row an output.
std::string prediction_csv(const PredictionOutcome& outcome, const std::vector<Quantity>& outputs);

}  // namespace mottle::study
