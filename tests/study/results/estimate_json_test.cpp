#include "study/results/estimate_json.hpp"

#include <gtest/gtest.h>

#include <cmath>

#include "mottle/updating/estimate/sample_estimate.hpp"
#include "support/linear_model.hpp"

namespace mottle::study {
namespace {

/// Two parameters with a normal prior, and a result for them.
struct Found {
  Found() {
    const Distribution prior({.kind = DistributionKind::normal, .mean = 1.0, .std = 0.5});
    space =
        std::make_unique<ParameterSpace>(std::vector<Parameter>{{.name = "a", .unit = "-"}, {.name = "b", .unit = "-"}},
                                         JointDistribution({prior, prior}));
  }
  Json json() const {
    const UpdatingProblem problem{.model = model, .space = *space};
    Json parameters = Json::object();
    add_estimate(problem, result, parameters);
    return parameters;
  }
  test::LinearModel model{Eigen::VectorXd::Zero(1), Eigen::MatrixXd::Ones(1, 2)};
  std::unique_ptr<ParameterSpace> space;
  UpdatingResult result;
};

TEST(EstimateJson, OfAPopulationHoldsItsQuantilesCurvesAndRegions) {
  Found found;
  Eigen::Matrix2d covariance;
  covariance << 0.04, 0.03, 0.03, 0.09;
  found.result.set_estimate(std::make_shared<NormalPopulation>(
      std::vector<ParameterTransform>(2), PopulationOnScales{Eigen::Vector2d(1.0, 2.0), covariance, {}}, 0));
  const Json json = found.json();
  EXPECT_EQ(json["estimate"]["kind"], "population");
  EXPECT_TRUE(json["estimate"]["log_evidence"].is_null());
  EXPECT_NEAR(json["quantiles"]["values"][1][4].get<double>(), 2.0 + 0.3 * 1.959963984540054, 1e-12);
  EXPECT_NEAR(json["correlation"][0][1].get<double>(), 0.5, 1e-14);
  EXPECT_EQ(json["densities"][0]["updated"]["x"].size(), 161U);
  EXPECT_TRUE(json["densities"][0]["band"].is_null());
  ASSERT_EQ(json["regions"].size(), 1U);
  const Json& x = json["regions"][0]["outlines"][0]["x"];
  EXPECT_EQ(x.front(), x.back());
  EXPECT_NEAR(x.front().get<double>(), 1.4, 1e-5);  // two deviations; six digits
}

TEST(EstimateJson, OfAPosteriorHoldsItsEvidence) {
  Found found;
  Eigen::MatrixXd samples(4, 2);
  samples << 1.0, 2.0, 1.1, 2.2, 0.9, 2.1, 1.0, 1.9;
  found.result.set_estimate(
      std::make_shared<SampleEstimate>(std::vector<ParameterTransform>(2), samples, Eigen::VectorXd(), -12.5));
  const Json json = found.json();
  EXPECT_EQ(json["estimate"]["kind"], "posterior");
  EXPECT_EQ(json["estimate"]["log_evidence"], -12.5);
  EXPECT_NEAR(json["estimate"]["effective_samples"].get<double>(), 4.0, 1e-12);
  EXPECT_FALSE(found.result.is_population);
  EXPECT_TRUE(json["regions"][0]["interval_ends"].empty());
}

TEST(EstimateJson, LeavesOutACorrelationThatOthersHaveAnIntervalForAndItHasNot) {
  Found found;
  found.result.set_estimate(std::make_shared<NormalPopulation>(
      std::vector<ParameterTransform>(2),
      PopulationOnScales{Eigen::Vector2d(1.0, 2.0), Eigen::Vector2d(0.04, 0.0).asDiagonal(), {}}, 0));
  const Json json = found.json();
  EXPECT_TRUE(json["correlation"][0][1].is_null());
  EXPECT_TRUE(json["densities"][1]["updated"].is_null());
  EXPECT_TRUE(json["regions"][0]["outlines"].empty());
}

TEST(EstimateJson, OfAResultWithoutOneIsEmpty) {
  EXPECT_TRUE(Found().json().empty());
}

TEST(EstimateJson, KeepsSixDigitsOfTheRangeOfWhatIsDrawn) {
  const Json far = drawn_json(Eigen::Vector3d(2.1e11, 2.1e11 + 1234.5678, 2.1e11 + 9000.0));
  EXPECT_NEAR(far[1].get<double>() - 2.1e11, 1234.5678, 0.01);
  EXPECT_EQ(drawn_json(Eigen::Vector2d(0.0, 1.0 / 3.0))[1].dump(), "0.333333");
  EXPECT_EQ(drawn_json(Eigen::Vector2d(7.0, 7.0))[0].dump(), "7.0");
}

}  // namespace
}  // namespace mottle::study
