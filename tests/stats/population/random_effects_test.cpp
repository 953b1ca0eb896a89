// The random-effects estimator against closed forms and a published fit.
#include "mottle/stats/population/random_effects.hpp"

#include <gtest/gtest.h>

#include <Eigen/LU>
#include <cmath>

#include "mottle/stats/moments/descriptive.hpp"
#include "mottle/stats/population/population_intervals.hpp"

namespace mottle::stats {
namespace {

/// Distance between pituitary and pterygomaxillary fissure of 27 children at ages 8, 10, 12 and 14, in mm: the data of
/// [Potthoff1964].
Eigen::MatrixXd orthodont() {
  Eigen::MatrixXd d(27, 4);
  d << 26, 25, 29, 31, 21.5, 22.5, 23, 26.5, 23, 22.5, 24, 27.5, 25.5, 27.5, 26.5, 27, 20, 23.5, 22.5, 26, 24.5, 25.5,
      27, 28.5, 22, 22, 24.5, 26.5, 24, 21.5, 24.5, 25.5, 23, 20.5, 31, 26, 27.5, 28, 31, 31.5, 23, 23, 23.5, 25, 21.5,
      23.5, 24, 28, 17, 24.5, 26, 29.5, 22.5, 25.5, 25.5, 26, 23, 24.5, 26, 30, 22, 21.5, 23.5, 25,  // boys
      21, 20, 21.5, 23, 21, 21.5, 24, 25.5, 20.5, 24, 24.5, 26, 23.5, 24.5, 25, 26.5, 21.5, 23, 22.5, 23.5, 20, 21, 21,
      22.5, 21.5, 22.5, 23, 25, 23, 23, 23.5, 24, 20, 21, 22, 21.5, 16.5, 19, 19, 19.5, 24.5, 25, 28, 28;
  return d;
}

std::vector<RandomEffectsUnit> growth_curves() {
  Eigen::MatrixXd design(4, 2);
  design << 1, 8, 1, 10, 1, 12, 1, 14;
  const Eigen::MatrixXd data = orthodont();
  std::vector<RandomEffectsUnit> units;
  for (Eigen::Index s = 0; s < data.rows(); ++s) {
    units.push_back({design, data.row(s).transpose(), Eigen::VectorXd::Ones(4), {0, 0, 0, 0}});
  }
  return units;
}

TEST(RandomEffects, GivesThePublishedRestrictedFitOfTheOrthodontData) {
  const RandomEffectsFit fit =
      fit_random_effects(growth_curves(), Eigen::MatrixXd(Eigen::Vector2d(4.0, 0.1).asDiagonal()), {.factors = 1});
  ASSERT_TRUE(fit.converged);
  // [Pinheiro2000], section 4.3: lme(distance ~ age, Orthodont), as printed.
  EXPECT_NEAR(fit.mean(0), 16.7611, 5e-5);
  EXPECT_NEAR(fit.mean(1), 0.6602, 5e-5);
  EXPECT_NEAR(std::sqrt(fit.covariance(0, 0)), 2.32703, 2e-4);
  EXPECT_NEAR(std::sqrt(fit.covariance(1, 1)), 0.22643, 2e-5);
  EXPECT_NEAR(fit.covariance(0, 1) / std::sqrt(fit.covariance(0, 0) * fit.covariance(1, 1)), -0.609, 5e-4);
  EXPECT_NEAR(std::sqrt(fit.noise_factors(0)), 1.31004, 5e-5);
}

/// Six units of three effects seen through an invertible design.
struct Complete {
  Complete() : x(6, 3), design(3, 3) {
    x << 1.1, 2.0, 0.3, 0.9, 2.2, 0.1, 1.3, 1.7, 0.4, 0.7, 2.1, 0.6, 1.0, 1.8, 0.2, 1.2, 2.4, 0.5;
    design << 2.0, 0.3, 0.1, -0.4, 1.5, 0.2, 0.3, 0.6, 1.1;
    for (Eigen::Index s = 0; s < 6; ++s) {
      units.push_back({design, design * x.row(s).transpose(), Eigen::VectorXd::Zero(3)});
    }
  }
  Eigen::MatrixXd x;
  Eigen::MatrixXd design;
  std::vector<RandomEffectsUnit> units;
};

TEST(RandomEffects, WithoutNoiseIsTheSampleMeanAndTheUnbiasedCovariance) {
  const Complete c;
  const RandomEffectsFit fit = fit_random_effects(c.units, Eigen::Matrix3d::Identity(), {});
  EXPECT_LT((fit.mean - sample_mean(c.x)).norm(), 1e-10);
  EXPECT_LT((fit.covariance - sample_covariance(c.x)).norm(), 1e-8);
  EXPECT_LT((fit.effects - c.x).norm(), 1e-8);
}

TEST(RandomEffects, WithoutRestrictionDividesByTheNumberOfUnits) {
  const Complete c;
  const RandomEffectsFit fit = fit_random_effects(c.units, Eigen::Matrix3d::Identity(), {.is_restricted = false});
  EXPECT_LT((fit.covariance - sample_covariance(c.x) * 5.0 / 6.0).norm(), 1e-8);
}

TEST(RandomEffects, TakesKnownNoiseOffTheCovarianceOfTheUnits) {
  Complete c;
  const Eigen::Vector3d noise(1e-4, 4e-4, 2e-4);
  for (RandomEffectsUnit& unit : c.units) unit.noise = noise;
  const RandomEffectsFit fit = fit_random_effects(c.units, Eigen::Matrix3d::Identity(), {});
  // Balanced analysis of variance: while the difference is positive definite it is the restricted estimate.
  const Eigen::Matrix3d inverse = c.design.inverse();
  const Eigen::Matrix3d expected =
      sample_covariance(c.x) - Eigen::MatrixXd(inverse * noise.asDiagonal() * inverse.transpose());
  ASSERT_GT(expected.determinant(), 0.0);
  EXPECT_LT((fit.covariance - expected).norm(), 1e-7);
}

TEST(RandomEffects, EstimatesTheNoiseOfRepeatedMeasurementsAsTheAnalysisOfVariance) {
  // One effect measured three times on each of four units: textbook one-way analysis of variance.
  Eigen::MatrixXd y(4, 3);
  y << 5.1, 5.3, 4.9, 6.2, 6.0, 6.4, 4.4, 4.6, 4.3, 5.6, 5.9, 5.5;
  std::vector<RandomEffectsUnit> units;
  for (Eigen::Index s = 0; s < 4; ++s) {
    units.push_back({Eigen::MatrixXd::Ones(3, 1), y.row(s).transpose(), Eigen::VectorXd::Ones(3), {0, 0, 0}});
  }
  const RandomEffectsFit fit = fit_random_effects(units, Eigen::MatrixXd::Identity(1, 1), {.factors = 1});
  const Eigen::VectorXd means = y.rowwise().mean();
  const double within = (y.colwise() - means).squaredNorm() / 8.0;
  const double between = 3.0 * (means.array() - means.mean()).square().sum() / 3.0;
  EXPECT_NEAR(fit.noise_factors(0), within, 1e-7);
  EXPECT_NEAR(fit.covariance(0, 0), (between - within) / 3.0, 1e-7);
}

TEST(RandomEffects, KeepsGroupsUncorrelatedAndAMeanWhereItIsHeld) {
  const Complete c;
  RandomEffectsSettings settings;
  settings.covariance_groups = {0, 1, 0};
  settings.mean_origin = Eigen::Vector3d(0.0, 2.5, 0.0);
  settings.mean_directions = Eigen::MatrixXd::Zero(3, 2);
  settings.mean_directions(0, 0) = settings.mean_directions(2, 1) = 1.0;
  const RandomEffectsFit fit = fit_random_effects(c.units, Eigen::Matrix3d::Identity(), settings);
  EXPECT_EQ(fit.covariance(0, 1), 0.0);
  EXPECT_NE(fit.covariance(0, 2), 0.0);
  EXPECT_EQ(fit.mean(1), 2.5);
  // The held effect's variance is about what it is held at: sum of squares over the number of units.
  EXPECT_NEAR(fit.covariance(1, 1), (c.x.col(1).array() - 2.5).square().mean(), 1e-7);
}

/// An effect that all units share is a regression: y = a_s + b z, a_s ~ N(a, v), is fitted by ordinary least squares.
TEST(RandomEffects, AnEffectWithoutVarianceIsSharedByAllUnits) {
  const double z[] = {-1.0, 0.5, 2.0, 0.0, 1.5, -0.7};
  const double y[] = {0.3, 1.9, 3.2, 1.4, 2.5, 0.9};
  std::vector<RandomEffectsUnit> units;
  Eigen::MatrixXd x(6, 2);
  Eigen::VectorXd values(6);
  for (Eigen::Index s = 0; s < 6; ++s) {
    x.row(s) << 1.0, z[s];
    values(s) = y[s];
    units.push_back({x.row(s), values.segment(s, 1), Eigen::VectorXd::Zero(1)});
  }
  const Eigen::Vector2d beta = (x.transpose() * x).inverse() * x.transpose() * values;
  const double residual = (values - x * beta).squaredNorm();
  Eigen::Matrix2d start = Eigen::Matrix2d::Zero();
  start(0, 0) = 1.0;
  for (const bool is_restricted : {true, false}) {
    RandomEffectsSettings settings;
    settings.is_restricted = is_restricted;
    settings.covariance_groups = {0, 1};
    const RandomEffectsFit fit = fit_random_effects(units, start, settings);
    EXPECT_TRUE(fit.mean.isApprox(beta, 1e-9));
    EXPECT_NEAR(fit.covariance(0, 0), residual / (is_restricted ? 4.0 : 6.0), 1e-8);
    EXPECT_EQ(fit.covariance(1, 1), 0.0);
  }
}

TEST(RandomEffects, InformationOfACompleteSampleIsThatOfTheWishartDistribution) {
  const Complete c;
  const RandomEffectsFit fit = fit_random_effects(c.units, Eigen::Matrix3d::Identity(), {});
  const RandomEffectsInformation information = random_effects_information(c.units, fit, {});
  const Eigen::MatrixXd s = sample_covariance(c.x);
  for (Eigen::Index i = 0; i < 3; ++i) {
    for (Eigen::Index j = 0; j < 3; ++j) {
      const double expected = (s(i, j) * s(i, j) + s(i, i) * s(j, j)) / 5.0;
      EXPECT_NEAR(information.variance_of(Eigen::Vector3d::Unit(i), Eigen::Vector3d::Unit(j)), expected,
                  1e-6 * expected);
    }
  }
  EXPECT_LT((information.mean_from_effects - s / 6.0).norm(), 1e-8);
}

TEST(PopulationEvidence, IsNoneWhereOutputsSeeNothing) {
  std::vector<RandomEffectsUnit> units(3);
  for (RandomEffectsUnit& unit : units) {
    unit = {Eigen::MatrixXd(2, 0), Eigen::Vector2d(0.1, 0.2), Eigen::Vector2d(1.0, 1.0), {}};
  }
  RandomEffectsFit fit;
  fit.mean = Eigen::VectorXd(0);
  fit.covariance = Eigen::MatrixXd(0, 0);
  const PopulationEvidence evidence = population_evidence(units, fit, {}, Eigen::MatrixXd(2, 0));
  EXPECT_EQ(evidence.mean, Eigen::Vector2d::Zero());
  EXPECT_EQ(evidence.degrees_of_freedom, Eigen::Matrix2d::Zero());
  EXPECT_TRUE(std::isnan(population_intervals(evidence, std::vector<ParameterTransform>(2), 0.95).mean(0, 0)));
}

TEST(PopulationIntervals, AreTheTextbooksForACompleteSample) {
  const Complete c;
  const RandomEffectsFit fit = fit_random_effects(c.units, Eigen::Matrix3d::Identity(), {});
  const PopulationEvidence evidence = population_evidence(c.units, fit, {}, Eigen::Matrix3d::Identity());
  const PopulationIntervals intervals = population_intervals(evidence, std::vector<ParameterTransform>(3), 0.95);
  const Eigen::MatrixXd s = sample_covariance(c.x);
  const double mean = c.x.col(0).mean();
  constexpr double k_t = 2.570581836;          // Student's t, 5 degrees of freedom, 0.975
  constexpr double k_chi_low = 0.831211613;    // chi-squared, 5 degrees of freedom, 0.025
  constexpr double k_chi_high = 12.832501994;  // and 0.975
  EXPECT_NEAR(intervals.mean(0, 1), mean + k_t * std::sqrt(s(0, 0) / 6.0), 1e-8);
  EXPECT_NEAR(intervals.std(0, 0), std::sqrt(5.0 * s(0, 0) / k_chi_high), 1e-8);
  EXPECT_NEAR(intervals.std(0, 1), std::sqrt(5.0 * s(0, 0) / k_chi_low), 1e-8);
}

TEST(PopulationIntervals, HaveTheExactDistributionOfACorrelation) {
  // Ten pairs with r = 0.5: the ends solve P(R <= 0.5 | rho) = 0.975 and 0.025; integration of Hotelling's density.
  PopulationEvidence evidence;
  evidence.mean = Eigen::Vector2d::Zero();
  evidence.total = (Eigen::Matrix2d() << 4.0, 1.0, 1.0, 1.0).finished();
  evidence.noise = Eigen::Matrix2d::Zero();
  evidence.mean_covariance = Eigen::Vector2d(0.4, 0.1).asDiagonal();
  evidence.degrees_of_freedom = Eigen::Matrix2d::Constant(9.0);
  const PopulationIntervals intervals = population_intervals(evidence, std::vector<ParameterTransform>(2), 0.95);
  EXPECT_NEAR(intervals.correlation_lower(1, 0), -0.18092, 0.01);
  EXPECT_NEAR(intervals.correlation_upper(1, 0), 0.83929, 0.01);
}

}  // namespace
}  // namespace mottle::stats
