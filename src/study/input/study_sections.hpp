// Readers of the sections of a study file, one function a section.
#pragma once

#include "mottle/layers.hpp"
#include "mottle/study/input/study.hpp"
#include "study/input/toml_reader.hpp"

namespace mottle::study {

/// [[parameter]] and [correlation] of `owner` (the root, or [truth]).
StudyParameters read_parameters(TomlReader& owner, const ModelSource& model);

/// Modes of a model with many degrees of freedom are tracked by MAC unless told otherwise, those of few masses, or
/// without shapes, by order.
OutputSelection read_outputs(TomlReader reader, const ModelSource& model);
StudyTest read_test(TomlReader reader, const std::filesystem::path& folder);
StudyUpdate read_update(TomlReader reader);
StudyTruth read_truth(TomlReader reader, const ModelSource& model);
StudyDiagnose read_diagnose(TomlReader reader);
SurrogateSettings read_surrogate(TomlReader reader);
StudyPredict read_predict(TomlReader reader, const ModelSource& model, const std::filesystem::path& folder);

/// One [[parameter]]; without targets its name is that of a placeholder.
StudyParameter read_parameter(TomlReader& reader, bool has_targets = true);

}  // namespace mottle::study
