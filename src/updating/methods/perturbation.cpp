#include "updating/methods/perturbation.hpp"

namespace mottle::updating {

const OptionTable<PerturbationOptions>& perturbation_option_table() {
  using P = PerturbationOptions;
  static const OptionTable<P> table = OptionTable<P>().choice<MomentWeighting>(
      "weighting", &P::weighting,
      {{"variance", MomentWeighting::variance}, {"covariance", MomentWeighting::covariance}},
      "Weight W of the outputs where there are more of them than parameters: the inverse of the tests' variances, or "
      "of "
      "their whole covariance.");
  return table;
}

UpdatingResult PerturbationUpdater::update(const UpdatingProblem& problem, const RunContext& context) const {
  const ScaledParameters parameters(problem.space);
  MomentMethod method;
  method.name = "perturbation";
  method.weighting = options_.weighting;
  method.replaces_covariance = true;
  method.note =
      "They are right to first order in that scatter: where the outputs are curved within it, means and standard "
      "deviations are biased.";
  method.evaluate = [&](MomentState& state, std::int64_t& evaluations) {
    if (!evaluate_at_mean(problem, parameters, state, state.output_mean, context, evaluations)) return false;
    state.output_covariance = state.sensitivity * state.covariance * state.sensitivity.transpose();
    return true;
  };
  return iterate_moments(problem, parameters, method, context);
}

}  // namespace mottle::updating
