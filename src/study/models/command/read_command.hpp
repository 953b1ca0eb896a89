// The keys of [model] of kind "command".
#pragma once

#include <filesystem>

#include "mottle/drivers/command/solver_command.hpp"
#include "study/input/toml_reader.hpp"

namespace mottle {

SolverCommand read_command(TomlReader& reader, const std::filesystem::path& folder);

}  // namespace mottle
