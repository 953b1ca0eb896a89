// A finite-element model with parameters on its card fields.
#pragma once

#include <vector>

#include "mottle/fem/assembly/assembly.hpp"
#include "mottle/layers.hpp"
#include "mottle/model/parameters/field_targets.hpp"
#include "mottle/model/structures/sparse_structure.hpp"

namespace mottle::model {

/// K(x) = sum of powers of x times constant matrices where the parameters allow it, re-assembled for each sample where
/// not. Where the deck asks for a static reduction, M(x) is that of fem::reduce_statically(). Shapes have a row for
/// each equation; degrees of freedom are named "101:+Z", "101:+RX", in the displacement system of the grid point.
class FiniteElementStructure final : public SparseStructure {
 public:
  /// @param fallback  parts of the reference where a parameter's cards differ in value [parameter]
  /// Throws InvalidInput: what find_field_targets() and assemble() refuse, a parameter that acts on no element.
  FiniteElementStructure(FiniteElementModel model, const std::vector<ParameterTargets>& parameters,
                         const Eigen::VectorXd& fallback);

  Eigen::Index parameter_count() const override { return static_cast<Eigen::Index>(targets_.parameters.size()); }
  Eigen::Index mode_count() const override { return static_cast<Eigen::Index>(assembled_.equations.size()); }
  int find_degree_of_freedom(const std::string& name) const override;
  std::string unknown_degree_of_freedom(const std::string& name) const override;
  ObservationMatrix observation(const std::vector<int>& degrees_of_freedom) const override;
  double total_mass(const Eigen::Ref<const Eigen::VectorXd>& parameters) const override;
  std::vector<std::string> description(const Eigen::Ref<const Eigen::VectorXd>& parameters) const override;
  std::string parameter_role(Eigen::Index parameter) const override;

  const FiniteElementModel* mesh() const override { return &model_; }

  const FiniteElementModel& model() const { return model_; }
  const AssembledModel& assembled() const { return assembled_; }
  /// Fields that each parameter acts on.
  const std::vector<FieldParameter>& field_parameters() const { return targets_.parameters; }
  const std::vector<PhysicalLimit>& limits() const { return targets_.limits; }
  /// The parameters of the deck as it stands: 1 for factors, the cards' value otherwise [parameter].
  const Eigen::VectorXd& reference() const override { return reference_; }
  const SeparableMatrix& stiffness_terms() const override { return assembled_.stiffness; }
  const SeparableMatrix& mass_terms() const override { return assembled_.mass; }
  bool is_separable() const override { return is_separable_; }
  bool terms_hold_at(const Eigen::Ref<const Eigen::VectorXd>& parameters) const override;
  bool is_separable_in(Eigen::Index parameter) const override {
    return !is_reduced_ && assembled_.is_separable[static_cast<std::size_t>(parameter)];
  }
  Matrices matrices_at(const Eigen::Ref<const Eigen::VectorXd>& parameters) const override;
  std::string equation_name(int row) const override;

 private:
  bool is_as_assembled(const Eigen::Ref<const Eigen::VectorXd>& parameters) const;
  Matrices assembled_at(const Eigen::Ref<const Eigen::VectorXd>& parameters) const;

  FiniteElementModel model_;
  FieldTargets targets_;
  AssembledModel assembled_;
  Eigen::VectorXd reference_;
  bool is_separable_ = true;
  bool is_reduced_ = false;  // statically (ASET, OMIT), so that masses depend on stiffnesses
};

}  // namespace mottle::model
