#include "fem/assembly/omitted_equations.hpp"

#include "mottle/core/error.hpp"

namespace mottle::fem {
namespace {

/// Marks a set's equations; refuses what is in another set.
void mark(const FiniteElementModel& model, const EquationMap& map, const std::vector<std::pair<int, Components>>& set,
          const char* name, std::vector<bool>& marks) {
  for (const auto& [node, components] : set) {
    for (int c = 0; c < 6; ++c) {
      if (((components >> c) & 1) == 0) continue;
      const int state = map.state(degree_of_freedom(node, c));
      require(state >= 0, "{}: {} is {}; a degree of freedom belongs to one set only, as in Nastran: take it out of {}",
              name, degree_of_freedom_name(model, node, c),
              state == EquationMap::k_fixed ? "fixed by SPC or on its GRID card"
                                            : "dependent on others by a rigid element or MPC",
              name);
      marks[static_cast<std::size_t>(state)] = true;
    }
  }
}

}  // namespace

std::vector<bool> omitted_equations(const FiniteElementModel& model, const EquationMap& map) {
  if (model.analysis_set.empty() && model.omitted_set.empty()) return {};
  std::vector<bool> kept(static_cast<std::size_t>(map.equation_count()), false);
  std::vector<bool> omitted = kept;
  mark(model, map, model.analysis_set, "ASET", kept);
  mark(model, map, model.omitted_set, "OMIT", omitted);
  for (std::size_t k = 0; k < kept.size(); ++k) {
    const Equation& equation = map.equations()[k];
    require(!kept[k] || !omitted[k], "{} is in ASET and in OMIT; take one away",
            degree_of_freedom_name(model, equation.node, equation.component));
  }
  if (model.analysis_set.empty()) return omitted;
  kept.flip();
  return kept;
}

}  // namespace mottle::fem
