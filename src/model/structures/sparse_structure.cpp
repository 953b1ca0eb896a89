#include "mottle/model/structures/sparse_structure.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

namespace mottle::model {

SparseStructure::Matrices SparseStructure::matrices_at(const Eigen::Ref<const Eigen::VectorXd>& parameters) const {
  return {stiffness_terms().at(parameters), mass_terms().at(parameters), mass_terms().is_semidefinite_at(parameters)};
}

SparseStructure::Matrices SparseStructure::derivative_at(const Eigen::Ref<const Eigen::VectorXd>& parameters,
                                                         Eigen::Index parameter) const {
  if (terms_give_derivative(parameters, parameter)) {
    const int p = static_cast<int>(parameter);
    return {stiffness_terms().derivative(parameters, p), mass_terms().derivative(parameters, p)};
  }
  // Central differences of the matrices: third-order small, and free of the rounding that eigenvalues would add.
  constexpr double k_step = 1e-5;
  const double step = k_step * std::max(std::abs(parameters(parameter)), 1e-3);
  Eigen::VectorXd moved = parameters;
  moved(parameter) = parameters(parameter) + step;
  const Matrices after = matrices_at(moved);
  moved(parameter) = parameters(parameter) - step;
  const Matrices before = matrices_at(moved);
  const auto slope = [step](const SparseMatrix& up, const SparseMatrix& down) -> SparseMatrix {
    return SparseMatrix((up - down) * (0.5 / step)).pruned(0.0, 0.0);  // most elements do not know the parameter
  };
  return {slope(after.stiffness, before.stiffness), slope(after.mass, before.mass)};
}

std::string SparseStructure::separable_role(Eigen::Index parameter) const {
  int lowest = 0;
  int highest = 0;
  for (const SeparableMatrix* matrix : {&stiffness_terms(), &mass_terms()}) {
    for (const SeparableMatrix::Term& term : matrix->terms) {
      for (const ParameterPower& power : term.coefficient) {
        if (power.parameter != parameter) continue;
        lowest = std::min(lowest, power.power);
        highest = std::max(highest, power.power);
      }
    }
  }
  if (lowest == 0 && highest == 0) return {};
  if (lowest < 0) return fmt::format("exactly separable, powers {} to {}: no re-assembly", lowest, highest);
  return highest == 1 ? "exactly separable, linearly: no re-assembly"
                      : fmt::format("exactly separable, powers up to {}: no re-assembly", highest);
}

}  // namespace mottle::model
