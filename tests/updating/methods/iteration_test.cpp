#include "mottle/updating/methods/iteration.hpp"

#include <gtest/gtest.h>

#include <limits>

#include "mottle/core/error.hpp"

namespace mottle::updating {
namespace {

constexpr double k_missing = std::numeric_limits<double>::quiet_NaN();

TestData tests_of(const Eigen::MatrixXd& values) {
  return {values, Eigen::VectorXd::Zero(values.cols())};
}

TEST(TestMoments, HaveNoScatterOfAnOutputThatOneSpecimenHas) {
  const TestMoments moments =
      test_moments(tests_of((Eigen::Matrix3d() << 1.0, k_missing, 4.0, 2.0, 7.0, 8.0, 3.0, k_missing, 6.0).finished()));
  EXPECT_EQ(moments.mean, Eigen::Vector3d(2.0, 7.0, 6.0));
  EXPECT_EQ(moments.count, Eigen::Vector3i(3, 1, 3));
  EXPECT_EQ(moments.covariance, (Eigen::Matrix3d() << 1.0, 0.0, 1.0, 0.0, 0.0, 0.0, 1.0, 0.0, 4.0).finished());
}

TEST(TestMoments, NeedAValueOfEachOutput) {
  EXPECT_THROW(test_moments(tests_of((Eigen::Matrix2d() << 1.0, k_missing, 2.0, k_missing).finished())), InvalidInput);
  EXPECT_THROW(test_moments(tests_of(Eigen::RowVector2d(1.0, k_missing))), InvalidInput);
}

TEST(RequireRepeatedOutputs, NamesTheOutputThatOneSpecimenHas) {
  const std::vector<Quantity> outputs = {{QuantityKind::frequency, 1, "", "Hz"},
                                         {QuantityKind::frequency, 2, "", "Hz"}};
  const Eigen::Matrix2d values = (Eigen::Matrix2d() << 1.0, 2.0, 1.1, k_missing).finished();
  EXPECT_NO_THROW(require_repeated_outputs(tests_of(values.row(0)), outputs));
  try {
    require_repeated_outputs(tests_of(values), outputs);
    FAIL() << "no fault was found";
  } catch (const InvalidInput& error) {
    EXPECT_NE(std::string(error.what()).find("output 'f2' is measured once in 2 specimens"), std::string::npos)
        << error.what();
  }
}

}  // namespace
}  // namespace mottle::updating
