#include "fem/assembly/equation_map.hpp"

#include <algorithm>
#include <map>

#include "mottle/core/error.hpp"

namespace mottle::fem {
namespace {

constexpr int k_free = 0;

/// Replaces dependent slots on the right-hand sides by their own sums, depth first.
class Resolver {
 public:
  Resolver(const FiniteElementModel& model, const std::vector<DependentDegreeOfFreedom>& equations,
           const std::map<int, std::size_t>& equation_of)
      : model_(model),
        equations_(equations),
        equation_of_(equation_of),
        stage_(equations.size(), 0),
        sums_(equations.size()) {}

  const std::vector<DependentDegreeOfFreedom::Term>& resolve(std::size_t index) {
    constexpr int k_open = 1;
    constexpr int k_done = 2;
    const DependentDegreeOfFreedom& equation = equations_[index];
    require(stage_[index] != k_open, "{}: {} depends on itself through other constraints", equation.source,
            degree_of_freedom_name(model_, equation.degree_of_freedom / 6, equation.degree_of_freedom % 6));
    if (stage_[index] == k_done) return sums_[index];
    stage_[index] = k_open;
    std::map<int, double> sum;
    for (const auto& term : equation.terms) {
      const auto found = equation_of_.find(term.degree_of_freedom);
      if (found == equation_of_.end()) {
        sum[term.degree_of_freedom] += term.coefficient;
        continue;
      }
      for (const auto& inner : resolve(found->second))
        sum[inner.degree_of_freedom] += term.coefficient * inner.coefficient;
    }
    for (const auto& [slot, coefficient] : sum) sums_[index].push_back({slot, coefficient});
    stage_[index] = k_done;
    return sums_[index];
  }

 private:
  const FiniteElementModel& model_;
  const std::vector<DependentDegreeOfFreedom>& equations_;
  const std::map<int, std::size_t>& equation_of_;
  std::vector<int> stage_;
  std::vector<std::vector<DependentDegreeOfFreedom::Term>> sums_;
};

}  // namespace

EquationMap::EquationMap(const FiniteElementModel& model) : state_(6 * model.nodes.size(), k_free) {
  fix(model);
  const std::vector<DependentDegreeOfFreedom> equations = dependent_degrees_of_freedom(model);
  std::map<int, std::size_t> equation_of;
  for (std::size_t k = 0; k < equations.size(); ++k) {
    const int slot = equations[k].degree_of_freedom;
    const std::string name = degree_of_freedom_name(model, slot / 6, slot % 6);
    require(state(slot) != k_fixed, "{}: {} is dependent here and fixed by SPC or on its GRID card; take one away",
            equations[k].source, name);
    const auto [previous, is_new] = equation_of.emplace(slot, k);
    require(is_new, "{}: {} is dependent here and already in {}; a component can depend once", equations[k].source,
            name, equations[previous->second].source);
  }
  for (std::size_t k = 0; k < equations.size(); ++k) {
    state_[static_cast<std::size_t>(equations[k].degree_of_freedom)] = k_dependent - static_cast<int>(k);
  }
  number();
  Resolver resolver(model, equations, equation_of);
  for (std::size_t k = 0; k < equations.size(); ++k) {
    std::vector<Term> sum;
    for (const auto& term : resolver.resolve(k)) {
      if (state(term.degree_of_freedom) >= 0) sum.push_back({state(term.degree_of_freedom), term.coefficient});
    }
    sums_.push_back(std::move(sum));
  }
}

void EquationMap::fix(const FiniteElementModel& model) {
  for (std::size_t node = 0; node < model.nodes.size(); ++node) {
    for (std::size_t c = 1; model.nodes[node].is_scalar && c < 6; ++c) state_[6 * node + c] = k_fixed;
  }
  for (const auto& [node, components] : model.fixed) {
    for (int c = 0; c < 6; ++c) {
      if (((components >> c) & 1) != 0) state_[static_cast<std::size_t>(degree_of_freedom(node, c))] = k_fixed;
    }
  }
}

void EquationMap::number() {
  equations_.clear();
  for (std::size_t slot = 0; slot < state_.size(); ++slot) {
    if (state_[slot] < 0) continue;
    state_[slot] = static_cast<int>(equations_.size());
    equations_.push_back({static_cast<int>(slot / 6), static_cast<int>(slot % 6)});
  }
}

void EquationMap::constrain(const std::vector<bool>& is_constrained) {
  std::vector<int> renumbered(is_constrained.size(), k_fixed);
  int next = 0;
  for (std::size_t k = 0; k < is_constrained.size(); ++k) {
    if (!is_constrained[k]) renumbered[k] = next++;
  }
  for (int& slot : state_) {
    if (slot >= 0) slot = renumbered[static_cast<std::size_t>(slot)];
  }
  for (std::vector<Term>& sum : sums_) {
    for (Term& term : sum) term.equation = renumbered[static_cast<std::size_t>(term.equation)];
    std::erase_if(sum, [](const Term& term) { return term.equation == k_fixed; });
  }
  std::erase_if(equations_, [&, k = std::size_t{0}](const Equation&) mutable { return is_constrained[k++]; });
}

}  // namespace mottle::fem
