// Lists of points on a card: "1 2 3", "1 THRU 9".
#pragma once

#include <functional>

#include "formats/nastran/builder.hpp"
#include "mottle/layers.hpp"

namespace mottle::formats::nastran {

/// Calls `use` for every node in fields first..last. Of a THRU range those points count that exist.
/// @throws FormatError  a point outside a range that does not exist, a range without points or turned round
void for_each_listed_node(ModelBuilder& builder, const Card& card, int first, int last,
                          const std::function<void(int)>& use);

}  // namespace mottle::formats::nastran
