#include "mottle/updating/prediction/prediction.hpp"

#include <gtest/gtest.h>

#include <Eigen/Cholesky>
#include <boost/math/distributions/fisher_f.hpp>
#include <boost/math/distributions/students_t.hpp>
#include <cmath>

#include "mottle/stats/distributions/standard_normal.hpp"
#include "mottle/updating/estimate/sample_estimate.hpp"
#include "support/instrumented.hpp"
#include "support/linear_model.hpp"
#include "updating/population/normal_theory.hpp"

namespace mottle::updating {
namespace {

using test::LinearModel;

/// A normal population that a test changes before it predicts.
struct KnownPopulation {
  PopulationOnScales estimate;
  Eigen::Index specimens = 0;  ///< 0: known exactly

  NormalPopulation made() const {
    return {std::vector<ParameterTransform>(static_cast<std::size_t>(estimate.mean.size())), estimate, specimens};
  }
};

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

  KnownPopulation population(Eigen::Index specimens) const {
    const Eigen::Vector2d mean(0.3, 0.7);
    return {{mean, covariance, sample_evidence(mean, covariance, std::max(specimens, Eigen::Index{1}))}, specimens};
  }
  /// As large as the scatter times `part`.
  void add_noise(KnownPopulation& known, double part) const {
    known.estimate.evidence.noise = part * covariance;
    known.estimate.evidence.total = (1.0 + part) * covariance;
    known.estimate.evidence.mean_covariance = (1.0 + part) / static_cast<double>(known.specimens) * covariance;
  }

  Prediction run(const KnownPopulation& known, double noise = 0.0, int draws = k_draws) const {
    return predict(*model, *space, known.made(), {.noise_std = Eigen::Vector2d::Constant(noise), .draws = draws}, {});
  }

