#include "updating/methods/moment_matching.hpp"

#include "mottle/core/error.hpp"
#include "mottle/stats/sampling/sampling.hpp"

namespace mottle::updating {
namespace {

using Rule = MomentMatchingOptions::Rule;

Rule chosen_rule(Rule wanted, Eigen::Index parameters) {
  constexpr Eigen::Index k_few = 3;
  constexpr Eigen::Index k_some = 8;  // beyond, the weights of the rule of degree 5 grow too large of either sign
  if (wanted != Rule::automatic) return wanted;
  if (parameters <= k_few) return Rule::gauss_hermite;
  return parameters <= k_some ? Rule::fifth_degree : Rule::cloud;
}

GaussianRule make_rule(Rule kind, int points, const UpdatingProblem& problem, const RunContext& context) {
  const Eigen::Index count = problem.space.count();
  if (kind == Rule::gauss_hermite) return tensor_hermite_rule(count, points);
  if (kind == Rule::fifth_degree) return fifth_degree_rule(count);
  return standardised_rule(uniform_design(problem.cloud.design, problem.cloud.samples, count,
                                          {.seed = context.seed, .purpose = StreamPurpose::parameter_cloud}));
}

}  // namespace

const OptionTable<MomentMatchingOptions>& moment_matching_option_table() {
  using M = MomentMatchingOptions;
  static const OptionTable<M> table =
      OptionTable<M>()
          .choice<M::Rule>("rule", &M::rule,
                           {{"auto", M::Rule::automatic},
                            {"gauss-hermite", M::Rule::gauss_hermite},
                            {"degree-5", M::Rule::fifth_degree},
                            {"cloud", M::Rule::cloud}},
                           "Points over which mean and covariance of the outputs are taken: a Gauss-Hermite grid, the "
                           "symmetric rule of degree 5, or a cloud of samples points drawn as sampling "
                           "says; \"auto\" chooses by the number of parameters.")
          .integer("points", &M::points, {.lower = 2.0, .upper = 40.0}, "-",
                   "Points of the Gauss-Hermite grid along each parameter.")
          .choice<MomentWeighting>(
              "weighting", &M::weighting,
              {{"variance", MomentWeighting::variance}, {"covariance", MomentWeighting::covariance}},
              "Weight W of the outputs where there are more of them than parameters: the inverse of the tests' "
              "variances, or of their whole covariance.");
  return table;
}

UpdatingResult MomentMatchingUpdater::update(const UpdatingProblem& problem, const RunContext& context) const {
  const ScaledParameters parameters(problem.space);
  const Rule kind = chosen_rule(options_.rule, parameters.count());
  const GaussianRule rule = make_rule(kind, options_.points, problem, context);
  MomentMethod method;
  method.name = "moment-matching";
  method.weighting = options_.weighting;
  method.note =
      kind == Rule::cloud
          ? "Mean and covariance of the outputs are those of a cloud and contain its Monte-Carlo error."
          : fmt::format("Mean and covariance of the outputs are integrals over {} points.", rule.weights.size());
  method.evaluate = [&](MomentState& state, std::int64_t& evaluations) {
    if (!evaluate_at_mean(problem, parameters, state, state.output_mean, context, evaluations)) return false;
    return evaluate_by_rule(problem, parameters, rule, state, context, evaluations);
  };
  return iterate_moments(problem, parameters, method, context);
}

}  // namespace mottle::updating
