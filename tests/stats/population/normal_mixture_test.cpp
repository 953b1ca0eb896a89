// Mixtures of linear random effects against another program, closed forms and the estimator of one population.
#include "mottle/stats/population/normal_mixture.hpp"

#include <gtest/gtest.h>

#include <cmath>

#include "mottle/stats/moments/descriptive.hpp"
#include "mottle/stats/population/mixture_choice.hpp"

namespace mottle::stats {
namespace {

/// Two batches of twelve and six units, seen without noise.
Eigen::MatrixXd points() {
  Eigen::MatrixXd x(18, 2);
  x << 1.2, 0.3, 0.8, -0.4, 1.9, 0.9, 0.1, 0.2, 1.4, -0.8, 0.6, 1.1, 2.2, 0.1, 1.0, 0.7, -0.3, -0.2, 1.6, 1.5, 4.1, 3.2,
      5.0, 2.1, 4.6, 3.9, 3.7, 2.4, 5.6, 3.3, 4.3, 1.2, 3.2, 2.9, 2.9, 1.4;
  return x;
}

std::vector<RandomEffectsUnit> units_of(const Eigen::MatrixXd& x, double noise = 0.0) {
  std::vector<RandomEffectsUnit> units;
  for (const auto& row : x.rowwise()) {
    units.push_back(
        {Eigen::MatrixXd::Identity(x.cols(), x.cols()), row.transpose(), Eigen::VectorXd::Constant(x.cols(), noise)});
  }
  return units;
}

Eigen::MatrixXd halves() {
  Eigen::MatrixXd start = Eigen::MatrixXd::Zero(18, 2);
  start.col(0).head(10).setOnes();
  start.col(1).tail(8).setOnes();
  return start;
}

const MixtureSettings textbook{.is_restricted = false, .prior_weight = 0.0, .iterations = 20000, .tolerance = 1e-13};

TEST(NormalMixture, HasLikelihoodMomentsAndProbabilitiesOfScikitLearn) {
  const auto fit = fit_mixture(mixture_data(units_of(points())), halves(), textbook);
  ASSERT_TRUE(fit && fit->converged);
  // sklearn.mixture.GaussianMixture 1.2.1 (reg_covar = 0, tol = 1e-13), validation/mixture/sklearn_reference.py.
  EXPECT_NEAR(fit->log_likelihood, -53.063516282390026, 1e-9);
  EXPECT_NEAR(fit->components[0].weight, 0.57406359, 2e-6);
  EXPECT_LT((fit->components[0].mean - Eigen::Vector2d(1.11396578, 0.37637485)).norm(), 1e-5);
  EXPECT_LT((fit->components[1].mean - Eigen::Vector2d(4.22457824, 2.59700532)).norm(), 1e-5);
  EXPECT_NEAR(fit->components[0].covariance(0, 0), 0.64962602, 1e-5);
  EXPECT_NEAR(fit->components[1].covariance(1, 0), 0.23961199, 1e-5);
  EXPECT_NEAR(fit->probabilities(9, 0), 0.98593335, 1e-5);
  EXPECT_NEAR(fit->probabilities(17, 1), 0.63738994, 1e-5);
}

TEST(NormalMixture, HasTheLikelihoodOfScikitLearnWithACommonCovariance) {
  MixtureSettings common = textbook;
  common.has_common_covariance = true;
  const auto fit = fit_mixture(mixture_data(units_of(points())), halves(), common);
  ASSERT_TRUE(fit && fit->converged);
  EXPECT_NEAR(fit->log_likelihood, -53.30878643143435, 1e-9);
  EXPECT_NEAR(fit->components[1].covariance(0, 1), 0.20305109, 1e-5);
}

TEST(NormalMixture, IsTheRestrictedEstimateOfOnePopulationWhereThereIsOneBatch) {
  const std::vector<RandomEffectsUnit> units = units_of(points(), 0.2);
  const RandomEffectsFit one = fit_random_effects(units, Eigen::MatrixXd::Identity(2, 2), {});
  const auto fit = fit_mixture(mixture_data(units), Eigen::MatrixXd(Eigen::MatrixXd::Ones(18, 1)),
                               {.prior_weight = 0.0, .iterations = 20000, .tolerance = 1e-14});
  ASSERT_TRUE(fit);
  EXPECT_LT((fit->components[0].mean - one.mean).norm(), 1e-6);
  EXPECT_LT((fit->components[0].covariance - one.covariance).norm(), 1e-5);
}

TEST(NormalMixture, DrawsVariancesTogetherByTheWeightOfTheBelief) {
  // Far apart, so that each unit belongs to one batch: (scatter + nu W) / (n - 1 + nu), W the pooled scatter.
  Eigen::MatrixXd x(10, 1);
  x << -1.0, 0.0, 1.0, 2.0, 3.0, 997.0, 999.0, 1001.0, 1003.0, 1005.0;
  Eigen::MatrixXd start = Eigen::MatrixXd::Zero(10, 2);
  start.col(0).head(5).setOnes();
  start.col(1).tail(5).setOnes();
  const auto fit = fit_mixture(mixture_data(units_of(x)), start, {.prior_weight = 4.0, .tolerance = 1e-14});
  ASSERT_TRUE(fit);
  const double first = fit->components[0].covariance(0, 0);
  const double second = fit->components[1].covariance(0, 0);
  // Sums of squares 10 and 40, equal sizes: W is the mean of both variances; variances 2.5 and 10 come half way to it.
  EXPECT_NEAR(first, 0.5 * (2.5 + 6.25), 1e-4);
  EXPECT_NEAR(second, 0.5 * (10.0 + 6.25), 1e-4);
}

TEST(NormalMixture, UsesUnitsThatSeeOneEffectOnly) {
  std::vector<RandomEffectsUnit> units = units_of(points());
  units[3] = {Eigen::RowVector2d(0.0, 1.0), Eigen::VectorXd::Constant(1, 0.2), Eigen::VectorXd::Zero(1)};
  const auto fit = fit_mixture(mixture_data(units), halves(), textbook);
  ASSERT_TRUE(fit);
  // Its density is that of the marginal: the likelihood at the estimate, summed by hand.
  double sum = 0.0;
  for (std::size_t s = 0; s < units.size(); ++s) {
    double density = 0.0;
    for (const MixtureComponent& own : fit->components) {
      const Eigen::MatrixXd c = units[s].design * own.covariance * units[s].design.transpose();
      const Eigen::VectorXd r = units[s].response - units[s].design * own.mean;
      const double determinant = c.rows() == 1 ? c(0, 0) : c(0, 0) * c(1, 1) - c(0, 1) * c(1, 0);
      Eigen::MatrixXd inverse = Eigen::MatrixXd::Constant(1, 1, 1.0 / c(0, 0));
      if (c.rows() == 2) {
        inverse.resize(2, 2);
        inverse << c(1, 1), -c(0, 1), -c(1, 0), c(0, 0);
        inverse /= determinant;
      }
      density += own.weight * std::exp(-0.5 * r.dot(inverse * r)) /
                 std::sqrt(std::pow(2.0 * 3.14159265358979323846, static_cast<double>(c.rows())) * determinant);
    }
    sum += std::log(density);
  }
  EXPECT_NEAR(fit->log_likelihood, sum, 1e-6);
}

TEST(MixtureChoice, FindsTwoFarBatchesAndOneAmongUnitsThatAreOne) {
  MixtureData like = mixture_data(units_of(Eigen::MatrixXd::Zero(30, 2)));
  const Eigen::Matrix2d unit = Eigen::Matrix2d::Identity();
  const MixtureSearch search{.samples = 99};
  const MixtureData one = draw_units(like, {{1.0, Eigen::Vector2d(0.0, 0.0), unit}}, {}, {.seed = 3});
  const MixtureData two = draw_units(
      like, {{0.6, Eigen::Vector2d(-4.0, 0.0), unit}, {0.4, Eigen::Vector2d(4.0, 0.0), unit}}, {}, {.seed = 4});
  EXPECT_EQ(choose_mixture(one, search, {}).fit.components.size(), 1U);
  const MixtureChoice choice = choose_mixture(two, search, {});
  EXPECT_EQ(choice.fit.components.size(), 2U);
  EXPECT_TRUE(choice.tests.front().is_refused);
  EXPECT_FALSE(choice.tests.back().is_refused);
}

TEST(MixtureChoice, DependsNotOnThreads) {
  const MixtureData data = mixture_data(units_of(points()));
  const MixtureSearch search{.samples = 99};
  const MixtureChoice a = choose_mixture(data, search, {.seed = 7, .threads = 1});
  const MixtureChoice b = choose_mixture(data, search, {.seed = 7, .threads = 3});
  ASSERT_EQ(a.tests.size(), b.tests.size());
  EXPECT_EQ(a.tests.front().p_value, b.tests.front().p_value);
  EXPECT_EQ(a.tests.front().critical, b.tests.front().critical);
  EXPECT_EQ(a.fit.probabilities, b.fit.probabilities);
}

TEST(MixtureChoice, NeedsThreeUnitsABatch) {
  EXPECT_EQ(fewest_units(5, 1), 15);
  EXPECT_EQ(fewest_units(2, 8), 11);
}

}  // namespace
}  // namespace mottle::stats
