// The keys of [model] of kind "command".
#pragma once

#include <filesystem>

#include "mottle/drivers/command/solver_command.hpp"
#include "mottle/layers.hpp"
#include "study/input/toml_reader.hpp"

namespace mottle::study {

SolverCommand read_command(TomlReader& reader, const std::filesystem::path& folder);

}  // namespace mottle::study
