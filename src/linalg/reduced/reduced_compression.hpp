// What of a trained basis its samples need.
#pragma once

#include <vector>

#include "linalg/reduced/reduced_model_parts.hpp"
#include "linalg/reduced/training_samples.hpp"

namespace mottle::linalg {

/// Drops directions that none of the chosen training samples needs (the basis grew by what was missing at the time, and
/// later vectors make earlier ones superfluous), rotates the others to the nominal modes, and makes the model on the
/// leading directions if it saves time.
void compress(ReducedModel::Parts& parts, const TrainingSamples& samples, const std::vector<Eigen::Index>& chosen);

}  // namespace mottle::linalg
