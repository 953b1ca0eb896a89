// The tables that runs leave in their folder.
#pragma once

#include <memory>
#include <string>
#include <vector>

#include "mottle/layers.hpp"
#include "mottle/study/jobs/study_objects.hpp"
#include "mottle/updating/methods/cloud.hpp"

namespace mottle::study {

/// Columns: parameters, outputs, status ("ok", or why the run failed).
std::string cloud_csv(const Cloud& cloud, const ParameterSpace& space, const std::vector<Quantity>& outputs);

/// Columns: iteration, parameters, outputs; at most 500 samples of each cloud, for drawing.
std::string clouds_csv(const std::vector<Cloud>& clouds, const ParameterSpace& space,
                       const std::vector<Quantity>& outputs);

/// The tests as they were used.
std::string tests_csv(const StudyTests& tests, const std::vector<Quantity>& outputs);

/// Names of parameters, then of outputs.
std::vector<std::string> column_names(const ParameterSpace& space, const std::vector<Quantity>& outputs);

/// The study's method with its options.
std::unique_ptr<Updater> make_method(const Study& study);

}  // namespace mottle::study
