#include "updating/methods/shared_offset.hpp"

#include <gtest/gtest.h>

#include <Eigen/Cholesky>
#include <Eigen/LU>
#include <limits>

#include "mottle/stats/moments/descriptive.hpp"
#include "support/linear_model.hpp"

namespace mottle::updating {
namespace {

/// Four outputs of different sizes, two parameters, three specimens of which one misses an entry.
struct Displaced {
  Displaced() {
    const Distribution prior({.kind = DistributionKind::normal, .mean = 10.0, .std = 1.0});
    space = std::make_unique<ParameterSpace>(std::vector<Parameter>{{"a", "-"}, {"b", "-"}},
                                             JointDistribution({prior, prior}));
    slopes << 1.0, 0.3, -20.0, 10.0, 0.05, 0.1, 0.4, -0.6;
    tests << 3.0, -18.0, 0.4, 1.2, 2.0, std::numeric_limits<double>::quiet_NaN(), 0.1, 0.7, 1.5, 7.0, 0.3, -0.2;
    cloud.resize(200, 4);
    RandomStream stream({.seed = 7, .purpose = StreamPurpose::truth}, 0);
    for (double& value : cloud.reshaped()) value = stream.uniform();
    cloud = cloud * Eigen::Vector4d(1.0, 30.0, 0.2, 1.0).asDiagonal() + cloud.leftCols(2) * slopes.transpose();
  }
  SharedOffset offset() const {
    return {{.model = model,
             .space = *space,
             .tests = {.values = tests, .repeatability_std = Eigen::Vector4d::Zero(), .model_error_std = error},
             .cloud = {}},
            slopes,
            cloud};
  }
  /// E[d | r] = D (D + C / n + s^2 J J')^-1 r: the mean of the population has a wide prior, and nothing is said of
  /// directions.
  Eigen::Matrix4d gain() const {
    constexpr double k_wide = 1e4;
    return error.cwiseAbs2().asDiagonal() *
           (of_mean() + k_wide * k_wide * slopes * slopes.transpose()).fullPivLu().inverse();
  }
  Eigen::Matrix4d of_mean() const {
    const Eigen::Vector4d count(3.0, 2.0, 3.0, 3.0);
    Eigen::Matrix4d together = Eigen::Matrix4d::Constant(3.0);
    together.row(1).setConstant(2.0);
    together.col(1).setConstant(2.0);
    Eigen::Matrix4d covariance = sample_covariance(cloud).cwiseProduct(together);
    covariance = count.cwiseInverse().asDiagonal() * covariance * count.cwiseInverse().asDiagonal();
    covariance.diagonal() += error.cwiseAbs2();
    return covariance;
  }
  Eigen::Matrix<double, 2, 4> left_inverse() const {
    const Eigen::Matrix4d weight = of_mean().llt().solve(Eigen::Matrix4d::Identity());
    return (slopes.transpose() * weight * slopes).inverse() * slopes.transpose() * weight;
  }
  Eigen::Vector4d residual() const {
    return Eigen::Vector4d(6.5 / 3.0, -5.5, 0.8 / 3.0, 1.7 / 3.0) - cloud.colwise().mean().transpose();
  }

  Eigen::Vector4d error{0.5, 40.0, 0.3, 0.9};
  Eigen::Matrix<double, 4, 2> slopes;
  Eigen::Matrix<double, 3, 4> tests;
  Eigen::MatrixXd cloud;
  test::LinearModel model{Eigen::Vector4d::Zero(), Eigen::MatrixXd::Ones(4, 2)};
  std::unique_ptr<ParameterSpace> space;
};

TEST(SharedOffset, TakesOffTheMeanOfTheErrorGivenTheTests) {
  const Displaced displaced;
  const Eigen::RowVector4d known = (displaced.gain() * displaced.residual()).transpose();
  const Eigen::MatrixXd found = displaced.offset().taken_off(displaced.tests);
  EXPECT_TRUE(std::isnan(found(1, 1)));
  EXPECT_EQ(found.array().isNaN().count(), 1);
  for (int s = 0; s < 3; ++s) {
    for (int k = 0; k < 4; ++k) {
      if (s == 1 && k == 1) continue;
      EXPECT_NEAR(displaced.tests(s, k) - found(s, k), known(k), 1e-5 * displaced.error(k)) << s << ", " << k;
    }
  }
}

TEST(SharedOffset, DisplacesSimulatedTestsByWhatIsLeft) {
  const Displaced displaced;
  const Eigen::Vector4d normal(0.3, -1.2, 0.8, 2.0);
  const Eigen::Vector4d error = displaced.error.cwiseProduct(normal);
  const Eigen::Vector4d left = error - displaced.gain() * (displaced.residual() + error);
  const Eigen::Vector4d rest = left - displaced.slopes * (displaced.left_inverse() * left);
  const Eigen::MatrixXd moved = displaced.offset().displaced(displaced.tests, normal) - displaced.tests;
  for (int k = 0; k < 4; ++k) {
    EXPECT_NEAR(moved(0, k), rest(k), 1e-5 * displaced.error(k)) << k;
    EXPECT_NEAR(moved(2, k), rest(k), 1e-5 * displaced.error(k)) << k;
  }
}

TEST(SharedOffset, MovesTheMeanByWhatTheTestsLeaveOpen) {
  const Displaced displaced;
  const Eigen::Matrix4d variance = displaced.error.cwiseAbs2().asDiagonal();
  const Eigen::Matrix4d left = variance - displaced.gain() * variance;
  const Eigen::Matrix2d expected = displaced.left_inverse() * left * displaced.left_inverse().transpose();
  const Eigen::MatrixXd factor = displaced.offset().mean_factor();
  EXPECT_LT((factor * factor.transpose() - expected).norm(), 1e-5 * expected.norm());
}

TEST(SharedOffset, IsNothingWithoutError) {
  Displaced displaced;
  displaced.error.setZero();
  const SharedOffset none = displaced.offset();
  EXPECT_TRUE(none.is_none());
  EXPECT_EQ(none.taken_off(displaced.tests).row(0), displaced.tests.row(0));
}

}  // namespace
}  // namespace mottle::updating
