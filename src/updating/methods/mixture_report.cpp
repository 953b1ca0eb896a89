#include "updating/methods/mixture_report.hpp"

#include <algorithm>
#include <boost/math/distributions/chi_squared.hpp>
#include <cmath>

#include "mottle/core/text.hpp"
#include "mottle/linalg/dense/decompositions.hpp"
#include "mottle/stats/moments/descriptive.hpp"
#include "updating/methods/mixture_intervals.hpp"
#include "updating/population/model_error.hpp"
#include "updating/population/population_report.hpp"
#include "updating/verdict/other_solutions.hpp"

namespace mottle::updating {
namespace {

constexpr int k_power_samples = 200;  // standard error of a power of 80 %: 2.8 %

/// Of the batches; of none where specimens do not differ.
Batch batch_on_axes(const std::vector<ParameterTransform>& scales, const BatchOnScales& batch) {
  const VariableMoments moments = moments_of_variables(scales, batch.mean, batch.covariance);
  return {.weight = batch.weight,
          .mean = moments.mean,
          .std = moments.covariance.diagonal().cwiseMax(0.0).cwiseSqrt(),
          .correlation = correlation_from_covariance(batch.covariance)};
}

void count_specimens(MixtureFindings& findings) {
  for (Eigen::Index s = 0; s < findings.probabilities.rows(); ++s) {
    const Eigen::Index own = findings.batch_of(s);
    if (own >= 0) ++findings.batches[static_cast<std::size_t>(own)].specimens;
  }
}

std::string p_text(double p) {
  return p < 0.01 ? fmt::format("{:.1g}", p) : fmt::format("{:.2f}", p);
}

void say_number(const UpdatingProblem& problem, const MixtureFindings& findings, const MixtureNumber& number,
                UpdatingResult& result) {
  const auto n = problem.tests.values.rows();
  if (number.is_alike) {
    result.notes.emplace_back("The specimens do not differ: there are no batches to look for.");
    return;
  }
  if (!number.not_believed.empty()) {
    result.notes.push_back(number.not_believed);
    return;
  }
  if (number.is_given) {
    result.notes.push_back(
        fmt::format("The number of batches, {}, was given: whether the specimens show as many was not tested.",
                    findings.batches.size()));
    return;
  }
  if (number.tests.empty()) {
    result.notes.push_back(fmt::format(
        "Batches were not looked for: {} specimens are too few to tell two batches of {} parameters from one.", n,
        problem.space.count()));
    return;
  }
  std::vector<std::string> steps;
  for (const ComponentsTest& test : findings.tests) {
    steps.push_back(fmt::format("{} against {}: p = {}", test.components, test.components + 1, p_text(test.p_value)));
  }
  result.notes.push_back(fmt::format("Number of batches: {}, by a bootstrap of the likelihood ratio ({}).",
                                     findings.batches.size(), join(steps)));
  if (static_cast<int>(findings.batches.size()) == number.most && findings.tests.back().is_refused) {
    result.notes.push_back(fmt::format("More than {} batches were not looked for.", number.most));
  }
}

void say_power(const UpdatingProblem& problem, const MixtureFindings& findings, UpdatingResult& result) {
  if (findings.is_number_given || findings.tests.empty()) return;
  const auto n = problem.tests.values.rows();
  const bool is_one = findings.batches.size() == 1;
  const std::string closer = is_one ? " That one batch was found does not exclude closer ones." : "";
  if (!findings.detectable) {
    result.notes.push_back(fmt::format(
        "With {} specimens two batches cannot be told from one with a probability of 80 %, however far apart (up to "
        "20 standard deviations were tried).{}",
        n, closer));
    return;
  }
  result.notes.push_back(fmt::format(
      "With {} specimens only batches {:.1f} standard deviations apart can be told: two of equal size are found with "
      "a probability of 80 % where their means differ by as many standard deviations of a batch (with its noise).{}",
      n, *findings.detectable, closer));
}

void say_batches(const UpdatingProblem& problem, const MixtureFindings& findings, UpdatingResult& result) {
  constexpr std::size_t k_listed = 6;
  const std::vector<std::string> names = problem.space.names();
  for (std::size_t k = 0; k < findings.batches.size(); ++k) {
    const Batch& batch = findings.batches[k];
    std::vector<std::string> values;
    for (std::size_t i = 0; i < std::min(names.size(), k_listed); ++i) {
      const auto place = static_cast<Eigen::Index>(i);
      values.push_back(fmt::format("{} {:.4g} +- {:.2g}", names[i], batch.mean(place), batch.std(place)));
    }
    result.notes.push_back(fmt::format("Batch {}: {} of {} specimens; mean and standard deviation {}{}.", k + 1,
                                       batch.specimens, problem.tests.values.rows(), join(values),
                                       names.size() > k_listed ? ", ..." : ""));
  }
}

/// Distance of a specimen from a batch, and the probability of one as large without outliers.
Outlier outlier_of(const MixturePopulationFit& fit, Eigen::Index specimen) {
  const auto s = static_cast<std::size_t>(specimen);
  const MixtureDesign& design = fit.data.design(s);
  double nearest = 1e300;
  for (const MixtureComponent& own : fit.mixture.components) {
    const Eigen::MatrixXd total = design.design * own.covariance * design.design.transpose() + design.noise;
    const Eigen::VectorXd rest = fit.data.responses[s] - design.design * own.mean;
    nearest = std::min(nearest, rest.dot(solve_semidefinite(total, rest)));
  }
  const boost::math::chi_squared law(static_cast<double>(design.design.rows()));
  const double one = boost::math::cdf(boost::math::complement(law, nearest));
  return {specimen, std::sqrt(nearest), std::min(1.0, static_cast<double>(fit.data.size()) * one)};
}

void find_outliers(const UpdatingProblem& problem, const MixturePopulationFit& fit, UpdatingResult& result) {
  const Eigen::VectorXd outlying = fit.mixture.probabilities.rightCols(1);
  std::vector<std::string> named;
  for (Eigen::Index s = 0; s < outlying.size(); ++s) {
    if (!(outlying(s) > k_outlying)) continue;
    result.outliers.push_back(outlier_of(fit, s));
    named.push_back(fmt::format("{} ({:.2f})", problem.tests.number_of(s), outlying(s)));
  }
  std::stable_sort(result.outliers.begin(), result.outliers.end(),
                   [](const Outlier& a, const Outlier& b) { return a.distance > b.distance; });
  if (!named.empty()) {
    result.notes.push_back(fmt::format(
        "Outliers, which belong to no batch and take no part in its moments (probability): {}.", join(named)));
  }
}

/// Each specimen against its most probable batch.
SpecimenEstimates specimens_in_batches(const UpdatingProblem& problem, const MixturePopulationFit& fit,
                                       PopulationFit whole) {
  std::optional<SpecimenEstimates> all;
  const Eigen::VectorXd centre = whole.effects.mean - fit.frame.unit.asDiagonal() * fit.mixture.mean();
  whole.model_error.reset();
  for (std::size_t k = 0; k < fit.mixture.components.size(); ++k) {
    const MixtureComponent& own = fit.mixture.components[k];
    whole.effects.mean = centre + fit.frame.unit.asDiagonal() * own.mean;
    whole.effects.covariance = fit.frame.unit.asDiagonal() * own.covariance * fit.frame.unit.asDiagonal();
    const SpecimenEstimates these = estimate_specimens(problem, whole);
    if (!all) all = these;
    for (Eigen::Index s = 0; s < these.residuals.rows(); ++s) {
      if (fit.mixture.component_of(s) == static_cast<Eigen::Index>(k)) all->residuals.row(s) = these.residuals.row(s);
    }
  }
  return *all;
}

/// The model's error moves all batches alike.
void widen_by_model_error(const PopulationFit& one, const std::vector<ParameterTransform>& scales,
                          Eigen::MatrixXd& intervals) {
  constexpr double k_quantile = 1.959964;
  if (!one.model_error) return;
  const ModelError& error = *one.model_error;
  const Eigen::VectorXd shared = (error.gain * error.covariance * error.gain.transpose()).diagonal();
  for (Eigen::Index i = 0; i < intervals.rows(); ++i) {
    const double slope = scales[static_cast<std::size_t>(i)].slope(one.mean(i));
    const double own = k_quantile * slope * std::sqrt(std::max(shared(i), 0.0));
    const double middle = 0.5 * (intervals(i, 0) + intervals(i, 1));
    const double half = std::hypot(0.5 * (intervals(i, 1) - intervals(i, 0)), own);
    intervals.row(i) = Eigen::RowVector2d(middle - half, middle + half);
  }
}

void add_intervals(const UpdatingProblem& problem, const PopulationFit& one, const MixtureSearch& search,
                   const MixturePopulationFit& fit, const RunContext& context, MixtureFindings& findings,
                   UpdatingResult& result) {
  context.phase({.name = "intervals and tests of the estimate"});
  MixtureSearch twice = search;
  twice.samples = 2 * search.samples;
  const std::vector<MixtureFit> redrawn = redrawn_fits(fit.alike, fit.mixture, twice, context);
  if (2 * redrawn.size() < static_cast<std::size_t>(twice.samples)) {
    result.warnings.push_back(fmt::format(
        "In {} of {} samples drawn from the estimate a batch is lost: no intervals are given. The batches are too "
        "small, or too near to one another.",
        static_cast<std::size_t>(twice.samples) - redrawn.size(), twice.samples));
    return;
  }
  result.intervals = mixture_intervals(problem, fit, redrawn, findings.batches);
  const std::vector<ParameterTransform> scales = problem.space.transforms();
  widen_by_model_error(one, scales, result.intervals->mean);
  for (Batch& batch : findings.batches) widen_by_model_error(one, scales, batch.mean_interval);
}

void add_power(const MixtureSearch& search, const MixturePopulationFit& fit, const RunContext& context,
               MixtureFindings& findings) {
  if (findings.tests.empty() || !std::isfinite(findings.tests.front().critical)) return;
  context.phase({.name = "power of the number of batches"});
  findings.detectable = detectable_distance(fit.alike, fit.mixture.within(), findings.tests.front().critical, search,
                                            k_power_samples, context);
}

void say_prior(const MixtureSearch& search, const MixtureFindings& findings, UpdatingResult& result) {
  if (findings.batches.size() < 2 || search.settings.has_common_covariance || search.settings.prior_weight == 0.0)
    return;
  Eigen::Index least = findings.batches.front().specimens;
  for (const Batch& batch : findings.batches) least = std::min(least, batch.specimens);
  const double nu = search.settings.prior_weight;
  result.notes.push_back(fmt::format(
      "Covariances of the batches are drawn towards their mean with the weight of {:.3g} specimens (covariance_prior): "
      "the variance in the smallest batch is off by {:.0f} % of its difference from the others.",
      nu, 100.0 * nu / std::max(static_cast<double>(least) - 1.0 + nu, 1.0)));
}

}  // namespace

void describe_mixture(const UpdatingProblem& problem, const TestMoments& tests, const SolvedPopulation& solved,
                      const MixtureSearch& search, const MixtureNumber& number, const RunContext& context,
                      const MixturePopulationFit& fit, UpdatingResult& result) {
  const PopulationFit& one = solved.best();
  const std::vector<ParameterTransform> scales = problem.space.transforms();
  MixtureFindings findings{.batches = {},
                           .probabilities = fit.mixture.probabilities,
                           .is_number_given = number.is_given,
                           .tests = number.tests};
  std::vector<BatchOnScales> batches;
  for (const MixtureComponent& own : fit.mixture.components) {
    batches.push_back(fit.frame.on_scales(own));
    findings.batches.push_back(batch_on_axes(scales, batches.back()));
  }
  count_specimens(findings);
  result.set_estimate(std::make_shared<MixturePopulation>(scales, std::move(batches)));
  IterationRecord last = record_state(problem, tests, *result.estimate, context);
  result.model_evaluations += last.cloud.samples.rows();
  result.history.back() = std::move(last);
  add_intervals(problem, one, search, fit, context, findings, result);
  add_power(search, fit, context, findings);
  PopulationFit whole = as_one_population(problem, one, fit);
  result.noise_covariance = one.noise.asDiagonal();
  result.specimens = specimens_in_batches(problem, fit, whole);
  result.model_error = one.model_error;
  result.sensitivity = whole.sensitivity;
  for (Eigen::Index i = 0; i < whole.mean.size(); ++i) {
    result.sensitivity.col(i) /= scales[static_cast<std::size_t>(i)].slope(whole.mean(i));
  }
  result.notes.emplace_back(
      "Mean, standard deviation and correlation are those of all batches together, without outliers and measurement "
      "noise.");
  say_number(problem, findings, number, result);
  say_power(problem, findings, result);
  say_batches(problem, findings, result);
  find_outliers(problem, fit, result);
  say_prior(search, findings, result);
  if (findings.batches.size() > 1) {
    result.notes.emplace_back(
        "The verdict's tests do not depend on the number of batches, and none of them tests it or the batches' "
        "normality. Specimens of one batch that were tested in two ways look like two batches.");
  }
  if (one.model_error) result.notes.push_back(model_error_note(problem, *one.model_error));
  name_other_solutions(problem, whole, solved.solutions, solved.starts, result);
  test_population(problem, whole, context, result);
  result.mixture = std::make_shared<const MixtureFindings>(std::move(findings));
}

void describe_one_batch(const UpdatingProblem& problem, const MixtureSearch& search, const MixtureNumber& number,
                        const RunContext& context, const MixturePopulationFit& fit, UpdatingResult& result) {
  MixtureFindings findings{.batches = {},
                           .probabilities = fit.mixture.probabilities,
                           .is_number_given = number.is_given,
                           .tests = number.tests};
  if (findings.probabilities.size() == 0) {  // not looked for
    findings.probabilities = Eigen::MatrixXd::Zero(problem.tests.values.rows(), 2);
    findings.probabilities.col(0).setOnes();
  }
  const PopulationOnScales& population = *result.estimate->population();
  findings.batches.push_back(batch_on_axes(problem.space.transforms(), {1.0, population.mean, population.covariance}));
  if (result.intervals) {
    findings.batches.front().mean_interval = result.intervals->mean;
    findings.batches.front().std_interval = result.intervals->std;
  }
  count_specimens(findings);
  const bool is_power_asked = number.not_believed.empty();
  if (is_power_asked && !fit.mixture.components.empty()) add_power(search, fit, context, findings);
  say_number(problem, findings, number, result);
  if (is_power_asked) say_power(problem, findings, result);
  result.mixture = std::make_shared<const MixtureFindings>(std::move(findings));
}

}  // namespace mottle::updating
