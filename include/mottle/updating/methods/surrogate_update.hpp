// Updating a model that costs minutes a run: the method works on a surrogate, which is refined where the estimate lies.
#pragma once

#include <vector>

#include "mottle/layers.hpp"
#include "mottle/model/surrogate_model.hpp"
#include "mottle/updating/methods/surrogate_settings.hpp"
#include "mottle/updating/methods/updater.hpp"

namespace mottle::updating {

/// What was known of the surrogate's error in one round.
struct SurrogateRound {
  Eigen::Index runs = 0;              ///< that the surrogate was fitted to
  Eigen::VectorXd carried_error;      ///< root mean square of left-out runs, as carried into R [output]
  Eigen::VectorXd error_at_estimate;  ///< root mean square over new runs drawn from the updated population [output]
  /// Standard deviation over these runs as the surrogate has it, over that of the model, less 1; of outputs whose
  /// scatter is less than a tenth of the tests' 0 [output].
  Eigen::VectorXd scatter_error_at_estimate;
};

/// One update by surrogate:
///
/// 1. A Latin hypercube over `spread` deviations of the prior is run; runs that fail are left out.
/// 2. The surrogate is fitted. The error of left-out runs (once there are some near the estimate, of those, or what the
///    last surrogate was off there, if less) is added in squares to the repeatability of the tests; to none where the
///    noise is estimated, which then holds it already.
/// 3. The method updates.
/// 4. The model is run at points drawn from the updated population. Where the surrogate is off there by more than
///    `tolerance` of the tests' scatter, or its standard deviation of an output over these points by more than that
///    fraction of the model's, and once in any case, those runs join the fit and it goes on with 2.
class SurrogateUpdate {
 public:
  /// @param problem  with the model that costs; must outlive this object
  SurrogateUpdate(const UpdatingProblem& problem, const SurrogateSettings& settings);
  SurrogateUpdate(const SurrogateUpdate&) = delete;  // problem() refers to a member
  SurrogateUpdate& operator=(const SurrogateUpdate&) = delete;

  /// Result of the last round; its model_evaluations are runs of the model that costs.
  ///
  /// @throws InvalidInput   fewer runs than the surrogate's kind needs
  /// @throws SystemFailure  too many runs fail, the surrogate cannot be fitted; as the method
  UpdatingResult run(const Updater& method, const RunContext& context);

  /// The problem as the method saw it last: with the surrogate for the model and its error in the tests' noise.
  const UpdatingProblem& problem() const { return problem_; }
  const std::vector<SurrogateRound>& rounds() const { return rounds_; }
  /// Whether the last round's errors of values and of scatter were within the tolerance.
  bool is_good() const { return is_good_; }

 private:
  void run_design(const RunContext& context);
  void add_runs(const Eigen::MatrixXd& samples, const RunContext& context);
  void fit();
  void check(const UpdatingResult& result, const RunContext& context);
  Eigen::VectorXd scatter() const;

  const UpdatingProblem& given_;
  SurrogateSettings settings_;
  SurrogateModel model_;
  UpdatingProblem problem_;
  Eigen::MatrixXd samples_, outputs_;  ///< runs so far
  Eigen::Index first_near_ = 0;        ///< runs from here on were drawn from estimates
  std::int64_t evaluations_ = 0;
  std::vector<SurrogateRound> rounds_;
  bool is_good_ = false;
};

}  // namespace mottle::updating
