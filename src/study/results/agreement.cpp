#include "study/results/agreement.hpp"

#include <algorithm>
#include <cmath>
#include <limits>

#include "mottle/linalg/dense/decompositions.hpp"
#include "mottle/model/reference_sizes.hpp"
#include "mottle/stats/distributions/chi_squared.hpp"
#include "mottle/stats/tests/binomial_range.hpp"
#include "mottle/stats/tests/hotelling.hpp"
#include "mottle/updating/methods/iteration.hpp"

namespace mottle::study {
namespace {

constexpr double k_nan = std::numeric_limits<double>::quiet_NaN();
constexpr double k_last_digits = 1e-9;  // a standard deviation below it, of the value, is rounding

/// What is the same for all outputs.
struct AgreementWithTests {
  TestMoments tests;
  Eigen::VectorXd noise;        // R, variance [output]
  Eigen::VectorXd model_error;  // D, variance [output]
  const IterationRecord& first;
  const IterationRecord& last;
  Eigen::VectorXd sizes = {};  // that errors of means are fractions of [output]
};

AgreementWithTests comparison_of(const UpdatingProblem& problem, const UpdatingResult& result) {
  AgreementWithTests c{test_moments(problem.tests), {}, {}, result.history.front(), result.history.back()};
  const Eigen::Index p = c.tests.mean.size();
  c.sizes = reference_sizes(problem.model.outputs(), c.tests.mean);
  c.noise = result.noise_covariance.size() > 0 ? Eigen::VectorXd(result.noise_covariance.diagonal())
                                               : Eigen::VectorXd(problem.tests.repeatability_std.cwiseAbs2());
  c.model_error = Eigen::VectorXd::Zero(p);
  if (result.model_error) {
    c.model_error = result.model_error->std.cwiseAbs2();
  } else if (!problem.tests.is_model_error_estimated && problem.tests.model_error_std.size() == p) {
    c.model_error = problem.tests.model_error_std.cwiseAbs2();
  }
  return c;
}

Eigen::Index valid_samples(const IterationRecord& state) {
  return std::max<Eigen::Index>(state.cloud.samples.rows() - static_cast<Eigen::Index>(state.cloud.failures.size()), 1);
}

/// Variance of a test in the cloud, and of the tests; nan where the tests show none.
double tested_variance(const AgreementWithTests& c, Eigen::Index k) {
  const double variance = c.tests.covariance(k, k);
  const double rounding = k_last_digits * std::abs(c.tests.mean(k));
  return c.tests.count(k) >= 2 && variance > rounding * rounding ? variance : k_nan;
}

CloudComparison compare_cloud(const AgreementWithTests& c, const IterationRecord& state, Eigen::Index k) {
  const double n = c.tests.count(k);
  const double tested = tested_variance(c, k);
  const double sampling = std::isnan(tested) ? c.noise(k) / n : tested / n;
  const double error = std::sqrt(sampling + state.output_covariance(k, k) / static_cast<double>(valid_samples(state)) +
                                 c.model_error(k));
  CloudComparison comparison;
  comparison.mean_difference = state.output_mean(k) - c.tests.mean(k);
  comparison.mean_error = c.sizes(k) == 0.0 ? k_nan : comparison.mean_difference / c.sizes(k);
  comparison.standard_errors = sampling > 0.0 ? comparison.mean_difference / error : k_nan;
  comparison.std_ratio = std::sqrt((state.output_covariance(k, k) + c.noise(k)) / tested);
  return comparison;
}

/// Two-sided quantile of Student's t.
double student_t(int degrees_of_freedom, double alpha) {
  return hotelling_t_critical(degrees_of_freedom + 1, 1, 1, alpha);
}

OutputAgreement compare_output(const AgreementWithTests& c, Eigen::Index k) {
  const double alpha = k_chance / static_cast<double>(c.tests.mean.size());
  OutputAgreement output{k, compare_cloud(c, c.first, k), compare_cloud(c, c.last, k), k_nan, k_nan, k_nan};
  const int degrees_of_freedom = c.tests.count(k) - 1;
  const bool has_scatter = !std::isnan(tested_variance(c, k));
  if (has_scatter) {
    const double nu = degrees_of_freedom;
    output.critical_standard_errors = student_t(degrees_of_freedom, alpha);
    output.min_std_ratio = std::sqrt(nu / chi_squared_quantile(1.0 - 0.5 * alpha, nu));
    output.max_std_ratio = std::sqrt(nu / chi_squared_quantile(0.5 * alpha, nu));
  } else if (c.noise(k) > 0.0) {
    output.critical_standard_errors = std::sqrt(chi_squared_quantile(1.0 - alpha, 1.0));
  }
  if (std::isfinite(output.final.standard_errors) && std::isfinite(output.critical_standard_errors)) {
    output.is_mean_reproduced = std::abs(output.final.standard_errors) <= output.critical_standard_errors;
  }
  if (has_scatter && std::isfinite(output.final.std_ratio)) {
    output.is_scatter_reproduced =
        output.final.std_ratio >= output.min_std_ratio && output.final.std_ratio <= output.max_std_ratio;
  }
  return output;
}

/// Squared distance of a test from the cloud's mean; nan where the cloud has no region.
double squared_distance(const Eigen::VectorXd& off, const Eigen::MatrixXd& covariance) {
  constexpr double k_singular = 1e-12;
  const Eigen::VectorXd scale = covariance.diagonal().cwiseSqrt();
  if (!(scale.minCoeff() > 0.0)) return k_nan;
  const Eigen::MatrixXd correlation =
      scale.cwiseInverse().asDiagonal() * covariance * scale.cwiseInverse().asDiagonal();
  if (!(semidefinite_pivots(correlation).minCoeff() > k_singular)) return k_nan;
  const Eigen::VectorXd scaled = off.cwiseQuotient(scale);
  return scaled.dot(solve_semidefinite(correlation, scaled));
}

/// Complete tests within the region of a state's cloud; nothing where it has none.
std::optional<int> count_inside(const AgreementWithTests& c, const IterationRecord& state,
                                const std::vector<Eigen::VectorXd>& complete, double probability) {
  const auto p = static_cast<int>(c.tests.mean.size());
  const Eigen::Index samples = valid_samples(state);
  if (samples <= p + 1 || !state.output_covariance.allFinite()) return std::nullopt;
  Eigen::MatrixXd covariance = state.output_covariance * (1.0 + 1.0 / static_cast<double>(samples));
  covariance.diagonal() += c.noise + c.model_error;
  const double critical = hotelling_t_critical(1, static_cast<int>(samples), p, 1.0 - probability);
  int inside = 0;
  for (const Eigen::VectorXd& test : complete) {
    const double distance = squared_distance(test - state.output_mean, covariance);
    if (std::isnan(distance)) return std::nullopt;
    inside += distance <= critical * critical ? 1 : 0;
  }
  return inside;
}

std::optional<RegionAgreement> compare_region(const AgreementWithTests& c, const TestData& tests,
                                              Eigen::Index parameters) {
  std::vector<Eigen::VectorXd> complete;
  for (Eigen::Index s = 0; s < tests.values.rows(); ++s) {
    if (tests.values.row(s).allFinite()) complete.emplace_back(tests.values.row(s).transpose());
  }
  if (complete.size() < 2) return std::nullopt;
  RegionAgreement region{.tests = static_cast<int>(complete.size())};
  const std::optional<int> final = count_inside(c, c.last, complete, region.probability);
  if (!final) return std::nullopt;
  region.initial = count_inside(c, c.first, complete, region.probability);
  region.final = *final;
  region.is_judged = (c.noise.array() > 0.0).all() || c.tests.mean.size() <= parameters;
  region.min_inside = binomial_range(region.tests, region.probability, 1.0 - 2.0 * k_chance).min_successes;
  return region;
}

}  // namespace

double OutputAgreement::scatter_misfit() const {
  const double limit = final.std_ratio < 1.0 ? min_std_ratio : max_std_ratio;
  if (final.std_ratio == 0.0) return std::numeric_limits<double>::infinity();
  return std::log(final.std_ratio) / std::log(limit);
}

double OutputAgreement::misfit() const {
  const double of_mean = std::abs(final.standard_errors) / critical_standard_errors;
  const double of_scatter = scatter_misfit();
  return std::max(std::isnan(of_mean) ? 0.0 : of_mean, std::isnan(of_scatter) ? 0.0 : of_scatter);
}

bool Agreement::are_means_reproduced() const {
  return std::all_of(outputs.begin(), outputs.end(),
                     [](const OutputAgreement& output) { return output.is_mean_reproduced.value_or(true); });
}

bool Agreement::is_scatter_reproduced() const {
  return (!region || region->is_reproduced()) &&
         std::all_of(outputs.begin(), outputs.end(),
                     [](const OutputAgreement& output) { return output.is_scatter_reproduced.value_or(true); });
}

Agreement compare_with_tests(const UpdatingProblem& problem, const UpdatingResult& result) {
  const AgreementWithTests c = comparison_of(problem, result);
  Agreement agreement;
  for (Eigen::Index k = 0; k < c.tests.mean.size(); ++k) agreement.outputs.push_back(compare_output(c, k));
  std::stable_sort(agreement.outputs.begin(), agreement.outputs.end(),
                   [](const OutputAgreement& a, const OutputAgreement& b) { return a.misfit() > b.misfit(); });
  agreement.region = compare_region(c, problem.tests, problem.space.count());
  return agreement;
}

}  // namespace mottle::study
