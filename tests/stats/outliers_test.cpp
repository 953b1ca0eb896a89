#include "mottle/stats/outliers.hpp"

#include <gtest/gtest.h>

#include <cmath>

#include "mottle/core/random.hpp"
#include "mottle/stats/standard_normal.hpp"

namespace mottle {
namespace {

Eigen::MatrixXd normal_samples(Eigen::Index count, Eigen::Index variables, std::uint32_t replication) {
  Eigen::MatrixXd samples(count, variables);
  for (Eigen::Index s = 0; s < count; ++s) {
    RandomStream stream({.seed = 11, .iteration = replication}, static_cast<std::uint32_t>(s));
    for (Eigen::Index k = 0; k < variables; ++k) samples(s, k) = standard_normal_quantile(stream.uniform());
  }
  return samples;
}

TEST(Outliers, AreSeldomFoundWhereThereAreNone) {
  int found = 0;
  constexpr int k_replications = 2000;
  for (std::uint32_t r = 0; r < k_replications; ++r)
    found += find_outliers(normal_samples(10, 3, r), 0.05).empty() ? 0 : 1;
  // Bonferroni over ten distances is all but exact; three binomial standard errors are 1.5 %.
  EXPECT_NEAR(found / static_cast<double>(k_replications), 0.05, 0.015);
}

TEST(Outliers, AreFoundOneAfterTheOther) {
  Eigen::MatrixXd samples = normal_samples(30, 2, 1);
  samples.row(4) << 12.0, -11.0;
  samples.row(17) << -30.0, 2.0;
  const std::vector<Outlier> outliers = find_outliers(samples, 0.05);
  ASSERT_EQ(outliers.size(), 2U);
  EXPECT_EQ(outliers[0].sample, 17);
  EXPECT_EQ(outliers[1].sample, 4);
  EXPECT_LT(outliers[1].p_value, 1e-6);
}

TEST(Outliers, NeedMoreSamplesThanVariables) {
  EXPECT_TRUE(find_outliers(normal_samples(5, 3, 2), 0.5).empty());
}

TEST(Outliers, DoNotDependOnUnits) {
  Eigen::MatrixXd samples = normal_samples(20, 2, 3);
  samples.row(3) << 9.0, 9.0;
  const std::vector<Outlier> before = find_outliers(samples, 0.05);
  samples.col(0) *= 1e9;
  const std::vector<Outlier> after = find_outliers(samples, 0.05);
  ASSERT_EQ(before.size(), after.size());
  EXPECT_NEAR(before[0].distance, after[0].distance, 1e-9);
}

}  // namespace
}  // namespace mottle
