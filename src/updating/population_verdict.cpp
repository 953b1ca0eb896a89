// Whether a fitted population can be right: what the specimens' residuals say.
#include <Eigen/QR>
#include <algorithm>
#include <boost/math/distributions/fisher_f.hpp>
#include <cmath>

#include "mottle/core/error.hpp"
#include "mottle/core/text.hpp"
#include "mottle/stats/chi_squared.hpp"
#include "population_report.hpp"

namespace mottle {
namespace {

/// Residuals of the specimens in units of the noise, what their own best parameters leave of them.
struct WhitenedResiduals {
  Eigen::MatrixXd values;       // [specimen x output], 0 where missing
  Eigen::MatrixXd mean_design;  // whitened, over the specimens that have the output [output x effect]
  Eigen::VectorXd count;        // specimens that have the output [output]
  double squares = 0.0;
  double freedom = 0.0;
};

WhitenedResiduals whiten(const UpdatingProblem& problem, const PopulationFit& fit) {
  const Eigen::MatrixXd& tests = problem.tests.values;
  const Eigen::Index effects = fit.effects.mean.size();
  WhitenedResiduals result{Eigen::MatrixXd::Zero(tests.rows(), tests.cols()),
                           Eigen::MatrixXd::Zero(tests.cols(), effects), Eigen::VectorXd::Zero(tests.cols())};
  for (Eigen::Index s = 0; s < tests.rows(); ++s) {
    const RandomEffectsUnit& unit = fit.units[static_cast<std::size_t>(s)];
    std::vector<Eigen::Index> rows;
    for (Eigen::Index k = 0; k < tests.cols(); ++k) {
      if (!std::isnan(tests(s, k))) rows.push_back(k);
    }
    const Eigen::VectorXd weight = fit.noise(rows).cwiseSqrt().cwiseInverse();
    const Eigen::MatrixXd design = weight.asDiagonal() * unit.design;
    const Eigen::VectorXd response = weight.asDiagonal() * unit.response;
    const Eigen::ColPivHouseholderQR<Eigen::MatrixXd> factor(design);
    const Eigen::VectorXd residual = response - design * factor.solve(response);
    for (std::size_t k = 0; k < rows.size(); ++k) {
      const auto place = static_cast<Eigen::Index>(k);
      result.values(s, rows[k]) = residual(place);
      result.mean_design.row(rows[k]) += design.row(place);
      result.count(rows[k]) += 1.0;
    }
    result.squares += residual.squaredNorm();
    result.freedom += static_cast<double>(rows.size()) - static_cast<double>(factor.rank());
  }
  for (Eigen::Index k = 0; k < tests.cols(); ++k) result.mean_design.row(k) /= std::max(result.count(k), 1.0);
  return result;
}

/// Directions of whitened outputs that no parameter moves [output x direction].
Eigen::MatrixXd unmoved_directions(const Eigen::MatrixXd& design) {
  const Eigen::ColPivHouseholderQR<Eigen::MatrixXd> factor(design);
  const Eigen::MatrixXd q = factor.householderQ() * Eigen::MatrixXd::Identity(design.rows(), design.rows());
  return q.rightCols(design.rows() - factor.rank());
}

VerdictTest mean_residual_test(const WhitenedResiduals& residuals, bool is_noise_known, double level,
                               Eigen::Index specimens) {
  const Eigen::MatrixXd directions = unmoved_directions(residuals.mean_design);
  const Eigen::VectorXd sums = residuals.values.colwise().sum();
  const Eigen::VectorXd means = sums.cwiseQuotient(residuals.count.cwiseMax(1.0).cwiseSqrt());
  const double misfit = (directions.transpose() * means).squaredNorm();
  const auto freedom = static_cast<double>(directions.cols());
  const double rest = residuals.freedom - freedom;
  VerdictTest test{.name = "mean-residuals", .statistic = misfit};
  if (is_noise_known) {
    test.critical = chi_squared_quantile(1.0 - level, freedom);
    test.p_value = chi_squared_upper_tail(misfit, freedom);
  } else {
    test.statistic = misfit / freedom / (std::max(residuals.squares - misfit, 1e-300) / rest);
    const boost::math::fisher_f law(freedom, rest);
    test.critical = boost::math::quantile(complement(law, level));
    test.p_value = boost::math::cdf(complement(law, test.statistic));
  }
  test.passed = test.statistic <= test.critical;
  test.meaning = fmt::format(
      "Mean residuals of {} specimens in the {} directions that no parameter moves: are they no more than the "
      "measurement's noise?",
      specimens, directions.cols());
  return test;
}

/// Passes where the statistic is no larger than chi-squared of this freedom is once in 1 / level.
VerdictTest chi_squared_test(std::string name, double statistic, double freedom, double level) {
  const double critical = chi_squared_quantile(1.0 - level, freedom);
  return {.name = std::move(name),
          .statistic = statistic,
          .critical = critical,
          .p_value = chi_squared_upper_tail(statistic, freedom),
          .passed = statistic <= critical,
          .meaning = {}};
}

VerdictTest scatter_residual_test(const WhitenedResiduals& residuals, double mean_misfit, double mean_freedom,
                                  double level) {
  const double freedom = residuals.freedom - mean_freedom;
  VerdictTest test =
      chi_squared_test("scatter-of-residuals", std::max(residuals.squares - mean_misfit, 0.0), freedom, level);
  test.meaning = fmt::format(
      "Chi-squared with {:.0f} degrees of freedom: do the residuals scatter from specimen to specimen no more than the "
      "measurement's noise?",
      freedom);
  return test;
}

/// Likelihood ratio of correlations between the groups, with the factor that brings its mean to that of chi-squared.
VerdictTest correlation_test(const PopulationFit& fit, double freedom, double level) {
  RandomEffectsSettings full = fit.settings;
  full.covariance_groups.clear();
  const RandomEffectsFit free = fit_random_effects(fit.units, fit.effects.covariance, full);
  const auto n = static_cast<double>(fit.units.size());
  const auto q = static_cast<double>(fit.effects.mean.size());
  const double factor = std::max(1.0 - (2.0 * q + 11.0) / (6.0 * n), 0.1);
  const double gain = std::max(free.log_likelihood - fit.effects.log_likelihood, 0.0);
  VerdictTest test = chi_squared_test("correlations", 2.0 * factor * gain, freedom, level);
  test.meaning = fmt::format(
      "Likelihood ratio with {:.0f} degrees of freedom: are the parameters that may not be correlated uncorrelated in "
      "the tests?",
      freedom);
  return test;
}

double restricted_entries(const std::vector<int>& groups) {
  double count = 0.0;
  for (std::size_t i = 0; i < groups.size(); ++i) {
    for (std::size_t j = 0; j < i; ++j) count += groups[i] != groups[j] ? 1.0 : 0.0;
  }
  return count;
}

/// Tests without noise that no parameters give.
VerdictTest reproduction_test(const PopulationFit& fit) {
  const auto lost = std::count(fit.specimens.converged.begin(), fit.specimens.converged.end(), false);
  return {.name = "reproduction",
          .statistic = static_cast<double>(lost),
          .critical = 0.0,
          .p_value = lost > 0 ? 0.0 : 1.0,
          .passed = lost == 0,
          .meaning = fmt::format("Number of specimens, of {}, whose test no parameters reproduce.",
                                 fit.specimens.converged.size())};
}

}  // namespace

void test_population(const UpdatingProblem& problem, const PopulationFit& fit, UpdatingResult& result) {
  const bool has_noise = (fit.noise.array() > 0.0).all();
  const bool is_known = fit.settings.factors == 0;
  const double restricted = restricted_entries(fit.settings.covariance_groups);
  WhitenedResiduals residuals;
  double mean_freedom = 0.0;
  if (has_noise) {
    residuals = whiten(problem, fit);
    mean_freedom = static_cast<double>(unmoved_directions(residuals.mean_design).cols());
  }
  const bool has_means = has_noise && mean_freedom > 0.0 && residuals.freedom > mean_freedom;
  const bool has_scatter = has_means && is_known;
  const int tests = (has_means ? 1 : 0) + (has_scatter ? 1 : 0) + (restricted > 0.0 ? 1 : 0);
  // Independent tests: the level of each is such that one false alarm among them has the level of the whole.
  const double level = 1.0 - std::pow(1.0 - problem.level, 1.0 / std::max(tests, 1));
  if (has_means) {
    result.tests.push_back(mean_residual_test(residuals, is_known, level, problem.tests.values.rows()));
  }
  if (has_scatter) {
    result.tests.push_back(scatter_residual_test(residuals, result.tests.back().statistic, mean_freedom, level));
  }
  if (restricted > 0.0) result.tests.push_back(correlation_test(fit, restricted, level));
  if (!has_noise) result.tests.push_back(reproduction_test(fit));
  if (!has_means) {
    result.notes.push_back(fmt::format(
        "{} outputs are no more than the {} combinations of parameters that they see: any means can be matched, so the "
        "means have no degrees of freedom to judge the model by.",
        problem.tests.values.cols(), fit.seen.cols()));
  }
  if (!has_scatter && restricted == 0.0) {
    result.notes.push_back(
        "The covariance of the parameters is free to match any covariance of the tests: the covariances have no "
        "degrees "
        "of freedom to judge the model by.");
  }
}

}  // namespace mottle
