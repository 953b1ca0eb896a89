// Pairing of measured modes with a model whose shapes are the columns of the identity: three masses on springs to
// ground.
#include "study/tests/pair_modes.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>
#include <numbers>

#include "core/message_of.hpp"
#include "mottle/core/error.hpp"
#include "mottle/model/structure_model.hpp"
#include "mottle/model/structures/affine_matrices.hpp"

namespace mottle::study {
namespace {

using ::testing::ElementsAre;
using ::testing::HasSubstr;
using ::testing::IsEmpty;

/// Frequencies 10, 20 and 30 Hz, mass-normalised shapes e_1, e_2, e_3.
double stiffness(int mode) {
  return std::pow(2.0 * std::numbers::pi * 10.0 * mode, 2);
}
StructureModel model(ShapeSize size = ShapeSize::mass_normalised) {
  MassSpringSystem system;
  for (const char* name : {"1:+X", "1:+Y", "1:+Z"}) system.masses.push_back({name, 1.0});
  for (int k = 0; k < 3; ++k) system.springs.push_back({std::string("k") + "123"[k], k_ground, k, stiffness(k + 1)});
  const std::vector<ParameterTargets> targets = {{"k1", {"spring:k1"}, false}};
  return {separate(system, targets),
          {.frequencies = {1, 2, 3},
           .shape_modes = {1, 2},
           .shape_degrees_of_freedom = {"1:+X", "1:+Y"},
           .shape_size = size},
          Eigen::VectorXd::Constant(1, stiffness(1))};
}

/// Modes in the order 2, 1, 3 with some components mixed, at node 1 in a frame of one's own.
MeasuredModes measured(const Eigen::Matrix3d& axes, const Eigen::Matrix3d& global_shapes) {
  MeasuredModes modes;
  modes.file = "a.uff";
  for (int axis = 0; axis < 3; ++axis) {
    modes.components.push_back({.node = 1, .direction = axes.col(axis), .axis = axis});
  }
  modes.frequencies = Eigen::Vector3d(20.0, 10.0, 30.0);
  modes.damping = Eigen::Vector3d::Constant(std::nan(""));
  modes.collinearity = Eigen::Vector3d::Ones();
  modes.shapes = axes.transpose() * global_shapes;
  modes.has_own_axes = !axes.isIdentity();
  modes.is_scaled = {true, true, true};
  return modes;
}

const Eigen::Matrix3d k_swapped = (Eigen::Matrix3d() << 0, 1, 0, -1, 0, 0, 0, 0, 1).finished();  // modes -2, 1, 3

TEST(PairModes, TurnsLocalComponentsIntoTheModels) {
  const double c = std::cos(0.6);
  const double s = std::sin(0.6);
  const Eigen::Matrix3d axes = (Eigen::Matrix3d() << c, 0, s, 0, -1, 0, s, 0, -c).finished();
  const PairedModes paired = pair_modes(model(), {measured(axes, k_swapped)}, true);
  const Eigen::RowVectorXd expected = (Eigen::RowVectorXd(7) << 10, 20, 30, 1, 0, 0, 1).finished();
  EXPECT_TRUE(paired.values.isApprox(expected, 1e-12)) << paired.values;
  EXPECT_THAT(paired.notes, ElementsAre(HasSubstr("a.uff: shapes taken in the nodes' own axes (sum of MAC 3.00, in")));
}

// NX Correlation writes datasets 2420 and 2414 so: own axes at the nodes, global numbers.
TEST(PairModes, TakesGlobalNumbersAtNodesWithOwnAxesForWhatTheyAre) {
  const double c = std::cos(0.6);
  const double s = std::sin(0.6);
  const Eigen::Matrix3d axes = (Eigen::Matrix3d() << c, 0, s, 0, -1, 0, s, 0, -c).finished();
  MeasuredModes modes = measured(axes, k_swapped);
  modes.shapes = k_swapped;
  const PairedModes paired = pair_modes(model(), {modes}, true);
  const Eigen::RowVectorXd expected = (Eigen::RowVectorXd(7) << 10, 20, 30, 1, 0, 0, 1).finished();
  EXPECT_TRUE(paired.values.isApprox(expected, 1e-12)) << paired.values;
  EXPECT_THAT(paired.notes, ElementsAre(HasSubstr("a.uff: shapes taken in global axes")));
}

TEST(PairModes, NotesNothingWhereNothingIsInDoubt) {
  EXPECT_THAT(pair_modes(model(), {measured(Eigen::Matrix3d::Identity(), k_swapped)}, true).notes, IsEmpty());
}

TEST(PairModes, GivesNoComponentThatTheMeasuredDirectionsDoNotSpan) {
  const double c = std::sqrt(0.5);
  MeasuredModes modes = measured((Eigen::Matrix3d() << c, -c, 0, c, c, 0, 0, 0, 1).finished(), k_swapped);
  modes.shapes.row(1).setConstant(std::nan(""));  // of the two askew directions in the plane one is left
  const PairedModes paired = pair_modes(model(), {modes}, true);
  EXPECT_TRUE(paired.values.rightCols(4).array().isNaN().all()) << paired.values;
  EXPECT_EQ(paired.values(2), 30.0);
}

TEST(PairModes, ScalesShapesOfFreeSizeToTheModels) {
  MeasuredModes modes = measured(Eigen::Matrix3d::Identity(), 50.0 * k_swapped);
  modes.is_scaled = {false, false, false};
  const PairedModes paired = pair_modes(model(ShapeSize::free), {modes}, true);
  EXPECT_NEAR(paired.values(3), 1.0, 1e-12);
  EXPECT_NEAR(paired.values(6), 1.0, 1e-12);
  EXPECT_THAT(paired.notes, IsEmpty());
}

TEST(PairModes, UsesNoShapeWithoutModalMassWhereTheSizeIsData) {
  MeasuredModes modes = measured(Eigen::Matrix3d::Identity(), k_swapped);
  modes.is_scaled = {true, false, true};  // the model's mode 1 is the second of the test
  const PairedModes paired = pair_modes(model(ShapeSize::by_tests), {modes}, true);
  EXPECT_TRUE(std::isnan(paired.values(3)) && std::isnan(paired.values(4))) << paired.values;
  EXPECT_FALSE(paired.values.leftCols(3).hasNaN() || paired.values.rightCols(2).hasNaN()) << paired.values;
  EXPECT_THAT(paired.notes, ElementsAre(HasSubstr("specimen 1 mode 1.")));
}

TEST(PairModes, SaysWhatIsDoubtfulMissingAndLeftOut) {
  Eigen::Matrix3d shapes = k_swapped;
  shapes.col(0) << 0.66, -0.75, 0.0;  // MAC 0.56 with mode 2, 0.44 with mode 1: too low and too near
  MeasuredModes modes = measured(Eigen::Matrix3d::Identity(), shapes);
  modes.collinearity(1) = 0.7;
  shapes.col(2) << 1.0, 1.0, 1.0;  // MAC 1/3 with each
  const PairedModes paired = pair_modes(model(), {modes, measured(Eigen::Matrix3d::Identity(), shapes)}, true);
  EXPECT_TRUE(std::isnan(paired.values(1, 2)));
  EXPECT_EQ(paired.values(1, 0), 10.0);
  ASSERT_EQ(paired.notes.size(), 2U);
  EXPECT_EQ(paired.notes[0], "Modes that were not found: specimen 2 mode 3.");
  EXPECT_THAT(paired.notes[1], HasSubstr("specimen 1 mode 1 (phase collinearity 0.70)"));
  EXPECT_THAT(paired.notes[1], HasSubstr("specimen 1 mode 2 (MAC 0.56"));
  EXPECT_THAT(paired.table, HasSubstr("a.uff,missing,"));
  EXPECT_THAT(paired.table, HasSubstr("a.uff,left out,it fits no mode well enough"));
}

// Modes at 10 and 10.5 Hz turned by 40 degrees: MAC 0.59 each, and the plane of both is the model's.
TEST(PairModes, PairsCloseModesThatHaveMixedByWhatTheySpan) {
  MassSpringSystem system;
  OutputSelection outputs{.frequencies = {1, 2}, .minimum_mac = 0.7};
  const double frequencies[] = {1.0, 1.05, 3.0, 4.0};
  for (int k = 0; k < 4; ++k) {
    system.masses.push_back({std::string("m") + "1234"[k], 1.0});
    system.springs.push_back({std::string("k") + "1234"[k], k_ground, k, std::pow(frequencies[k], 2) * stiffness(1)});
  }
  const StructureModel close{separate(system, {{"k1", {"spring:k1"}, false}}), outputs,
                             Eigen::VectorXd::Constant(1, stiffness(1))};
  const double c = std::cos(0.7);
  const double s = std::sin(0.7);
  MeasuredModes modes{.file = "a.uff",
                      .frequencies = Eigen::Vector2d(10.1, 10.4),
                      .damping = Eigen::Vector2d::Constant(std::nan("")),
                      .shapes = (Eigen::MatrixXd(4, 2) << c, -s, s, c, 0.01, 0.01, 0.01, 0.01).finished(),
                      .collinearity = Eigen::Vector2d::Ones(),
                      .is_scaled = {true, true}};
  for (const auto& mass : system.masses) modes.components.push_back({.name = mass.name});
  const PairedModes paired = pair_modes(close, {modes}, true);
  EXPECT_EQ(paired.values, Eigen::RowVector2d(10.1, 10.4));
  EXPECT_THAT(
      paired.notes,
      ElementsAre(HasSubstr("specimen 1 mode 1 (MAC 0.58, 1.00 together with mode 2, which is close in frequency")));
  modes.shapes.col(1) << -s, 0.0, c, 0.0;  // into the third mode: nothing close
  EXPECT_TRUE(pair_modes(close, {modes}, true).values.hasNaN());
}

TEST(PairModes, DoubtsAModalMassThatIsFarFromTheModels) {
  const PairedModes paired = pair_modes(model(), {measured(Eigen::Matrix3d::Identity(), 7.0 * k_swapped)}, true);
  ASSERT_EQ(paired.notes.size(), 1U);
  EXPECT_THAT(paired.notes[0], HasSubstr("it is 7 times as large as the model's"));
}

TEST(PairModes, PairsByRankInFrequencyWhereAsked) {
  MeasuredModes modes = measured(Eigen::Matrix3d::Identity(), k_swapped);
  modes.components = {{.name = "a"}, {.name = "b"}, {.name = "c"}};
  EXPECT_EQ(pair_modes(model(), {modes}, false).values.leftCols(3), Eigen::RowVector3d(10, 20, 30));
  EXPECT_THAT(test::message_of<InvalidInput>([&] { pair_modes(model(), {modes}, true); }),
              HasSubstr("a.uff: none of its 3 measured degrees of freedom is in the model"));
}

}  // namespace
}  // namespace mottle::study
