#include "mottle/updating/methods/cloud.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>
#include <limits>

#include "core/message_of.hpp"

namespace mottle::updating {
namespace {

using ::testing::HasSubstr;

constexpr StreamKey k_key{.seed = 3, .purpose = StreamPurpose::parameter_cloud, .iteration = 1};

/// y = 2 x, fails where x > `highest`.
class DoublingModel final : public Model {
 public:
  explicit DoublingModel(double highest = std::numeric_limits<double>::infinity()) : highest_(highest) {}
  Eigen::Index parameter_count() const override { return 1; }
  const std::vector<Quantity>& outputs() const override { return outputs_; }
  Evaluation evaluate(const Eigen::Ref<const Eigen::MatrixXd>& samples, const RunContext&) const override {
    Evaluation result{2.0 * samples, {}};
    for (Eigen::Index s = 0; s < samples.rows(); ++s) {
      if (samples(s, 0) <= highest_) continue;
      result.outputs(s, 0) = std::numeric_limits<double>::quiet_NaN();
      result.failures.push_back({s, "too stiff"});
    }
    return result;
  }

 private:
  double highest_;
  std::vector<Quantity> outputs_{named_quantity("y", "-")};
};

ParameterSpace space(double mean = 1.0, double std = 0.8) {
  const Distribution normal({.kind = DistributionKind::normal, .mean = mean, .std = std});
  constexpr double k_infinity = std::numeric_limits<double>::infinity();
  return {{{"k", "N/m", -k_infinity, k_infinity, {}}}, JointDistribution({normal})};
}

Eigen::MatrixXd one_to_ten() {
  return Eigen::VectorXd::LinSpaced(10, 1.0, 10.0);
}

TEST(EvaluatePoints, GivesPointsAndOutputsRowByRow) {
  const Cloud cloud = evaluate_points(DoublingModel(), one_to_ten(), 0.3, {});
  EXPECT_EQ(cloud.samples, one_to_ten());
  EXPECT_EQ(cloud.outputs, 2.0 * one_to_ten());
  EXPECT_EQ(cloud.rejected, 0);
}

TEST(EvaluatePoints, KeepsFailedRunsWithTheirReason) {
  const Cloud cloud = evaluate_points(DoublingModel(8.5), one_to_ten(), 0.3, {});
  EXPECT_EQ(cloud.samples.rows(), 10);
  ASSERT_EQ(cloud.failures.size(), 2U);
  EXPECT_EQ(cloud.failures[0].sample, 8);
  EXPECT_EQ(cloud.failures[0].reason, "too stiff");
}

TEST(EvaluatePoints, GivesAnEmptyCloudForNoPoints) {
  EXPECT_EQ(evaluate_points(DoublingModel(), Eigen::MatrixXd(0, 1), 0.3, {}).valid().samples.rows(), 0);
}

TEST(EvaluatePoints, RefusesPointsOfAnotherSpace) {
  EXPECT_EQ(
      test::message_of<InvalidInput>([] { evaluate_points(DoublingModel(), Eigen::MatrixXd::Ones(2, 3), 0.3, {}); }),
      "3 columns of parameters given, the model has 1");
}

TEST(CloudValid, DropsFailedSamplesWithTheirOutputs) {
  Eigen::MatrixXd points = one_to_ten();
  points.row(0).swap(points.row(8));  // failures at the first, a middle and the last sample
  points.row(4).swap(points.row(7));
  const Cloud::Valid valid = evaluate_points(DoublingModel(7.5), points, 0.5, {}).valid();
  const Eigen::VectorXd expected = (Eigen::VectorXd(7) << 2.0, 3.0, 4.0, 6.0, 7.0, 5.0, 1.0).finished();
  EXPECT_EQ(valid.samples, expected);
  EXPECT_EQ(valid.outputs, 2.0 * expected);
}

TEST(CloudValid, IsTheWholeCloudWhereNothingFailed) {
  EXPECT_EQ(evaluate_points(DoublingModel(), one_to_ten(), 0.3, {}).valid().samples, one_to_ten());
}

TEST(EvaluatePoints, AllowsExactlyTheGivenFractionOfFailures) {
  EXPECT_NO_THROW(evaluate_points(DoublingModel(7.5), one_to_ten(), 0.3, {}));
}

TEST(EvaluatePoints, StopsWhereMoreFailAndNamesTheFirstReason) {
  EXPECT_EQ(test::message_of<SystemFailure>([] { evaluate_points(DoublingModel(6.5), one_to_ten(), 0.3, {}); }),
            "4 of 10 model runs failed, at most 30 % may (max_failed); the first, sample 6: too stiff");
}

TEST(EvaluatePoints, StopsWhereEveryRunFailedWhateverIsAllowed) {
  EXPECT_THAT(test::message_of<SystemFailure>([] { evaluate_points(DoublingModel(0.0), one_to_ten(), 1.0, {}); }),
              HasSubstr("10 of 10 model runs failed"));
}

TEST(EvaluateCloud, DrawsFromTheGivenDistribution) {
  const ParameterSpace prior = space();
  const JointDistribution other({Distribution({.kind = DistributionKind::normal, .mean = 5.0, .std = 0.5})});
  const Cloud cloud = evaluate_cloud(DoublingModel(), prior, other, {.samples = 2000}, k_key, {});
  EXPECT_EQ(cloud.samples, prior.draw(other, SamplingDesign::monte_carlo, 2000, k_key).samples);
  EXPECT_NEAR(cloud.outputs.mean(), 10.0, 4.0 * 1.0 / std::sqrt(2000.0));  // four standard errors of 2 x
}

TEST(EvaluateCloud, FollowsTheDesignAskedFor) {
  const ParameterSpace prior = space();
  const CloudSettings settings{.samples = 64, .design = SamplingDesign::sobol};
  const Cloud cloud = evaluate_cloud(DoublingModel(), prior, prior.prior(), settings, k_key, {});
  EXPECT_EQ(cloud.samples, prior.draw(prior.prior(), SamplingDesign::sobol, 64, k_key).samples);
}

TEST(EvaluateCloud, ReportsHowManyDrawsWereImpossible) {
  const ParameterSpace prior = space();
  const Cloud cloud = evaluate_cloud(DoublingModel(), prior, prior.prior(), {.samples = 1000}, k_key, {});
  EXPECT_EQ(cloud.rejected, prior.draw(prior.prior(), SamplingDesign::monte_carlo, 1000, k_key).rejected);
  EXPECT_GT(cloud.rejected, 0);  // a tenth of N(1, 0.8) is negative
}

// N(1, 0.8) cut at zero exceeds 2 with probability 0.1056 / 0.8944 = 0.118.
TEST(EvaluateCloud, StopsWhereTooManyRunsFail) {
  const ParameterSpace prior = space();
  EXPECT_NO_THROW(evaluate_cloud(DoublingModel(2.0), prior, prior.prior(), {.samples = 1000}, k_key, {}));
  EXPECT_THROW(
      evaluate_cloud(DoublingModel(2.0), prior, prior.prior(), {.samples = 1000, .max_failed = 0.05}, k_key, {}),
      SystemFailure);
}

}  // namespace
}  // namespace mottle::updating
