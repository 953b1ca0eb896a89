// Which equations are constrained although the model does not say so: those that nothing stiffens.
#pragma once

#include <vector>

#include "fem/assembly/element_store.hpp"
#include "mottle/layers.hpp"

namespace mottle::fem {

/// By equation, at the card's values; `nodes` is their number in the model.
std::vector<bool> find_automatic_constraints(AutomaticConstraints wanted, const ElementStore& store,
                                             const EquationMap& map, std::size_t nodes);

}  // namespace mottle::fem
