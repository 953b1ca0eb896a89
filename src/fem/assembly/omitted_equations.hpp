// Which equations a static reduction omits.
#pragma once

#include <vector>

#include "fem/assembly/equation_map.hpp"
#include "mottle/layers.hpp"

namespace mottle::fem {

/// By equation; empty: none is omitted. `map` as it is before AUTOSPC constrains equations.
///
/// @throws InvalidInput  a degree of freedom of the analysis or omitted set that is fixed, dependent or in both sets
std::vector<bool> omitted_equations(const FiniteElementModel& model, const EquationMap& map);

}  // namespace mottle::fem
