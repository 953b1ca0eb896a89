#include "updating/population/noise_levels.hpp"

#include <algorithm>

#include "mottle/stats/population/residual_noise.hpp"
#include "mottle/updating/methods/iteration.hpp"
#include "updating/fits/measured_outputs.hpp"
#include "updating/population/population_fit.hpp"

namespace mottle::updating {
namespace {

using Lists = std::vector<std::vector<Eigen::Index>>;

Lists measured_outputs_of_all(const Eigen::Ref<const Eigen::MatrixXd>& values) {
  Lists lists;
  for (Eigen::Index s = 0; s < values.rows(); ++s) lists.push_back(measured_outputs(values, s));
  return lists;
}

/// One level for each output whose noise is not known.
std::vector<int> own_levels(const std::vector<int>& kinds) {
  std::vector<int> own(kinds.size(), -1);
  int next = 0;
  for (std::size_t k = 0; k < kinds.size(); ++k) {
    if (kinds[k] >= 0) own[k] = next++;
  }
  return own;
}

/// Variances of the outputs at their levels.
Eigen::VectorXd at_levels(const Eigen::VectorXd& base, const std::vector<int>& of_output,
                          const Eigen::VectorXd& levels) {
  Eigen::VectorXd variance = base;
  for (std::size_t k = 0; k < of_output.size(); ++k) {
    if (of_output[k] >= 0) variance(static_cast<Eigen::Index>(k)) *= levels(of_output[k]);
  }
  return variance;
}

/// The units with the noise of the outputs changed by a factor.
void scale_noise(const Lists& outputs, const Eigen::VectorXd& factor, std::vector<RandomEffectsUnit>& units) {
  for (std::size_t s = 0; s < units.size(); ++s) units[s].noise.array() *= factor(outputs[s]).array();
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
  const Lists outputs = measured_outputs_of_all(values);
  const ResidualNoise common =
      estimate_residual_noise(units, outputs, {noise.factor, Eigen::VectorXd::Ones(noise.factors)}, tolerance);
  NoiseOfResiduals found{.variance = at_levels(noise.base, noise.factor, common.levels),
                         .degrees_of_freedom = common.degrees_of_freedom};
  found.common = {found.variance, noise.factor, noise.factors};
  const auto open = static_cast<double>(std::ranges::count_if(noise.factor, [](int level) { return level >= 0; }));
  const double directions = common.degrees_of_freedom / (static_cast<double>(values.rows()) - 1.0);
  found.has_own_levels = open > noise.factors && 0.5 * directions * (directions + 1.0) >= open;
  if (!found.has_own_levels) return found;
  std::vector<RandomEffectsUnit> scaled = units;
  scale_noise(outputs, found.variance.cwiseQuotient(noise.base), scaled);
  const std::vector<int> own = own_levels(noise.factor);
  const ResidualNoise apart = estimate_residual_noise(
      scaled, outputs, {own, Eigen::VectorXd::Ones(static_cast<Eigen::Index>(open)), k_weight}, tolerance);
  found.variance = at_levels(found.common.base, own, apart.levels);
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
  scale_noise(measured_outputs_of_all(values), found.variance.cwiseQuotient(noise.base), fit.units);
  for (RandomEffectsUnit& unit : fit.units) unit.factor.clear();
  fit.settings.factors = 0;
  fit.noise = found.variance;
  fit.noise_of_residuals = std::move(found);
}

}  // namespace mottle::updating
