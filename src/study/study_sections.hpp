// Readers of the sections of a study file, one function a section.
#pragma once

#include "mottle/study/study.hpp"
#include "toml_reader.hpp"

namespace mottle {

MassSpringSystem read_model(TomlReader reader);

/// [[parameter]] and [correlation] of `owner` (the root, or [truth]).
StudyParameters read_parameters(TomlReader& owner);

ModalOutputs read_outputs(TomlReader reader);
StudyTest read_test(TomlReader reader, const std::filesystem::path& folder);
StudyUpdate read_update(TomlReader reader);
StudyTruth read_truth(TomlReader reader);

}  // namespace mottle
