// A finite-element model with parameters on its card fields, solved sample by sample with sparse matrices.
#pragma once

#include <memory>
#include <mutex>
#include <optional>
#include <vector>

#include "mottle/fem/assembly.hpp"
#include "mottle/linalg/reduced_model.hpp"
#include "mottle/linalg/sparse_modes.hpp"
#include "mottle/model/field_targets.hpp"
#include "mottle/model/modal_structure.hpp"

namespace mottle {

/// How clouds may be solved.
struct ReductionSettings {
  double frequency_error = 1e-4;  ///< that a sample may have, relative
  Eigen::VectorXd nominal = {};   ///< where the reduced model begins [parameter]
  Eigen::MatrixXd training = {};  ///< samples that the reduced model learns from [sample x parameter]
};

/// K(x) = sum of powers of x times constant matrices where the parameters allow it, re-assembled for each sample where
/// not. Shapes have a row for each equation; degrees of freedom are named "101:+Z", "101:+RX", in the displacement
/// system of the grid point.
class FiniteElementStructure final : public ModalStructure {
 public:
  /// @param fallback  parts of the reference where a parameter's cards differ in value [parameter]
  /// Throws InvalidInput: what find_field_targets() and assemble() refuse, a parameter that acts on no element.
  FiniteElementStructure(FiniteElementModel model, const std::vector<ParameterTargets>& parameters,
                         const Eigen::VectorXd& fallback);

  Eigen::Index parameter_count() const override { return static_cast<Eigen::Index>(targets_.parameters.size()); }
  Eigen::Index mode_count() const override { return static_cast<Eigen::Index>(assembled_.equations.size()); }
  bool is_damped() const override { return false; }
  int find_degree_of_freedom(const std::string& name) const override;
  std::string unknown_degree_of_freedom(const std::string& name) const override;
  Eigen::MatrixXd displacements(const Eigen::Ref<const Eigen::MatrixXd>& shapes,
                                const std::vector<int>& degrees_of_freedom) const override;
  ModeSet modes_at(const Eigen::Ref<const Eigen::VectorXd>& parameters, int modes) const override;
  /// By the reduced model where one is allowed and worth its cost, samples beyond its bounds exactly; a sample's
  /// numbers then depend on the batch that it is in.
  SolverUse solve(const Eigen::Ref<const Eigen::MatrixXd>& samples, int modes, const ModalObservation& observation,
                  const RunContext& context, const Visitor& visit) const override;
  /// Weighted by the mass matrix of the reference, so that rotations and dense meshes count as they should.
  Eigen::MatrixXd cosines(const ModeSet& reference, const ModeSet& modes) const override;
  Eigen::MatrixXd eigenvalue_derivatives(const Eigen::Ref<const Eigen::VectorXd>& parameters,
                                         const ModeSet& modes) const override;
  Eigen::MatrixXd shape_derivatives(const Eigen::Ref<const Eigen::VectorXd>& parameters, const ModeSet& modes,
                                    int mode) const override;
  Eigen::VectorXd damping_ratios(const Eigen::Ref<const Eigen::VectorXd>& parameters,
                                 const ModeSet& modes) const override;
  int modes_for_damping(int modes) const override { return modes; }
  Eigen::Index batch_size() const override { return reduction_ ? 2048 : 64; }
  double total_mass(const Eigen::Ref<const Eigen::VectorXd>& parameters) const override;
  std::vector<std::string> description(const Eigen::Ref<const Eigen::VectorXd>& parameters) const override;
  std::string parameter_role(Eigen::Index parameter) const override;

  /// Allows clouds to be solved by a reduced model; nothing changes where the parameters are not separable or the model
  /// is small.
  void allow_reduction(ReductionSettings settings);

  const FiniteElementModel& model() const { return model_; }
  const AssembledModel& assembled() const { return assembled_; }
  const std::vector<PhysicalLimit>& limits() const { return targets_.limits; }
  /// The parameters of the deck as it stands: 1 for factors, the cards' value otherwise [parameter].
  const Eigen::VectorXd& reference() const { return reference_; }

  /// Modes of one sample with everything that is known about them.
  SparseModes solve_one(const Eigen::Ref<const Eigen::VectorXd>& parameters, const SparseModesOptions& options) const;
  /// Why a sample has no modes, in the deck's terms; empty where it has.
  std::string failure_text(const SparseModes& modes) const;

 private:
  struct Matrices {
    SparseMatrix stiffness, mass;
  };
  Matrices matrices_at(const Eigen::Ref<const Eigen::VectorXd>& parameters) const;
  Matrices derivative_at(const Eigen::Ref<const Eigen::VectorXd>& parameters, Eigen::Index parameter) const;
  /// From phi_ref' M phi and the squared M-lengths of the phi.
  static Eigen::MatrixXd cosines_from(const Eigen::MatrixXd& products, const Eigen::RowVectorXd& squares);
  struct Observer;
  /// Solves and visits the given rows of `samples`.
  void solve_exactly(const Eigen::Ref<const Eigen::MatrixXd>& samples, const std::vector<Eigen::Index>& rows, int modes,
                     const Observer& observer, const RunContext& context, const Visitor& visit) const;
  /// Visits the rows that the reduced model is sure of and returns the others.
  std::vector<Eigen::Index> solve_reduced(const ReducedModel& reduced, const Eigen::Ref<const Eigen::MatrixXd>& samples,
                                          const std::vector<Eigen::Index>& rows, const Observer& observer,
                                          const RunContext& context, const Visitor& visit, SolverUse& use) const;
  std::vector<Eigen::Index> reduce(const Eigen::Ref<const Eigen::MatrixXd>& samples, int modes,
                                   const Observer& observer, const RunContext& context, const Visitor& visit,
                                   SolverUse& use) const;
  /// Null where the nominal model cannot be solved.
  const ReducedModel* trained_model(int modes, int threads) const;
  TermCoefficients coefficients_at(const Eigen::Ref<const Eigen::MatrixXd>& samples) const;
  std::unique_ptr<SparseModeSolver> take_solver() const;
  void give_back(std::unique_ptr<SparseModeSolver> solver) const;

  FiniteElementModel model_;
  FieldTargets targets_;
  AssembledModel assembled_;
  Eigen::VectorXd reference_;
  bool is_separable_ = true;
  SparseMatrix reference_mass_;
  std::optional<ReductionSettings> reduction_;
  mutable std::mutex reduction_mutex_;  // of the next two
  mutable std::unique_ptr<ReducedModel> reduced_;
  mutable int reduced_modes_ = 0;
  mutable std::mutex mutex_;  // of the pool: solvers keep their symbolic factorisation, one a thread
  mutable std::vector<std::unique_ptr<SparseModeSolver>> solvers_;
};

}  // namespace mottle
