#include "mottle/dynamics/modes/mac.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <numbers>
#include <numeric>
#include <random>

#include "mottle/core/error.hpp"

namespace mottle::dynamics {
namespace {

Eigen::MatrixXd random_matrix(Eigen::Index rows, Eigen::Index columns, std::mt19937_64& random) {
  std::normal_distribution<double> normal;
  Eigen::MatrixXd matrix(rows, columns);
  for (double& entry : matrix.reshaped()) entry = normal(random);
  return matrix;
}

double total(const Eigen::MatrixXd& score, const std::vector<int>& column_of) {
  double sum = 0.0;
  for (Eigen::Index row = 0; row < score.rows(); ++row) sum += score(row, column_of[static_cast<std::size_t>(row)]);
  return sum;
}

/// The highest total over every way to choose distinct columns.
double best_total(const Eigen::MatrixXd& score) {
  std::vector<int> order(static_cast<std::size_t>(score.cols()));
  std::iota(order.begin(), order.end(), 0);
  double best = -std::numeric_limits<double>::infinity();
  do {
    best = std::max(best, total(score, order));
  } while (std::next_permutation(order.begin(), order.end()));
  return best;
}

// By hand: a'b = 4, a'a = 5, b'b = 5, so 16/25; and 0 for (2, -1).
TEST(Mac, IsTheSquaredCosineBetweenShapes) {
  const Eigen::Vector2d a(1.0, 2.0);
  const Eigen::MatrixXd b = (Eigen::MatrixXd(2, 2) << 2.0, 2.0, 1.0, -1.0).finished();
  const Eigen::MatrixXd mac = modal_assurance_criterion(a, b);
  EXPECT_DOUBLE_EQ(mac(0, 0), 0.64);
  EXPECT_EQ(mac(0, 1), 0.0);
}

TEST(Mac, HasARowForEachShapeOfTheFirstAndAColumnForEachOfTheSecond) {
  std::mt19937_64 random(1);
  const Eigen::MatrixXd mac = modal_assurance_criterion(random_matrix(5, 2, random), random_matrix(5, 3, random));
  EXPECT_EQ(mac.rows(), 2);
  EXPECT_EQ(mac.cols(), 3);
}

// The scales reach where products of four components leave the range of double.
TEST(Mac, DoesNotDependOnTheScaleOrSignOfShapes) {
  std::mt19937_64 random(2);
  const Eigen::MatrixXd a = random_matrix(4, 3, random), b = random_matrix(4, 3, random);
  const Eigen::MatrixXd mac = modal_assurance_criterion(a, b);
  for (const double scale : {-1.0, 1e100, 1e-100}) {
    // 1e-13: a dozen roundings, amplified by cancellation in the products of random shapes.
    EXPECT_LT((modal_assurance_criterion(scale * a, scale * b) - mac).norm(), 1e-13) << scale;
  }
}

TEST(Mac, IsNeverAboveOne) {
  std::mt19937_64 random(3);
  for (int i = 0; i < 1000; ++i) {
    const Eigen::MatrixXd shape = random_matrix(7, 1, random);
    const double mac = modal_assurance_criterion(shape, 3.0 * shape)(0, 0);
    ASSERT_LE(mac, 1.0);
    ASSERT_GT(mac, 1.0 - 1e-14);  // a dozen roundings
  }
}

TEST(Mac, IsZeroForAZeroShape) {
  EXPECT_EQ(modal_assurance_criterion(Eigen::Vector2d::Zero(), Eigen::Vector2d::Ones())(0, 0), 0.0);
}

TEST(Mac, RefusesShapesOfDifferentDegreesOfFreedom) {
  EXPECT_THROW(modal_assurance_criterion(Eigen::VectorXd::Ones(2), Eigen::VectorXd::Ones(3)), InvalidInput);
}

TEST(OptimalAssignment, ReachesTheBestTotalOfAllPermutations) {
  std::mt19937_64 random(4);
  for (int columns = 1; columns <= 6; ++columns) {
    for (int rows = 1; rows <= columns; ++rows) {
      for (int repetition = 0; repetition < 20; ++repetition) {
        const Eigen::MatrixXd score = random_matrix(rows, columns, random);
        // 1e-12: sums of at most six numbers near one, in another order.
        ASSERT_NEAR(total(score, optimal_assignment(score)), best_total(score), 1e-12) << score;
      }
    }
  }
}

TEST(OptimalAssignment, ReachesTheBestTotalWhereScoresAreTied) {
  std::mt19937_64 random(5);
  std::uniform_int_distribution<int> small(0, 2);
  for (int repetition = 0; repetition < 200; ++repetition) {
    Eigen::MatrixXd score(4, 5);
    for (double& entry : score.reshaped()) entry = small(random);
    ASSERT_EQ(total(score, optimal_assignment(score)), best_total(score)) << score;
  }
}

TEST(OptimalAssignment, GivesNoColumnTwice) {
  std::vector<int> column_of = optimal_assignment(Eigen::MatrixXd::Zero(5, 6));
  std::sort(column_of.begin(), column_of.end());
  EXPECT_EQ(std::unique(column_of.begin(), column_of.end()), column_of.end());
  EXPECT_THAT(column_of, ::testing::Each(::testing::AllOf(::testing::Ge(0), ::testing::Lt(6))));
}

// Taking the highest entry first would leave 0.9 + 0.1; the other way round it is 0.8 + 0.8.
TEST(OptimalAssignment, DoesNotTakeTheHighestEntryFirst) {
  const Eigen::MatrixXd score = (Eigen::MatrixXd(2, 2) << 0.9, 0.8, 0.8, 0.1).finished();
  EXPECT_THAT(optimal_assignment(score), ::testing::ElementsAre(1, 0));
}

TEST(OptimalAssignment, IsEmptyForNothing) {
  EXPECT_TRUE(optimal_assignment(Eigen::MatrixXd(0, 3)).empty());
}

TEST(OptimalAssignment, RefusesMoreRowsThanColumns) {
  EXPECT_THROW(optimal_assignment(Eigen::MatrixXd::Zero(3, 2)), InvalidInput);
}

}  // namespace
}  // namespace mottle::dynamics
