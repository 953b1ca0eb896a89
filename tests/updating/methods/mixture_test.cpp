// Batches of specimens of a linear model whose parameters are known.
#include "updating/methods/mixture.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <limits>

#include "mottle/core/error.hpp"
#include "mottle/core/random.hpp"
#include "mottle/stats/distributions/standard_normal.hpp"
#include "support/linear_model.hpp"
#include "support/linear_problem.hpp"
#include "support/methods.hpp"

namespace mottle::updating {
namespace {

/// Eighteen specimens near (3, 5), twelve near (3.6, 4.4), standard deviations 0.1, noise as in LinearProblem.
struct TwoBatches {
  explicit TwoBatches(double noise = 0.02) : sigma(Eigen::Vector4d::Constant(noise)) {
    Eigen::MatrixXd x(30, 2);
    for (Eigen::Index s = 0; s < 30; ++s) {
      RandomStream stream({.seed = 11}, static_cast<std::uint32_t>(s));
      const bool is_second = s % 5 == 1 || s % 5 == 3;
      x.row(s) << (is_second ? 3.6 : 3.0) + 0.1 * standard_normal_quantile(stream.uniform()),
          (is_second ? 4.4 : 5.0) + 0.1 * standard_normal_quantile(stream.uniform());
    }
    values = linear.model.evaluate(x, {}).outputs;
    for (Eigen::Index s = 0; s < 30; ++s) {
      RandomStream stream({.seed = 12}, static_cast<std::uint32_t>(s));
      for (Eigen::Index k = 0; k < 4; ++k) values(s, k) += noise * standard_normal_quantile(stream.uniform());
    }
  }
  UpdatingProblem problem() const {
    UpdatingProblem own = linear.problem(sigma);
    own.tests.values = values;
    return own;
  }
  UpdatingResult update(const MixtureOptions& options = {}, const RunContext& context = {}) const {
    return MixtureUpdater(options).update(problem(), context);
  }
  test::LinearProblem linear;
  Eigen::VectorXd sigma;
  Eigen::MatrixXd values;
};

bool is_right(const UpdatingResult& result, Eigen::Index specimen) {
  const bool is_second = specimen % 5 == 1 || specimen % 5 == 3;
  return result.mixture->batch_of(specimen) == (is_second ? 1 : 0);
}

TEST(Mixture, FindsTwoBatchesAndAssignsEverySpecimen) {
  const TwoBatches batches;
  const UpdatingResult result = batches.update();
  EXPECT_EQ(result.status, UpdatingStatus::converged) << result.message;
  ASSERT_TRUE(result.mixture);
  ASSERT_EQ(result.mixture->batches.size(), 2U);
  for (Eigen::Index s = 0; s < 30; ++s) EXPECT_TRUE(is_right(result, s)) << s;
  EXPECT_EQ(result.mixture->batches[0].specimens, 18);
  // Four standard errors of means of 18 and 12: 0.1 / sqrt(n).
  EXPECT_LT((result.mixture->batches[0].mean - Eigen::Vector2d(3.0, 5.0)).cwiseAbs().maxCoeff(), 0.4 / std::sqrt(18.0));
  EXPECT_LT((result.mixture->batches[1].mean - Eigen::Vector2d(3.6, 4.4)).cwiseAbs().maxCoeff(), 0.4 / std::sqrt(12.0));
  EXPECT_TRUE(result.mixture->detectable.has_value());
  ASSERT_TRUE(result.intervals);
  for (Eigen::Index i = 0; i < 2; ++i) {
    EXPECT_LT(result.intervals->mean(i, 0), result.mean(i));
    EXPECT_GT(result.intervals->mean(i, 1), result.mean(i));
  }
}

TEST(Mixture, GivesTheSameInAnyOrderOfTheSpecimens) {
  const TwoBatches batches;
  UpdatingProblem turned = batches.problem();
  turned.tests.values = batches.values.colwise().reverse();
  const MixtureOptions options{.components = 2};
  const UpdatingResult a = batches.update(options);
  const UpdatingResult b = MixtureUpdater(options).update(turned, {});
  EXPECT_EQ(a.mean, b.mean);
  EXPECT_EQ(a.covariance, b.covariance);
  EXPECT_EQ(a.mixture->probabilities, Eigen::MatrixXd(b.mixture->probabilities.colwise().reverse()));
  EXPECT_EQ(a.specimens->parameters, Eigen::MatrixXd(b.specimens->parameters.colwise().reverse()));
}

TEST(Mixture, NamesAnOutlierAndLeavesItOutOfTheMoments) {
  TwoBatches batches;
  batches.values.row(7) +=
      1.5 * test::LinearProblem::slope().col(0).transpose() + 1.5 * test::LinearProblem::slope().col(1).transpose();
  const UpdatingResult result = batches.update({.components = 2});
  EXPECT_EQ(result.mixture->batch_of(7), -1);
  ASSERT_EQ(result.outliers.size(), 1U);
  EXPECT_EQ(result.outliers[0].sample, 7);
  EXPECT_LT(std::sqrt(result.covariance(0, 0)), 0.4);  // 0.31 of both batches; with the outlier 0.42
}

TEST(Mixture, UsesSpecimensWithMissingEntries) {
  TwoBatches batches;
  for (const Eigen::Index s : {2, 6, 16, 23}) batches.values(s, s % 4) = std::numeric_limits<double>::quiet_NaN();
  const UpdatingResult result = batches.update({.components = 2});
  for (Eigen::Index s = 0; s < 30; ++s) EXPECT_TRUE(is_right(result, s)) << s;
}

/// Specimens of LinearProblem's model: `a` as given, b normal about 5.
UpdatingResult update_with(const std::vector<double>& a) {
  const TwoBatches batches;
  Eigen::MatrixXd x(static_cast<Eigen::Index>(a.size()), 2);
  for (Eigen::Index s = 0; s < x.rows(); ++s) {
    RandomStream stream({.seed = 31}, static_cast<std::uint32_t>(s));
    x.row(s) << a[static_cast<std::size_t>(s)], 5.0 + 0.1 * standard_normal_quantile(stream.uniform());
  }
  UpdatingProblem problem = batches.problem();
  problem.tests.values = batches.linear.model.evaluate(x, {}).outputs;
  return MixtureUpdater({.bootstrap_samples = 99}).update(problem, {});
}

TEST(Mixture, TakesOneSkewedPopulationForOneAndNamesTheScaleThatExplainsIt) {
  std::vector<double> skewed;  // quantiles of a log-normal distribution: ln-std 0.8
  for (int s = 0; s < 40; ++s) skewed.push_back(std::exp(0.8 * standard_normal_quantile((s + 0.5) / 40.0)));
  const UpdatingResult result = update_with(skewed);
  ASSERT_TRUE(result.mixture);
  EXPECT_TRUE(result.mixture->tests.front().is_refused);  // by itself it would be split
  EXPECT_EQ(result.mixture->batches.size(), 1U);
  EXPECT_TRUE(test::says(result, "with scale = \"log\" of a they are normal"));
}

TEST(Mixture, KeepsTwoBatchesThatNoScaleMakesOne) {
  std::vector<double> batches;  // at 1 and 3, within each a tenth
  for (int s = 0; s < 40; ++s) {
    const double score = standard_normal_quantile((s / 2 + 0.5) / 20.0);
    batches.push_back((s % 2 == 0 ? 1.0 : 3.0) * std::exp(0.1 * score));
  }
  const UpdatingResult result = update_with(batches);
  EXPECT_EQ(result.mixture->batches.size(), 2U);
}

TEST(Mixture, SaysThatOneBatchIsOneAndWhatItCouldNotSee) {
  const test::LinearProblem linear;
  const UpdatingResult result = MixtureUpdater({}).update(linear.problem(linear.noise), {});
  ASSERT_TRUE(result.mixture);
  EXPECT_EQ(result.mixture->batches.size(), 1U);
  EXPECT_NE(result.estimate->population(), nullptr);
  const bool has_power = std::any_of(result.notes.begin(), result.notes.end(), [](const std::string& note) {
    return note.find("can be told") != std::string::npos || note.find("cannot be told") != std::string::npos;
  });
  EXPECT_TRUE(has_power);
}

TEST(Mixture, TakesIdenticalSpecimensForOneBatch) {
  TwoBatches batches;
  for (Eigen::Index s = 1; s < 30; ++s) batches.values.row(s) = batches.values.row(0);
  const UpdatingResult result = batches.update();
  EXPECT_EQ(result.mixture->batches.size(), 1U);
}

TEST(Mixture, RefusesMoreBatchesThanSpecimensCanShow) {
  TwoBatches batches;
  batches.values = batches.values.topRows(6).eval();
  try {
    batches.update({.components = 5});
    FAIL() << "five batches of six specimens";
  } catch (const InvalidInput& error) {
    EXPECT_NE(std::string(error.what()).find("at least 15 specimens"), std::string::npos) << error.what();
  }
}

TEST(Mixture, KeepsTheMeanOfABatchWithinItsBounds) {
  const TwoBatches batches;
  const UpdatingProblem free = batches.problem();
  std::vector<Parameter> parameters = batches.linear.space->parameters();
  parameters[0].upper_bound = 3.5;
  const ParameterSpace space(parameters, batches.linear.space->prior());
  const UpdatingResult result =
      MixtureUpdater({.components = 2})
          .update({.model = free.model, .space = space, .tests = free.tests, .cloud = free.cloud}, {});
  EXPECT_NEAR(result.mixture->batches[1].mean(0), 3.5, 1e-6);
}

TEST(Mixture, ReadsTheNumberOfBatchesAsAWordOrANumber) {
  const auto& table = mixture_option_table();
  EXPECT_EQ(table.read({}, "test").components, 0);
  EXPECT_EQ(table.read({{"components", OptionValue(std::int64_t{3})}}, "test").components, 3);
  EXPECT_EQ(table.read({{"components", OptionValue(std::string("automatic"))}}, "test").components, 0);
  EXPECT_THROW(table.read({{"components", OptionValue(std::int64_t{6})}}, "test"), InvalidInput);
  EXPECT_THROW(table.read({{"components", OptionValue(std::string("many"))}}, "test"), InvalidInput);
}

}  // namespace
}  // namespace mottle::updating
