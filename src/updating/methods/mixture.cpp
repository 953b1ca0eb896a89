#include "updating/methods/mixture.hpp"

#include <algorithm>
#include <map>
#include <numeric>

#include "mottle/core/subject.hpp"
#include "mottle/updating/methods/iteration.hpp"
#include "updating/fits/regional_problem.hpp"
#include "updating/methods/mixture_report.hpp"
#include "updating/methods/mixture_scales.hpp"
#include "updating/population/linear_record.hpp"
#include "updating/population/mixture_fit.hpp"
#include "updating/population/model_error.hpp"
#include "updating/population/population_report.hpp"

namespace mottle::updating {
namespace {

constexpr int k_most = 5;

/// Specimens in an order that is that of their values, so that the order in which they are listed changes no bit.
std::vector<Eigen::Index> order_of(const Eigen::MatrixXd& values) {
  std::vector<Eigen::Index> order(static_cast<std::size_t>(values.rows()));
  std::iota(order.begin(), order.end(), 0);
  std::stable_sort(order.begin(), order.end(), [&](Eigen::Index a, Eigen::Index b) {
    for (Eigen::Index k = 0; k < values.cols(); ++k) {
      const bool has_a = !std::isnan(values(a, k));
      const bool has_b = !std::isnan(values(b, k));
      if (has_a != has_b) return has_a;
      if (has_a && values(a, k) != values(b, k)) return values(a, k) < values(b, k);
    }
    return false;
  });
  return order;
}

UpdatingProblem sorted(const UpdatingProblem& problem, const std::vector<Eigen::Index>& order) {
  UpdatingProblem own = problem;
  own.tests.values = problem.tests.values(order, Eigen::all);
  own.tests.numbers.clear();
  for (const Eigen::Index s : order) own.tests.numbers.push_back(problem.tests.number_of(s));
  return own;
}

/// Rows back in the order of the study.
void put_back(const std::vector<Eigen::Index>& order, Eigen::MatrixXd& rows) {
  const Eigen::MatrixXd from = rows;
  for (std::size_t s = 0; s < order.size(); ++s) rows.row(order[s]) = from.row(static_cast<Eigen::Index>(s));
}

void put_back(const std::vector<Eigen::Index>& order, UpdatingResult& result) {
  if (result.specimens) {
    put_back(order, result.specimens->parameters);
    put_back(order, result.specimens->residuals);
  }
  for (Outlier& outlier : result.outliers) outlier.sample = order[static_cast<std::size_t>(outlier.sample)];
  if (!result.mixture) return;
  MixtureFindings findings = *result.mixture;
  put_back(order, findings.probabilities);
  result.mixture = std::make_shared<const MixtureFindings>(std::move(findings));
}

/// Parameters that may be correlated with one another, at most.
Eigen::Index largest_group(const UpdatingProblem& problem) {
  if (problem.covariance_groups.empty()) return problem.space.count();
  std::map<int, Eigen::Index> sizes;
  for (const int group : problem.covariance_groups) ++sizes[group];
  return std::max_element(sizes.begin(), sizes.end(), [](const auto& a, const auto& b) { return a.second < b.second; })
      ->second;
}

void require_specimens(const UpdatingProblem& problem, const MixtureOptions& options) {
  const auto n = static_cast<int>(problem.tests.values.rows());
  require_of(n >= 2, {Subject::Kind::method, "mixture"},
             "{} specimen has no scatter to explain; at least 2 are needed, or use method = \"deterministic\"", n);
  require_of(!problem.tests.is_model_error_estimated, {Subject::Kind::model_error},
             "\"estimated\" is not for method \"mixture\", which would take differences of batches for it; give it as "
             "numbers, or use method = \"maximum-likelihood\"");
  if (options.components < 2) return;
  const int fewest = fewest_units(options.components, largest_group(problem));
  require_of(n >= fewest, {Subject::Kind::option, "mixture.components"},
             "{} batches of {} parameters need at least {} specimens ({} a batch, and a scatter about their means that "
             "can be estimated), there are {}; give fewer components, or \"automatic\"",
             options.components, problem.space.count(), fewest, k_smallest_batch, n);
}

MixtureSearch search_of(const UpdatingProblem& problem, const PopulationFit& one, const MixtureOptions& options,
                        const MixtureFrame& frame) {
  MixtureSearch search;
  search.settings.is_restricted = options.likelihood == MixtureOptions::Likelihood::restricted;
  search.settings.prior_weight = options.covariance_prior;
  search.settings.has_common_covariance = options.scatter == MixtureOptions::Scatter::common;
  search.settings.covariance_groups = one.settings.covariance_groups;
  search.settings.confine = within_bounds(problem, frame);
  search.outlier_fraction = options.outlier_fraction;
  search.outlier_width = options.outlier_width;
  search.starts = options.starts;
  search.samples = options.bootstrap_samples;
  search.level = problem.level;
  return search;
}

/// The number of batches, and the batches to begin with.
MixtureNumber choose(const UpdatingProblem& problem, const MixtureOptions& options, MixtureSearch& search,
                     const RunContext& context, MixturePopulationFit& fit) {
  MixtureNumber number{.is_given = options.components > 0, .is_alike = fit.frame.unit.isZero(0.0)};
  if (number.is_alike) return number;
  const auto n = static_cast<int>(problem.tests.values.rows());
  const Eigen::Index together = std::min<Eigen::Index>(largest_group(problem), fit.frame.map.cols());
  search.most = options.components > 0 ? options.components : k_most;
  while (search.most > 1 && n < fewest_units(search.most, together)) --search.most;
  number.most = search.most;
  if (n < fewest_units(1, together)) return number;
  if (!number.is_given) {
    MixtureChoice choice = choose_mixture(fit.alike, search, context);
    fit.mixture = std::move(choice.fit);
    number.tests = std::move(choice.tests);
    return number;
  }
  const MixtureSettings settings = search.settings_for(fit.alike);
  std::optional<MixtureFit> found;
  for (int k = 1; k <= search.most; ++k) {
    const std::optional<MixtureFit> fewer = found;
    found = find_mixture(fit.alike, k, fewer ? &*fewer : nullptr, settings, search.starts,
                         {.seed = context.seed, .purpose = StreamPurpose::mixture_start});
  }
  require_of(found.has_value(), {Subject::Kind::option, "mixture.components"},
             "no start leads to {} batches of {} specimens at least; give fewer components, or \"automatic\"",
             options.components, k_smallest_batch);
  fit.mixture = *std::move(found);
  return number;
}

bool has_outlier(const MixtureFit& mixture) {
  return mixture.probabilities.size() > 0 && (mixture.probabilities.rightCols(1).array() > k_outlying).any();
}

/// Likelihood, noise and intervals of one population.
MaximumLikelihoodOptions one_population(const MixtureOptions& options) {
  return {.likelihood = options.likelihood, .noise = options.noise};
}

/// One population on other scales, in the place of the batches that were found.
std::optional<ExplainingScales> scales_instead_of_batches(const UpdatingProblem& problem, const MixtureOptions& options,
                                                          const SolvedPopulation& solved, const MixtureNumber& number,
                                                          const RunContext& context, std::int64_t& evaluations) {
  const auto choose_there = [&](const UpdatingProblem& other, const PopulationFit& one) {
    MixturePopulationFit fit = begin_mixture(other, one);
    MixtureSearch search = search_of(other, one, options, fit.frame);
    return choose(other, options, search, context, fit);
  };
  return explaining_scales(problem, solved, number, context, choose_there, evaluations);
}

/// Batches on the first estimate of one population, and what follows from them.
void find_batches(const UpdatingProblem& problem, const TestMoments& tests, const MixtureOptions& options,
                  const SolvedPopulation& solved, const RunContext& context, UpdatingResult& result) {
  const PopulationFit& one = solved.best();
  const RegionalProblem near(problem, one.region);
  MixturePopulationFit fit = begin_mixture(problem, one);
  MixtureSearch search = search_of(problem, one, options, fit.frame);
  MixtureNumber number = choose(problem, options, search, context, fit);
  const std::optional<ExplainingScales> scales =
      scales_instead_of_batches(problem, options, solved, number, context, result.model_evaluations);
  if (scales) {
    number.not_believed = explaining_scales_note(*scales, number);
    fit.mixture = {};
  }
  if (!scales && (fit.mixture.components.size() > 1 || has_outlier(fit.mixture))) {
    iterate_mixture(near.problem(), one, search, context, fit, [&](const MixturePopulationFit& now) {
      append_state(result, linear_record(problem, as_one_population(problem, one, now), tests));
      if (!context.stop_requested() && !now.converged && now.iterations < problem.iterations)
        begin_iteration(problem, static_cast<int>(result.history.size()), context);
      return !context.stop_requested();
    });
    context.throw_if_stopped();
    result.model_evaluations += fit.evaluations;
    result.status = fit.converged && one.converged ? UpdatingStatus::converged : UpdatingStatus::max_iterations;
    result.message =
        ending_message(result.status, result.history.size() - 1, problem.tolerance,
                       {.at_rest = "no mean and no standard deviation of a batch moves", .moving = "the batches"});
    describe_mixture(near.problem(), tests, solved, search, number, context, fit, result);
  } else {
    result.set_estimate(std::make_shared<NormalPopulation>(
        problem.space.transforms(), PopulationOnScales{one.mean, one.covariance, evidence_of(one)},
        problem.tests.values.rows()));
    IterationRecord last = record_state(near.problem(), tests, *result.estimate, context);
    result.model_evaluations += last.cloud.samples.rows();
    result.history.back() = std::move(last);
    context.phase({.name = "intervals and tests of the estimate"});
    describe_population(problem, solved, one_population(options), context, result);
    describe_one_batch(problem, search, number, context, fit, result);
  }
}

}  // namespace

const OptionTable<MixtureOptions>& mixture_option_table() {
  using M = MixtureOptions;
  static const OptionTable<M> table =
      OptionTable<M>()
          .integer_or("components", &M::components, {.lower = 1.0, .upper = k_most}, "automatic", 0,
                      "Number of batches: given, or found by tests of one against two, two against three, and so on, "
                      "each at the level of the verdict.")
          .choice<M::Scatter>("scatter", &M::scatter, {{"own", M::Scatter::own}, {"common", M::Scatter::common}},
                              "Each batch has its own covariance, or all have one.")
          .number("covariance_prior", &M::covariance_prior, {.lower = 0.0, .upper = 1e6}, "specimens",
                  "Weight of the belief that batches scatter alike, which keeps each from collapsing onto a few "
                  "specimens.")
          .number("outlier_fraction", &M::outlier_fraction, {.lower = 0.0, .upper = 0.2}, "-",
                  "Fraction of specimens expected to belong to no batch; 0: there are none.")
          .number("outlier_width", &M::outlier_width, {.lower = 1.5, .upper = 100.0}, "-",
                  "Standard deviations of outliers' parameters, as a multiple of those of all specimens together.")
          .choice<M::Noise>(
              "noise", &M::noise,
              {{"automatic", M::Noise::automatic}, {"given", M::Noise::given}, {"estimated", M::Noise::estimated}},
              "Measurement noise: as for maximum-likelihood, whose estimate for one population is used.")
          .choice<M::Likelihood>(
              "likelihood", &M::likelihood,
              {{"restricted", M::Likelihood::restricted}, {"plain", M::Likelihood::plain}},
              "Restricted likelihood, whose standard deviations are not too small where specimens are few, or the "
              "plain one.")
          .integer("bootstrap_samples", &M::bootstrap_samples, {.lower = 99.0, .upper = 100000.0}, "-",
                   "Number of samples of specimens, drawn from an estimate and searched again, of each test of the "
                   "number of batches, and half of those for intervals.")
          .integer("starts", &M::starts, {.lower = 0.0, .upper = 1000.0}, "-",
                   "Number of random starts of each search, beside those that split a batch.");
  return table;
}

UpdatingResult MixtureUpdater::update(const UpdatingProblem& given, const RunContext& context) const {
  require_specimens(given, options_);
  const std::vector<Eigen::Index> order = order_of(given.tests.values);
  const UpdatingProblem problem = sorted(given, order);
  require_repeated_outputs(problem.tests, problem.model.outputs());
  const TestMoments tests = test_moments(problem.tests);
  const PopulationFitSettings settings{.noise = noise_model(problem, one_population(options_), "mixture"),
                                       .model_error = model_error_model(problem),
                                       .is_restricted = options_.likelihood == MixtureOptions::Likelihood::restricted,
                                       .iterations = problem.iterations,
                                       .tolerance = problem.tolerance};
  UpdatingResult result;
  append_state(result, record_state(problem, tests, problem.space.prior(), 0, context));
  result.mean = problem.space.prior().mean();
  result.covariance = problem.space.prior().covariance();
  result.status = UpdatingStatus::stopped;
  result.message = "stopped on request before the first iteration";
  if (context.stop_requested()) return result;
  begin_iteration(problem, 1, context);
  const SolvedPopulation solved =
      solve_population(problem, settings, result.history.front().cloud, context,
                       record_iterations(problem, tests, context, result), result.model_evaluations);
  const PopulationFit& one = solved.best();
  result.message = "stopped on request before batches were looked for";
  if (context.stop_requested()) return result;
  try {
    UpdatingResult found = result;
    found.status = one.converged ? UpdatingStatus::converged : UpdatingStatus::max_iterations;
    found.message = ending_message(
        found.status, static_cast<std::size_t>(one.iterations), problem.tolerance,
        {.at_rest = "no mean and no standard deviation moves", .moving = "means and standard deviations"});
    find_batches(problem, tests, options_, solved, context, found);
    put_back(order, found);
    return found;
  } catch (const Stopped&) {
    result.message = "stopped on request while batches were looked for";
    return result;
  }
}

}  // namespace mottle::updating
