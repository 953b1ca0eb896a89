#include "mottle/stats/tests/normality.hpp"

#include <gtest/gtest.h>

#include <cmath>

#include "mottle/core/random.hpp"
#include "mottle/stats/distributions/standard_normal.hpp"
#include "support/instrumented.hpp"

namespace mottle::stats {
namespace {

Eigen::VectorXd weights_of_men() {  // the example of [Shapiro1965]
  return Eigen::VectorXd{{148, 154, 158, 160, 161, 162, 166, 170, 182, 195, 236}};
}

struct Population {
  std::vector<RandomEffectsUnit> units;
  RandomEffectsFit fit;
};

/// Tests y = x + e of given effects.
Population observe(const Eigen::MatrixXd& effects, double noise, std::uint32_t replication) {
  Population population;
  const Eigen::Index q = effects.cols();
  RandomStream stream({.seed = 14, .iteration = replication}, 0);
  for (const auto& row : effects.rowwise()) {
    Eigen::VectorXd response = row.transpose();
    for (double& value : response) value += noise * standard_normal_quantile(stream.uniform());
    population.units.push_back(
        {Eigen::MatrixXd::Identity(q, q), response, Eigen::VectorXd::Constant(q, noise * noise)});
  }
  population.fit = fit_random_effects(population.units, Eigen::MatrixXd::Identity(q, q), {});
  return population;
}

Eigen::MatrixXd normal_effects(Eigen::Index count, Eigen::Index variables, std::uint32_t replication) {
  RandomStream stream({.seed = 13, .iteration = replication}, 0);
  Eigen::MatrixXd effects(count, variables);
  for (double& value : effects.reshaped()) value = standard_normal_quantile(stream.uniform());
  return effects;
}

double p_value_of(const Eigen::MatrixXd& effects, double noise, std::uint32_t replication) {
  const Population population = observe(effects, noise, replication);
  return test_normality(population.units, population.fit, Eigen::MatrixXd::Identity(effects.cols(), effects.cols()))
      .p_value;
}

TEST(Normality, HasShapiroAndWilksStatistic) {
  // scipy.stats.shapiro and skew, SciPy 1.10.
  const NormalityStatistics men = normality_statistics(weights_of_men());
  EXPECT_NEAR(men.shapiro_wilk, 0.7888147830963135, 2e-6);
  EXPECT_NEAR(men.skewness, 1.678543901586165, 1e-12);
  const Eigen::VectorXd five{{3.0, 1.0, 4.0, 1.5, 9.0}};
  EXPECT_NEAR(normality_statistics(five).shapiro_wilk, 0.8591295480728149, 2e-6);
  Eigen::VectorXd fifty(50);
  for (int i = 0; i < 50; ++i) fifty(i) = std::exp(std::sin((i + 1.0) * (i + 1.0)));
  EXPECT_NEAR(normality_statistics(fifty).shapiro_wilk, 0.7940056324005127, 2e-6);
}

TEST(Normality, HasTheRatioOfTheBestSplit) {
  // Computed with NumPy from the definition.
  const Eigen::VectorXd batches{{0.61, 0.58, 0.63, 0.6, 0.57, 1.42, 1.38, 1.44, 1.4, 1.37}};
  const NormalityStatistics split = normality_statistics(batches);
  EXPECT_NEAR(split.two_batches, 290.654676258993, 1e-6);
  EXPECT_EQ(split.lower_batch, 5);
  EXPECT_NEAR(normality_statistics(weights_of_men()).two_batches, 2.8900343642611683, 1e-10);
}

TEST(Normality, HasTheProbabilityOfShapiroAndWilksStatistic) {
  // scipy.stats.shapiro: p = 0.00670 of W alone; both statistics together are at most twice as probable.
  const double p = normality_probabilities(normality_statistics(weights_of_men()), 11).p_value;
  EXPECT_GT(p, 0.004);
  EXPECT_LT(p, 0.0145);
}

TEST(Normality, HasHenzeAndZirklersStatistic) {
  // Computed with NumPy and scipy.spatial.distance.cdist from the definition.
  Eigen::MatrixXd flowers(10, 2);
  flowers << 5.1, 3.5, 4.9, 3.0, 4.7, 3.2, 4.6, 3.1, 5.0, 3.6, 5.4, 3.9, 4.6, 3.4, 5.0, 3.4, 4.4, 2.9, 4.9, 3.1;
  EXPECT_NEAR(henze_zirkler(flowers), 0.1781114226780307, 1e-10);
  Eigen::MatrixXd three(10, 3);
  three << flowers, Eigen::VectorXd{{1, 2, 4, 8, 16, 32, 64, 3, 5, 7}};
  EXPECT_NEAR(henze_zirkler(three), 0.8450753384887748, 1e-10);
}

TEST(Normality, IsDeniedToOneNormalPopulationOfTwenty) {
  if (test::k_is_instrumented) GTEST_SKIP() << test::k_left_to_optimised_build;
  constexpr int k_replications = 1000;
  for (const double noise : {0.0, 1.0}) {
    int denied = 0;
    for (std::uint32_t r = 0; r < k_replications; ++r) {
      denied += p_value_of(normal_effects(12, 3, r), noise, r) <= 0.05 ? 1 : 0;
    }
    // The tests are correlated, so the level is a little below 5 %; three standard errors are 2.1 %.
    EXPECT_NEAR(denied, 45, 21) << noise;
  }
}

TEST(Normality, IsDeniedToTwoBatches) {
  int denied = 0;
  constexpr int k_replications = 100;
  for (std::uint32_t r = 0; r < k_replications; ++r) {
    Eigen::MatrixXd effects = normal_effects(20, 3, r);
    for (Eigen::Index s = 0; s < 20; ++s) effects(s, 0) = (s % 2 == 0 ? 0.6 : 1.4) + 0.1 * effects(s, 0);
    denied += p_value_of(effects, 0.0, r) <= 0.05 ? 1 : 0;
  }
  EXPECT_EQ(denied, k_replications);
}

TEST(Normality, IsDeniedToALogNormalPopulation) {
  int denied = 0;
  constexpr int k_replications = 100;
  for (std::uint32_t r = 0; r < k_replications; ++r) {
    Eigen::MatrixXd effects = normal_effects(50, 3, r);
    effects.col(0) = (std::sqrt(std::log(1.64)) * effects.col(0).array()).exp();
    denied += p_value_of(effects, 0.0, r) <= 0.05 ? 1 : 0;
  }
  EXPECT_GE(denied, 97);
}

TEST(Normality, CannotBeToldWhereNoiseIsMostOfTheScatter) {
  const Population population = observe(normal_effects(60, 2, 1), 3.0, 1);
  const NormalityTest test = test_normality(population.units, population.fit, Eigen::Matrix2d::Identity());
  EXPECT_LT(test.variables[0].reliability, 0.5);
}

TEST(Normality, NeedsFiveSpecimens) {
  const Population population = observe(normal_effects(4, 1, 1), 0.0, 1);
  EXPECT_EQ(test_normality(population.units, population.fit, Eigen::MatrixXd::Identity(1, 1)).tests, 0);
}

}  // namespace
}  // namespace mottle::stats
