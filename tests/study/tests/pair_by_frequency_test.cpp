// Modes paired by ascending frequency, against the smallest sum over all assignments that keep the order.
#include "study/tests/pair_by_frequency.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <functional>
#include <random>

namespace mottle::study {
namespace {

std::vector<int> partners(const Eigen::VectorXd& tests, const Eigen::VectorXd& model) {
  std::vector<int> found;
  for (const FrequencyPair& pair : pair_in_order(tests, model)) found.push_back(pair.mode);
  return found;
}

double square(double test, double model) {
  return std::pow(std::log(model / test), 2);
}

/// Smallest sum by trying every assignment that keeps the order.
double smallest_sum(const Eigen::VectorXd& tests, const Eigen::VectorXd& model, Eigen::Index test, Eigen::Index first) {
  if (test == tests.size()) return 0.0;
  double best = square(1.0, 1.5) + smallest_sum(tests, model, test + 1, first);
  for (Eigen::Index mode = first; mode < model.size(); ++mode) {
    best = std::min(best, square(tests(test), model(mode)) + smallest_sum(tests, model, test + 1, mode + 1));
  }
  return best;
}

double sum_of(const Eigen::VectorXd& tests, const Eigen::VectorXd& model) {
  double sum = 0.0;
  for (const FrequencyPair& pair : pair_in_order(tests, model)) {
    sum += pair.mode < 0 ? square(1.0, 1.5) : square(tests(pair.test), model(pair.mode));
  }
  return sum;
}

TEST(PairInOrder, HasTheSmallestSumOfAllAssignmentsThatKeepTheOrder) {
  std::mt19937 random(7);
  std::uniform_real_distribution<double> step(0.01, 0.4);
  for (int trial = 0; trial < 200; ++trial) {
    Eigen::VectorXd tests(1 + trial % 5);
    Eigen::VectorXd model(1 + trial % 7);
    for (Eigen::VectorXd* list : {&tests, &model}) {
      double value = 1.0;
      for (double& one : *list) one = value *= 1.0 + step(random);
    }
    EXPECT_NEAR(sum_of(tests, model), smallest_sum(tests, model, 0, 0), 1e-12) << "trial " << trial;
  }
}

TEST(PairInOrder, PassesOverRigidBodyModesAndModesThatWereNotTested) {
  const Eigen::VectorXd model = (Eigen::VectorXd(6) << 0.0, 0.0, 10.0, 11.0, 20.0, 30.0).finished();
  EXPECT_EQ(partners(Eigen::Vector3d(9.5, 19.0, 31.0), model), (std::vector<int>{2, 4, 5}));
}

TEST(PairInOrder, LeavesAModeWithoutPartnerThatIsHalfAsFarAgain) {
  EXPECT_EQ(partners(Eigen::Vector2d(1.0, 10.0), Eigen::Vector2d(1.6, 10.5)), (std::vector<int>{-1, 1}));
  EXPECT_EQ(partners(Eigen::Vector2d(1.0, 10.0), Eigen::Vector2d(1.4, 10.5)), (std::vector<int>{0, 1}));
}

TEST(PairInOrder, DoubtsWhatIsFarOrAsNearToAnotherMode) {
  const auto pairs =
      pair_in_order(Eigen::Vector3d(10.0, 20.0, 30.0), (Eigen::VectorXd(4) << 10.1, 19.9, 20.1, 36.0).finished());
  EXPECT_FALSE(pairs[0].is_doubtful);
  EXPECT_TRUE(pairs[1].is_doubtful) << "two modes as near";
  EXPECT_EQ(pairs[1].mode + pairs[1].rival, 3) << "modes 1 and 2";
  EXPECT_EQ(pairs[0].rival, -1);
  EXPECT_EQ(pairs[2].rival, -1);
  EXPECT_TRUE(pairs[2].is_doubtful) << "20 % away";
  EXPECT_NEAR(pairs[2].difference, 0.2, 1e-14);
}

}  // namespace
}  // namespace mottle::study
