#include "mottle/stats/moments/spearman.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <limits>

#include "mottle/core/error.hpp"
#include "mottle/stats/sampling/sampling.hpp"

namespace mottle::stats {
namespace {

TEST(Spearman, EqualValuesShareTheAverageOfTheirRanks) {
  Eigen::VectorXd values(6);
  values << 3.0, 1.0, 3.0, 9.0, 3.0, 0.5;
  Eigen::VectorXd expected(6);
  expected << 4.0, 2.0, 4.0, 6.0, 4.0, 1.0;
  EXPECT_EQ(average_ranks(values), expected);
}

// SciPy 1.10: scipy.stats.spearmanr(X[:, i], Y[:, j]).correlation.
TEST(Spearman, WithTiesIsThatOfScipy) {
  Eigen::MatrixXd x(7, 2);
  x << 1, 5, 2, 5, 2, 3, 4, 1, 5, 2, 6, 2, 2, 8;
  Eigen::MatrixXd y(7, 2);
  y << 2.5, -1, 2.0, 0, 2.5, 0, 7.1, 3, 2.5, 9, 9.9, 4, 1.0, 2;
  const Eigen::MatrixXd correlation = spearman(x, y);
  EXPECT_NEAR(correlation(0, 0), 0.6153846153846154, 1e-12);
  EXPECT_NEAR(correlation(0, 1), 0.9349469900084572, 1e-12);
  EXPECT_NEAR(correlation(1, 0), -0.849207775608447, 1e-12);
  EXPECT_NEAR(correlation(1, 1), -0.6330541649476574, 1e-12);
}

TEST(Spearman, MonotoneCurveHasCorrelationOneWhateverItsShape) {
  const Eigen::MatrixXd x = uniform_design(SamplingDesign::monte_carlo, 100, 1, {.seed = 1});
  Eigen::MatrixXd y(100, 2);
  y << (20.0 * x.array()).exp().matrix(), -x.array().cube().matrix();
  EXPECT_NEAR(spearman(x, y)(0, 0), 1.0, 1e-14);
  EXPECT_NEAR(spearman(x, y)(0, 1), -1.0, 1e-14);
}

TEST(Spearman, ConstantColumnGivesZero) {
  const Eigen::MatrixXd x = Eigen::MatrixXd::Constant(5, 1, 3.0);
  EXPECT_EQ(spearman(x, Eigen::VectorXd::LinSpaced(5, 0.0, 1.0))(0, 0), 0.0);
}

TEST(Spearman, RefusesMissingEntriesAndTooFewRows) {
  Eigen::MatrixXd x = Eigen::MatrixXd::Ones(3, 1);
  EXPECT_THROW(static_cast<void>(spearman(x, Eigen::MatrixXd::Ones(4, 1))), InvalidInput);
  EXPECT_THROW(static_cast<void>(spearman(x.topRows(1), x.topRows(1))), InvalidInput);
  x(1, 0) = std::numeric_limits<double>::quiet_NaN();
  EXPECT_THROW(static_cast<void>(spearman(x, Eigen::MatrixXd::Ones(3, 1))), InvalidInput);
}

}  // namespace
}  // namespace mottle::stats
