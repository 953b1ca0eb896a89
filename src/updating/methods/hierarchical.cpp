#include "mottle/updating/methods/hierarchical.hpp"

#include <algorithm>
#include <cmath>
#include <limits>

#include "mottle/core/subject.hpp"
#include "mottle/updating/estimate/posterior.hpp"
#include "mottle/updating/methods/iteration.hpp"
#include "updating/methods/hierarchical_report.hpp"
#include "updating/methods/hierarchical_target.hpp"
#include "updating/methods/sampled_result.hpp"
#include "updating/sampling/island_batches.hpp"

namespace mottle::updating {
namespace {

void require_specimens(const UpdatingProblem& problem) {
  const Eigen::MatrixXd& values = problem.tests.values;
  require_of(values.rows() >= 2, {Subject::Kind::method, "hierarchical"},
             "{} specimen has no scatter, and its posterior of a population would be the prior's; at least 2 are "
             "needed, or use method = \"bayes\" for what is known of that one",
             values.rows());
  for (Eigen::Index s = 0; s < values.rows(); ++s) {
    require_of(!values.row(s).array().isNaN().all(), {Subject::Kind::tests},
               "specimen {} has no measured value; take it out of the tests", problem.tests.number_of(s));
  }
}

/// Copies of one specimen, typed in or simulated, with noise of unknown level: the density of the tests grows without
/// end as scatter and noise go to zero together, and from three copies on it has no integral.
void require_scatter(const UpdatingProblem& problem, const NoiseLevels& noise) {
  constexpr double k_digits = 1e-9;  // of the values
  if (noise.is_known()) return;
  bool are_repeated = false;
  for (const auto& output : problem.tests.values.colwise()) {
    const auto values = output.array();
    const auto is_missing = values.isNaN();
    const double largest = is_missing.select(std::numeric_limits<double>::lowest(), values).maxCoeff();
    const double smallest = is_missing.select(std::numeric_limits<double>::max(), values).minCoeff();
    if (largest - smallest > k_digits * std::max(std::abs(largest), std::abs(smallest))) return;
    are_repeated = are_repeated || is_missing.count() + 1 < output.size();
  }
  require_of(
      !are_repeated, {Subject::Kind::repeatability},
      "the specimens are the same to the last digit, so that neither their scatter nor the noise has a posterior; "
      "give the noise, or use method = \"bayes\" for what is known of that one specimen");
}

/// A part of every island, one below the other.
template <typename Part>
Eigen::MatrixXd all_rows(const std::vector<CorrectedIsland>& islands, const Part& part) {
  std::vector<const Eigen::MatrixXd*> parts;
  for (const CorrectedIsland& island : islands) parts.push_back(&part(island));
  return stacked(parts, parts.front()->cols());
}

Eigen::MatrixXd points_of(const std::vector<CorrectedIsland>& islands) {
  return all_rows(islands, [](const CorrectedIsland& one) -> const Eigen::MatrixXd& { return one.island.points; });
}

Eigen::MatrixXd auxiliaries_of(const std::vector<CorrectedIsland>& islands) {
  return all_rows(islands, [](const CorrectedIsland& one) -> const Eigen::MatrixXd& { return one.auxiliaries; });
}

Eigen::MatrixXd log_ratios_of(const std::vector<CorrectedIsland>& islands) {
  return all_rows(islands, [](const CorrectedIsland& one) -> const Eigen::MatrixXd& { return one.log_ratio; });
}

/// Chains of the draws' numbers, with the log-likelihood of the tests given the specimens' parameters.
std::shared_ptr<const SampledPosterior> put_together(const std::vector<CorrectedIsland>& islands,
                                                     const Eigen::VectorXd& log_likelihood, NamedDraws named,
                                                     const HierarchicalTarget& target) {
  std::vector<SampledIsland> sampled;
  for (const CorrectedIsland& island : islands) sampled.push_back(island.island);
  const Eigen::Index draws = sampled.front().points.rows();
  for (std::size_t i = 0; i < sampled.size(); ++i)
    sampled[i].log_likelihood = log_likelihood.segment(static_cast<Eigen::Index>(i) * draws, draws);
  SampledPosterior posterior =
      make_posterior(sampled, std::move(named.names), std::move(named.values), PosteriorModes::not_sought);
  posterior.failed_runs = target.failed();
  posterior.evaluations = target.evaluations();
  return std::make_shared<const SampledPosterior>(std::move(posterior));
}

}  // namespace

const OptionTable<HierarchicalOptions>& hierarchical_option_table() {
  using Options = HierarchicalOptions;
  static const OptionTable<Options> table = [] {
    OptionTable<Options> made;
    made.choice<Options::CovariancePrior>(
            "covariance_prior", &Options::covariance_prior,
            {{"lkj", Options::CovariancePrior::lkj}, {"inverse-wishart", Options::CovariancePrior::inverse_wishart}},
            "Prior of the population's covariance on the parameters' scales: half-t standard deviations and LKJ "
            "correlations, or inverse Wishart, under which each variance is scaled inverse chi-squared.")
        .number("scatter_scale", &Options::scatter_scale, {.lower = 0.0, .excludes_lower = true}, "-",
                "Scale of the prior of the standard deviations, as a fraction of the prior's standard deviation of "
                "each parameter on its scale.")
        .number("scatter_degrees_of_freedom", &Options::scatter_degrees_of_freedom, {.lower = 0.5, .upper = 1e6}, "-",
                "Degrees of freedom of that prior: few leave a scatter of many times its scale possible; 1 is a "
                "half-Cauchy.")
        .number("correlation_shape", &Options::correlation_shape, {.lower = 0.5, .upper = 1e6}, "-",
                "Shape of the LKJ prior: 1 has the same density for all correlation matrices, more is for weaker "
                "correlations.");
    return add_sampling_options(made);
  }();
  return table;
}

UpdatingResult HierarchicalUpdater::update(const UpdatingProblem& problem, const RunContext& context) const {
  require_draws("hierarchical", options_);
  require_specimens(problem);
  const TestMoments tests = test_moments(problem.tests);
  const NoiseLevels noise(problem, options_, "hierarchical");
  require_scatter(problem, noise);
  const PopulationPrior prior(problem, options_, noise);
  UpdatingResult result;
  append_state(result, record_state(problem, tests, problem.space.prior(), 0, context));
  if (context.stop_requested()) return stopped_result(std::move(result), problem, "before the first stage");
  context.phase({.name = "sampling of the population"});
  try {
    const Eigen::VectorXd levels = Eigen::VectorXd::Constant(noise.count(), noise.level(0.0));
    const SpecimenFits fits =
        fits_to_linearise(problem, prior.scatter_scale(), noise.variances(levels), context, result.model_evaluations);
    HierarchicalTarget target(problem, prior, linear_specimens(problem.tests.values, fits), context);
    const std::vector<CorrectedIsland> islands =
        sample_corrected(target.target(), target.correction(), settings_of(options_), context);
    result.model_evaluations += target.evaluations();
    HierarchicalDraws draws{.populations = prior.populations(points_of(islands))};
    const DrawnSpecimens drawn = target.specimens(draws.populations, auxiliaries_of(islands));
    draws.specimens = drawn.points;
    NamedDraws named = named_draws(problem, prior, draws);
    if (!named.has_specimens)
      result.notes.emplace_back("posterior.csv holds the population alone: the specimens' parameters are too many.");
    result.posterior = put_together(islands, target.log_likelihood(draws.populations, drawn, log_ratios_of(islands)),
                                    std::move(named), target);
    const bool is_finished =
        std::all_of(islands.begin(), islands.end(), [](const auto& one) { return one.island.is_finished; });
    conclude_sampling(*result.posterior, "hierarchical", options_, is_finished, result);
    const HierarchicalFindings findings{target.near(), prior, noise, fits, draws, *result.posterior};
    estimate_population(findings, result);
    append_state(result, record_state(target.near(), tests, *result.estimate, context));
    context.phase({.name = "tests of the posterior"});
    describe_hierarchical(findings, context, result);
  } catch (const Stopped&) {
    return stopped_result(std::move(result), problem, "while the posterior was sampled");
  }
  return result;
}

}  // namespace mottle::updating
