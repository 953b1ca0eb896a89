#include "mottle/updating/sampling/approximate_posterior.hpp"

#include <gtest/gtest.h>

#include <Eigen/Core>
#include <cmath>
#include <numbers>

#include "mottle/core/error.hpp"
#include "mottle/stats/distributions/standard_normal.hpp"
#include "updating/methods/sample_comparison.hpp"

namespace mottle::updating {
namespace {

constexpr Eigen::Index k_simulations = 40000;

RandomStream stream_of(std::uint32_t set) {
  return {{.seed = 11, .purpose = StreamPurpose::truth}, set};
}

/// theta ~ N(0, 2^2), one datum z ~ N(theta, 1): given z the posterior is N(0.8 z, 0.8).
SimulationTable conjugate_table() {
  SimulationTable table{Eigen::MatrixXd(k_simulations, 1), Eigen::MatrixXd(k_simulations, 1),
                        Eigen::VectorXd::Zero(k_simulations)};
  for (Eigen::Index k = 0; k < k_simulations; ++k) {
    RandomStream stream = stream_of(static_cast<std::uint32_t>(k));
    table.points(k, 0) = 2.0 * standard_normal_quantile(stream.uniform());
    table.summaries(k, 0) = table.points(k, 0) + standard_normal_quantile(stream.uniform());
  }
  return table;
}

TEST(ApproximatePosterior, ApproachesTheExactOneAsTheToleranceFalls) {
  const SimulationTable table = conjugate_table();
  const Eigen::VectorXd observed = Eigen::VectorXd::Constant(1, 1.5);
  double before = 1e9;
  for (const double fraction : {1.0, 0.3, 0.05}) {
    const AcceptedDraws draws = accept_nearest(table, observed, fraction, false);
    const double error = std::abs(draws.mean(0) - 1.2) + std::abs(std::sqrt(draws.covariance(0, 0)) - std::sqrt(0.8));
    EXPECT_LT(error, before) << fraction;
    before = error;
  }
  // Of 2,000 accepted, some 1,670 count: standard errors 0.022 of the mean and 0.016 of the standard deviation.
  const AcceptedDraws draws = accept_nearest(table, observed, 0.05, false);
  EXPECT_NEAR(draws.mean(0), 1.2, 0.08);
  EXPECT_NEAR(std::sqrt(draws.covariance(0, 0)), std::sqrt(0.8), 0.06);
}

TEST(ApproximatePosterior, IsExactAtAnyToleranceByRegressionWhereAllIsNormal) {
  const SimulationTable table = conjugate_table();
  for (const double fraction : {1.0, 0.3, 0.05}) {
    const AcceptedDraws draws = accept_nearest(table, Eigen::VectorXd::Constant(1, 1.5), fraction);
    EXPECT_NEAR(draws.mean(0), 1.2, 0.08) << fraction;
    EXPECT_NEAR(std::sqrt(draws.covariance(0, 0)), std::sqrt(0.8), 0.06) << fraction;
  }
}

TEST(ApproximatePosterior, WeighsProposalsByThePrior) {
  SimulationTable table = conjugate_table();
  // N(0, 2^2) was proposed; N(1, 1) is the prior: the posterior is N((1 + z) / 2, 1 / 2).
  table.log_weight = -0.5 * (table.points.col(0).array() - 1.0).square() + table.points.col(0).array().square() / 8.0;
  const AcceptedDraws draws = accept_nearest(table, Eigen::VectorXd::Constant(1, 1.5), 0.05);
  EXPECT_NEAR(draws.mean(0), 1.25, 0.08);
  EXPECT_NEAR(std::sqrt(draws.covariance(0, 0)), std::sqrt(0.5), 0.06);
}

/// The gradient of the energy distance as to a shift is Wilcoxon's statistic, so that the posterior of a mean has the
/// efficiency of Hodges and Lehmann's estimator, 3 / pi.
TEST(ApproximatePosterior, ByTheEnergyGradientHasTheEfficiencyOfHodgesAndLehmann) {
  constexpr Eigen::Index k_specimens = 20;
  constexpr Eigen::Index k_points = 200;
  Eigen::MatrixXd cloud(k_points, 1);
  for (Eigen::Index k = 0; k < k_points; ++k)
    cloud(k, 0) = standard_normal_quantile((static_cast<double>(k) + 0.5) / static_cast<double>(k_points));
  const SampleComparison comparison(SampleDistance::energy, Eigen::MatrixXd::Zero(k_specimens, 1),
                                    Eigen::MatrixXd::Identity(1, 1), 1);
  const DistanceGradient gradient(comparison, cloud, {Eigen::MatrixXd::Ones(k_points, 1)});
  SimulationTable table{Eigen::MatrixXd(k_simulations, 1), Eigen::MatrixXd(k_simulations, 1),
                        Eigen::VectorXd::Zero(k_simulations)};
  for (Eigen::Index k = 0; k < k_simulations; ++k) {
    RandomStream stream = stream_of(static_cast<std::uint32_t>(k));
    table.points(k, 0) = 3.0 * (stream.uniform() - 0.5);  // seven standard errors to either side
    Eigen::MatrixXd tests(k_specimens, 1);
    for (double& value : tests.col(0)) value = table.points(k, 0) + standard_normal_quantile(stream.uniform());
    table.summaries.row(k) = gradient.of_tests(tests).transpose();
  }
  const AcceptedDraws draws = accept_nearest(table, Eigen::VectorXd::Zero(1), 0.1);
  const double expected = std::sqrt(std::numbers::pi / 3.0 / static_cast<double>(k_specimens));
  EXPECT_NEAR(draws.mean(0), 0.0, 4.0 * expected / std::sqrt(draws.effective));
  EXPECT_NEAR(std::sqrt(draws.covariance(0, 0)), expected, 4.0 * expected / std::sqrt(2.0 * draws.effective));
}

TEST(DistanceGradient, IsTwiceTheDifferenceOfProbabilitiesForTheEnergyDistance) {
  constexpr Eigen::Index k_points = 2000;
  Eigen::MatrixXd cloud(k_points, 1);
  for (Eigen::Index k = 0; k < k_points; ++k)
    cloud(k, 0) = standard_normal_quantile((static_cast<double>(k) + 0.5) / static_cast<double>(k_points));
  const SampleComparison comparison(SampleDistance::energy, Eigen::MatrixXd::Zero(1, 1),
                                    Eigen::MatrixXd::Identity(1, 1), 1);
  const DistanceGradient gradient(comparison, cloud, {Eigen::MatrixXd::Ones(k_points, 1)});
  // d/dm 2 E|Y + m - z| = 2 P(Y > z) - 2 P(Y < z)
  EXPECT_NEAR(gradient.of_tests(Eigen::MatrixXd::Constant(1, 1, 0.8))(0), 2.0 - 4.0 * standard_normal_cdf(0.8), 2e-3);
}

TEST(UniformProposals, FillAnEllipsoidEvenly) {
  Eigen::MatrixXd covariance(2, 2);
  covariance << 4.0, 1.0, 1.0, 1.0;
  const Eigen::MatrixXd points = propose_uniformly(Eigen::Vector2d(1.0, -1.0), covariance, 20000,
                                                   {.seed = 2, .purpose = StreamPurpose::abc_proposal});
  const double reach = 1.5 * std::sqrt(2.0) + 1.0;
  const Eigen::MatrixXd off = points.rowwise() - Eigen::RowVector2d(1.0, -1.0);
  // The covariance of a uniform distribution in an ellipse is a quarter of the square of its reach.
  const Eigen::MatrixXd measured = off.transpose() * off / 20000.0;
  EXPECT_LT((measured - 0.25 * reach * reach * covariance).cwiseAbs().maxCoeff(), 0.04 * reach * reach);
}

TEST(IntervalCalibration, StretchesIntervalsThatAreTooNarrow) {
  // Draws of half the width that the estimates scatter with: 67 % hold the truth, twice the width holds it in 95 %.
  AcceptedDraws draws;
  constexpr Eigen::Index k_draws = 2000;
  draws.points.resize(k_draws, 1);
  for (Eigen::Index k = 0; k < k_draws; ++k) {
    draws.points(k, 0) = 0.5 * standard_normal_quantile((static_cast<double>(k) + 0.5) / static_cast<double>(k_draws));
  }
  draws.weights = Eigen::VectorXd::Constant(k_draws, 1.0 / static_cast<double>(k_draws));
  Eigen::MatrixXd estimates(4000, 1);
  for (Eigen::Index b = 0; b < estimates.rows(); ++b)
    estimates(b, 0) = standard_normal_quantile(stream_of(static_cast<std::uint32_t>(b)).uniform());
  const auto carry = [](const Eigen::MatrixXd& points, const Eigen::MatrixXd& about,
                        const Eigen::RowVectorXd& observed) {
    return Eigen::MatrixXd((points - about).rowwise() + observed);
  };
  const IntervalCalibration found =
      calibrate_intervals({draws}, Eigen::VectorXd::Zero(1), estimates, Eigen::VectorXd::Zero(1), carry);
  EXPECT_NEAR(found.coverage(0), 0.673, 4.0 * std::sqrt(0.673 * 0.327 / 4000.0));
  EXPECT_NEAR(found.factor(0), 2.0, 0.13);  // four standard errors of a 95 % quantile
  EXPECT_NEAR(found.checked_coverage, 0.95, 4.0 * std::sqrt(2.0) * found.checked_standard_error);
}

TEST(ApproximatePosterior, RefusesTooFewPossibleSimulations) {
  SimulationTable table{Eigen::MatrixXd::Zero(100, 1), Eigen::MatrixXd::Zero(100, 1),
                        Eigen::VectorXd::Constant(100, -std::numeric_limits<double>::infinity())};
  EXPECT_THROW(accept_nearest(table, Eigen::VectorXd::Zero(1), 0.5), InvalidInput);
}

}  // namespace
}  // namespace mottle::updating
