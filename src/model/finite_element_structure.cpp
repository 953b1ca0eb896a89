#include "mottle/model/finite_element_structure.hpp"

#include <algorithm>
#include <charconv>
#include <cmath>
#include <limits>

#include "mottle/core/error.hpp"
#include "mottle/core/parallel.hpp"
#include "mottle/core/text.hpp"
#include "mottle/fem/mass_properties.hpp"
#include "mottle/modal/sensitivity.hpp"

namespace mottle {
namespace {

constexpr const char* k_no_role = "acts on no element";

const char* const k_components[] = {"+X", "+Y", "+Z", "+RX", "+RY", "+RZ"};

}  // namespace

FiniteElementStructure::FiniteElementStructure(FiniteElementModel model,
                                               const std::vector<ParameterTargets>& parameters,
                                               const Eigen::VectorXd& fallback)
    : model_(std::move(model)),
      targets_(find_field_targets(model_, parameters)),
      assembled_(assemble(model_, targets_.parameters)) {
  for (const GeometryTarget& target : targets_.geometry) {
    for (std::size_t p = 0; p < targets_.parameters.size(); ++p) {
      const auto& fields = targets_.parameters[p].fields;
      if (std::count(fields.begin(), fields.end(), target.field) > 0) assembled_.is_separable[p] = false;
    }
  }
  is_separable_ =
      std::all_of(assembled_.is_separable.begin(), assembled_.is_separable.end(), [](bool is) { return is; });
  for (std::size_t p = 0; p < parameters.size(); ++p) {
    require(parameter_role(static_cast<Eigen::Index>(p)) != k_no_role,
            "parameter '{}': it acts on nothing: no element uses {}", parameters[p].parameter,
            join(parameters[p].targets));
  }
  reference_ = fallback;
  for (std::size_t p = 0; p < parameters.size(); ++p) {
    const FieldParameter& parameter = targets_.parameters[p];
    const double first = model_.value(parameter.fields.front());
    const bool is_one = std::all_of(parameter.fields.begin(), parameter.fields.end(),
                                    [&](FieldIndex field) { return model_.value(field) == first; });
    if (parameter.is_factor || is_one) reference_(static_cast<Eigen::Index>(p)) = parameter.is_factor ? 1.0 : first;
  }
  reference_mass_ = matrices_at(reference_).mass;
}

FiniteElementStructure::Matrices FiniteElementStructure::matrices_at(
    const Eigen::Ref<const Eigen::VectorXd>& parameters) const {
  if (is_separable_) return {assembled_.stiffness.at(parameters), assembled_.mass.at(parameters)};
  FiniteElementModel deck = model_at(model_, targets_, parameters);
  // What AUTOSPC holds is settled by the reference, so that shapes of all samples have the same rows.
  deck.settings.automatic_constraints = false;
  for (const AutomaticConstraint& held : assembled_.automatic_constraints) {
    deck.fixed.emplace_back(held.node, static_cast<Components>(1 << held.component));
  }
  const AssembledModel moved = assemble(deck, {});
  const Eigen::VectorXd none;
  return {moved.stiffness.at(none), moved.mass.at(none)};
}

FiniteElementStructure::Matrices FiniteElementStructure::derivative_at(
    const Eigen::Ref<const Eigen::VectorXd>& parameters, Eigen::Index parameter) const {
  if (is_separable_) {
    const int p = static_cast<int>(parameter);
    return {assembled_.stiffness.derivative(parameters, p), assembled_.mass.derivative(parameters, p)};
  }
  // Central differences of the matrices: third-order small, and free of the rounding that eigenvalues would add.
  constexpr double k_step = 1e-5;
  const double step = k_step * std::max(std::abs(parameters(parameter)), 1e-3);
  Eigen::VectorXd moved = parameters;
  moved(parameter) = parameters(parameter) + step;
  const Matrices after = matrices_at(moved);
  moved(parameter) = parameters(parameter) - step;
  const Matrices before = matrices_at(moved);
  return {(after.stiffness - before.stiffness) * (0.5 / step), (after.mass - before.mass) * (0.5 / step)};
}

std::unique_ptr<SparseModeSolver> FiniteElementStructure::take_solver() const {
  const std::lock_guard lock(mutex_);
  if (solvers_.empty()) return std::make_unique<SparseModeSolver>();
  auto solver = std::move(solvers_.back());
  solvers_.pop_back();
  return solver;
}

void FiniteElementStructure::give_back(std::unique_ptr<SparseModeSolver> solver) const {
  const std::lock_guard lock(mutex_);
  solvers_.push_back(std::move(solver));
}

SparseModes FiniteElementStructure::solve_one(const Eigen::Ref<const Eigen::VectorXd>& parameters,
                                              const SparseModesOptions& options) const {
  const Matrices matrices = matrices_at(parameters);
  auto solver = take_solver();
  SparseModes modes = solver->solve(matrices.stiffness, matrices.mass, options);
  give_back(std::move(solver));
  return modes;
}

std::string FiniteElementStructure::failure_text(const SparseModes& modes) const {
  if (modes.failed_row < 0) return modes.failure;
  const Equation& equation = assembled_.equations[static_cast<std::size_t>(modes.failed_row)];
  return fmt::format("{} (first seen at {})", modes.failure,
                     degree_of_freedom_name(model_, equation.node, equation.component));
}

int FiniteElementStructure::find_degree_of_freedom(const std::string& name) const {
  int id = 0;
  const auto [end, error] = std::from_chars(name.data(), name.data() + name.size(), id);
  const int node = error == std::errc() ? model_.find_node(id) : -1;
  if (node < 0) return -1;
  const std::string rest(end, name.data() + name.size());
  const bool is_scalar = model_.nodes[static_cast<std::size_t>(node)].is_scalar;
  if (is_scalar) return rest.empty() ? 6 * node : -1;
  for (int c = 0; c < 6; ++c) {
    if (rest == fmt::format(":{}", k_components[c])) return 6 * node + c;
  }
  return -1;
}

std::string FiniteElementStructure::unknown_degree_of_freedom(const std::string& name) const {
  constexpr const char* k_form =
      "a degree of freedom is GRID:DIRECTION, like 101:+Z or 101:+RX, with directions +X +Y +Z "
      "+RX +RY +RZ of the grid point's displacement system";
  if (name.empty()) return fmt::format("none is named; {}", k_form);
  int id = 0;
  const bool is_number = std::from_chars(name.data(), name.data() + name.size(), id).ec == std::errc();
  if (is_number && model_.find_node(id) < 0) return fmt::format("'{}': the deck has no grid point {}", name, id);
  return fmt::format("'{}' is not known here; {}", name, k_form);
}

Eigen::MatrixXd FiniteElementStructure::displacements(const Eigen::Ref<const Eigen::MatrixXd>& shapes,
                                                      const std::vector<int>& degrees_of_freedom) const {
  Eigen::MatrixXd result = Eigen::MatrixXd::Zero(static_cast<Eigen::Index>(degrees_of_freedom.size()), shapes.cols());
  for (Eigen::Index k = 0; k < result.rows(); ++k) {
    const int slot = degrees_of_freedom[static_cast<std::size_t>(k)];
    for (decltype(assembled_.expansion)::InnerIterator entry(assembled_.expansion, slot); entry; ++entry) {
      result.row(k) += entry.value() * shapes.row(entry.col());
    }
  }
  return result;
}

ModeSet FiniteElementStructure::modes_at(const Eigen::Ref<const Eigen::VectorXd>& parameters, int modes) const {
  SparseModes found = solve_one(parameters, {.modes = modes, .counts_below = true});
  require(found.failure.empty(), "model: it cannot be solved at the parameters' means: {}", failure_text(found));
  if (!found.is_complete()) {
    throw SystemFailure(
        fmt::format("the solver found {} modes below {:.6g} (rad/s)^2 where the inertia of K - s M counts {}",
                    found.values.size(), found.counted_at, found.counted_below));
  }
  return {found.values, found.vectors};
}

Eigen::MatrixXd FiniteElementStructure::cosines(const ModeSet& reference, const ModeSet& modes) const {
  const Eigen::MatrixXd weighed = symmetric_product(reference_mass_, modes.shapes);
  const Eigen::RowVectorXd squares = modes.shapes.cwiseProduct(weighed).colwise().sum();
  return cosines_from(reference.shapes.transpose() * weighed, squares);
}

Eigen::MatrixXd FiniteElementStructure::cosines_from(const Eigen::MatrixXd& products,
                                                     const Eigen::RowVectorXd& squares) {
  return (products * squares.cwiseSqrt().cwiseInverse().asDiagonal()).cwiseMax(-1.0).cwiseMin(1.0);
}

Eigen::MatrixXd FiniteElementStructure::eigenvalue_derivatives(const Eigen::Ref<const Eigen::VectorXd>& parameters,
                                                               const ModeSet& modes) const {
  Eigen::MatrixXd derivatives(modes.eigenvalues.size(), parameter_count());
  for (Eigen::Index i = 0; i < parameter_count(); ++i) {
    const Matrices d = derivative_at(parameters, i);
    derivatives.col(i) = eigenvalue_sensitivity_from_products(modes, symmetric_product(d.stiffness, modes.shapes),
                                                              symmetric_product(d.mass, modes.shapes));
  }
  return derivatives;
}

Eigen::MatrixXd FiniteElementStructure::shape_derivatives(const Eigen::Ref<const Eigen::VectorXd>& parameters,
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

Eigen::VectorXd FiniteElementStructure::damping_ratios(const Eigen::Ref<const Eigen::VectorXd>&,
                                                       const ModeSet& modes) const {
  return Eigen::VectorXd::Constant(modes.eigenvalues.size(), std::numeric_limits<double>::quiet_NaN());
}

double FiniteElementStructure::total_mass(const Eigen::Ref<const Eigen::VectorXd>& parameters) const {
  return mass_properties(model_at(model_, targets_, parameters)).mass.mean();
}

std::string FiniteElementStructure::parameter_role(Eigen::Index parameter) const {
  if (!assembled_.is_separable[static_cast<std::size_t>(parameter)]) return "re-assembled for each sample";
  int highest = 0;
  for (const SeparableMatrix* matrix : {&assembled_.stiffness, &assembled_.mass, &assembled_.damping}) {
    for (const SeparableMatrix::Term& term : matrix->terms) {
      for (const ParameterPower& power : term.coefficient) {
        if (power.parameter == parameter) highest = std::max(highest, power.power);
      }
    }
  }
  if (highest == 0) return k_no_role;
  return highest == 1 ? "exactly separable, linearly: no re-assembly"
                      : fmt::format("exactly separable, powers up to {}: no re-assembly", highest);
}

}  // namespace mottle
