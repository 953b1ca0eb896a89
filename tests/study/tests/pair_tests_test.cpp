#include "study/tests/pair_tests.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <limits>

#include "mottle/core/error.hpp"

namespace mottle::study {
namespace {

constexpr double k_missing = std::numeric_limits<double>::quiet_NaN();

OutputSelection three_modes() {
  return {.frequencies = {1, 2, 4}, .shape_modes = {1, 2, 4}, .shape_degrees_of_freedom = {"a", "b", "c"}};
}

TEST(PairTests, AMeasuredModeMovesToTheNumberOfItsShape) {
  // The test found the model's second mode first, upside down: frequencies 20, 10, 40.
  Eigen::MatrixXd values(1, 12);
  values << 20, 10, 40, 0, -1, 0, 1, 0, 0, 0, 0, 2;
  const auto notes = pair_tests(values, three_modes(), Eigen::Matrix3d::Identity());
  Eigen::RowVectorXd expected(12);
  expected << 10, 20, 40, 1, 0, 0, 0, 1, 0, 0, 0, 2;
  EXPECT_EQ((values - expected).cwiseAbs().maxCoeff(), 0.0) << values;
  ASSERT_EQ(notes.size(), 1U);
  EXPECT_NE(notes[0].find("specimen 1 mode 2 is the model's 1 (MAC 1.00)"), std::string::npos) << notes[0];
}

TEST(PairTests, EigenvaluesAndRatiosMoveWithTheirModes) {
  OutputSelection outputs = three_modes();
  outputs.static_loads = {{{{"a", 1.0}}, {"a", "b"}}};
  outputs.eigenvalues = {1, 2};
  outputs.shape_ratios = {{1, "a", "b"}, {2, "a", "b"}, {1, "b", "c"}};
  Eigen::MatrixXd values(1, 19);  // the test's modes 1 and 2 are the model's 2 and 1
  values << 20, 10, 40, 0, 1, 0, 1, 0, 0, 0, 0, 2, 7, 8, 0.1, 0.2, 3, 4, 5;
  pair_tests(values, outputs, Eigen::Matrix3d::Identity());
  Eigen::RowVectorXd expected(6);
  expected << 7, 8, 0.2, 0.1, 4, 3;
  EXPECT_EQ(values.row(0).segment(12, 6), expected) << values;
  EXPECT_TRUE(std::isnan(values(0, 18)));  // of the test's mode 2 this ratio was not measured
}

TEST(PairTests, AShapeThatNoSignMakesLikeTheModelsIsNamedWithItsSpecimen) {
  OutputSelection outputs{.frequencies = {1}, .shape_modes = {1}, .shape_degrees_of_freedom = {"a", "b", "c"}};
  const Eigen::Vector3d reference(1.0, 1.0, 1.0);
  Eigen::MatrixXd values(3, 4);
  values << 10, 1, 1, 1, 10, 1, -1, 1, 10, 0.9, 1, k_missing;
  const std::string sentence = unlike_shapes(values, outputs, reference, {4, 6, 9});
  EXPECT_NE(sentence.find("specimen 6 mode 1 (MAC 0.11)"), std::string::npos) << sentence;
  EXPECT_NE(sentence.find("With the other sign of b they are alike"), std::string::npos) << sentence;
  EXPECT_EQ(sentence.find("specimen 4"), std::string::npos) << sentence;
  EXPECT_EQ(sentence.find("specimen 9"), std::string::npos) << sentence;
}

TEST(PairTests, DampingRatiosMoveWithTheirModesAndOthersStay) {
  OutputSelection outputs = three_modes();
  outputs.damping = {2, 1};
  outputs.static_loads = {{{{"a", 1.0}}, {"a"}}};
  Eigen::MatrixXd values(1, 15);  // the test's modes 1 and 2 are the model's 2 and 1
  values << 20, 10, 40, 0, 1, 0, 1, 0, 0, 0, 0, 2, 0.1, 0.2, 7;
  pair_tests(values, outputs, Eigen::Matrix3d::Identity());
  EXPECT_EQ(values(0, 12), 0.2);  // zeta2 is the ratio of the test's mode 1
  EXPECT_EQ(values(0, 13), 0.1);
  EXPECT_EQ(values(0, 14), 7.0);
}

TEST(PairTests, AModeThatFitsNoneIsLeftOut) {
  Eigen::MatrixXd values(1, 12);
  const double third = std::sqrt(1.0 / 3.0);  // MAC 1/3 with each
  values << 10, 20, 40, 1, 0, 0, 0, 1, 0, third, third, third;
  Eigen::MatrixXd expected = values;
  const auto notes = pair_tests(values, three_modes(), Eigen::Matrix3d::Identity());
  EXPECT_TRUE(std::isnan(values(0, 2)));
  EXPECT_TRUE(values.row(0).tail(3).array().isNaN().all());
  EXPECT_EQ(values(0, 0), 10.0);
  ASSERT_EQ(notes.size(), 1U);
  EXPECT_NE(notes[0].find("specimen 1 mode 4"), std::string::npos) << notes[0];
}

TEST(PairTests, AModeWithAMissingComponentCountsAsNotMeasured) {
  Eigen::MatrixXd values(1, 12);
  values << 10, 20, 40, 1, 0, 0, 0, k_missing, 0, 0, 0, 1;
  EXPECT_TRUE(pair_tests(values, three_modes(), Eigen::Matrix3d::Identity()).empty());
  EXPECT_TRUE(std::isnan(values(0, 1)));
  EXPECT_EQ(values(0, 2), 40.0);
}

TEST(PairTests, ShapesThatStandUpsideDownAreTurned) {
  Eigen::Matrix3d reference;
  reference << 1, 1, 0.1, 2, 0, 0.1, 3, -1, 0.1;
  Eigen::MatrixXd values(1, 12);
  // Mode 1 upside down with a component missing; mode 2 as it is; of mode 4 one component, whose sign noise may turn.
  values << 10, 20, 40, k_missing, -2.1, -2.9, 1.1, 0.1, -1, k_missing, -0.1, k_missing;
  const std::string note = turn_shapes(values, three_modes(), reference);
  EXPECT_NE(note.find("turned, 1: specimen 1 mode 1."), std::string::npos) << note;
  EXPECT_EQ(values(0, 4), 2.1);
  EXPECT_EQ(values(0, 5), 2.9);
  EXPECT_TRUE(std::isnan(values(0, 3)));
  EXPECT_EQ(values(0, 6), 1.1);
  EXPECT_EQ(values(0, 10), -0.1);
  EXPECT_TRUE(turn_shapes(values, three_modes(), reference).empty());
}

TEST(PairTests, NeedsShapesOfTheSameModesAsTheFrequencies) {
  Eigen::MatrixXd values(1, 4);
  OutputSelection outputs = three_modes();
  outputs.frequencies = {1};
  EXPECT_THROW(pair_tests(values, outputs, Eigen::Matrix3d::Identity()), InvalidInput);
  outputs.shape_modes.clear();
  EXPECT_THROW(pair_tests(values, outputs, Eigen::Matrix3d::Identity()), InvalidInput);
}

}  // namespace
}  // namespace mottle::study
