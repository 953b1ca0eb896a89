#include "updating/methods/hierarchical_report.hpp"

#include <algorithm>
#include <cmath>
#include <limits>

#include "mottle/core/subject.hpp"
#include "mottle/core/text.hpp"
#include "mottle/linalg/dense/decompositions.hpp"
#include "mottle/stats/moments/descriptive.hpp"
#include "mottle/stats/moments/quantiles.hpp"
#include "mottle/updating/estimate/population_posterior.hpp"
#include "mottle/updating/methods/iteration.hpp"
#include "updating/fits/scaled_parameters.hpp"
#include "updating/methods/hierarchical_tests.hpp"
#include "updating/methods/sampled_result.hpp"
#include "updating/population/model_error.hpp"
#include "updating/population/population_report.hpp"

namespace mottle::updating {
namespace {

constexpr double k_tail = 0.5 * (1.0 - k_confidence);

Eigen::RowVector2d ends_of(std::vector<double> values) {
  const Eigen::RowVector2d ends = equal_tails(std::move(values), k_confidence, QuantileRule::ends);
  return ends.allFinite() ? ends : Eigen::RowVector2d::Constant(std::numeric_limits<double>::quiet_NaN());
}

/// One number of each draw.
template <typename Number>
std::vector<double> of_each(const HierarchicalDraws& draws, const Number& number) {
  std::vector<double> values;
  for (const PopulationAt& population : draws.populations) values.push_back(number(population));
  return values;
}

double deviation_of(const PopulationAt& population, Eigen::Index i) {
  return population.factor.row(i).norm();
}

double correlation_of_pair(const PopulationAt& population, Eigen::Index i, Eigen::Index j) {
  const double product = deviation_of(population, i) * deviation_of(population, j);
  return product > 0.0 ? std::clamp(population.factor.row(i).dot(population.factor.row(j)) / product, -1.0, 1.0) : 0.0;
}

Eigen::MatrixXd errors_of(const HierarchicalDraws& draws) {
  Eigen::MatrixXd errors(static_cast<Eigen::Index>(draws.populations.size()),
                         draws.populations.front().model_error.size());
  for (Eigen::Index i = 0; i < errors.rows(); ++i)
    errors.row(i) = draws.populations[static_cast<std::size_t>(i)].model_error.transpose();
  return errors;
}

/// Mean of the means, medians of the standard deviations, mean of the correlations.
PopulationOnScales typical_population(const HierarchicalDraws& draws) {
  const Eigen::MatrixXd means = means_of(draws);
  const Eigen::Index q = means.cols();
  PopulationOnScales typical{means.colwise().mean().transpose(), Eigen::MatrixXd(q, q), {}};
  Eigen::VectorXd deviations(q);
  for (Eigen::Index i = 0; i < q; ++i) {
    deviations(i) =
        quantile(of_each(draws, [&](const PopulationAt& at) { return deviation_of(at, i); }), 0.5, QuantileRule::ends);
    typical.covariance(i, i) = deviations(i) * deviations(i);
    for (Eigen::Index j = 0; j < i; ++j) {
      double sum = 0.0;
      for (const PopulationAt& at : draws.populations) sum += correlation_of_pair(at, i, j);
      const double correlation = sum / static_cast<double>(means.rows());
      typical.covariance(i, j) = typical.covariance(j, i) = correlation * deviations(i) * deviations(j);
    }
  }
  return typical;
}

ParameterIntervals intervals_of(const UpdatingProblem& problem, const HierarchicalDraws& draws) {
  const std::vector<ParameterTransform> scales = problem.space.transforms();
  const auto q = static_cast<Eigen::Index>(scales.size());
  ParameterIntervals intervals{.mean = Eigen::MatrixXd(q, 2),
                               .std = Eigen::MatrixXd(q, 2),
                               .correlation_lower = Eigen::MatrixXd::Identity(q, q),
                               .correlation_upper = Eigen::MatrixXd::Identity(q, q),
                               .made_by = "posterior"};
  for (Eigen::Index i = 0; i < q; ++i) {
    std::vector<double> means;
    std::vector<double> deviations;
    for (const PopulationAt& at : draws.populations) {
      const double deviation = deviation_of(at, i);
      const VariableMoments moments =
          moments_of_variables({scales[static_cast<std::size_t>(i)]}, Eigen::VectorXd::Constant(1, at.mean(i)),
                               Eigen::MatrixXd::Constant(1, 1, deviation * deviation));
      means.push_back(moments.mean(0));
      deviations.push_back(std::sqrt(moments.covariance(0, 0)));
    }
    intervals.mean.row(i) = ends_of(means);
    intervals.std.row(i) = ends_of(deviations);
    for (Eigen::Index j = 0; j < i; ++j) {
      const Eigen::RowVector2d ends =
          ends_of(of_each(draws, [&](const PopulationAt& at) { return correlation_of_pair(at, i, j); }));
      intervals.correlation_lower(i, j) = intervals.correlation_lower(j, i) = ends(0);
      intervals.correlation_upper(i, j) = intervals.correlation_upper(j, i) = ends(1);
    }
  }
  return intervals;
}

/// The model's error given the tests, and how the means follow it.
std::optional<ModelError> found_model_error(const UpdatingProblem& problem, const HierarchicalDraws& draws) {
  const Eigen::VectorXd variance = problem.tests.model_error_variance();
  if (variance.isZero(0.0)) return std::nullopt;
  const Eigen::MatrixXd errors = errors_of(draws);
  const Eigen::MatrixXd means = means_of(draws);
  ModelError error{.std = variance.cwiseSqrt(),
                   .shift = errors.colwise().mean().transpose(),
                   .covariance = sample_covariance(errors),
                   .gain = {}};
  const Eigen::MatrixXd together = (means.rowwise() - means.colwise().mean()).transpose() *
                                   (errors.rowwise() - errors.colwise().mean()) /
                                   static_cast<double>(errors.rows() - 1);
  error.gain = together * semidefinite_pseudo_inverse(error.covariance);
  return error;
}

void estimate_specimens_by_draws(const HierarchicalFindings& findings, SpecimenEstimates& specimens) {
  const UpdatingProblem& problem = findings.problem;
  const Eigen::Index q = problem.space.count();
  const std::vector<ParameterTransform> scales = problem.space.transforms();
  specimens.lower.resize(specimens.parameters.rows(), q);
  specimens.upper = specimens.lower;
  for (Eigen::Index s = 0; s < specimens.parameters.rows(); ++s) {
    const Eigen::MatrixXd x = to_variables(scales, findings.draws.specimens.middleCols(s * q, q));
    specimens.parameters.row(s) = x.colwise().mean();
    for (Eigen::Index i = 0; i < q; ++i) {
      const Eigen::VectorXd own = x.col(i);
      const Eigen::RowVector2d ends = ends_of({own.begin(), own.end()});
      specimens.lower(s, i) = ends(0);
      specimens.upper(s, i) = ends(1);
    }
  }
}

/// Standard deviations whose 95 % interval the tests hardly narrow.
void warn_of_prior(const HierarchicalFindings& findings, UpdatingResult& result) {
  constexpr double k_as_wide = 0.5;  // of the prior's interval, both as factors: logarithms
  const Eigen::VectorXd lower = findings.prior.standard_deviations(k_tail);
  const Eigen::VectorXd upper = findings.prior.standard_deviations(1.0 - k_tail);
  std::vector<std::string> names;
  for (Eigen::Index i = 0; i < lower.size(); ++i) {
    const Eigen::RowVector2d ends =
        ends_of(of_each(findings.draws, [&](const PopulationAt& at) { return deviation_of(at, i); }));
    if (std::log(ends(1) / ends(0)) < k_as_wide * std::log(upper(i) / lower(i))) continue;
    names.push_back(findings.problem.space.names()[static_cast<std::size_t>(i)]);
  }
  if (names.empty()) return;
  result.warnings.push_back(fmt::format(
      "The scatter of {} rests on its prior (hierarchical.scatter_scale) as much as on {} specimens: their interval of "
      "the standard deviation is more than half as wide as before the tests, on a logarithmic axis.",
      join(names), findings.problem.tests.values.rows()));
}

void add_notes(const HierarchicalFindings& findings, UpdatingResult& result) {
  result.notes.push_back(
      "Mean, standard deviation and correlation are those of one population amid the posterior: mean of the means, "
      "medians of the standard deviations, means of the correlations, on the parameters' scales. The intervals are of "
      "the posterior; predictions draw new specimens from all of it.");
  if (findings.noise.is_known()) {
    result.notes.push_back("The measurement noise is taken as known.");
  } else {
    std::vector<std::string> levels;
    const Eigen::VectorXd variances = result.noise_covariance.diagonal();
    for (Eigen::Index k = 0; k < variances.size(); ++k) {
      levels.push_back(fmt::format("{} {:.3g}", findings.problem.model.outputs()[static_cast<std::size_t>(k)].name(),
                                   std::sqrt(variances(k))));
    }
    result.notes.push_back(
        fmt::format("Standard deviation of the measurement, sampled with the population: {}.", join(levels)));
  }
  note_model_error(findings.problem, "hierarchical",
                   "is sampled with the population: it is shared by all specimens, and what is known of the mean does "
                   "not fall below it with their number.",
                   result);
  note_failed_runs(findings.posterior, "specimens there have", result);
  warn_of_prior(findings, result);
}

}  // namespace

Eigen::MatrixXd means_of(const HierarchicalDraws& draws) {
  Eigen::MatrixXd means(static_cast<Eigen::Index>(draws.populations.size()), draws.populations.front().mean.size());
  for (Eigen::Index i = 0; i < means.rows(); ++i)
    means.row(i) = draws.populations[static_cast<std::size_t>(i)].mean.transpose();
  return means;
}

NamedDraws named_draws(const UpdatingProblem& problem, const PopulationPrior& prior, const HierarchicalDraws& draws) {
  constexpr Eigen::Index k_most = 100;  // columns for specimens: with 4,000 draws 8 MB
  const Eigen::Index own = prior.dimension();
  const Eigen::Index q = problem.space.count();
  NamedDraws named{.names = prior.names(), .has_specimens = draws.specimens.cols() <= k_most};
  const Eigen::Index columns = own + (named.has_specimens ? draws.specimens.cols() : 0);
  named.values.resize(draws.specimens.rows(), columns);
  for (Eigen::Index i = 0; i < named.values.rows(); ++i)
    named.values.row(i).head(own) = prior.values(draws.populations[static_cast<std::size_t>(i)]).transpose();
  if (!named.has_specimens) return named;
  for (Eigen::Index s = 0; s < problem.tests.values.rows(); ++s) {
    for (const std::string& name : problem.space.names())
      named.names.push_back(fmt::format("{}:{}", name, problem.tests.number_of(s)));
    named.values.middleCols(own + s * q, q) =
        to_variables(problem.space.transforms(), draws.specimens.middleCols(s * q, q));
  }
  return named;
}

void estimate_population(const HierarchicalFindings& findings, UpdatingResult& result) {
  PopulationOnScales typical = typical_population(findings.draws);
  const Eigen::MatrixXd means = means_of(findings.draws);
  const Eigen::Index q = means.cols();
  typical.evidence = {typical.mean, typical.covariance, Eigen::MatrixXd::Zero(q, q), sample_covariance(means),
                      Eigen::MatrixXd::Zero(q, q)};
  result.model_error = found_model_error(findings.problem, findings.draws);
  PopulationDraws draws{.means = means};
  for (const PopulationAt& at : findings.draws.populations) draws.factors.push_back(at.factor);
  if (result.model_error) {
    const ModelError& error = *result.model_error;
    draws.shifts = (errors_of(findings.draws).rowwise() - error.shift.transpose()) * error.gain.transpose();
  }
  result.set_estimate(std::make_shared<PopulationPosterior>(findings.problem.space.transforms(), std::move(typical),
                                                            std::move(draws),
                                                            findings.posterior.evidence.log_evidence));
  result.intervals = intervals_of(findings.problem, findings.draws);
  Eigen::MatrixXd levels(means.rows(), findings.noise.count());
  for (Eigen::Index i = 0; i < levels.rows(); ++i)
    levels.row(i) = findings.draws.populations[static_cast<std::size_t>(i)].levels.transpose();
  result.noise_covariance = mean_noise(findings.noise, levels).asDiagonal();
}

void describe_hierarchical(const HierarchicalFindings& findings, const RunContext& context, UpdatingResult& result) {
  const PopulationFit fit = as_population_fit(findings, result);
  result.sensitivity = fit.sensitivity;
  const std::vector<ParameterTransform> scales = findings.problem.space.transforms();
  for (Eigen::Index i = 0; i < fit.mean.size(); ++i)
    result.sensitivity.col(i) /= scales[static_cast<std::size_t>(i)].slope(fit.mean(i));
  result.specimens = estimate_specimens(findings.problem, fit);
  estimate_specimens_by_draws(findings, *result.specimens);
  add_notes(findings, result);
  test_hierarchical(findings, fit, context, result);
}

}  // namespace mottle::updating
