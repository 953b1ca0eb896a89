#include "study/results/agreement.hpp"

#include <gtest/gtest.h>

#include <cmath>

#include "support/linear_model.hpp"

namespace mottle::study {
namespace {

/// Two outputs with tests of mean 10 and standard deviation 1, and a last cloud of given moments.
struct Compared {
  Compared(const Eigen::Vector2d& mean, const Eigen::Vector2d& standard_deviation) {
    const Distribution prior({.kind = DistributionKind::normal, .mean = 10.0, .std = 1.0});
    space =
        std::make_unique<ParameterSpace>(std::vector<Parameter>{{.name = "a", .unit = "-"}, {.name = "b", .unit = "-"}},
                                         JointDistribution({prior, prior}));
    // Orthogonal and of the same size: the scatter of both is 1, their covariance zero.
    const Eigen::VectorXd u = Eigen::VectorXd::LinSpaced(10, -4.5, 4.5);
    const Eigen::VectorXd v = u.array().square() - 8.25;
    tests.values.resize(10, 2);
    tests.values.col(0) = (u * 3.0 / u.norm()).array() + 10.0;
    tests.values.col(1) = (v * 3.0 / v.norm()).array() + 10.0;
    tests.repeatability_std = Eigen::Vector2d::Zero();
    result.history.push_back(state(Eigen::Vector2d(12.0, 12.0), Eigen::Vector2d::Ones()));
    result.history.push_back(state(mean, standard_deviation));
  }
  static IterationRecord state(const Eigen::Vector2d& mean, const Eigen::Vector2d& standard_deviation) {
    IterationRecord record;
    record.output_mean = mean;
    record.output_covariance = standard_deviation.cwiseAbs2().asDiagonal();
    record.cloud.samples = Eigen::MatrixXd::Zero(1000000, 1);  // the cloud's own sampling error does not count
    return record;
  }
  Agreement agreement() const { return compare_with_tests({.model = model, .space = *space, .tests = tests}, result); }
  test::LinearModel model{Eigen::VectorXd::Zero(2), Eigen::MatrixXd::Identity(2, 2)};
  std::unique_ptr<ParameterSpace> space;
  TestData tests;
  UpdatingResult result;
};

TEST(Agreement, OfTheSameMomentsIsReproducedInEverything) {
  const Agreement agreement = Compared({10.0, 10.0}, {1.0, 1.0}).agreement();
  EXPECT_TRUE(agreement.are_means_reproduced());
  EXPECT_TRUE(agreement.is_scatter_reproduced());
  EXPECT_NEAR(agreement.outputs[0].final.std_ratio, 1.0, 1e-12);
  EXPECT_NEAR(agreement.outputs[0].initial.mean_error, 0.2, 1e-12);
}

TEST(Agreement, OfAMeanIsLimitedByStudentsTForAllOutputsTogether) {
  // t(9; 1 - 0.01 / 4) = 3.6897, from tables of Student's distribution; a standard error is 1 / sqrt(10).
  const double limit = 3.6897 / std::sqrt(10.0);
  EXPECT_NEAR(Compared({10.0, 10.0}, {1.0, 1.0}).agreement().outputs[0].critical_standard_errors, 3.6897, 1e-4);
  EXPECT_TRUE(Compared({10.0 + 0.99 * limit, 10.0}, {1.0, 1.0}).agreement().are_means_reproduced());
  EXPECT_FALSE(Compared({10.0 + 1.01 * limit, 10.0}, {1.0, 1.0}).agreement().are_means_reproduced());
}

TEST(Agreement, OfAScatterIsLimitedByChiSquared) {
  // chi2(9) has 0.25 % below 1.45014 and above 25.46248, by bisection of its closed form for odd degrees of freedom.
  const OutputAgreement output = Compared({10.0, 10.0}, {1.0, 1.0}).agreement().outputs[0];
  EXPECT_NEAR(output.min_std_ratio, std::sqrt(9.0 / 25.46248), 1e-5);
  EXPECT_NEAR(output.max_std_ratio, std::sqrt(9.0 / 1.45014), 1e-4);
  EXPECT_FALSE(Compared({10.0, 10.0}, {1.0, 0.14}).agreement().is_scatter_reproduced());
  EXPECT_FALSE(Compared({10.0, 10.0}, {1.0, 3.0}).agreement().is_scatter_reproduced());
}

TEST(Agreement, HasTheWorstOutputFirst) {
  const Agreement agreement = Compared({10.0, 10.0}, {1.0, 0.14}).agreement();
  EXPECT_EQ(agreement.outputs[0].output, 1);
  EXPECT_GT(agreement.outputs[0].misfit(), 1.0);
  EXPECT_LT(agreement.outputs[1].misfit(), 1.0);
}

TEST(Agreement, CountsTheTestsWithinTheRegionOfTheCloud) {
  const RegionAgreement right = *Compared({10.0, 10.0}, {1.0, 1.0}).agreement().region;
  EXPECT_EQ(right.tests, 10);
  EXPECT_EQ(right.final, 10);
  EXPECT_EQ(right.min_inside, 7);  // P(at most 6 of 10 | 0.95) = 0.0010, P(at most 7) = 0.0115
  const RegionAgreement narrow = *Compared({10.0, 10.0}, {0.14, 0.14}).agreement().region;
  EXPECT_LT(narrow.final, 3);
  EXPECT_FALSE(narrow.is_reproduced());
}

TEST(Agreement, CountsTheKnownNoiseAsScatterOfTheModel) {
  Compared compared({10.0, 10.0}, {0.6, 0.6});
  compared.tests.repeatability_std = Eigen::Vector2d(0.8, 0.8);
  EXPECT_NEAR(compared.agreement().outputs[0].final.std_ratio, 1.0, 1e-12);
}

TEST(Agreement, SaysNothingOfTheScatterOfOneSpecimen) {
  Compared compared({10.0, 10.0}, {1.0, 1.0});
  compared.tests.values.conservativeResize(1, 2);
  const Agreement agreement = compared.agreement();
  EXPECT_FALSE(agreement.outputs[0].is_scatter_reproduced.has_value());
  EXPECT_FALSE(agreement.region.has_value());
  EXPECT_TRUE(agreement_json(agreement, compared.model.outputs())["outputs"][0]["final"]["std_ratio"].is_null());
}

TEST(Agreement, OfACloudWithoutScatterIsNotReproduced) {
  const Agreement agreement = Compared({10.0, 10.0}, {0.0, 0.0}).agreement();
  EXPECT_FALSE(agreement.is_scatter_reproduced());
  EXPECT_FALSE(agreement.region.has_value());
}

}  // namespace
}  // namespace mottle::study
