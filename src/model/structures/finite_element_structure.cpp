#include "mottle/model/structures/finite_element_structure.hpp"

#include <algorithm>
#include <charconv>
#include <optional>

#include "mottle/core/error.hpp"
#include "mottle/core/subject.hpp"
#include "mottle/core/text.hpp"
#include "mottle/fem/assembly/mass_properties.hpp"
#include "mottle/fem/assembly/static_reduction.hpp"
#include "mottle/linalg/sparse/negative_mass.hpp"

namespace mottle::model {
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
  is_reduced_ = has_omitted_mass(assembled_.mass, assembled_.is_omitted);
  is_separable_ = !is_reduced_ && std::all_of(assembled_.is_separable.begin(), assembled_.is_separable.end(),
                                              [](bool is) { return is; });
  for (std::size_t p = 0; p < parameters.size(); ++p) {
    require_of(parameter_role(static_cast<Eigen::Index>(p)) != k_no_role, subject_parameter(parameters[p].parameter),
               "it acts on nothing: no element uses {}", join(parameters[p].targets));
  }
  reference_ = fallback;
  for (std::size_t p = 0; p < parameters.size(); ++p) {
    const FieldParameter& parameter = targets_.parameters[p];
    const double first = model_.value(parameter.fields.front());
    const bool is_one = std::all_of(parameter.fields.begin(), parameter.fields.end(),
                                    [&](FieldIndex field) { return model_.value(field) == first; });
    if (parameter.is_factor || is_one) reference_(static_cast<Eigen::Index>(p)) = parameter.is_factor ? 1.0 : first;
  }
}

bool FiniteElementStructure::terms_hold_at(const Eigen::Ref<const Eigen::VectorXd>& parameters) const {
  return !is_reduced_ && is_as_assembled(parameters);
}

/// Whether the terms give K and M before a reduction.
bool FiniteElementStructure::is_as_assembled(const Eigen::Ref<const Eigen::VectorXd>& parameters) const {
  for (std::size_t p = 0; p < targets_.parameters.size(); ++p) {
    if (assembled_.is_separable[p]) continue;
    const FieldParameter& other = targets_.parameters[p];
    const double value = parameters(static_cast<Eigen::Index>(p));
    const bool is_as_assembled = std::all_of(other.fields.begin(), other.fields.end(), [&](FieldIndex field) {
      return value == (other.is_factor ? 1.0 : model_.value(field));
    });
    if (!is_as_assembled) return false;
  }
  return true;
}

FiniteElementStructure::Matrices FiniteElementStructure::matrices_at(
    const Eigen::Ref<const Eigen::VectorXd>& parameters) const {
  Matrices matrices = is_as_assembled(parameters) ? SparseStructure::matrices_at(parameters) : assembled_at(parameters);
  if (is_reduced_) {
    if (!matrices.is_mass_semidefinite) {  // the kept rows alone may hide it
      const std::optional<NegativeMass> negative = find_negative_mass(matrices.stiffness, matrices.mass);
      if (negative) throw InvalidInput(describe(*negative, equation_name(negative->row)));
    }
    reduce_statically(matrices.stiffness, matrices.mass, assembled_.is_omitted,
                      [this](int row) { return equation_name(row); });
    matrices.is_mass_semidefinite = true;
  }
  return matrices;
}

FiniteElementStructure::Matrices FiniteElementStructure::assembled_at(
    const Eigen::Ref<const Eigen::VectorXd>& parameters) const {
  FiniteElementModel deck = model_at(model_, targets_, parameters);
  // The same components are constrained at all samples, those of the reference, so that all shapes have the same rows.
  deck.settings.automatic_constraints = AutomaticConstraints::none;
  deck.analysis_set.clear();
  deck.omitted_set.clear();
  for (const AutomaticConstraint& constraint : assembled_.automatic_constraints) {
    deck.fixed.emplace_back(constraint.node, static_cast<Components>(1 << constraint.component));
  }
  const AssembledModel moved = assemble(deck, {});
  const Eigen::VectorXd none;
  return {moved.stiffness.at(none), moved.mass.at(none), moved.mass.is_semidefinite_at(none)};
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

ObservationMatrix FiniteElementStructure::observation(const std::vector<int>& degrees_of_freedom) const {
  std::vector<Eigen::Triplet<double>> entries;
  for (std::size_t k = 0; k < degrees_of_freedom.size(); ++k) {
    for (ObservationMatrix::InnerIterator entry(assembled_.expansion, degrees_of_freedom[k]); entry; ++entry) {
      entries.emplace_back(static_cast<int>(k), static_cast<int>(entry.col()), entry.value());
    }
  }
  ObservationMatrix rows(static_cast<Eigen::Index>(degrees_of_freedom.size()), mode_count());
  rows.setFromTriplets(entries.begin(), entries.end());
  return rows;
}

double FiniteElementStructure::total_mass(const Eigen::Ref<const Eigen::VectorXd>& parameters) const {
  return mass_properties(model_at(model_, targets_, parameters)).mass.mean();
}

std::string FiniteElementStructure::equation_name(int row) const {
  const Equation& equation = assembled_.equations[static_cast<std::size_t>(row)];
  return degree_of_freedom_name(model_, equation.node, equation.component);
}

std::string FiniteElementStructure::parameter_role(Eigen::Index parameter) const {
  if (!assembled_.is_separable[static_cast<std::size_t>(parameter)]) return "re-assembled for each sample";
  std::string role = separable_role(parameter);
  if (role.empty()) return k_no_role;
  return is_reduced_ ? "reduced anew for each sample (ASET, OMIT)" : role;
}

}  // namespace mottle::model
