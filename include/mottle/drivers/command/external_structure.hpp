// A structure whose modes come from runs of somebody else's program.
#pragma once

#include <map>
#include <string>
#include <vector>

#include "mottle/drivers/command/solver_runs.hpp"
#include "mottle/model/structures/modal_structure.hpp"

namespace mottle {

class ExternalStructure final : public ModalStructure {
 public:
  /// Runs the solver once, at the parameters' means: what it gives there says which modes and degrees of freedom there
  /// are.
  ///
  /// @param names       of the parameters
  /// @param nominal     their means
  /// @param deviations  their prior deviations
  /// @param stop        ends a single run early; nullptr: nothing does. Lives as long as this object
  /// @throws InvalidInput   as SolverRuns; FormatError: a value that does not fit into its place
  /// @throws SystemFailure  the run gave no modes; Stopped
  ExternalStructure(SolverCommand command, const std::vector<std::string>& names, const Eigen::VectorXd& nominal,
                    const Eigen::VectorXd& deviations, const SolverPlace& place, const std::atomic<bool>* stop);

  Eigen::Index parameter_count() const override { return nominal_.size(); }
  /// As many as the run at the means gave.
  Eigen::Index mode_count() const override { return modes_.eigenvalues.size(); }
  bool is_damped() const override { return false; }
  int find_degree_of_freedom(const std::string& name) const override;
  std::string unknown_degree_of_freedom(const std::string& name) const override;
  Eigen::MatrixXd displacements(const Eigen::Ref<const Eigen::MatrixXd>& shapes,
                                const std::vector<int>& degrees_of_freedom) const override;
  /// Throws SystemFailure where the run fails.
  ModeSet modes_at(const Eigen::Ref<const Eigen::VectorXd>& parameters, int modes) const override;
  /// Throws SystemFailure where too many runs fail.
  SolverUse solve(const Eigen::Ref<const Eigen::MatrixXd>& samples, int modes, const ModalObservation& observation,
                  const RunContext& context, const Visitor& visit) const override;
  Eigen::MatrixXd cosines(const ModeSet& reference, const ModeSet& modes) const override;

  /// nan: differences must be taken.
  Eigen::MatrixXd eigenvalue_derivatives(const Eigen::Ref<const Eigen::VectorXd>& parameters,
                                         const ModeSet& modes) const override;
  Eigen::MatrixXd shape_derivatives(const Eigen::Ref<const Eigen::VectorXd>& parameters, const ModeSet& modes,
                                    int mode) const override;
  bool has_derivatives() const override { return false; }
  double difference_step() const override { return runs_.command().difference_step; }

  /// nan: a solver's run does not tell.
  Eigen::VectorXd damping_ratios(const Eigen::Ref<const Eigen::VectorXd>& parameters,
                                 const ModeSet& modes) const override;
  int modes_for_damping(int modes) const override { return modes; }
  Eigen::Index batch_size() const override { return 8192; }  // each run is kept by itself
  double total_mass(const Eigen::Ref<const Eigen::VectorXd>& parameters) const override;
  std::vector<std::string> description(const Eigen::Ref<const Eigen::VectorXd>& parameters) const override;
  std::string parameter_role(Eigen::Index) const override { return "through the solver's input: a run each"; }

  /// What a user should know: places whose formats are too coarse.
  const std::vector<std::string>& notes() const { return notes_; }

 private:
  class Pool;
  std::string observe(const ExtractedModes& found, const ModalObservation& observation, ObservedModes& observed) const;

  mutable SolverRuns runs_;
  Eigen::VectorXd nominal_;
  ExtractedModes modes_;  // at the means
  int least_ = 0;         // how many a run must give
  const std::atomic<bool>* stop_ = nullptr;
  std::map<std::string, int> rows_;
  std::vector<std::string> notes_;
  mutable std::atomic<std::int64_t> done_{0};
  mutable std::atomic<std::int64_t> failed_{0};
};

}  // namespace mottle
