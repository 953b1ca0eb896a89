// Ratios of shape components against closed forms, differences and the shapes that they are made of.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>
#include <utility>

#include "core/message_of.hpp"
#include "model/structures.hpp"
#include "mottle/model/structure_model.hpp"
#include "mottle/model/structures/affine_matrices.hpp"

namespace mottle::model {
namespace {

using test::one_each;
using ::testing::HasSubstr;

StructureModel three_masses(OutputSelection outputs) {
  return {separate(test::three_mass_system(), one_each({"spring:k1", "mass:m2", "spring:k6"})), std::move(outputs),
          Eigen::Vector3d(1.2, 0.9, 2.8)};
}

// Two equal masses on springs k to ground, tied by kc, of which the first spring is k + d: with lambda the eigenvalue,
// (k + d + kc - lambda) phi_1 = kc phi_2, so phi_2 / phi_1 = (k + d + kc - lambda) / kc, and lambda solves a quadratic.
TEST(ShapeRatios, HaveTheClosedFormOfTwoMasses) {
  const double k = 2.0;
  const double kc = 0.7;
  const StructureModel model(separate(test::two_mass_system(k, k, kc), one_each({"spring:k1"})),
                             {.shape_ratios = {{1, "m2", "m1"}, {2, "m2", "m1"}, {1, "m1", "m2"}}},
                             Eigen::VectorXd::Constant(1, k));
  for (const double d : {0.0, 0.5}) {
    const Eigen::RowVectorXd ratios = model.evaluate(Eigen::MatrixXd::Constant(1, 1, k + d), {}).outputs.row(0);
    const double middle = k + kc + 0.5 * d;
    const double half = std::hypot(0.5 * d, kc);
    EXPECT_NEAR(ratios(0), (k + d + kc - (middle - half)) / kc, 1e-13);
    EXPECT_NEAR(ratios(1), (k + d + kc - (middle + half)) / kc, 1e-13);
    EXPECT_NEAR(ratios(2), 1.0 / ratios(0), 1e-13);
  }
}

TEST(ShapeRatios, DerivativesAreThoseOfCentralDifferences) {
  const StructureModel model = three_masses(
      {.frequencies = {1}, .shape_ratios = {{1, "m2", "m1"}, {3, "m1", "m3"}, {3, "m2", "m1"}, {2, "m1", "m2"}}});
  const Eigen::Vector3d x(1.4, 0.9, 2.5);
  const Eigen::MatrixXd jacobian = model.jacobian(x);
  constexpr double k_step = 1e-5;  // truncation of order 1e-10, rounding 1e-15 / 1e-5
  for (Eigen::Index i = 0; i < x.size(); ++i) {
    Eigen::MatrixXd ends = x.transpose().replicate(2, 1);
    ends(0, i) -= k_step;
    ends(1, i) += k_step;
    const Eigen::MatrixXd y = model.evaluate(ends, {}).outputs;
    const Eigen::VectorXd differences = (y.row(1) - y.row(0)).transpose() / (2.0 * k_step);
    EXPECT_LT((jacobian.col(i) - differences).cwiseAbs().maxCoeff(), 1e-8) << i;
  }
}

TEST(ShapeRatios, AreThoseOfTheShapesComponents) {
  const StructureModel model = three_masses({.shape_modes = {2},
                                             .shape_degrees_of_freedom = {"m1", "m2", "m3"},
                                             .shape_ratios = {{2, "m1", "m2"}, {2, "m3", "m2"}}});
  const Eigen::RowVectorXd y = model.evaluate(Eigen::RowVector3d(1.2, 1.1, 2.0), {}).outputs.row(0);
  EXPECT_NEAR(y(3), y(0) / y(1), 1e-14);
  EXPECT_NEAR(y(4), y(2) / y(1), 1e-14);
}

TEST(ShapeRatios, AreNamedByModeAndBothDegreesOfFreedom) {
  const StructureModel model = three_masses({.shape_ratios = {{2, "m1", "m2"}}});
  EXPECT_EQ(model.outputs()[0].name(), "ratio2:m1/m2");
  EXPECT_EQ(model.outputs()[0].unit, "-");
  EXPECT_EQ(shape_ratio(1, "7:+RX", "8:+Z", "mm").unit, "1/mm");
  EXPECT_EQ(shape_ratio(1, "8:+Z", "7:+RX", "mm").unit, "mm");
  EXPECT_EQ(shape_ratio(1, "7:+RX", "8:+RZ", "mm").unit, "-");
}

// Masses 1 and 2 swing against each other about a node at the middle one.
TEST(ShapeRatios, ADenominatorAtANodeOfTheModeIsRefused) {
  const MassSpringSystem system{
      .masses = {{"m1", 1.0}, {"m2", 1.0}, {"m3", 1.0}},
      .springs = {{"k1", k_ground, 0, 1.0}, {"k2", 0, 1, 1.0}, {"k3", 1, 2, 1.0}, {"k4", 2, k_ground, 1.0}},
      .dampers = {}};
  const auto make = [&] {
    StructureModel(separate(system, one_each({"spring:k1"})), {.shape_ratios = {{2, "m1", "m2"}}},
                   Eigen::VectorXd::Ones(1));
  };
  EXPECT_THAT(test::message_of<InvalidInput>(make), HasSubstr("shape_ratios: mode 2 does not move 'm2'"));
}

TEST(ShapeRatios, ATwofoldOrUnknownRatioIsRefused) {
  const auto make = [](std::vector<ShapeRatio> ratios) {
    return test::message_of<InvalidInput>([&] { three_masses({.shape_ratios = ratios}); });
  };
  EXPECT_THAT(make({{1, "m1", "m2"}, {1, "m1", "m2"}}), HasSubstr("is given twice"));
  EXPECT_THAT(make({{4, "m1", "m2"}}), HasSubstr("mode 4 is not there"));
  EXPECT_THAT(make({{1, "m1", "m9"}}), HasSubstr("m9"));
}

}  // namespace
}  // namespace mottle::model
