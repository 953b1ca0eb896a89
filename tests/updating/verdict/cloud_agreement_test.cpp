#include "updating/verdict/cloud_agreement.hpp"

#include <gtest/gtest.h>

#include <boost/math/distributions/chi_squared.hpp>
#include <cmath>

#include "mottle/core/random.hpp"
#include "mottle/stats/distributions/standard_normal.hpp"
#include "mottle/stats/moments/descriptive.hpp"

namespace mottle::updating {
namespace {

using Draw = double (*)(RandomStream&);

double draw_normal(RandomStream& stream) {
  return standard_normal_quantile(stream.uniform());
}

/// Rank-numbered: nearly fixed below the crossing, steep above it, which one specimen of ten reaches.
double draw_beyond_kink(RandomStream& stream) {
  constexpr double k_crossing = 1.2816;  // P(N(0, 1) > 1.2816) = 0.1
  return std::max(standard_normal_quantile(stream.uniform()) - k_crossing, 0.0);
}

Eigen::VectorXd drawn(Draw draw, int count, std::uint32_t stream_number) {
  RandomStream stream({.seed = 11}, stream_number);
  Eigen::VectorXd values(count);
  for (double& value : values) value = draw(stream);
  return values;
}

double variance_of(const Eigen::VectorXd& values) {
  return sample_covariance(values)(0, 0);
}

/// One output whose model is that of the cloud with noise of 0.02.
ScatterComparison compare(const Eigen::VectorXd& cloud, double tested, int specimens) {
  constexpr double k_noise = 0.02;
  return {.tested = Eigen::VectorXd::Constant(1, tested),
          .model = Eigen::VectorXd::Constant(1, variance_of(cloud) + k_noise * k_noise),
          .cloud = cloud,
          .count = Eigen::VectorXi::Constant(1, specimens),
          .is_whole = {true},
          .names = {"f2"}};
}

constexpr int k_studies = 150;

double refused_share(Draw draw, double level, double scale = 1.0) {
  constexpr int k_specimens = 10;
  const Eigen::VectorXd cloud = drawn(draw, 10000, 0);
  int refused = 0;
  for (std::uint32_t r = 1; r <= k_studies; ++r) {
    Eigen::VectorXd tests = scale * drawn(draw, k_specimens, r);
    tests += 0.02 * drawn(draw_normal, k_specimens, 10000 + r);
    const PlannedTest test = cloud_agreement_test(compare(cloud, variance_of(tests), k_specimens));
    EXPECT_EQ(test.statistic > test.critical(level), test.p_value < level);
    refused += test.p_value < level ? 1 : 0;
  }
  return static_cast<double>(refused) / k_studies;
}

// 150 studies know a share of 0.05 to 0.018: four standard deviations are 0.071.
TEST(CloudAgreement, KeepsItsLevelForAnOutputWithAKinkThatFewSpecimensReach) {
  EXPECT_LT(refused_share(draw_beyond_kink, 0.05), 0.121);
}

TEST(CloudAgreement, KeepsItsLevelForNormalOutputs) {
  const double share = refused_share(draw_normal, 0.05);
  EXPECT_GT(share, 0.0);
  EXPECT_LT(share, 0.121);
}

TEST(CloudAgreement, RefusesScatterOfAnotherSizeInSpiteOfTheKink) {
  EXPECT_GT(refused_share(draw_beyond_kink, 0.05, 20.0), 0.4);  // where a specimen lies beyond it: 1 - 0.9^10 = 0.65
  EXPECT_GT(refused_share(draw_normal, 0.05, 4.0), 0.99);
}

TEST(CloudAgreement, IsChiSquaredForNormalOutputs) {
  const Eigen::VectorXd cloud = drawn(draw_normal, 100000, 0);
  for (const double ratio : {0.2, 0.6, 1.0, 1.5, 3.0}) {
    const ScatterComparison comparison = compare(cloud, ratio * (variance_of(cloud) + 0.0004), 10);
    const boost::math::chi_squared law(9.0);
    const double below = boost::math::cdf(law, 9.0 * ratio);
    const double expected = 2.0 * std::min(below, 1.0 - below);
    // The larger of two estimates of one probability, one of them from 20,000 draws.
    EXPECT_NEAR(cloud_agreement_test(comparison).p_value, expected, 4.0 * std::sqrt(expected / 20000.0)) << ratio;
  }
}

TEST(CloudAgreement, CanRefuseOneOutputOfMany) {
  constexpr int k_outputs = 300;
  ScatterComparison many = compare(drawn(draw_normal, 1000, 0), 1.0, 10);
  many.tested = Eigen::VectorXd::Constant(k_outputs, 1.0);
  many.tested(7) = 100.0;
  many.model = Eigen::VectorXd::Constant(k_outputs, many.model(0));
  many.cloud = Eigen::MatrixXd(many.cloud.replicate(1, k_outputs));
  many.count = Eigen::VectorXi::Constant(k_outputs, 10);
  many.is_whole.assign(k_outputs, true);
  many.names.assign(k_outputs, "f");
  EXPECT_LT(cloud_agreement_test(many).p_value, 0.0025);
}

}  // namespace
}  // namespace mottle::updating
