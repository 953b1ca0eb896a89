// The case control section: commands, subcases, and which command holds in a subcase.
#pragma once

#include <string>
#include <string_view>

#include "mottle/formats/nastran/deck.hpp"
#include "mottle/layers.hpp"

namespace mottle::formats::nastran {

/// Adds one command (its continuation lines joined, its comment removed) to the deck.
void read_case_command(std::string_view line, int file, int line_number, NastranDeck& deck);

}  // namespace mottle::formats::nastran
