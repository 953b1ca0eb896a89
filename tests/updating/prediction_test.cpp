#include "mottle/updating/prediction.hpp"

#include <gtest/gtest.h>

#include <Eigen/Cholesky>
#include <Eigen/LU>
#include <boost/math/distributions/fisher_f.hpp>
#include <boost/math/distributions/students_t.hpp>
#include <cmath>

#include "mottle/stats/standard_normal.hpp"
#include "support/linear_model.hpp"

namespace mottle {
namespace {

using test::LinearModel;

struct Bench {
  Bench() {
    slope << 1.0, 0.5, -0.3, 2.0;
    covariance << 0.04, 0.01, 0.01, 0.09;
    model = std::make_unique<LinearModel>(Eigen::Vector2d(1.0, -2.0), slope);
    const std::vector<Parameter> parameters{{.name = "a", .unit = "-", .limit = {-1e9, false}},
                                            {.name = "b", .unit = "-", .limit = {-1e9, false}}};
    const Distribution prior({.kind = DistributionKind::normal, .mean = 0.0, .std = 1.0});
    space = std::make_unique<ParameterSpace>(parameters, JointDistribution({prior, prior}));
  }

  PredictedPopulation population(Eigen::Index specimens) const {
    return {Eigen::Vector2d(0.3, 0.7), covariance, Eigen::Matrix2d::Zero(), specimens};
  }

  Prediction run(const PredictedPopulation& known, double noise = 0.0, int draws = k_draws) const {
    return predict(*model, *space, known, {.noise_std = Eigen::Vector2d::Constant(noise), .draws = draws}, {});
  }

