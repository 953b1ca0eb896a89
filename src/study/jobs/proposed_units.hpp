// A guess at the units of a deck, from the moduli and densities of its materials.
#pragma once

#include <string>
#include <vector>

#include "mottle/fem/finite_element_model.hpp"
#include "mottle/layers.hpp"

namespace mottle::study {

struct ProposedUnits {
  std::string units = "SI";
  std::string reason;
};

/// The system in which Young's moduli and densities are nearest to those of metals and plastics, on a logarithmic
/// scale: 70 GPa and 2,700 kg/m^3. SI, with a reason that says so, where the deck has neither.
ProposedUnits propose_units(const std::vector<double>& moduli, const std::vector<double>& densities);
ProposedUnits propose_units(const FiniteElementModel& model);

}  // namespace mottle::study
