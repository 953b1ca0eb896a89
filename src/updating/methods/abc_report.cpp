#include "updating/methods/abc_report.hpp"

#include <algorithm>
#include <cmath>
#include <limits>

#include "mottle/core/text.hpp"
#include "mottle/linalg/dense/decompositions.hpp"
#include "mottle/stats/chains/chain_diagnostics.hpp"
#include "mottle/stats/moments/descriptive.hpp"
#include "mottle/stats/population/population_intervals.hpp"
#include "mottle/stats/tests/normality.hpp"
#include "mottle/updating/estimate/sample_estimate.hpp"

namespace mottle::updating {
namespace {

constexpr double k_nan = std::numeric_limits<double>::quiet_NaN();
constexpr Eigen::Index k_chains = 4;
constexpr Eigen::Index k_draws = 500;

/// Means and standard deviations of the parameters on their own axes, correlations on the scales, levels of noise: of
/// each draw [draw x name].
Eigen::MatrixXd reported_values(const AbcFit& fit, const Eigen::MatrixXd& points) {
  const PopulationCoordinates& coordinates = fit.coordinates;
  const Eigen::Index q = coordinates.parameters();
  const Eigen::Index pairs = fit.has_correlations ? q * (q - 1) / 2 : 0;
  Eigen::MatrixXd values(points.rows(), 2 * q + pairs + coordinates.levels());
  for (Eigen::Index k = 0; k < points.rows(); ++k) {
    const SampledPopulation population = coordinates.at(points.row(k).transpose());
    const VariableMoments moments =
        moments_of_variables(fit.parameters.scales(), population.mean, population.covariance());
    values.row(k).head(q) = moments.mean.transpose();
    values.row(k).segment(q, q) = moments.covariance.diagonal().cwiseSqrt().transpose();
    const Eigen::MatrixXd correlation = correlation_from_covariance(population.covariance());
    for (Eigen::Index i = 1, place = 2 * q; fit.has_correlations && i < q; ++i) {
      for (Eigen::Index j = 0; j < i; ++j) values(k, place++) = correlation(i, j);
    }
    values.row(k).tail(coordinates.levels()) = points.row(k).tail(coordinates.levels()).array().exp().matrix();
  }
  return values;
}

std::vector<std::string> reported_names(const AbcFit& fit) {
  const std::vector<std::string> parameters = fit.problem.space.names();
  std::vector<std::string> names;
  for (const std::string& name : parameters) names.push_back("mean " + name);
  for (const std::string& name : parameters) names.push_back("std " + name);
  for (std::size_t i = 1; fit.has_correlations && i < parameters.size(); ++i) {
    for (std::size_t j = 0; j < i; ++j) {
      names.push_back(fmt::format("correlation {} {}", parameters[j], parameters[i]));
    }
  }
  for (Eigen::Index l = 0; l < fit.coordinates.levels(); ++l) names.push_back(fmt::format("noise level {}", l + 1));
  return names;
}

std::vector<std::string> coordinate_names(const AbcFit& fit) {
  const std::vector<std::string> parameters = fit.problem.space.names();
  std::vector<std::string> names;
  for (const std::string& name : parameters) names.push_back("mean " + name);
  for (const std::string& name : parameters) names.push_back("ln std " + name);
  for (Eigen::Index k = 0; k < fit.coordinates.correlations(); ++k) {
    names.push_back(fmt::format("partial correlation {}", k + 1));
  }
  for (Eigen::Index l = 0; l < fit.coordinates.levels(); ++l) names.push_back(fmt::format("ln noise level {}", l + 1));
  return names;
}

Eigen::RowVector2d ends_of(const Eigen::VectorXd& values, const Eigen::VectorXd& weights) {
  return {weighted_quantile(values, weights, 0.025), weighted_quantile(values, weights, 0.975)};
}

ParameterIntervals intervals_of(const AbcFit& fit, const SampledPopulations& sampled, const Eigen::MatrixXd& values,
                                const UpdatingResult& result) {
  const Eigen::Index q = fit.coordinates.parameters();
  const Eigen::VectorXd& weights = sampled.draws.weights;
  ParameterIntervals ends{Eigen::MatrixXd::Constant(q, 2, k_nan), Eigen::MatrixXd::Constant(q, 2, k_nan),
                          Eigen::MatrixXd::Constant(q, q, k_nan), Eigen::MatrixXd::Constant(q, q, k_nan), "simulation"};
  const auto hold = [](Eigen::MatrixXd& intervals, Eigen::Index row, double estimate) {
    intervals(row, 0) = std::min(intervals(row, 0), estimate);
    intervals(row, 1) = std::max(intervals(row, 1), estimate);
  };
  ends.correlation_lower.diagonal().setOnes();
  ends.correlation_upper.diagonal().setOnes();
  for (Eigen::Index i = 0; i < q; ++i) {
    if (!fit.is_seen[static_cast<std::size_t>(i)]) continue;
    ends.mean.row(i) = ends_of(values.col(i), weights);
    ends.std.row(i) = ends_of(values.col(q + i), weights);
    hold(ends.mean, i, result.mean(i));
    hold(ends.std, i, std::sqrt(result.covariance(i, i)));
  }
  const std::vector<int>& groups = fit.problem.covariance_groups;
  for (Eigen::Index i = 1, place = 2 * q; fit.has_correlations && i < q; ++i) {
    for (Eigen::Index j = 0; j < i; ++j, ++place) {
      const auto a = static_cast<std::size_t>(i);
      const auto b = static_cast<std::size_t>(j);
      const bool is_free = groups.empty() || groups[a] == groups[b];
      if (!is_free || !fit.is_seen[a] || !fit.is_seen[b]) continue;
      const Eigen::RowVector2d both = ends_of(values.col(place), weights);
      ends.correlation_lower(i, j) = ends.correlation_lower(j, i) = both(0);
      ends.correlation_upper(i, j) = ends.correlation_upper(j, i) = both(1);
    }
  }
  return ends;
}

/// Draws of equal weight from each quarter of the simulations, by systematic resampling, and how well the quarters
/// agree.
void add_chains(const SampledPopulations& sampled, const Eigen::MatrixXd& values, AbcFindings& findings) {
  findings.chains = k_chains;
  findings.draws = k_draws;
  findings.values.resize(k_chains * k_draws, values.cols());
  for (Eigen::Index c = 0; c < k_chains; ++c) {
    double total = 0.0;
    for (Eigen::Index k = c; k < values.rows(); k += k_chains) total += sampled.draws.weights(k);
    double sum = 0.0;
    Eigen::Index draw = 0;
    Eigen::Index last = c;
    for (Eigen::Index k = c; k < values.rows(); k += k_chains) {
      sum += sampled.draws.weights(k);
      last = k;
      while (draw < k_draws && (static_cast<double>(draw) + 0.5) * total < sum * static_cast<double>(k_draws)) {
        findings.values.row(c * k_draws + draw++) = values.row(k);
      }
    }
    while (draw < k_draws) findings.values.row(c * k_draws + draw++) = values.row(last);
  }
  findings.r_hat.resize(values.cols());
  for (Eigen::Index k = 0; k < values.cols(); ++k) {
    findings.r_hat(k) = rank_normalised_r_hat(findings.values.col(k).reshaped(k_draws, k_chains));
  }
}

/// Probability that normal tests have a least normal output as little normal; nan: fewer than five values of each.
double normality_of(const Eigen::MatrixXd& values) {
  constexpr std::size_t k_fewest = 5;
  double least = 1.0;
  int tested = 0;
  for (Eigen::Index k = 0; k < values.cols(); ++k) {
    std::vector<double> present;
    std::ranges::copy_if(values.col(k), std::back_inserter(present), [](double value) { return !std::isnan(value); });
    const auto [low, high] = std::ranges::minmax(present);
    if (present.size() < k_fewest || !(high - low > 1e-9 * std::max(std::abs(high), std::abs(low)))) continue;
    const Eigen::VectorXd column =
        Eigen::Map<const Eigen::VectorXd>(present.data(), static_cast<Eigen::Index>(present.size()));
    ++tested;
    least = std::min(least, normality_probabilities(normality_statistics(column), column.size()).p_value);
  }
  return tested > 0 ? 1.0 - std::pow(1.0 - least, tested) : k_nan;
}

/// Geometric mean of the ratios of widths; nan: none is known.
double width_ratio(const Eigen::MatrixXd& own, const Eigen::MatrixXd& other) {
  double sum = 0.0;
  int count = 0;
  for (Eigen::Index i = 0; i < own.rows(); ++i) {
    const double ratio = (own(i, 1) - own(i, 0)) / (other(i, 1) - other(i, 0));
    if (!std::isfinite(ratio) || !(ratio > 0.0)) continue;
    sum += std::log(ratio);
    ++count;
  }
  return count > 0 ? std::exp(sum / count) : k_nan;
}

void compare_with_likelihood(const AbcFit& fit, const UpdatingResult& result, AbcFindings& findings) {
  constexpr double k_nearly_linear = 0.02;  // of the variance: 14 % of an output's scatter
  const PopulationIntervals normal =
      population_intervals(result.estimate->population()->evidence, fit.parameters.scales(), 0.95);
  findings.curvature = fit.nearest.transport->curvature().maxCoeff();
  findings.normality_p = normality_of(fit.problem.tests.values);
  findings.width_ratio_mean = width_ratio(result.intervals->mean, normal.mean);
  findings.width_ratio_std = width_ratio(result.intervals->std, normal.std);
  findings.is_likelihood_better = !(findings.normality_p <= fit.problem.level) && findings.curvature <= k_nearly_linear;
}

std::string likelihood_note(const AbcFit& fit, const AbcFindings& findings) {
  const std::string widths =
      std::isnan(findings.width_ratio_mean) || std::isnan(findings.width_ratio_std)
          ? "no parameter has intervals to compare"
          : fmt::format(
                "intervals of a normal likelihood at the estimate would be {:.2f} times as wide for means and "
                "{:.2f} times for standard deviations",
                1.0 / findings.width_ratio_mean, 1.0 / findings.width_ratio_std);
  const std::string shape = std::isnan(findings.normality_p) ? "The tests are too few to say whether they are normal"
                                                             : fmt::format("The tests {} (p = {:.2g})",
                                                                           findings.normality_p > fit.problem.level
                                                                               ? "show no departure from normality"
                                                                               : "are not normal",
                                                                           findings.normality_p);
  const std::string line = fmt::format("{:.1f} % of an output's variance at most is not linear in the parameters",
                                       100.0 * findings.curvature);
  if (findings.is_likelihood_better) {
    return fmt::format("{} and {}: a likelihood method would do better; {} (method = \"maximum-likelihood\").", shape,
                       line, widths);
  }
  return fmt::format("{}, {}: a normal likelihood has no claim here ({}).", shape, line, widths);
}

void add_notes(const AbcFit& fit, const SampledPopulations& sampled, const AbcFindings& findings,
               UpdatingResult& result) {
  constexpr double k_few_effective = 100.0;
  constexpr Eigen::Index k_few_specimens = 5;  // of one parameter
  constexpr double k_max_r_hat = 1.1;
  result.notes.emplace_back(
      "Mean, standard deviation and correlation are those of the normal population on the parameters' scales whose "
      "cloud is nearest to the tests, without the measurement noise.");
  result.notes.push_back(fmt::format(
      "95 % intervals held the truth in {:.1f} % of {} simulated studies of as many specimens before they were "
      "stretched (by {:.2f} to {:.2f}), and in {:.1f} % (standard error {:.1f}) of those that did not make the factors "
      "after.",
      100.0 * findings.coverage.mean(), findings.calibration_sets, findings.factor.minCoeff(),
      findings.factor.maxCoeff(), 100.0 * findings.checked_coverage, 100.0 * findings.checked_standard_error));
  result.notes.push_back(likelihood_note(fit, findings));
  if (!fit.has_correlations && fit.coordinates.parameters() > 1) {
    result.notes.emplace_back(
        "Correlations are taken as zero: the specimens are too few for them, or abc.correlations says so.");
  }
  const double effective = sampled.draws.effective;
  if (effective < k_few_effective || findings.r_hat.maxCoeff() > k_max_r_hat) {
    result.warnings.push_back(fmt::format(
        "Intervals rest on {:.0f} independent draws, whose quarters agree to an R-hat of {:.3f}; give more simulations "
        "(abc.simulations), fewer parameters, or correlations = \"none\".",
        effective, findings.r_hat.maxCoeff()));
  }
  const Eigen::Index specimens = fit.problem.tests.values.rows();
  const Eigen::Index enough = std::max(k_few_specimens, 2 * (fit.coordinates.parameters() + 1));
  if (specimens < enough) {
    result.warnings.push_back(fmt::format(
        "Intervals of {} specimens are too narrow, and what simulated studies say of their coverage is too good: these "
        "are made at the estimate, which so few specimens do not determine. Use method = \"hierarchical\", or measure "
        "{} at least.",
        specimens, enough));
  }
  if (findings.exceeded < fit.problem.level) {
    result.warnings.push_back(fmt::format(
        "The tests are farther from the model's cloud ({:.3g}) than {:.1f} % of tests that are simulated from it: no "
        "normal population of these parameters that was found gives such tests.",
        findings.distances.empty() ? k_nan : findings.distances.back(), 100.0 * (1.0 - findings.exceeded)));
  }
}

}  // namespace

std::vector<bool> seen_parameters(const ScaledParameters& parameters,
                                  const Eigen::Ref<const Eigen::MatrixXd>& sensitivity,
                                  const Eigen::Ref<const Eigen::VectorXd>& unit) {
  constexpr double k_unseen = 1e-3;
  constexpr double k_mostly_seen = 0.1;
  const Eigen::MatrixXd scaled =
      unit.cwiseInverse().asDiagonal() * sensitivity * parameters.standard_deviation().asDiagonal();
  const SingularValues svd(scaled, Eigen::ComputeThinV);
  const Eigen::Index rank = (svd.values().array() > k_unseen * svd.values()(0)).count();
  std::vector<bool> is_seen;
  for (Eigen::Index i = 0; i < parameters.count(); ++i) {
    const double seen = svd.right().row(i).head(rank).squaredNorm();
    is_seen.push_back(1.0 - seen <= k_mostly_seen * k_mostly_seen);
  }
  return is_seen;
}

void describe_abc(const AbcFit& fit, const SampledPopulations& sampled, UpdatingResult& result) {
  auto findings = std::make_shared<AbcFindings>();
  findings->distance = fit.options.distance == AbcOptions::Distance::energy ? "energy" : "sliced-wasserstein";
  findings->distances = fit.nearest.distances;
  findings->simulated_distance = sampled.simulated_distance;
  findings->exceeded = sampled.exceeded;
  findings->stages = sampled.stages;
  findings->fraction = sampled.fraction;
  findings->calibration_sets = sampled.calibration_sets;
  findings->coordinates = coordinate_names(fit);
  findings->factor = sampled.calibration.factor;
  findings->coverage = sampled.calibration.coverage;
  findings->checked_coverage = sampled.calibration.checked_coverage;
  findings->checked_standard_error = sampled.calibration.checked_standard_error;
  const Eigen::MatrixXd values = reported_values(fit, sampled.stretched(fit.coordinates));
  findings->names = reported_names(fit);
  add_chains(sampled, values, *findings);
  result.intervals = intervals_of(fit, sampled, values, result);
  compare_with_likelihood(fit, result, *findings);
  add_notes(fit, sampled, *findings, result);
  result.abc = std::move(findings);
}

}  // namespace mottle::updating