  static constexpr int k_draws = 100000;
  Eigen::Matrix2d slope;
  Eigen::Matrix2d covariance;
  std::unique_ptr<LinearModel> model;
  std::unique_ptr<ParameterSpace> space;
};

TEST(Prediction, OfALinearModelHasStudentsIntervals) {
  const Bench bench;
  const Prediction found = bench.run(bench.population(10));
  const Eigen::Vector2d mean = Eigen::Vector2d(1.0, -2.0) + bench.slope * Eigen::Vector2d(0.3, 0.7);
  const Eigen::Matrix2d c = bench.slope * bench.covariance * bench.slope.transpose();
  const double t = boost::math::quantile(boost::math::students_t(9.0), 0.975);
  for (int k = 0; k < 2; ++k) {
    const double half = t * std::sqrt(c(k, k) * 1.1);
    EXPECT_NEAR(found.mean(k), mean(k), 0.01 * std::sqrt(c(k, k)));
    EXPECT_NEAR(found.covariance(k, k), c(k, k), 0.02 * c(k, k));
    EXPECT_NEAR(found.interval(k, 0), mean(k) - half, 0.02 * half);
    EXPECT_NEAR(found.interval(k, 1), mean(k) + half, 0.02 * half);
  }
}

TEST(Prediction, OfALinearModelHasHotellingsJointRegion) {
  const Bench bench;
  const Prediction found = bench.run(bench.population(10));
  const double f = boost::math::quantile(boost::math::fisher_f(2.0, 8.0), 0.95);
  EXPECT_NEAR(found.joint_critical, 1.1 * 2.0 * 9.0 / 8.0 * f, 0.03 * 1.1 * 2.0 * 9.0 / 8.0 * f);
}

TEST(Prediction, OfAKnownPopulationHasNormalIntervalsAndNoiseAdds) {
  const Bench bench;
  const Prediction found = bench.run(bench.population(0), 0.2);
  const Eigen::Matrix2d c = bench.slope * bench.covariance * bench.slope.transpose();
  for (int k = 0; k < 2; ++k) {
    const double half = 1.959964 * std::sqrt(c(k, k) + 0.04);
    EXPECT_NEAR(0.5 * (found.interval(k, 1) - found.interval(k, 0)), half, 0.02 * half);
  }
  EXPECT_NEAR(found.joint_critical, 5.991465, 0.15);
}

/// Noise equal to the scatter, known: the total scatter is what nine degrees of freedom were seen of.
TEST(Prediction, TheNoisesShareIsTakenOffWhatIsUncertain) {
  const Bench bench;
  PredictedPopulation known = bench.population(10);
  known.noise_share = known.covariance;
  const Prediction with = bench.run(known);
  const Prediction without = bench.run(bench.population(10));
  EXPECT_GT(with.interval(0, 1) - with.interval(0, 0), without.interval(0, 1) - without.interval(0, 0));
}

/// A modulus in Pa beside a thickness in km: the same prediction as in units in which both are about one.
TEST(Prediction, DoesNotDependOnTheUnitsOfTheParameters) {
  Bench bench;
  PredictedPopulation known = bench.population(10);
  known.noise_share = 0.5 * known.covariance;
  const Prediction plain = bench.run(known, 0.0, 4000);
  const Eigen::Vector2d unit(1e11, 1e-6);
  known.mean = unit.asDiagonal() * known.mean;
  known.covariance = unit.asDiagonal() * known.covariance * unit.asDiagonal();
  known.noise_share = unit.asDiagonal() * known.noise_share * unit.asDiagonal();
  bench.model =
      std::make_unique<LinearModel>(Eigen::Vector2d(1.0, -2.0), bench.slope * unit.cwiseInverse().asDiagonal());
  bench.space =
      std::make_unique<ParameterSpace>(std::vector<Parameter>{{.name = "a", .unit = "-", .limit = {-1e15, false}},
                                                              {.name = "b", .unit = "-", .limit = {-1.0, false}}},
                                       bench.space->prior());
  const Prediction scaled = bench.run(known, 0.0, 4000);
  EXPECT_EQ(scaled.impossible, 0);
  EXPECT_LT((scaled.covariance - plain.covariance).cwiseAbs().maxCoeff(), 1e-9 * plain.covariance.norm());
  EXPECT_LT((scaled.interval - plain.interval).cwiseAbs().maxCoeff(), 1e-9 * plain.interval.norm());
  EXPECT_NEAR(scaled.joint_critical, plain.joint_critical, 1e-8 * plain.joint_critical);
}

TEST(Prediction, HeldOutTestsOfTheSamePopulationAreCoveredAndUniform) {
  const Bench bench;
  const PredictedPopulation known = bench.population(0);
  const Prediction found = bench.run(known);
  const Eigen::Matrix2d root = bench.covariance.llt().matrixL();
  Eigen::MatrixXd values(400, 2);
  for (Eigen::Index s = 0; s < 400; ++s) {
    RandomStream stream({.seed = 11, .purpose = StreamPurpose::truth}, static_cast<std::uint32_t>(s));
    const Eigen::Vector2d z(standard_normal_quantile(stream.uniform()), standard_normal_quantile(stream.uniform()));
    values.row(s) = (Eigen::Vector2d(1.0, -2.0) + bench.slope * (Eigen::Vector2d(0.3, 0.7) + root * z)).transpose();
  }
  values(3, 0) = std::nan("");
  const HeldOutCheck check = check_held_out(found, known, values);
  for (int k = 0; k < 2; ++k) EXPECT_NEAR(check.coverage(k), 0.95, 0.04);
  EXPECT_NEAR(check.joint_coverage, 0.95, 0.04);
  EXPECT_GT(check.adjusted_p, 0.01);
  EXPECT_TRUE(std::isnan(check.transforms(3, 0)));
  EXPECT_TRUE(std::isnan(check.distances(3)));

  values.col(1).array() += 1.0;  // another population
  const HeldOutCheck other = check_held_out(found, known, values);
  EXPECT_LT(other.adjusted_p, 1e-6);
  EXPECT_LT(other.joint_coverage, 0.9);
}

TEST(Prediction, FewSpecimensHaveNoJointRegion) {
  const Bench bench;
  EXPECT_TRUE(std::isnan(bench.run(bench.population(3)).joint_critical));
}

TEST(Prediction, ThePopulationOfAResultGetsTheNoisesShare) {
  const Bench bench;
  UpdatingResult result;
  result.mean = Eigen::Vector2d(0.3, 0.7);
  result.covariance = bench.covariance;
  result.is_population = true;
  result.sensitivity = bench.slope;
  result.noise_covariance = Eigen::Vector2d(0.01, 0.04).asDiagonal();
  const PredictedPopulation found = predicted_population(*bench.space, result, 10);
  const Eigen::Matrix2d inverse = bench.slope.inverse();
  const Eigen::Matrix2d expected = inverse * Eigen::Vector2d(0.01, 0.04).asDiagonal() * inverse.transpose();
  EXPECT_TRUE(found.noise_share.isApprox(expected, 1e-9));
  EXPECT_EQ(found.specimens, 10);
}

}  // namespace
}  // namespace mottle
