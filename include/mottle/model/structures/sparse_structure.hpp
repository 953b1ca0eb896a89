// A structure with sparse matrices: how its modes and clouds are found. What the matrices are is the derived class's.
#pragma once

#include <filesystem>
#include <map>
#include <memory>
#include <mutex>
#include <optional>
#include <vector>

#include "mottle/fem/assembly/separable_matrix.hpp"
#include "mottle/linalg/reduced/reduced_model.hpp"
#include "mottle/linalg/sparse/sparse_modes.hpp"
#include "mottle/model/structures/modal_structure.hpp"

namespace mottle {

/// How clouds may be solved.
struct ReductionSettings {
  double frequency_error = 1e-4;  ///< that a sample may have, relative
  Eigen::VectorXd nominal = {};   ///< where the reduced model begins [parameter]
  Eigen::MatrixXd training = {};  ///< samples that the reduced model learns from [sample x parameter]
  std::filesystem::path cache{};  ///< folder where trained models are kept; empty: nowhere. Changes no number
};

/// Solves K(x) phi = lambda M(x) phi sample by sample with sparse factors, or clouds by a certified reduced model where
/// K and M are sums of known functions of x times constant matrices.
class SparseStructure : public ModalStructure {
 public:
  bool is_damped() const override { return false; }
  ModeSet modes_at(const Eigen::Ref<const Eigen::VectorXd>& parameters, int modes) const override;
  /// By the reduced model where one is allowed and worth its cost, samples beyond its bounds refined or exactly; a
  /// sample's numbers then depend on the batch that it is in.
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
  bool has_cheap_derivatives() const override { return !reduction_; }
  double difference_step() const override { return reduction_ ? k_coarse_difference_step : k_usual_difference_step; }
  Eigen::Index batch_size() const override { return reduction_ ? 2048 : 64; }

  /// Allows clouds to be solved by a reduced model; nothing changes where the parameters are not separable or the model
  /// is small.
  void allow_reduction(ReductionSettings settings);

  /// Modes of one sample with everything that is known about them.
  SparseModes solve_one(const Eigen::Ref<const Eigen::VectorXd>& parameters, const SparseModesOptions& options) const;
  /// Why a sample has no modes, in the model's terms; empty where it has.
  std::string failure_text(const SparseModes& modes) const;

 protected:
  struct Matrices {
    SparseMatrix stiffness, mass;
  };

  /// The terms of K(x) and M(x); where is_separable() is false they hold where terms_hold_at() says so.
  virtual const SeparableMatrix& stiffness_terms() const = 0;
  virtual const SeparableMatrix& mass_terms() const = 0;
  virtual bool is_separable() const { return true; }
  /// Whether the terms give the matrices at these parameters, and their derivative by this one.
  virtual bool terms_hold_at(const Eigen::Ref<const Eigen::VectorXd>& /*parameters*/,
                             Eigen::Index /*parameter*/) const {
    return is_separable();
  }
  virtual Matrices matrices_at(const Eigen::Ref<const Eigen::VectorXd>& parameters) const;
  /// What the user calls a row of the matrices.
  virtual std::string equation_name(int row) const = 0;

  /// Parameters whose mass matrix weighs cosines; to be set before anything is solved.
  void set_reference(const Eigen::Ref<const Eigen::VectorXd>& reference);

  /// "exactly separable, linearly: no re-assembly"; empty where the parameter stands in no term.
  std::string separable_role(Eigen::Index parameter) const;

 private:
  Matrices derivative_at(const Eigen::Ref<const Eigen::VectorXd>& parameters, Eigen::Index parameter) const;
  /// From phi_ref' M phi and the squared M-lengths of the phi.
  static Eigen::MatrixXd cosines_from(const Eigen::MatrixXd& products, const Eigen::RowVectorXd& squares);
  struct Observer;
  /// Solves and visits the given rows of `samples`.
  void solve_exactly(const Eigen::Ref<const Eigen::MatrixXd>& samples, const std::vector<Eigen::Index>& rows, int modes,
                     const Observer& observer, const RunContext& context, const Visitor& visit) const;
  struct Unsure;
  /// Visits the rows that the reduced model is sure of and returns the others.
  Unsure solve_reduced(const ReducedModel& reduced, const Eigen::Ref<const Eigen::MatrixXd>& samples,
                       const std::vector<Eigen::Index>& rows, const Observer& observer, const RunContext& context,
                       const Visitor& visit, SolverUse& use) const;
  /// Refines the given rows, visits those that it makes sure of and returns the others.
  std::vector<Eigen::Index> refine(const ReducedModel& reduced, const Eigen::Ref<const Eigen::MatrixXd>& samples,
                                   const std::vector<Eigen::Index>& rows, const Observer& observer,
                                   const RunContext& context, const Visitor& visit, SolverUse& use) const;
  std::vector<Eigen::Index> reduce(const Eigen::Ref<const Eigen::MatrixXd>& samples, int modes,
                                   const Observer& observer, const RunContext& context, const Visitor& visit,
                                   SolverUse& use) const;
  /// Null where the nominal model cannot be solved.
  const ReducedModel* trained_model(int modes, const RunContext& context) const;
  TermCoefficients coefficients_at(const Eigen::Ref<const Eigen::MatrixXd>& samples) const;
  std::unique_ptr<SparseModeSolver> take_solver() const;
  void give_back(std::unique_ptr<SparseModeSolver> solver) const;

  SparseMatrix reference_mass_;
  std::optional<ReductionSettings> reduction_;
  mutable std::mutex reduction_mutex_;  // of the next two
  mutable std::unique_ptr<ReducedModel> reduced_;
  mutable int reduced_modes_ = 0;
  mutable std::mutex mutex_;  // of the pool: solvers keep their symbolic factorisation, one a thread
  mutable std::vector<std::unique_ptr<SparseModeSolver>> solvers_;
  mutable std::mutex differences_mutex_;  // of the next two: two assemblies each, asked for once for every mode's shape
  mutable Eigen::VectorXd differences_at_;
  mutable std::map<Eigen::Index, Matrices> differences_;
};

}  // namespace mottle
