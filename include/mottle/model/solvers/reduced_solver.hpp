// Solves clouds of a structure with sparse matrices by a certified reduced model, and exactly where its error bounds
// are too large.
#pragma once

#include <filesystem>
#include <memory>
#include <optional>
#include <vector>

#include "mottle/layers.hpp"
#include "mottle/model/sample_region.hpp"
#include "mottle/model/solvers/exact_solver.hpp"

namespace mottle::model {

class TrainedReducedModels;

/// How clouds may be solved.
struct ReductionSettings {
  double frequency_error = 1e-4;  ///< that a sample may have, relative
  SampleRegion prior;             ///< what the reduced model of samples in no stated region learns from
  std::filesystem::path cache{};  ///< folder where trained models are kept; empty: nowhere. Changes no number
};

/// A cloud's samples by the reduced model where its error bounds are small enough, the others refined by steps with the
/// nominal factor or solved exactly; a sample's numbers then depend on the batch that it is in. Single solutions and
/// derivatives are exact, and static solutions.
class ReducedSolver final : public Solver {
 public:
  ReducedSolver(std::unique_ptr<const ExactSolver> exact, ReductionSettings settings);
  ~ReducedSolver() override;

  const Structure& structure() const override { return exact_->structure(); }
  ModeSet modes_at(const Eigen::Ref<const Eigen::VectorXd>& parameters, int modes) const override {
    return exact_->modes_at(parameters, modes);
  }
  SolverUse solve(const Eigen::Ref<const Eigen::MatrixXd>& samples, const SolutionRequest& request,
                  const RunContext& context, const Visitor& visit) const override;
  Eigen::MatrixXd cosines(const ModeSet& reference, const ModeSet& modes) const override {
    return exact_->cosines(reference, modes);
  }
  double eigenvalue_rounding(const Eigen::Ref<const Eigen::VectorXd>& parameters, const ModeSet& modes) const override {
    return exact_->eigenvalue_rounding(parameters, modes);
  }
  Eigen::MatrixXd eigenvalue_derivatives(const Eigen::Ref<const Eigen::VectorXd>& parameters,
                                         const ModeSet& modes) const override {
    return exact_->eigenvalue_derivatives(parameters, modes);
  }
  Eigen::MatrixXd shape_derivatives(const Eigen::Ref<const Eigen::VectorXd>& parameters, const ModeSet& modes,
                                    int mode) const override {
    return exact_->shape_derivatives(parameters, modes, mode);
  }
  std::vector<Eigen::MatrixXd> static_derivatives(const Eigen::Ref<const Eigen::VectorXd>& parameters,
                                                  const Eigen::MatrixXd& loads,
                                                  const ObservationMatrix& observation) const override {
    return exact_->static_derivatives(parameters, loads, observation);
  }
  bool has_cheap_derivatives() const override { return false; }
  double difference_step() const override { return k_coarse_difference_step; }
  bool adapts_to_regions() const override { return true; }
  Eigen::Index batch_size() const override { return 2048; }

 private:
  class CloudSolution;

  SolverUse solve_with_loads(const Eigen::Ref<const Eigen::MatrixXd>& samples, const SolutionRequest& request,
                             const RunContext& context, const Visitor& visit) const;

  std::unique_ptr<const ExactSolver> exact_;
  double frequency_error_;
  /// Functions of structure, settings and regions: for the modes whose errors matter, and for all.
  std::unique_ptr<TrainedReducedModels> narrow_, wide_;
};

/// By a reduced model where settings are given, the structure is separable and large enough for it to be faster; else
/// exactly.
std::unique_ptr<Solver> make_sparse_solver(std::unique_ptr<const SparseStructure> structure,
                                           std::optional<ReductionSettings> settings);

}  // namespace mottle::model
