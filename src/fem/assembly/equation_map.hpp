// From the slots of all nodes to the equations: fixed, dependent and free degrees of freedom.
#pragma once

#include <vector>

#include "fem/assembly/constraint_equations.hpp"
#include "mottle/fem/assembly/assembly.hpp"
#include "mottle/layers.hpp"

namespace mottle::fem {

/// Each slot (6 node + component) is free (an equation of its own), fixed, or a sum of equations.
class EquationMap {
 public:
  struct Term {
    int equation = 0;
    double coefficient = 0.0;
  };

  /// Throws InvalidInput, see assemble().
  explicit EquationMap(const FiniteElementModel& model);

  int equation_count() const { return static_cast<int>(equations_.size()); }
  int dependent_count() const { return static_cast<int>(sums_.size()); }
  const std::vector<Equation>& equations() const { return equations_; }

  /// Equation of a free slot; k_fixed; or k_dependent - index of its sum.
  int state(int slot) const { return state_[static_cast<std::size_t>(slot)]; }
  const std::vector<Term>& sum(int state) const { return sums_[static_cast<std::size_t>(k_dependent - state)]; }

  /// Fixes equations and renumbers the others.
  void constrain(const std::vector<bool>& is_constrained);

  static constexpr int k_fixed = -1;
  static constexpr int k_dependent = -2;

 private:
  void fix(const FiniteElementModel& model);
  void number();

  std::vector<int> state_;
  std::vector<std::vector<Term>> sums_;
  std::vector<Equation> equations_;
};

}  // namespace mottle::fem
