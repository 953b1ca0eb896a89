#include "updating/methods/covariance_adjustment.hpp"

#include "mottle/stats/sampling/sampling.hpp"

namespace mottle::updating {

const OptionTable<CovarianceAdjustmentOptions>& covariance_adjustment_option_table() {
  using C = CovarianceAdjustmentOptions;
  static const OptionTable<C> table =
      OptionTable<C>()
          .choice<C::CloudKind>(
              "cloud", &C::cloud,
              {{"monte-carlo", C::CloudKind::monte_carlo}, {"first-order", C::CloudKind::first_order}},
              "Where mean and covariance of the model's outputs come from: a cloud of samples "
              "points, or the sensitivities at the mean.")
          .choice<MomentWeighting>(
              "weighting", &C::weighting,
              {{"variance", MomentWeighting::variance}, {"covariance", MomentWeighting::covariance}},
              "Weight W of the outputs where there are more of them than parameters: the inverse of the tests' "
              "variances, or of their whole covariance.");
  return table;
}

UpdatingResult CovarianceAdjustmentUpdater::update(const UpdatingProblem& problem, const RunContext& context) const {
  const ScaledParameters parameters(problem.space);
  const bool is_linear = options_.cloud == CovarianceAdjustmentOptions::CloudKind::first_order;
  const StreamKey key{.seed = context.seed, .purpose = StreamPurpose::parameter_cloud};
  const GaussianRule rule =
      is_linear
          ? GaussianRule{}
          : standardised_rule(uniform_design(problem.cloud.design, problem.cloud.samples, parameters.count(), key));
  MomentMethod method;
  method.name = "covariance-adjustment";
  method.weighting = options_.weighting;
  method.note = is_linear ? "They are right to first order in that scatter: where the outputs are curved within it, "
                            "means and standard deviations are biased."
                          : "They contain the Monte-Carlo error of the cloud.";
  method.evaluate = [&](MomentState& state, std::int64_t& evaluations) {
    if (!evaluate_at_mean(problem, parameters, state, state.output_mean, context, evaluations)) return false;
    state.output_covariance = state.sensitivity * state.covariance * state.sensitivity.transpose();
    return is_linear || evaluate_by_rule(problem, parameters, rule, state, context, evaluations);
  };
  return iterate_moments(problem, parameters, method, context);
}

}  // namespace mottle::updating
