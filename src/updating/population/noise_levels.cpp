#include "updating/population/noise_levels.hpp"

#include <algorithm>

#include "mottle/stats/population/residual_noise.hpp"
#include "mottle/updating/methods/iteration.hpp"
#include "updating/fits/measured_outputs.hpp"
#include "updating/population/population_fit.hpp"

namespace mottle::updating {
namespace {

/// Variances of the outputs at their levels.
Eigen::VectorXd at_levels(const Eigen::VectorXd& base, const std::vector<int>& of_output,
                          const Eigen::VectorXd& levels) {
  Eigen::VectorXd variance = base;
  for (std::size_t k = 0; k < of_output.size(); ++k) {
    if (of_output[k] >= 0) variance(static_cast<Eigen::Index>(k)) *= levels(of_output[k]);
  }
  return variance;
}

}  // namespace

NoiseModel known_noise(Eigen::VectorXd variance) {
  const auto outputs = static_cast<std::size_t>(variance.size());
  return {std::move(variance), std::vector<int>(outputs, -1), 0};
}

NoiseOfResiduals noise_of_residuals(const Eigen::Ref<const Eigen::MatrixXd>& values,
                                    const std::vector<RandomEffectsUnit>& units, const NoiseModel& noise,
                                    double tolerance) {
  constexpr double k_weight = 4.0;
  std::vector<std::vector<Eigen::Index>> outputs;
  for (Eigen::Index s = 0; s < values.rows(); ++s) outputs.push_back(measured_outputs(values, s));
  const ResidualNoise common =
      estimate_residual_noise(units, outputs, {noise.factor, Eigen::VectorXd::Ones(noise.factors)}, tolerance);
  NoiseOfResiduals found{.variance = at_levels(noise.base, noise.factor, common.levels),
                         .degrees_of_freedom = common.degrees_of_freedom};
  found.common = {found.variance, noise.factor, noise.factors};
  const auto open = static_cast<double>(std::ranges::count_if(noise.factor, [](int level) { return level >= 0; }));
  const double directions = common.degrees_of_freedom / (static_cast<double>(values.rows()) - 1.0);
  found.has_own_levels = open > noise.factors && 0.5 * directions * (directions + 1.0) >= open;
  if (!found.has_own_levels) return found;
  OutputLevels own{.of_output = std::vector<int>(noise.factor.size(), -1),
                   .expected = Eigen::VectorXd(static_cast<Eigen::Index>(open)),
                   .weight = k_weight};
  int next = 0;
  for (std::size_t k = 0; k < noise.factor.size(); ++k) {
    if (noise.factor[k] < 0) continue;
    own.expected(next) = common.levels(noise.factor[k]);
    own.of_output[k] = next++;
  }
  found.variance = at_levels(noise.base, own.of_output, estimate_residual_noise(units, outputs, own, tolerance).levels);
  return found;
}

void take_noise_of_residuals(const Eigen::Ref<const Eigen::MatrixXd>& values, const NoiseModel& noise,
                             PopulationFit& fit) {
  NoiseOfResiduals found = noise_of_residuals(values, fit.units, noise);
  fit.settings.factors = noise.factors;
  fit.noise_of_residuals = {};
  if (found.degrees_of_freedom <= 0.0) return;
  TestData data;
  data.values = values;
  const TestMoments tests = test_moments(data);
  for (Eigen::Index k = 0; k < found.variance.size(); ++k) {
    constexpr int k_fewest = 3;  // two may be alike by chance
    const bool is_open = noise.factor[static_cast<std::size_t>(k)] >= 0;
    if (is_open && tests.count(k) >= k_fewest && tests.covariance(k, k) > 0.0) {
      found.variance(k) = std::min(found.variance(k), tests.covariance(k, k));
    }
  }
  const Eigen::VectorXd level = found.variance.cwiseQuotient(noise.base);
  for (Eigen::Index s = 0; s < values.rows(); ++s) {
    RandomEffectsUnit& unit = fit.units[static_cast<std::size_t>(s)];
    unit.noise.array() *= level(measured_outputs(values, s)).array();
    unit.factor.clear();
  }
  fit.settings.factors = 0;
  fit.noise = found.variance;
  fit.noise_of_residuals = std::move(found);
}

}  // namespace mottle::updating
