// Modes of a structure whose natural frequencies come from a model behind UM-Bridge servers.
#pragma once

#include <atomic>
#include <filesystem>
#include <functional>
#include <map>
#include <memory>
#include <mutex>
#include <string>
#include <vector>

#include "mottle/drivers/command/run_store.hpp"
#include "mottle/drivers/command/sample_pool.hpp"
#include "mottle/drivers/command/solver_runs.hpp"
#include "mottle/drivers/umbridge/umbridge_server.hpp"
#include "mottle/layers.hpp"
#include "mottle/model/solvers/solver.hpp"

namespace mottle::drivers {

class InputMap;
class UmbridgeClient;

/// The structure as far as the servers tell: how many frequencies there are.
class UmbridgeStructure final : public Structure {
 public:
  UmbridgeStructure(Eigen::Index parameters, Eigen::Index modes, std::vector<std::string> description)
      : parameters_(parameters), modes_(modes), description_(std::move(description)) {}

  Eigen::Index parameter_count() const override { return parameters_; }
  bool has_stiffness() const override { return false; }
  Eigen::Index mode_count() const override { return modes_; }
  int find_degree_of_freedom(const std::string& /*name*/) const override { return -1; }
  std::string unknown_degree_of_freedom(const std::string& name) const override;
  ObservationMatrix observation(const std::vector<int>& degrees_of_freedom) const override {
    return selected_equations(degrees_of_freedom, 0);
  }
  double total_mass(const Eigen::Ref<const Eigen::VectorXd>& parameters) const override;
  std::vector<std::string> description(const Eigen::Ref<const Eigen::VectorXd>& /*parameters*/) const override {
    return description_;
  }
  std::string parameter_role(Eigen::Index) const override { return "through the servers' model: a request each"; }

 private:
  Eigen::Index parameters_;
  Eigen::Index modes_;
  std::vector<std::string> description_;
};

/// Mode i is number i of the servers' output, whatever the others are: frequencies that cross do not change their
/// numbers unless the servers' model does that.
class UmbridgeSolver final : public Solver {
 public:
  /// Asks the servers what they offer and evaluates at the parameters' means.
  ///
  /// @param names    of the parameters
  /// @param nominal  their means
  /// @param storage  evaluations that took long are kept there, each at once; a resumed job uses them
  /// @param stop     ends a single request early; nullptr: nothing does. Lives as long as this object
  /// @throws InvalidInput   inputs that do not fit the model's; an output vector that it does not have; as
  ///                        UmbridgeClient; a resumed job whose servers answer otherwise than before
  /// @throws SystemFailure  no answer at the means; Stopped
  UmbridgeSolver(UmbridgeServer server, const std::vector<std::string>& names, const Eigen::VectorXd& nominal,
                 const RunStorage& storage, const std::atomic<bool>* stop);
  ~UmbridgeSolver() override;

  const Structure& structure() const override { return *structure_; }
  /// Throws ModelFailure where the servers fail.
  ModeSet modes_at(const Eigen::Ref<const Eigen::VectorXd>& parameters, int modes) const override;
  /// Throws SystemFailure where too many evaluations fail.
  SolverUse solve(const Eigen::Ref<const Eigen::MatrixXd>& samples, const SolutionRequest& request,
                  const RunContext& context, const Visitor& visit) const override;
  /// There are no shapes: [0 x 0].
  Eigen::MatrixXd cosines(const ModeSet& reference, const ModeSet& modes) const override;

  bool has_derivatives() const override;
  bool has_cheap_derivatives() const override;
  /// By /ApplyJacobian or /Gradient, whichever takes fewer requests; nan where one fails.
  Eigen::MatrixXd eigenvalue_derivatives(const Eigen::Ref<const Eigen::VectorXd>& parameters,
                                         const ModeSet& modes) const override;
  Eigen::MatrixXd shape_derivatives(const Eigen::Ref<const Eigen::VectorXd>& parameters, const ModeSet& modes,
                                    int mode) const override;
  std::vector<Eigen::MatrixXd> static_derivatives(const Eigen::Ref<const Eigen::VectorXd>& parameters,
                                                  const Eigen::MatrixXd& loads,
                                                  const ObservationMatrix& observation) const override;
  double difference_step() const override { return server_.difference_step; }
  /// How often derivatives were taken by differences because a request for them had failed, and why; empty: never.
  std::string derivatives_note() const;
  Eigen::Index batch_size() const override { return 1024; }

 private:
  struct Place {  ///< of a mode among the output vectors
    std::size_t vector = 0;
    std::size_t number = 0;
  };
  using Vectors = std::vector<std::vector<double>>;
  struct FirstFailure;

  static void say_failure(FirstFailure& failure, const std::string& text);

  void map_outputs();
  void describe();
  void forget_answers(const RunStorage& storage) const;
  void evaluate_means();
  void open_store(const RunStorage& storage);
  double eigenvalue_of(double output) const;
  double slope_of(double eigenvalue) const;
  RunRecord ask(const Eigen::Ref<const Eigen::VectorXd>& parameters, const std::atomic<bool>* stop) const;
  RunRecord evaluate(const Eigen::Ref<const Eigen::VectorXd>& parameters, const std::atomic<bool>* stop,
                     bool& is_reused) const;
  RunRecord recalled_or_asked(const Eigen::Ref<const Eigen::VectorXd>& parameters) const;
  RunRecord once(const std::string& what, const Eigen::Ref<const Eigen::VectorXd>& parameters,
                 const std::function<RunRecord()>& make) const;
  Digest key_of(const Eigen::Ref<const Eigen::VectorXd>& parameters) const;
  bool prefers_jacobian(Eigen::Index modes) const;
  Eigen::Index jacobian_requests() const;
  Eigen::Index gradient_requests(Eigen::Index modes) const;
  void add_jacobian_column(const Vectors& input, Eigen::Index parameter, Eigen::MatrixXd& derivatives,
                           FirstFailure& failure, const std::atomic<bool>& halt) const;
  void add_gradient_row(const Vectors& input, Eigen::Index mode, Eigen::MatrixXd& derivatives, FirstFailure& failure,
                        const std::atomic<bool>& halt) const;
  RunRecord asked_derivatives(const Eigen::Ref<const Eigen::VectorXd>& parameters, Eigen::Index modes) const;

  UmbridgeServer server_;  ///< `parallel` is this rank's part of the requests at once, which may be none
  Eigen::VectorXd nominal_;
  std::unique_ptr<UmbridgeClient> client_;
  std::unique_ptr<InputMap> inputs_;
  std::vector<Place> places_;  ///< [mode]
  std::unique_ptr<UmbridgeStructure> structure_;
  std::unique_ptr<RunStore> store_;
  bool is_resumed_ = false;
  Ranks* ranks_ = nullptr;
  Eigen::VectorXd nominal_eigenvalues_;
  const std::atomic<bool>* stop_ = nullptr;
  mutable FailureCount failures_;
  mutable std::mutex mutex_;                          // of the next
  mutable std::int64_t derivatives_ = 0;              ///< points at which they were asked for
  mutable std::int64_t failed_derivatives_ = 0;       ///< of them those where a request failed
  mutable std::string derivative_failure_;            ///< the first one's reason
  mutable std::map<Digest, Eigen::VectorXd> recent_;  ///< eigenvalues that the servers gave: derivatives begin there
};

}  // namespace mottle::drivers
