// Readers of the sections of a study file, one function a section.
#pragma once

#include "mottle/study/input/study.hpp"
#include "study/input/toml_reader.hpp"

namespace mottle {

StudyModelSource read_model(TomlReader reader, const std::filesystem::path& folder);

/// [model] of kind "command".
SolverCommand read_command(TomlReader& reader, const std::filesystem::path& folder);

/// "10 min", "30 s", "2 h", or a number of seconds.
std::chrono::milliseconds read_duration(TomlReader& reader, const std::string& key, std::chrono::milliseconds fallback);

/// [[parameter]] and [correlation] of `owner` (the root, or [truth]).
StudyParameters read_parameters(TomlReader& owner, StudyModelSource::Kind kind);

/// Modes of a model with many degrees of freedom are tracked by MAC unless told otherwise, those of few masses, or
/// without shapes, by order.
ModalOutputs read_outputs(TomlReader reader, const StudyModelSource& model);
StudyTest read_test(TomlReader reader, const std::filesystem::path& folder);
StudyUpdate read_update(TomlReader reader);
StudyTruth read_truth(TomlReader reader, StudyModelSource::Kind kind);
StudyDiagnose read_diagnose(TomlReader reader);
SurrogateSettings read_surrogate(TomlReader reader);
/// Names of SurrogateKind, in its order.
const std::vector<std::string>& surrogate_kinds();
StudyPredict read_predict(TomlReader reader, const StudyModelSource& model, const std::filesystem::path& folder);

/// One [[parameter]]; of a model by command it needs no target.
StudyParameter read_parameter(TomlReader& reader, StudyModelSource::Kind kind = StudyModelSource::Kind::mass_spring);

}  // namespace mottle
