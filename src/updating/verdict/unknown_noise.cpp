#include "updating/verdict/unknown_noise.hpp"

#include <algorithm>
#include <cmath>

#include "mottle/core/error.hpp"
#include "mottle/core/random.hpp"
#include "mottle/linalg/dense/decompositions.hpp"
#include "mottle/stats/distributions/chi_squared.hpp"
#include "mottle/stats/distributions/standard_normal.hpp"
#include "mottle/stats/moments/descriptive.hpp"
#include "updating/fits/measured_outputs.hpp"
#include "updating/verdict/simulated_law.hpp"

namespace mottle::updating {
namespace {

struct Statistics {
  double means = 0.0;
  double scatter = 0.0;
};

Statistics statistics_of(const MeanResiduals& residuals) {
  if (residuals.directions.cols() == 0) return {};
  const Eigen::MatrixXd values = residuals.values * residuals.directions;
  return {residuals.mean_squares, symmetric_eigenvalues(sample_covariance(values)).maxCoeff()};
}

/// Studies in which the model is right.
class StudiesOfUnknownNoise {
 public:
  StudiesOfUnknownNoise(const Eigen::MatrixXd& values, const PopulationFit& fit)
      : values_(values), fit_(fit), noise_(fit.noise_of_residuals.common), units_(fit.units) {
    for (std::size_t s = 0; s < units_.size(); ++s) {
      units_[s].noise = noise_.base(measured_outputs(values, static_cast<Eigen::Index>(s)));
    }
  }

  /// @param own  standard deviation of a cause of scatter that is no parameter, moving all residuals alike, in units of
  ///             the noise
  Statistics draw(std::uint32_t number, double own = 0.0) const {
    RandomStream stream({.seed = 4, .purpose = StreamPurpose::bootstrap}, number);
    const auto normal = [&] { return standard_normal_quantile(stream.uniform()); };
    const Eigen::VectorXd root = fit_.noise.cwiseSqrt();
    Eigen::VectorXd error = Eigen::VectorXd::Zero(root.size());
    if (fit_.model_error) {
      for (Eigen::Index k = 0; k < error.size(); ++k) error(k) = fit_.model_error->std(k) * normal();
    }
    std::vector<RandomEffectsUnit> units = units_;
    for (std::size_t s = 0; s < units.size(); ++s) {
      const double cause = own > 0.0 ? own * normal() : 0.0;
      const std::vector<Eigen::Index> rows = measured_outputs(values_, static_cast<Eigen::Index>(s));
      for (std::size_t k = 0; k < rows.size(); ++k) {
        const auto row = static_cast<Eigen::Index>(k);
        units[s].response(row) = error(rows[k]) + root(rows[k]) * (normal() + (k % 2 == 0 ? cause : -cause));
      }
    }
    constexpr double k_tolerance = 1e-3;
    const NoiseOfResiduals found = noise_of_residuals(values_, units, noise_, k_tolerance);
    const Eigen::VectorXd model_error = fit_.model_error ? fit_.model_error->std : Eigen::VectorXd();
    return statistics_of(mean_residuals(values_, units, found.variance, model_error));
  }

 private:
  const Eigen::MatrixXd& values_;
  const PopulationFit& fit_;
  const NoiseModel& noise_;
  std::vector<RandomEffectsUnit> units_;  // noise at the common levels
};

void plan_means(const MeanResiduals& residuals, const Eigen::VectorXd& simulated, TestPlan& plan) {
  const double d = residuals.mean_degrees_of_freedom;
  const auto n = static_cast<double>(residuals.values.rows());
  PlannedTest test = chi_squared_test("mean-residuals", residuals.mean_squares, d);
  test.aspect = Aspect::means;
  test.meaning = fmt::format(
      "Mean residuals of {:.0f} specimens in {} that no parameter moves: are they no more than the measurement's "
      "noise, which is estimated{}?",
      n, directions_text(d), residuals.largest_variance > 1.0 ? ", and the model's stated error" : "");
  const double per_mean = residuals.largest_variance / (n + residuals.largest_variance - 1.0);
  test.power = [=](double level) {
    const double shift = std::sqrt(chi_squared_detectable(d, level) * per_mean);
    return Power{fmt::format("means that are off by {:.2g} standard deviations of the noise in one of them", shift),
                 shift <= k_gross_error};
  };
  judge_by_studies(
      {residuals.mean_squares, simulated}, [d](double squares) { return chi_squared_upper_tail(squares, d); }, test);
  plan.add(std::move(test));
}

void plan_scatter(const StudiesOfUnknownNoise& studies, const MeanResiduals& residuals, const StudiedStatistic& largest,
                  TestPlan& plan) {
  const auto d = static_cast<double>(residuals.directions.cols());
  PlannedTest test{.name = "scatter-of-residuals"};
  test.aspect = Aspect::scatter;
  test.meaning = fmt::format(
      "Largest variance of the residuals in {} that no parameter moves: is it no more than noise of each output by "
      "itself makes?",
      directions_text(d));
  judge_by_studies(largest, {}, test);
  test.power = [=, critical = test.critical](double level) {
    constexpr std::uint32_t k_studies = 40;
    for (const double own : {1.0, 1.5, 2.0, 3.0, k_gross_error}) {
      int found = 0;
      for (std::uint32_t r = 0; r < k_studies; ++r) {
        found += studies.draw(r, own).scatter > critical(level) ? 1 : 0;
      }
      if (found < (1.0 - k_missed) * k_studies) continue;
      return Power{fmt::format("a further cause of scatter that moves all outputs by {:.2g} times their noise", own)};
    }
    return Power{"a further cause of scatter of more than five times the noise", false};
  };
  plan.add(std::move(test));
}

}  // namespace

void plan_tests_of_unknown_noise(const Eigen::MatrixXd& values, const PopulationFit& fit,
                                 const MeanResiduals& residuals, double level, TestPlan& plan) {
  constexpr double k_studies = 20.0;  // beyond the level of all tests
  const auto count = static_cast<std::uint32_t>(std::clamp(std::ceil(k_studies / level), 200.0, 3000.0));
  const StudiesOfUnknownNoise studies(values, fit);
  Eigen::VectorXd means(count);
  Eigen::VectorXd scatter(count);
  for (std::uint32_t r = 0; r < count; ++r) {
    const Statistics drawn = studies.draw(1000 + r);
    means(r) = drawn.means;
    scatter(r) = drawn.scatter;
  }
  if (fit.settings.levels == 0) plan_means(residuals, means, plan);
  if (!fit.noise_of_residuals.has_own_levels || residuals.directions.cols() < 2) {
    plan.leave_untested(Aspect::scatter,
                        "The scatter was not tested: the residuals that are left determine the level of the noise and "
                        "no more. Give [test] repeatability of every output, or measure further outputs.");
    return;
  }
  plan_scatter(studies, residuals, {statistics_of(residuals).scatter, scatter}, plan);
}

}  // namespace mottle::updating
