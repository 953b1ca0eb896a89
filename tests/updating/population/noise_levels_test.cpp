#include "updating/population/noise_levels.hpp"

#include <gtest/gtest.h>

#include <cmath>

#include "mottle/core/random.hpp"
#include "mottle/stats/distributions/standard_normal.hpp"

namespace mottle::updating {
namespace {

/// Tests of linear specimens with two parameters whose means are off by `bias` [output], and their linear problem.
struct LinearUnits {
  LinearUnits(Eigen::Index specimens, const Eigen::VectorXd& noise_std, const Eigen::VectorXd& bias) {
    RandomStream stream({.seed = 8, .purpose = StreamPurpose::truth}, 0);
    const auto normal = [&] { return standard_normal_quantile(stream.uniform()); };
    const Eigen::Index p = noise_std.size();
    Eigen::MatrixXd design(p, 2);
    for (double& entry : design.reshaped()) entry = normal();
    values.resize(specimens, p);
    for (Eigen::Index s = 0; s < specimens; ++s) {
      const Eigen::Vector2d effects(5.0 * normal(), 5.0 * normal());
      Eigen::VectorXd response = design * effects + bias;
      for (Eigen::Index k = 0; k < p; ++k) response(k) += noise_std(k) * normal();
      values.row(s) = response.transpose();
      units.push_back({design, response, Eigen::VectorXd::Ones(p)});
    }
    model = {Eigen::VectorXd::Ones(p), std::vector<int>(static_cast<std::size_t>(p), 0), 1};
  }

  NoiseOfResiduals noise() const { return noise_of_residuals(values, units, model); }

  Eigen::MatrixXd values;
  std::vector<RandomEffectsUnit> units;
  NoiseModel model;
};

TEST(NoiseOfResiduals, IsThatOfEachOutputAndNotTheBiasOfMeans) {
  constexpr Eigen::Index k_specimens = 1000;
  const Eigen::VectorXd std{{0.2, 0.1, 0.1, 0.08, 0.2, 0.06, 0.1, 0.15, 0.07, 0.2}};
  const Eigen::VectorXd bias{{3.0, -5.0, 0.0, 1.0, 2.0, 4.0, 1.0, -1.0, 0.5, 7.0}};
  const NoiseOfResiduals found = LinearUnits(k_specimens, std, bias).noise();
  EXPECT_TRUE(found.has_own_levels);
  EXPECT_NEAR(found.degrees_of_freedom, 8.0 * (k_specimens - 1), 1e-9);
  for (Eigen::Index k = 0; k < std.size(); ++k) {
    // Most of the information on an output is left by two parameters of ten: a deviation is known to 1 / sqrt(1000).
    EXPECT_NEAR(std::sqrt(found.variance(k)) / std(k), 1.0, 0.2) << k;
  }
  const NoiseOfResiduals unbiased = LinearUnits(k_specimens, std, Eigen::VectorXd::Zero(10)).noise();
  EXPECT_LT((found.variance - unbiased.variance).cwiseQuotient(unbiased.variance).cwiseAbs().maxCoeff(), 1e-5);
}

TEST(NoiseOfResiduals, IsCommonWhereTheResidualsCannotTellTheOutputsApart) {
  const Eigen::VectorXd std{{0.2, 0.02, 0.1, 0.05}};
  const NoiseOfResiduals found = LinearUnits(50, std, Eigen::VectorXd::Zero(4)).noise();
  EXPECT_FALSE(found.has_own_levels);
  EXPECT_DOUBLE_EQ(found.variance(0), found.variance(3));
}

TEST(NoiseOfResiduals, IsNearTheCommonLevelForFewSpecimens) {
  const Eigen::VectorXd std = Eigen::VectorXd::Constant(5, 0.1);
  const NoiseOfResiduals found = LinearUnits(3, std, Eigen::VectorXd::Zero(5)).noise();
  EXPECT_TRUE(found.has_own_levels);
  // Two degrees of freedom and less of each output beside the four of the common level.
  EXPECT_GT(found.variance.minCoeff(), 0.5 * found.common.base.minCoeff());
  EXPECT_LT(found.variance.maxCoeff(), 3.0 * found.common.base.maxCoeff());
}

TEST(NoiseOfResiduals, TellsNothingWhereParametersReachAllOutputs) {
  const Eigen::VectorXd std = Eigen::VectorXd::Constant(2, 0.1);
  EXPECT_EQ(LinearUnits(10, std, Eigen::VectorXd::Zero(2)).noise().degrees_of_freedom, 0.0);
}

}  // namespace
}  // namespace mottle::updating
