// Solves all samples of a batch of a small structure side by side in SIMD lanes.
#pragma once

#include "mottle/layers.hpp"
#include "mottle/linalg/batched/batch_eigen.hpp"
#include "mottle/model/solvers/solver.hpp"
#include "mottle/model/structures/dense_structure.hpp"

namespace mottle::model {

class DenseSolver final : public Solver {
 public:
  explicit DenseSolver(DenseStructure structure);

  const Structure& structure() const override { return structure_; }
  /// Returns all modes, regardless of the number requested.
  ModeSet modes_at(const Eigen::Ref<const Eigen::VectorXd>& parameters, int modes) const override;
  SolverUse solve(const Eigen::Ref<const Eigen::MatrixXd>& samples, const SolutionRequest& request,
                  const RunContext& context, const Visitor& visit) const override;
  Eigen::MatrixXd cosines(const ModeSet& reference, const ModeSet& modes) const override;
  Eigen::MatrixXd eigenvalue_derivatives(const Eigen::Ref<const Eigen::VectorXd>& parameters,
                                         const ModeSet& modes) const override;
  Eigen::MatrixXd shape_derivatives(const Eigen::Ref<const Eigen::VectorXd>& parameters, const ModeSet& modes,
                                    int mode) const override;
  std::vector<Eigen::MatrixXd> static_derivatives(const Eigen::Ref<const Eigen::VectorXd>& parameters,
                                                  const Eigen::MatrixXd& loads,
                                                  const ObservationMatrix& observation) const override;
  /// All: the damping ratios come from the whole damped eigenproblem.
  int modes_for_damping(int modes) const override;
  Eigen::Index batch_size() const override { return 8192; }

 private:
  std::int64_t samples_of_piece(const SolutionRequest& request) const;
  void solve_part(const Eigen::Ref<const Eigen::MatrixXd>& samples, const SolutionRequest& request,
                  const RunContext& context, const Visitor& visit) const;
  /// Why a sample has no modes.
  std::string failure_at(const Eigen::Ref<const Eigen::VectorXd>& parameters) const;
  void observe_shapes(const Eigen::MatrixXd& shapes, const Eigen::Ref<const Eigen::VectorXd>& parameters,
                      const SolutionRequest& request, Solution& solution) const;

  /// dK/dx or dM/dx of one parameter: an element's few entries, or a whole matrix.
  struct Slope {
    Eigen::SparseMatrix<double> sparse;  ///< empty where they are many
    Eigen::MatrixXd full;                ///< empty where entries are few

    explicit Slope(const Eigen::MatrixXd& matrix);
    /// phi' S phi of each shape phi.
    /// @param shapes  one a row [mode x degree of freedom]
    Eigen::VectorXd forms(const Eigen::MatrixXd& shapes) const;
  };

  DenseStructure structure_;
  PencilFamily pencils_;
  std::vector<Slope> stiffness_slopes_;  // by parameter
  std::vector<Slope> mass_slopes_;
};

}  // namespace mottle::model
