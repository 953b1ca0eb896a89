#include "mottle/model/structures/sparse_structure.hpp"

#include <algorithm>
#include <cmath>
#include <limits>

#include "mottle/core/error.hpp"
#include "mottle/dynamics/modes/sensitivity.hpp"

namespace mottle {

void SparseStructure::set_reference(const Eigen::Ref<const Eigen::VectorXd>& reference) {
  reference_mass_ = matrices_at(reference).mass;
}

SparseStructure::Matrices SparseStructure::matrices_at(const Eigen::Ref<const Eigen::VectorXd>& parameters) const {
  return {stiffness_terms().at(parameters), mass_terms().at(parameters)};
}

SparseStructure::Matrices SparseStructure::derivative_at(const Eigen::Ref<const Eigen::VectorXd>& parameters,
                                                         Eigen::Index parameter) const {
  if (terms_hold_at(parameters, parameter)) {
    const int p = static_cast<int>(parameter);
    return {stiffness_terms().derivative(parameters, p), mass_terms().derivative(parameters, p)};
  }
  {
    const std::lock_guard lock(differences_mutex_);
    if (differences_at_.size() != parameters.size() || differences_at_ != parameters) {
      differences_at_ = parameters;
      differences_.clear();
    }
    const auto known = differences_.find(parameter);
    if (known != differences_.end()) return known->second;
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
  Matrices result{slope(after.stiffness, before.stiffness), slope(after.mass, before.mass)};
  const std::lock_guard lock(differences_mutex_);
  if (differences_at_.size() == parameters.size() && differences_at_ == parameters) differences_[parameter] = result;
  return result;
}

std::unique_ptr<SparseModeSolver> SparseStructure::take_solver() const {
  const std::lock_guard lock(mutex_);
  if (solvers_.empty()) return std::make_unique<SparseModeSolver>();
  auto solver = std::move(solvers_.back());
  solvers_.pop_back();
  return solver;
}

void SparseStructure::give_back(std::unique_ptr<SparseModeSolver> solver) const {
  const std::lock_guard lock(mutex_);
  solvers_.push_back(std::move(solver));
}

SparseModes SparseStructure::solve_one(const Eigen::Ref<const Eigen::VectorXd>& parameters,
                                       const SparseModesOptions& options) const {
  const Matrices matrices = matrices_at(parameters);
  auto solver = take_solver();
  SparseModes modes = solver->solve(matrices.stiffness, matrices.mass, options);
  give_back(std::move(solver));
  return modes;
}

std::string SparseStructure::failure_text(const SparseModes& modes) const {
  if (modes.failed_row < 0) return modes.failure;
  return fmt::format("{} (first seen at {})", modes.failure, equation_name(modes.failed_row));
}

ModeSet SparseStructure::modes_at(const Eigen::Ref<const Eigen::VectorXd>& parameters, int modes) const {
  SparseModes found = solve_one(parameters, {.modes = modes, .counts_below = true});
  require(found.failure.empty(), "model: it cannot be solved at the parameters' means: {}", failure_text(found));
  if (!found.is_complete()) {
    throw ModelFailure(
        fmt::format("the solver found {} modes below {:.6g} (rad/s)^2 where the inertia of K - s M counts {}",
                    found.values.size(), found.counted_at, found.counted_below));
  }
  return {found.values, found.vectors};
}

Eigen::MatrixXd SparseStructure::cosines(const ModeSet& reference, const ModeSet& modes) const {
  const Eigen::MatrixXd weighed = symmetric_product(reference_mass_, modes.shapes);
  const Eigen::RowVectorXd squares = modes.shapes.cwiseProduct(weighed).colwise().sum();
  return cosines_from(reference.shapes.transpose() * weighed, squares);
}

Eigen::MatrixXd SparseStructure::cosines_from(const Eigen::MatrixXd& products, const Eigen::RowVectorXd& squares) {
  return (products * squares.cwiseSqrt().cwiseInverse().asDiagonal()).cwiseMax(-1.0).cwiseMin(1.0);
}

Eigen::MatrixXd SparseStructure::eigenvalue_derivatives(const Eigen::Ref<const Eigen::VectorXd>& parameters,
                                                        const ModeSet& modes) const {
  Eigen::MatrixXd derivatives(modes.eigenvalues.size(), parameter_count());
  for (Eigen::Index i = 0; i < parameter_count(); ++i) {
    const Matrices d = derivative_at(parameters, i);
    derivatives.col(i) = eigenvalue_sensitivity_from_products(modes, symmetric_product(d.stiffness, modes.shapes),
                                                              symmetric_product(d.mass, modes.shapes));
  }
  return derivatives;
}

Eigen::MatrixXd SparseStructure::shape_derivatives(const Eigen::Ref<const Eigen::VectorXd>& parameters,
                                                   const ModeSet& modes, int mode) const {
  const Matrices at = matrices_at(parameters);
  const auto shape = modes.shapes.col(mode);
  Eigen::MatrixXd elastic(shape.size(), parameter_count());
  Eigen::MatrixXd inertial(shape.size(), parameter_count());
  for (Eigen::Index i = 0; i < parameter_count(); ++i) {
    const Matrices d = derivative_at(parameters, i);
    elastic.col(i) = symmetric_product(d.stiffness, shape);
    inertial.col(i) = symmetric_product(d.mass, shape);
  }
  return nelson_shape_sensitivity(at.stiffness, at.mass, modes, mode, elastic, inertial);
}

Eigen::VectorXd SparseStructure::damping_ratios(const Eigen::Ref<const Eigen::VectorXd>&, const ModeSet& modes) const {
  return Eigen::VectorXd::Constant(modes.eigenvalues.size(), std::numeric_limits<double>::quiet_NaN());
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

}  // namespace mottle
