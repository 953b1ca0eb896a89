// Functions shared by the kinds of model.
#pragma once

#include <string>

#include "mottle/drivers/command/solver_command.hpp"
#include "mottle/layers.hpp"
#include "mottle/model/structures/matrix_structure.hpp"
#include "mottle/study/models/model_source.hpp"
#include "study/input/toml_reader.hpp"

namespace mottle::study {

/// Keys of kinds with sparse matrices, whose clouds may be solved by a reduced model.
std::optional<double> read_reduction(TomlReader& reader);

/// Path of a file relative to the folder of `deck`. Throws InvalidInput where it lies outside.
std::filesystem::path name_beside(const std::filesystem::path& file, const std::filesystem::path& deck);

ModelParts parts_of(MatrixModel model, std::vector<std::string> files);

/// By runs of a program whose input has placeholders of these names.
ModelParts make_external(const SolverCommand& command, const std::vector<std::string>& names,
                         const JointDistribution& prior, const RunSettings& settings);

}  // namespace mottle::study
