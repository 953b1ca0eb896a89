// Readers of the sections of a study file, one function a section.
#pragma once

#include "mottle/study/study.hpp"
#include "toml_reader.hpp"

namespace mottle {

StudyModelSource read_model(TomlReader reader, const std::filesystem::path& folder);

/// [[parameter]] and [correlation] of `owner` (the root, or [truth]).
StudyParameters read_parameters(TomlReader& owner);

/// Modes of a finite-element model are tracked by MAC unless told otherwise, those of few masses by order.
ModalOutputs read_outputs(TomlReader reader, StudyModelSource::Kind kind);
StudyTest read_test(TomlReader reader, const std::filesystem::path& folder);
StudyUpdate read_update(TomlReader reader);
StudyTruth read_truth(TomlReader reader);

}  // namespace mottle
