// What `maximum-likelihood` says of populations that are not normal.
#include <gtest/gtest.h>

#include <cmath>

#include "mottle/core/random.hpp"
#include "mottle/stats/distributions/standard_normal.hpp"
#include "mottle/updating/methods/maximum_likelihood.hpp"
#include "support/three_masses.hpp"

namespace mottle::updating {
namespace {

/// k1, k2, k5 ~ N(1, 0.1).
Eigen::MatrixXd normal_parameters(Eigen::Index count) {
  RandomStream stream({.seed = 16}, 0);
  Eigen::MatrixXd x(count, 3);
  for (double& value : x.reshaped()) value = 1.0 + 0.1 * standard_normal_quantile(stream.uniform());
  return x;
}

UpdatingResult update(const Eigen::MatrixXd& x) {
  const test::ThreeMasses structure;
  return MaximumLikelihoodUpdater({}).update(structure.problem(test::frequencies_of(structure, x)), {});
}

std::string remark_of(const UpdatingResult& result) {
  for (const std::string& note : result.notes) {
    if (note.starts_with("Remark")) return note;
  }
  return {};
}

TEST(NormalityReport, IsSilentOfANormalPopulation) {
  const UpdatingResult result = update(normal_parameters(20));
  ASSERT_TRUE(result.normality.has_value());
  EXPECT_FALSE(result.normality->is_remarkable);
  EXPECT_EQ(remark_of(result), "");
  EXPECT_NEAR(result.normality->test.variables[0].reliability, 1.0, 1e-6);
}

TEST(NormalityReport, NamesTwoBatchesAndTheirSpecimens) {
  Eigen::MatrixXd x = normal_parameters(20);
  for (Eigen::Index s = 0; s < 20; ++s) x(s, 0) = 0.5 * x(s, 0) + (s < 12 ? 0.1 : 0.9);
  const UpdatingResult result = update(x);
  ASSERT_TRUE(result.normality->is_remarkable);
  EXPECT_NE(remark_of(result).find("k1 looks like two batches, 12 specimens around 0.5"), std::string::npos)
      << remark_of(result);
  EXPECT_NE(remark_of(result).find("(specimens 13, 14, 15, 16, 17, 18, 19, 20)"), std::string::npos)
      << remark_of(result);
  EXPECT_EQ(result.normality->suggestions[1], "");
}

TEST(NormalityReport, SuggestsTheLogarithmOfALogNormalParameter) {
  Eigen::MatrixXd x = normal_parameters(50);
  const double spread = std::sqrt(std::log(1.64));  // coefficient of variation 0.8
  x.col(0) = (spread * (x.col(0).array() - 1.0) / 0.1 - 0.5 * spread * spread).exp();
  const UpdatingResult result = update(x);
  EXPECT_NE(remark_of(result).find("k1 looks normal on the scale \"log\": set scale = \"log\""), std::string::npos)
      << remark_of(result);
}

}  // namespace
}  // namespace mottle::updating
