// Solves a structure with sparse matrices sample by sample, with sparse factors.
#pragma once

#include <map>
#include <memory>
#include <mutex>
#include <vector>

#include "mottle/layers.hpp"
#include "mottle/linalg/sparse/sparse_modes.hpp"
#include "mottle/model/solvers/solver.hpp"
#include "mottle/model/structures/sparse_structure.hpp"

namespace mottle::model {

/// Cache of the derivatives of a structure's matrices at the latest point: some cost two assemblies each, and every
/// mode's shape needs them. Thread-safe.
class MatrixDerivatives {
 public:
  SparseStructure::Matrices at(const SparseStructure& structure, const Eigen::Ref<const Eigen::VectorXd>& parameters,
                               Eigen::Index parameter);

 private:
  std::mutex mutex_;  // of the next two
  Eigen::VectorXd point_;
  std::map<Eigen::Index, SparseStructure::Matrices> known_;
};

/// Eigensolvers that keep their symbolic factorisation, lent to one thread each.
class SparseModeSolverPool {
 public:
  SparseModes solve(const SparseStructure::Matrices& matrices, const SparseModesOptions& options);

  std::unique_ptr<SparseModeSolver> take();
  void give_back(std::unique_ptr<SparseModeSolver> solver);

 private:
  std::mutex mutex_;  // of the next
  std::vector<std::unique_ptr<SparseModeSolver>> idle_;
};

class ExactSolver final : public Solver {
 public:
  explicit ExactSolver(std::unique_ptr<const SparseStructure> structure);

  const Structure& structure() const override { return *structure_; }
  ModeSet modes_at(const Eigen::Ref<const Eigen::VectorXd>& parameters, int modes) const override;
  SolverUse solve(const Eigen::Ref<const Eigen::MatrixXd>& samples, const SolutionRequest& request,
                  const RunContext& context, const Visitor& visit) const override;
  /// Weighted by the mass matrix of the reference, so that rotations and dense meshes count as they should.
  Eigen::MatrixXd cosines(const ModeSet& reference, const ModeSet& modes) const override;
  /// entry_rounding() of the largest sum of |phi_i| |K_ij| |phi_j|.
  double eigenvalue_rounding(const Eigen::Ref<const Eigen::VectorXd>& parameters, const ModeSet& modes) const override;
  Eigen::MatrixXd eigenvalue_derivatives(const Eigen::Ref<const Eigen::VectorXd>& parameters,
                                         const ModeSet& modes) const override;
  Eigen::MatrixXd shape_derivatives(const Eigen::Ref<const Eigen::VectorXd>& parameters, const ModeSet& modes,
                                    int mode) const override;
  std::vector<Eigen::MatrixXd> static_derivatives(const Eigen::Ref<const Eigen::VectorXd>& parameters,
                                                  const Eigen::MatrixXd& loads,
                                                  const ObservationMatrix& observation) const override;
  Eigen::Index batch_size() const override { return 64; }

  const SparseStructure& sparse_structure() const { return *structure_; }
  const SparseMatrix& reference_mass() const { return reference_mass_; }

  /// Solves and visits the given rows of `samples` [sample x parameter]. Returns the processor seconds of one; 0: this
  /// rank was left none.
  double solve_rows(const Eigen::Ref<const Eigen::MatrixXd>& samples, const std::vector<Eigen::Index>& rows,
                    const SolutionRequest& request, const RunContext& context, const Visitor& visit) const;
  /// Modes of one sample with residuals and count.
  SparseModes solve_one(const Eigen::Ref<const Eigen::VectorXd>& parameters, const SparseModesOptions& options) const;
  /// Why a sample has no modes, in the model's terms; empty where it has.
  std::string failure_text(const SparseModes& modes) const;
  /// What is asked for, of full shapes [equation x mode].
  Solution observe(const Eigen::VectorXd& values, const Eigen::MatrixXd& vectors, const SolutionRequest& request) const;

 private:
  SparseModes solve_matrices(const SparseStructure::Matrices& matrices, SparseModesOptions options) const;
  std::string solve_row(const Eigen::VectorXd& parameters, const SolutionRequest& request, Solution& solution) const;

  std::unique_ptr<const SparseStructure> structure_;
  SparseMatrix reference_mass_;
  mutable SparseModeSolverPool pool_;      // changes no number
  mutable MatrixDerivatives derivatives_;  // changes no number
};

/// Cosines from phi_ref' M phi and the squared M-lengths of the phi.
Eigen::MatrixXd cosines_from(const Eigen::MatrixXd& products, const Eigen::RowVectorXd& squares);

}  // namespace mottle::model
