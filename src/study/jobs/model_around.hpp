// A study's model whose clouds will lie elsewhere than its prior.
#pragma once

#include <Eigen/Core>

#include "mottle/layers.hpp"
#include "mottle/study/jobs/study_objects.hpp"

namespace mottle::study {

/// make_model(), with the reduced model trained for clouds around `centre` [parameter] rather than around the prior's
/// mean: as wide as the prior. What the model says is the same within its error of frequencies, and modes are numbered
/// as ever; clouds around the centre are solved faster.
StudyModel make_model_around(const Eigen::VectorXd& centre, const Study& study, const StudyParameters& parameters,
                             const RunSettings& settings);

}  // namespace mottle::study
