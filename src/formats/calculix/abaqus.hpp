// What Abaqus writes beyond CalculiX's cards, put into those: parts and instances, output requests, named supports.
#pragma once

#include <string>
#include <vector>

#include "mottle/formats/calculix/deck.hpp"
#include "mottle/layers.hpp"

namespace mottle::formats {

/// Whether a deck has cards that only Abaqus writes: parts, an assembly, its output requests.
bool is_abaqus_deck(const CalculixDeck& deck);

struct FlatDeck {
  std::vector<std::string> lines;
  std::vector<std::string> notes;  ///< what was left out, and how nodes and elements are numbered
};

/// The same structure with CalculiX's cards alone.
///
/// Nodes and elements of the first instance keep their numbers, those of each further one, and then those of the
/// assembly itself, have a thousand (or the power of ten that is needed) added once more. Sets and surfaces of an
/// instance are called INSTANCE.NAME, as Abaqus calls them from outside. Coordinates are moved and turned with the
/// instance. Cards that need not be known here stay as they are: CalculiX says which of them it does not know.
///
/// @param lines         text of each line of the deck, with other numbers where they are wanted
/// @throws FormatError  a part that is missing, cards inside a part that have no place in a flat deck
FlatDeck flatten(const CalculixDeck& deck, const std::vector<std::string>& lines);

}  // namespace mottle::formats
