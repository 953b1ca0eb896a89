// A solver's command as bytes, for other processes to do the same runs.
#pragma once

#include <string>

#include "mottle/core/bytes.hpp"
#include "mottle/drivers/command/solver_command.hpp"
#include "mottle/layers.hpp"

namespace mottle::drivers {

void append_command(std::string& bytes, const SolverCommand& command);
/// Whether it was all there.
bool read_command(ByteReader& reader, SolverCommand& command);

}  // namespace mottle::drivers
