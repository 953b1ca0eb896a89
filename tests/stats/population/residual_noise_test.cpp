// Levels of noise from residuals against closed forms and the restricted likelihood as SciPy maximises it.
#include "mottle/stats/population/residual_noise.hpp"

#include <gtest/gtest.h>

#include <Eigen/Core>
#include <array>
#include <numeric>
#include <vector>

#include "mottle/core/error.hpp"
#include "mottle/core/random.hpp"
#include "mottle/stats/distributions/standard_normal.hpp"
#include "mottle/stats/moments/descriptive.hpp"

namespace mottle::stats {
namespace {

struct Units {
  std::vector<RandomEffectsUnit> units;
  std::vector<std::vector<Eigen::Index>> outputs;
};

/// Six units of two effects and five outputs whose means the effects do not reach; two entries are missing.
Units six_units() {
  constexpr std::array<std::array<double, 10>, 6> k_design = {
      {{0.2, -0.43, 0.1, -1.28, -0.62, -0.3, 0.9, 1.28, -1.37, -0.86},
       {0.25, -0.43, 0.14, -1.28, -0.58, -0.13, 0.76, 1.1, -1.51, -0.92},
       {0.02, -0.49, 0.0, -1.16, -0.56, -0.21, 0.65, 1.09, -1.33, -0.78},
       {0.05, -0.51, 0.03, -1.27, -0.47, -0.28, 0.9, 1.23, -1.38, -0.81},
       {0.21, -0.46, 0.0, -1.18, -0.44, -0.35, 0.98, 1.16, -1.39, -0.59},
       {0.28, -0.58, 0.13, -1.13, -0.6, -0.13, 0.89, 1.21, -1.18, -0.86}}};
  constexpr std::array<std::array<double, 5>, 6> k_values = {{{4.467, 15.968, 1.872, -11.353, 4.154},
                                                              {1.601, 3.874, 1.017, -4.527, 4.571},
                                                              {2.698, 8.976, 2.547, -8.251, 6.584},
                                                              {2.086, 5.253, -0.682, -1.995, -1.195},
                                                              {2.604, 14.023, 7.392, -20.49, 16.242},
                                                              {-0.976, 1.241, 1.593, -3.037, 5.358}}};
  const Eigen::VectorXd noise{{1.0, 4.0, 0.25, 1.0, 9.0}};
  Units six;
  for (std::size_t s = 0; s < 6; ++s) {
    std::vector<Eigen::Index> rows;
    for (Eigen::Index k = 0; k < 5; ++k) {
      const bool is_missing = (s == 1 && k == 2) || (s == 4 && k == 0);
      if (!is_missing) rows.push_back(k);
    }
    const Eigen::Map<const Eigen::Matrix<double, 5, 2, Eigen::RowMajor>> design(k_design[s].data());
    const Eigen::Map<const Eigen::VectorXd> values(k_values[s].data(), 5);
    six.units.push_back({design(rows, Eigen::all), values(rows), noise(rows)});
    six.outputs.push_back(rows);
  }
  return six;
}

void expect_near(const Eigen::VectorXd& found, const Eigen::VectorXd& wanted) {
  ASSERT_EQ(found.size(), wanted.size());
  for (Eigen::Index i = 0; i < found.size(); ++i) EXPECT_NEAR(found(i), wanted(i), 1e-6 * wanted(i)) << i;
}

// Expected values: the projected restricted likelihood (of an orthonormal complement of all effects and of the means in
// the three directions that residuals see, which SVD gives), maximised by SciPy 1.10. The two others have 0.003 and
// 0.039 of the weight that units without effects would give them.
TEST(ResidualNoise, MaximisesTheRestrictedLikelihoodOfUnitsWithGaps) {
  const auto [units, outputs] = six_units();
  const ResidualNoise common =
      estimate_residual_noise(units, outputs, {{0, 0, 0, 0, 0}, Eigen::VectorXd::Ones(1)}, 1e-9);
  EXPECT_TRUE(common.converged);
  EXPECT_EQ(common.degrees_of_freedom, 13.0);
  expect_near(common.levels, Eigen::VectorXd{{0.21969846291413}});
  const OutputLevels own{{0, 1, 2, 3, 4}, Eigen::VectorXd::Constant(5, 0.21969846291413), 4.0};
  expect_near(estimate_residual_noise(units, outputs, own, 1e-9).levels,
              Eigen::VectorXd{{0.1998308625297546, 0.2988793098700793, 0.2082326211936722, 0.1718659108755163,
                               0.2118981776016266}});
  const OutputLevels in_part{{0, 1, 2, -1, -1}, Eigen::VectorXd::Constant(3, 1.2), 4.0};
  expect_near(estimate_residual_noise(units, outputs, in_part, 1e-9).levels,
              Eigen::VectorXd{{0.8220198338114045, 0.8472856226435069, 0.924492014970958}});
}

TEST(ResidualNoise, DoesNotDependOnUnitsOfMeasurement) {
  const auto [units, outputs] = six_units();
  const OutputLevels levels{{0, 1, 2, 3, 4}, Eigen::VectorXd::Constant(5, 0.3), 2.0};
  const Eigen::VectorXd before = estimate_residual_noise(units, outputs, levels, 1e-10).levels;
  std::vector<RandomEffectsUnit> scaled = units;
  for (RandomEffectsUnit& unit : scaled) {
    unit.design.col(1) *= 1e9;  // the unit of an effect
    unit.design *= 1e-6;        // and that of the outputs
    unit.response *= 1e-6;
    unit.noise *= 1e-12;
  }
  expect_near(estimate_residual_noise(scaled, outputs, levels, 1e-10).levels, before);
}

TEST(ResidualNoise, IsTheSampleVarianceAndTheBeliefWithoutEffects) {
  RandomStream stream({.seed = 5}, 0);
  constexpr Eigen::Index k_units = 7;
  Eigen::MatrixXd values(k_units, 2);
  for (double& value : values.reshaped()) value = 3.0 + standard_normal_quantile(stream.uniform());
  Units all;
  for (Eigen::Index s = 0; s < k_units; ++s) {
    all.units.push_back({Eigen::MatrixXd(2, 0), values.row(s).transpose(), Eigen::VectorXd::Ones(2)});
    all.outputs.push_back({0, 1});
  }
  constexpr double k_weight = 4.0;
  const ResidualNoise found =
      estimate_residual_noise(all.units, all.outputs, {{0, 1}, Eigen::VectorXd::Constant(2, 0.5), k_weight}, 1e-12);
  const Eigen::VectorXd variance = sample_covariance(values).diagonal();
  expect_near(found.levels, ((k_units - 1) * variance.array() + k_weight * 0.5) / (k_units - 1 + k_weight));
  EXPECT_EQ(found.degrees_of_freedom, 2.0 * (k_units - 1));
}

TEST(ResidualNoise, OfCopiesIsTheRoundingThatIsLeft) {
  Units six = six_units();
  for (std::size_t s = 0; s < 6; ++s) {
    six.units[s] = six.units[0];
    six.outputs[s] = six.outputs[0];
  }
  EXPECT_EQ(estimate_residual_noise(six.units, six.outputs, {{0, 0, 0, 0, 0}, Eigen::VectorXd::Ones(1)}).levels(0),
            1e-16);
}

TEST(ResidualNoise, KeepsWhatIsExpectedWhereEffectsReachAllOutputs) {
  Units all;
  for (Eigen::Index s = 0; s < 4; ++s) {
    all.units.push_back({Eigen::MatrixXd::Identity(2, 2), Eigen::VectorXd::Constant(2, static_cast<double>(s)),
                         Eigen::VectorXd::Ones(2)});
    all.outputs.push_back({0, 1});
  }
  const ResidualNoise found = estimate_residual_noise(all.units, all.outputs, {{0, 0}, Eigen::VectorXd::Ones(1)});
  EXPECT_EQ(found.degrees_of_freedom, 0.0);
  EXPECT_EQ(found.levels(0), 1.0);
}

TEST(ResidualNoise, RefusesListsThatDoNotFit) {
  auto [units, outputs] = six_units();
  outputs[2].pop_back();
  EXPECT_THROW(estimate_residual_noise(units, outputs, {{0, 0, 0, 0, 0}, Eigen::VectorXd::Ones(1)}), InvalidInput);
}

}  // namespace
}  // namespace mottle::stats
