// A structure whose modes come from runs of an external program.
#pragma once

#include <map>
#include <memory>
#include <string>
#include <vector>

#include "mottle/drivers/command/sample_pool.hpp"
#include "mottle/drivers/command/solver_runs.hpp"
#include "mottle/drivers/scheduler/run_place.hpp"
#include "mottle/drivers/scheduler/scheduled_runs.hpp"
#include "mottle/layers.hpp"
#include "mottle/model/solvers/solver.hpp"

namespace mottle::drivers {

/// The structure as described by a program's run at the parameters' means: modes and degrees of freedom.
class ExternalStructure final : public Structure {
 public:
  /// @param nominal      modes of that run
  /// @param description  of the program, a line
  ExternalStructure(Eigen::Index parameters, ExtractedModes nominal, std::string description);

  Eigen::Index parameter_count() const override { return parameters_; }
  bool has_stiffness() const override { return false; }
  /// As many as the run at the means gave.
  Eigen::Index mode_count() const override { return nominal_.eigenvalues.size(); }
  int find_degree_of_freedom(const std::string& name) const override;
  std::string unknown_degree_of_freedom(const std::string& name) const override;
  ObservationMatrix observation(const std::vector<int>& degrees_of_freedom) const override {
    return selected_equations(degrees_of_freedom, nominal_.shapes.rows());
  }
  double total_mass(const Eigen::Ref<const Eigen::VectorXd>& parameters) const override;
  std::vector<std::string> description(const Eigen::Ref<const Eigen::VectorXd>& parameters) const override;
  std::string parameter_role(Eigen::Index) const override { return "through the solver's input: a run each"; }

  const ExtractedModes& nominal() const { return nominal_; }

 private:
  Eigen::Index parameters_;
  ExtractedModes nominal_;
  std::string description_;
  std::map<std::string, int> rows_;
};

class ExternalSolver final : public Solver {
 public:
  /// Runs the program once, at the parameters' means: what it gives there says which modes and degrees of freedom there
  /// are.
  ///
  /// @param names       of the parameters
  /// @param nominal     their means
  /// @param standard_deviations  of their prior
  /// @param stop        ends a single run early; nullptr: nothing does. Lives as long as this object
  /// @throws InvalidInput   as SolverRuns; FormatError: a value that does not fit into its place
  /// @throws SystemFailure  the run gave no modes; Stopped
  ExternalSolver(SolverCommand command, const std::vector<std::string>& names, const Eigen::VectorXd& nominal,
                 const Eigen::VectorXd& standard_deviations, const RunStorage& storage, const std::atomic<bool>* stop);

  const Structure& structure() const override { return structure_; }
  /// Throws SystemFailure where the run fails.
  ModeSet modes_at(const Eigen::Ref<const Eigen::VectorXd>& parameters, int modes) const override;
  /// Throws SystemFailure where too many runs fail.
  SolverUse solve(const Eigen::Ref<const Eigen::MatrixXd>& samples, const SolutionRequest& request,
                  const RunContext& context, const Visitor& visit) const override;
  Eigen::MatrixXd cosines(const ModeSet& reference, const ModeSet& modes) const override;

  bool has_derivatives() const override { return false; }
  /// nan: differences must be taken.
  Eigen::MatrixXd eigenvalue_derivatives(const Eigen::Ref<const Eigen::VectorXd>& parameters,
                                         const ModeSet& modes) const override;
  Eigen::MatrixXd shape_derivatives(const Eigen::Ref<const Eigen::VectorXd>& parameters, const ModeSet& modes,
                                    int mode) const override;
  std::vector<Eigen::MatrixXd> static_derivatives(const Eigen::Ref<const Eigen::VectorXd>& parameters,
                                                  const Eigen::MatrixXd& loads,
                                                  const ObservationMatrix& observation) const override;
  double difference_step() const override { return runs_.command().difference_step; }
  /// Each run is kept by itself; tasks of a scheduler are not to wait for the last of a part of the samples.
  Eigen::Index batch_size() const override { return scheduled_ ? 1'000'000 : 8192; }

  /// Notes for the user: placeholders whose formats are too coarse, frequencies that look like numbers of modes.
  const std::vector<std::string>& notes() const { return notes_; }
  /// Time of the run at the parameters' means, without that in a queue; 0: its result was there from a run before.
  double seconds_at_means() const { return seconds_at_means_; }

 private:
  void solve_sample(Eigen::Index s, const Eigen::Ref<const Eigen::MatrixXd>& samples, const SolutionRequest& request,
                    const Visitor& visit, const std::atomic<bool>& halt, std::atomic<std::int64_t>& reused) const;
  void finish_sample(Eigen::Index s, const SolverRuns::Run& run, const SolutionRequest& request, const Visitor& visit,
                     std::atomic<std::int64_t>& reused) const;
  ExternalStructure run_at_means(const std::atomic<bool>* stop);
  SolverRuns::Run run_one(const Eigen::VectorXd& values, int min_modes, const std::atomic<bool>* stop) const;
  std::string place_of_runs() const;
  std::string observe(const ExtractedModes& found, const SolutionRequest& request, Solution& solution) const;

  SharedRunPlace place_;
  mutable SolverRuns runs_;
  std::unique_ptr<ScheduledRuns> scheduled_;  ///< null: runs are this machine's
  Eigen::VectorXd nominal_;
  int least_ = 0;  // modes that a run must give
  Ranks* ranks_;
  double seconds_at_means_ = 0.0;
  ExternalStructure structure_;
  const std::atomic<bool>* stop_ = nullptr;
  std::vector<std::string> notes_;
  mutable FailureCount failures_;
};

}  // namespace mottle::drivers
