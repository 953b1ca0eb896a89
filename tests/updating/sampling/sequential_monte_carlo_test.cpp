#include "mottle/updating/sampling/sequential_monte_carlo.hpp"

#include <gtest/gtest.h>

#include <atomic>
#include <cmath>
#include <limits>
#include <numbers>

#include "mottle/core/error.hpp"
#include "mottle/updating/estimate/posterior.hpp"
#include "support/bayes_references.hpp"

namespace mottle::updating {
namespace {

using test::BeckAu;
using test::parameters_of;
using test::target_of;
using test::TwinEigenvalues;

constexpr double k_errors = 4.0;  // standard errors: once in 16,000 cases of a normal error

/// u ~ N(0, 1) in each dimension, measured once with noise s at m: everything is normal and independent.
SamplingTarget normal_target(Eigen::Index dimension, double measured, double noise) {
  return {.dimension = dimension, .log_likelihood = [=](const Eigen::MatrixXd& points) -> Eigen::VectorXd {
            const double scale = static_cast<double>(dimension) * std::log(noise * std::sqrt(2.0 * std::numbers::pi));
            return -0.5 * ((points.array() - measured) / noise).square().rowwise().sum() - scale;
          }};
}

double normal_log_evidence(Eigen::Index dimension, double measured, double noise) {
  const double variance = 1.0 + noise * noise;
  return -0.5 * static_cast<double>(dimension) *
         (std::log(2.0 * std::numbers::pi * variance) + measured * measured / variance);
}

void expect_normal(Eigen::Index dimension, double measured, double noise) {
  const std::vector<SampledIsland> islands = sample_posterior(normal_target(dimension, measured, noise), {}, {});
  const Evidence evidence = combine_evidence(islands);
  EXPECT_NEAR(evidence.log_evidence, normal_log_evidence(dimension, measured, noise),
              k_errors * evidence.standard_error);
  EXPECT_LT(evidence.standard_error, 0.2);
  const double mean = measured / (1.0 + noise * noise);
  const double std = noise / std::sqrt(1.0 + noise * noise);
  Eigen::MatrixXd all(0, dimension);
  for (const SampledIsland& island : islands) {
    all.conservativeResize(all.rows() + island.points.rows(), dimension);
    all.bottomRows(island.points.rows()) = island.points;
  }
  const double error = k_errors * std / std::sqrt(1000.0);  // as if an eighth of the draws were independent
  for (Eigen::Index i = 0; i < dimension; ++i) {
    EXPECT_NEAR(all.col(i).mean(), mean, error);
    EXPECT_NEAR(std::sqrt((all.col(i).array() - all.col(i).mean()).square().mean()), std, error);
  }
}

TEST(SequentialMonteCarlo, HasEvidenceAndMomentsOfANormalPosterior) {
  expect_normal(2, 1.5, 0.05);
}

TEST(SequentialMonteCarlo, HasEvidenceAndMomentsInFifteenDimensions) {
  expect_normal(15, 1.0, 0.2);
}

TEST(SequentialMonteCarlo, KeepsThePriorWhereTestsSayNothing) {
  const SamplingTarget flat{.dimension = 2, .log_likelihood = [](const Eigen::MatrixXd& points) -> Eigen::VectorXd {
                              return Eigen::VectorXd::Constant(points.rows(), -3.0);
                            }};
  const std::vector<SampledIsland> islands = sample_posterior(flat, {}, {});
  const Evidence evidence = combine_evidence(islands);
  EXPECT_NEAR(evidence.log_evidence, -3.0, 1e-12);
  EXPECT_NEAR(islands.front().points.col(0).mean(), 0.0, k_errors / std::sqrt(1000.0));
}

/// Half of a symmetric posterior: cut at 0, relative to the cut prior.
TEST(SequentialMonteCarlo, CutsThePriorAtWhatIsPossible) {
  SamplingTarget target = normal_target(1, 0.0, 0.1);
  target.is_possible = [](const Eigen::MatrixXd& points) {
    std::vector<bool> possible;
    for (Eigen::Index s = 0; s < points.rows(); ++s) possible.push_back(points(s, 0) > 0.0);
    return possible;
  };
  const std::vector<SampledIsland> islands = sample_posterior(target, {}, {});
  const Evidence evidence = combine_evidence(islands);
  EXPECT_NEAR(evidence.log_evidence, normal_log_evidence(1, 0.0, 0.1), k_errors * evidence.standard_error);
  for (const SampledIsland& island : islands) EXPECT_GT(island.points.minCoeff(), 0.0);
}

/// A bound of the likelihood decides moves that need no likelihood: the same draws from fewer of them.
TEST(SequentialMonteCarlo, HasTheSameDrawsWithABoundOfTheLikelihood) {
  SamplingTarget target = normal_target(3, 1.5, 0.1);
  std::atomic<Eigen::Index> points_asked{0};
  target.log_likelihood = [&, of = target.log_likelihood](const Eigen::MatrixXd& points) {
    points_asked += points.rows();
    return of(points);
  };
  const std::vector<SampledIsland> without = sample_posterior(target, {}, {});
  const Eigen::Index all = points_asked.exchange(0);
  target.largest_log_likelihood = [](const Eigen::MatrixXd& points) -> Eigen::VectorXd {
    return Eigen::VectorXd::Constant(points.rows(), -3.0 * std::log(0.1 * std::sqrt(2.0 * std::numbers::pi)));
  };
  const std::vector<SampledIsland> with = sample_posterior(target, {}, {});
  EXPECT_LT(static_cast<double>(points_asked), 0.98 * static_cast<double>(all));
  for (std::size_t i = 0; i < with.size(); ++i) {
    EXPECT_EQ(with[i].points, without[i].points);
    EXPECT_EQ(with[i].log_evidence, without[i].log_evidence);
  }
}

/// Reference values: the quadrature of the two-storey frame of [Beck2002].
TEST(SequentialMonteCarlo, FollowsTheRidgeOfTheTwoStoreyFrame) {
  const std::vector<SampledIsland> islands = sample_posterior(target_of<BeckAu>(), {}, {});
  const Evidence evidence = combine_evidence(islands);
  EXPECT_NEAR(evidence.log_evidence, std::log(1.50950476e-3), k_errors * evidence.standard_error);
  EXPECT_LT(evidence.standard_error, 0.05);
  const Eigen::MatrixXd x = parameters_of<BeckAu>(islands);
  const Eigen::RowVector2d mean = x.colwise().mean();
  const Eigen::MatrixXd apart = x.rowwise() - mean;
  const Eigen::Vector2d std = (apart.colwise().squaredNorm() / static_cast<double>(x.rows())).cwiseSqrt().transpose();
  // As if a quarter of the 8,000 draws were independent.
  EXPECT_NEAR(mean(0), 1.11699503, k_errors * 0.662 / std::sqrt(2000.0));
  EXPECT_NEAR(mean(1), 0.59343654, k_errors * 0.330 / std::sqrt(2000.0));
  EXPECT_NEAR(std(0), 0.66237308, 0.03);
  EXPECT_NEAR(std(1), 0.32994652, 0.015);
  const double correlation = apart.col(0).dot(apart.col(1)) / (static_cast<double>(x.rows()) * std(0) * std(1));
  EXPECT_NEAR(correlation, -0.97991033, 0.003);
}

TEST(SequentialMonteCarlo, KeepsBothOfTwinModesAndNamesThem) {
  const std::vector<SampledIsland> islands = sample_posterior(target_of<TwinEigenvalues>(), {}, {});
  const Evidence evidence = combine_evidence(islands);
  EXPECT_NEAR(evidence.log_evidence, std::log(0.00484102285), k_errors * evidence.standard_error);
  const Eigen::MatrixXd x = parameters_of<TwinEigenvalues>(islands);
  EXPECT_NEAR(x.col(0).mean(), 1.75110774, k_errors * 1.246 / std::sqrt(2000.0));
  EXPECT_NEAR(x.col(1).mean(), 0.87555529, k_errors * 0.623 / std::sqrt(2000.0));
  const SampledPosterior posterior = make_posterior(islands, {"a", "b"}, x);
  ASSERT_EQ(posterior.modes.size(), 2U);
  EXPECT_NEAR(posterior.modes[0].probability, 0.50000044, 0.03);
  EXPECT_NEAR(posterior.modes[0].mean(0) + posterior.modes[1].mean(0), 2.0 * 1.751, 0.05);
}

TEST(SequentialMonteCarlo, GivesTheSameBitsAtAnyNumberOfThreads) {
  const std::vector<SampledIsland> once = sample_posterior(target_of<BeckAu>(), {.particles = 200}, {.threads = 1});
  for (const int threads : {2, 8}) {
    const std::vector<SampledIsland> again =
        sample_posterior(target_of<BeckAu>(), {.particles = 200}, {.threads = threads});
    for (std::size_t i = 0; i < once.size(); ++i) {
      EXPECT_EQ(once[i].points, again[i].points);
      EXPECT_EQ(once[i].log_evidence, again[i].log_evidence);
    }
  }
}

TEST(SequentialMonteCarlo, TakesAFailedRunForOneOfNoLikelihood) {
  SamplingTarget target = normal_target(1, 1.0, 0.5);
  const auto log_likelihood = target.log_likelihood;
  target.log_likelihood = [=](const Eigen::MatrixXd& points) -> Eigen::VectorXd {
    Eigen::VectorXd values = log_likelihood(points);
    for (Eigen::Index s = 0; s < points.rows(); ++s) {
      if (points(s, 0) < 0.8) values(s) = std::numeric_limits<double>::quiet_NaN();  // the posterior's mean
    }
    return values;
  };
  const std::vector<SampledIsland> islands = sample_posterior(target, {}, {});
  const Evidence evidence = combine_evidence(islands);
  EXPECT_NEAR(evidence.log_evidence, normal_log_evidence(1, 1.0, 0.5) + std::log(0.5),
              k_errors * evidence.standard_error);
  EXPECT_GE(islands.front().points.minCoeff(), 0.8);
}

TEST(SequentialMonteCarlo, RefusesAPriorWithoutProbabilityAtTheTests) {
  const SamplingTarget nowhere{.dimension = 1, .log_likelihood = [](const Eigen::MatrixXd& points) -> Eigen::VectorXd {
                                 return Eigen::VectorXd::Constant(points.rows(),
                                                                  -std::numeric_limits<double>::infinity());
                               }};
  EXPECT_THROW(sample_posterior(nowhere, {}, {}), InvalidInput);
  SamplingTarget impossible = normal_target(1, 0.0, 1.0);
  impossible.is_possible = [](const Eigen::MatrixXd& points) {
    return std::vector<bool>(static_cast<std::size_t>(points.rows()), false);
  };
  EXPECT_THROW(sample_posterior(impossible, {.particles = 20}, {}), InvalidInput);
}

TEST(SequentialMonteCarlo, RefusesAnInfiniteLikelihood) {
  const SamplingTarget improper{.dimension = 1, .log_likelihood = [](const Eigen::MatrixXd& points) -> Eigen::VectorXd {
                                  return Eigen::VectorXd::Constant(points.rows(),
                                                                   std::numeric_limits<double>::infinity());
                                }};
  EXPECT_THROW(sample_posterior(improper, {}, {}), InvalidInput);
}

TEST(SequentialMonteCarlo, StopsWhenAsked) {
  const std::atomic<bool> stop{true};
  EXPECT_THROW(sample_posterior(target_of<BeckAu>(), {}, {.stop = &stop}), Stopped);
}

TEST(Evidence, IsTheMeanOverIslands) {
  std::vector<SampledIsland> islands(2);
  islands[0].log_evidence = 1000.0 + std::log(1.0);  // so large that exp() of it overflows
  islands[1].log_evidence = 1000.0 + std::log(3.0);
  const Evidence evidence = combine_evidence(islands);
  EXPECT_NEAR(evidence.log_evidence, 1000.0 + std::log(2.0), 1e-12);
  EXPECT_NEAR(evidence.standard_error, 0.5, 1e-12);  // deviation sqrt 2, over sqrt 2, over the mean 2
  EXPECT_NEAR(evidence.upper - evidence.log_evidence, 12.7062047 * 0.5, 1e-6);
}

}  // namespace
}  // namespace mottle::updating
