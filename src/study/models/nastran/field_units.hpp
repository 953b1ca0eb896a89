// Units of the numbers on Nastran's cards.
#pragma once

#include <string>

#include "mottle/layers.hpp"
#include "mottle/model/units.hpp"

namespace mottle::study {

/// Unit of a card's number, from what its name means on that card; names in capitals.
std::string field_unit(const std::string& card, const std::string& field, const UnitNames& units);

}  // namespace mottle::study