  static constexpr int k_draws = 100000;
  Eigen::Matrix2d slope;
  Eigen::Matrix2d covariance;
  std::unique_ptr<LinearModel> model;
  std::unique_ptr<ParameterSpace> space;
};

TEST(Prediction, HasStudentsIntervalsForALinearModel) {
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

TEST(Prediction, HasHotellingsJointRegionForALinearModel) {
  if (test::k_is_instrumented) GTEST_SKIP() << test::k_left_to_optimised_build;
  const Bench bench;
  const Prediction found = bench.run(bench.population(10));
  const double f = boost::math::quantile(boost::math::fisher_f(2.0, 8.0), 0.95);
  EXPECT_NEAR(found.joint_critical, 1.1 * 2.0 * 9.0 / 8.0 * f, 0.03 * 1.1 * 2.0 * 9.0 / 8.0 * f);
}

TEST(Prediction, HasNormalIntervalsForAKnownPopulationAndAddsNoise) {
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
  if (test::k_is_instrumented) GTEST_SKIP() << test::k_left_to_optimised_build;
  const Bench bench;
  KnownPopulation known = bench.population(10);
  bench.add_noise(known, 1.0);
  const Prediction with = bench.run(known);
  const Prediction without = bench.run(bench.population(10));
  EXPECT_GT(with.interval(0, 1) - with.interval(0, 0), without.interval(0, 1) - without.interval(0, 0));
}

/// A modulus in Pa beside a thickness in km: the same prediction as in units in which both are about one.
TEST(Prediction, DoesNotDependOnTheUnitsOfTheParameters) {
  Bench bench;
  KnownPopulation known = bench.population(10);
  bench.add_noise(known, 0.5);
  const Prediction plain = bench.run(known, 0.0, 4000);
  const Eigen::Vector2d unit(1e11, 1e-6);
  known.estimate.mean = unit.asDiagonal() * known.estimate.mean;
  PopulationEvidence& evidence = known.estimate.evidence;
  for (Eigen::MatrixXd* matrix :
       {&known.estimate.covariance, &evidence.total, &evidence.noise, &evidence.mean_covariance})
    *matrix = unit.asDiagonal() * *matrix * unit.asDiagonal();
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
  const KnownPopulation known = bench.population(0);
  const Prediction found = bench.run(known);
  const Eigen::Matrix2d root = bench.covariance.llt().matrixL();
  Eigen::MatrixXd values(400, 2);
  for (Eigen::Index s = 0; s < 400; ++s) {
    RandomStream stream({.seed = 11, .purpose = StreamPurpose::truth}, static_cast<std::uint32_t>(s));
    const Eigen::Vector2d z(standard_normal_quantile(stream.uniform()), standard_normal_quantile(stream.uniform()));
    values.row(s) = (Eigen::Vector2d(1.0, -2.0) + bench.slope * (Eigen::Vector2d(0.3, 0.7) + root * z)).transpose();
  }
  values(3, 0) = std::nan("");
  const HeldOutCheck check = check_held_out(found, known.made(), values);
  for (int k = 0; k < 2; ++k) EXPECT_NEAR(check.coverage(k), 0.95, 0.04);
  EXPECT_NEAR(check.joint_coverage, 0.95, 0.04);
  EXPECT_GT(check.adjusted_p, 0.01);
  EXPECT_TRUE(std::isnan(check.transforms(3, 0)));
  EXPECT_TRUE(std::isnan(check.distances(3)));

  values.col(1).array() += 1.0;  // another population
  const HeldOutCheck other = check_held_out(found, known.made(), values);
  EXPECT_LT(other.adjusted_p, 1e-6);
  EXPECT_LT(other.joint_coverage, 0.9);
}

TEST(Prediction, HeldOutTestsAreCountedByTheirTransforms) {
  const Bench bench;
  const KnownPopulation known = bench.population(0);
  const Prediction found = bench.run(known);
  Eigen::MatrixXd values(40, 2);
  values.col(0).setConstant(found.mean(0));
  values.col(1).setConstant(1e6);
  values(0, 1) = std::nan("");
  const HeldOutCheck check = check_held_out(found, known.made(), values);
  // 40 / 8 = 5 parts; the mean of a normal lies in the third.
  EXPECT_EQ(check.histograms[0].counts, (std::vector<int>{0, 0, 40, 0, 0}));
  EXPECT_EQ(check.histograms[1].counts, (std::vector<int>{0, 0, 0, 39}));
  EXPECT_EQ(check.histograms[0].fewest,
            3);  // P(K <= 2) = 0.008, P(K <= 3) = 0.028, P(K <= 12) = 0.957, P(K <= 13) = 0.981
  EXPECT_EQ(check.histograms[0].most, 13);
  EXPECT_EQ(check.min_inside(0), 34);          // of 40 at 0.95: P(K <= 33) = 0.0034, P(K <= 34) = 0.0139
  EXPECT_NEAR(check.scores(0, 0), 0.0, 0.01);  // 100,000 draws
}

TEST(Prediction, FewSpecimensHaveNoJointRegion) {
  const Bench bench;
  EXPECT_TRUE(std::isnan(bench.run(bench.population(3)).joint_critical));
}

/// Half of the entries of one variable missing: its intervals are those of its own degrees of freedom.
TEST(Prediction, EachVariableHasItsOwnDegreesOfFreedom) {
  if (test::k_is_instrumented) GTEST_SKIP() << test::k_left_to_optimised_build;
  Bench bench;
  bench.slope.setIdentity();
  bench.model = std::make_unique<LinearModel>(Eigen::Vector2d::Zero(), bench.slope);
  KnownPopulation known = bench.population(10);
  known.estimate.evidence.degrees_of_freedom << 9.0, 4.0, 4.0, 4.0;
  known.estimate.evidence.mean_covariance(1, 1) = bench.covariance(1, 1) / 5.0;
  const Prediction found = bench.run(known);
  const double first = boost::math::quantile(boost::math::students_t(9.0), 0.975) * std::sqrt(0.04 * 1.1);
  const double second = boost::math::quantile(boost::math::students_t(4.0), 0.975) * std::sqrt(0.09 * 1.2);
  EXPECT_NEAR(found.interval(0, 1) - found.interval(0, 0), 2.0 * first, 0.02 * 2.0 * first);
  EXPECT_NEAR(found.interval(1, 1) - found.interval(1, 0), 2.0 * second, 0.02 * 2.0 * second);
}

/// A wide population on a logit: first-order moments of x there lead to another population (its 95 % interval
/// would not be that of the logit).
TEST(Prediction, StandsOnTheScaleOfALogit) {
  if (test::k_is_instrumented) GTEST_SKIP() << test::k_left_to_optimised_build;
  const LinearModel model(Eigen::VectorXd::Zero(1), Eigen::MatrixXd::Ones(1, 1));
  Parameter parameter{.name = "a", .unit = "-"};
  parameter.transform = {ParameterTransform::Kind::logit, 0.0, 1.0};
  const ParameterSpace space(
      {parameter}, JointDistribution({Distribution({.kind = DistributionKind::uniform, .lower = 0.0, .upper = 1.0})}));
  const Eigen::VectorXd mean = Eigen::VectorXd::Constant(1, 1.0);
  const Eigen::MatrixXd covariance = Eigen::MatrixXd::Constant(1, 1, 4.0);
  const NormalPopulation estimate(space.transforms(), {mean, covariance, sample_evidence(mean, covariance, 1000000)},
                                  1000000);
  const Prediction found =
      predict(model, space, estimate, {.noise_std = Eigen::VectorXd::Zero(1), .draws = 100000}, {});
  EXPECT_NEAR(found.interval(0, 0), 1.0 / (1.0 + std::exp(-1.0 + 1.959964 * 2.0)), 0.003);
  EXPECT_NEAR(found.interval(0, 1), 1.0 / (1.0 + std::exp(-1.0 - 1.959964 * 2.0)), 0.003);
}

/// A method that estimates no population is normal in the parameters, on whatever scales others would take them.
TEST(Prediction, TakesTheCovarianceOfMomentsAloneAsKnown) {
  const Bench bench;
  const MomentEstimate moments(std::vector<ParameterTransform>(2, ParameterTransform{ParameterTransform::Kind::log}),
                               Eigen::Vector2d(0.3, 0.7), bench.covariance);
  const Prediction found =
      predict(*bench.model, *bench.space, moments, {.noise_std = Eigen::Vector2d::Zero(), .draws = Bench::k_draws}, {});
  const Prediction exact = bench.run(bench.population(0));
  EXPECT_EQ(found.interval, exact.interval);
  EXPECT_EQ(found.joint_critical, exact.joint_critical);
}

/// Of a sample of parameters the predicted distribution is that of the sample's outputs.
TEST(Prediction, HoldsTheOutputsOfAPosteriorsSamples) {
  const Bench bench;
  Eigen::MatrixXd samples(3, 2);
  samples << 0.0, 0.0, 1.0, 0.0, 0.0, 1.0;
  const SampleEstimate posterior(std::vector<ParameterTransform>(2), samples, Eigen::Vector3d(0.5, 0.3, 0.2));
  const Prediction found = predict(*bench.model, *bench.space, posterior,
                                   {.noise_std = Eigen::Vector2d::Zero(), .draws = Bench::k_draws}, {});
  const Eigen::Vector2d mean = Eigen::Vector2d(1.0, -2.0) + bench.slope * Eigen::Vector2d(0.3, 0.2);
  EXPECT_LT((found.mean - mean).norm(), 0.02);  // standard error 0.003
  EXPECT_EQ(found.interval(0, 0), 1.0);
  EXPECT_EQ(found.interval(0, 1), 2.0);
}

}  // namespace
}  // namespace mottle::updating
