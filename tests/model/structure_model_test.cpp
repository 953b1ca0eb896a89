#include "mottle/model/structure_model.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>
#include <limits>
#include <numbers>

#include "core/message_of.hpp"
#include "model/structures.hpp"
#include "mottle/model/structures/affine_matrices.hpp"

namespace mottle::model {
namespace {

using test::one_each;
using ::testing::HasSubstr;

constexpr double k_two_pi = 2.0 * std::numbers::pi;
constexpr double k_nan = std::numeric_limits<double>::quiet_NaN();

/// Three masses whose parameters are k1, k2, k5.
StructureModel three_masses(OutputSelection outputs) {
  return {separate(test::three_mass_system(), one_each({"spring:k1", "spring:k2", "spring:k5"})), std::move(outputs),
          Eigen::Vector3d::Ones()};
}

Eigen::RowVectorXd outputs_at(const Model& model, const Eigen::RowVectorXd& parameters) {
  return model.evaluate(parameters, {}).outputs.row(0);
}

/// The reason why a parameter vector fails, or "" where it does not.
std::string failure_at(const Model& model, const Eigen::RowVectorXd& parameters) {
  const Evaluation evaluation = model.evaluate(parameters, {});
  return evaluation.failures.empty() ? "" : evaluation.failures.front().reason;
}

/// One mass on a spring with a damper: parameters k, m, c.
StructureModel damped_mass() {
  const MassSpringSystem system{
      .masses = {{"m", 1.0}}, .springs = {{"k", k_ground, 0, 1.0}}, .dampers = {{"c", k_ground, 0, 0.1}}};
  return {separate(system, one_each({"spring:k", "mass:m", "damper:c"})),
          {.frequencies = {1}, .damping = {1}},
          Eigen::Vector3d(1.0, 1.0, 0.1)};
}

// lambda = 1, 4, 8 exactly: M = I, shapes (1, 1, 1), (1, -2, 1), (1, 0, -1).
TEST(StructureModel, GivesTheNominalFrequenciesOfTheThreeMasses) {
  const Eigen::RowVectorXd f = outputs_at(three_masses({.frequencies = {1, 2, 3}}), Eigen::RowVector3d::Ones());
  // Rounding of eigenvalues near ten: 1e-14.
  EXPECT_NEAR(f(0), 1.0 / k_two_pi, 1e-14);
  EXPECT_NEAR(f(1), 2.0 / k_two_pi, 1e-14);
  EXPECT_NEAR(f(2), std::sqrt(8.0) / k_two_pi, 1e-14);
}

// k1 = k2 = k5 = 2: lambda^3 - 17 lambda^2 + 82 lambda - 93 = 0 by hand; roots by numpy.linalg.eigvalsh (1.24).
TEST(StructureModel, GivesTheFrequenciesOfTheThreeMassesAtTheStart) {
  const Eigen::RowVectorXd f = outputs_at(three_masses({.frequencies = {1, 2, 3}}), Eigen::RowVector3d::Constant(2.0));
  EXPECT_NEAR(f(0), 0.20351425483058586, 1e-14);
  EXPECT_NEAR(f(1), 0.39688145068594455, 1e-14);
  EXPECT_NEAR(f(2), 0.48133366042913217, 1e-14);
}

TEST(StructureModel, GivesOutputsInTheOrderAskedFor) {
  const Eigen::RowVectorXd f = outputs_at(three_masses({.frequencies = {3, 1}}), Eigen::RowVector3d::Ones());
  EXPECT_NEAR(f(0), std::sqrt(8.0) / k_two_pi, 1e-14);
  EXPECT_NEAR(f(1), 1.0 / k_two_pi, 1e-14);
}

TEST(StructureModel, NamesOutputsAsATestFileDoes) {
  const StructureModel model =
      three_masses({.frequencies = {1, 3}, .shape_modes = {2}, .shape_degrees_of_freedom = {"m3", "m1"}});
  std::vector<std::string> names;
  for (const Quantity& output : model.outputs()) names.push_back(output.name() + " " + output.unit);
  EXPECT_THAT(names, ::testing::ElementsAre("f1 Hz", "f3 Hz", "phi2:m3 1/sqrt(kg)", "phi2:m1 1/sqrt(kg)"));
}

TEST(StructureModel, SaysWhatKindOfQuantityAnOutputIsAndOfWhichMode) {
  MassSpringSystem system = test::two_mass_system(1.0, 1.1, 1.0);
  system.masses[0].name = "7:+RX";
  system.masses[1].name = "7:+X";
  system.dampers = {{"c", k_ground, 0, 0.01}};
  const StructureModel model(separate(system, one_each({"spring:k1", "spring:k2"})),
                             {.frequencies = {2},
                              .shape_modes = {1},
                              .shape_degrees_of_freedom = {"7:+RX", "7:+X"},
                              .damping = {2},
                              .units = {.frequency = "kHz"}},
                             Eigen::Vector2d(1.0, 1.1));
  const std::vector<QuantityKind> kinds{QuantityKind::frequency, QuantityKind::rotation, QuantityKind::displacement,
                                        QuantityKind::damping_ratio};
  const std::vector<int> modes{2, 1, 1, 2};
  for (std::size_t k = 0; k < kinds.size(); ++k) {
    EXPECT_EQ(model.outputs()[k].kind, kinds[k]) << k;
    EXPECT_EQ(model.outputs()[k].number, modes[k]) << k;
  }
}

// K phi = lambda phi with lambda = 1, 8: phi = (1, 1, 1) / sqrt(3), (1, 0, -1) / sqrt(2).
TEST(StructureModel, GivesMassNormalisedShapesOfTheThreeMasses) {
  const StructureModel model = three_masses({.shape_modes = {1, 3}, .shape_degrees_of_freedom = {"m1", "m2", "m3"}});
  const Eigen::RowVectorXd shapes = outputs_at(model, Eigen::RowVector3d::Ones());
  EXPECT_LT((shapes.head(3).cwiseAbs().array() - 1.0 / std::sqrt(3.0)).abs().maxCoeff(), 1e-14);
  EXPECT_NEAR(std::abs(shapes(3)), 1.0 / std::sqrt(2.0), 1e-14);
  EXPECT_NEAR(shapes(4), 0.0, 1e-14);
  EXPECT_NEAR(shapes(5), -shapes(3), 1e-14);
}

// Mirror images: in the sample k1 and k2 have changed places, so its second shape is the reference's mirrored, and
// the sign that keeps it in phase with the reference is (m1, m2) -> (-m2, -m1). Of itself the larger entry is positive.
TEST(StructureModel, KeepsTheSignOfTheReferenceShapes) {
  const StructureModel model(separate(test::two_mass_system(1.0, 1.1, 1.0), one_each({"spring:k1", "spring:k2"})),
                             {.shape_modes = {2}, .shape_degrees_of_freedom = {"m1", "m2"}}, Eigen::Vector2d(1.0, 1.1));
  const Eigen::RowVectorXd reference = outputs_at(model, Eigen::RowVector2d(1.0, 1.1));
  const Eigen::RowVectorXd mirrored = outputs_at(model, Eigen::RowVector2d(1.1, 1.0));
  EXPECT_NEAR(mirrored(0), -reference(1), 1e-14);
  EXPECT_NEAR(mirrored(1), -reference(0), 1e-14);
}

// zeta = c / (2 sqrt(k m)).
TEST(StructureModel, GivesTheDampingRatioOfOneMass) {
  const Eigen::RowVectorXd y = outputs_at(damped_mass(), Eigen::RowVector3d(9.0, 4.0, 1.2));
  EXPECT_NEAR(y(0), 1.5 / k_two_pi, 1e-14);
  EXPECT_NEAR(y(1), 0.1, 1e-14);
}

TEST(StructureModel, AnOverdampedModeIsAFailureWithItsReason) {
  EXPECT_EQ(failure_at(damped_mass(), Eigen::RowVector3d(1.0, 1.0, 2.5)),
            "mode 1 does not oscillate: it is overdamped");
}

TEST(StructureModel, AnUnstableSampleIsAFailureWithItsReason) {
  EXPECT_EQ(failure_at(three_masses({.frequencies = {2, 1}}), Eigen::RowVector3d(-20.0, 1.0, 1.0)),
            "mode 1 is unstable: its eigenvalue is negative");
}

TEST(StructureModel, ASampleWithoutMassIsAFailureWithItsReason) {
  EXPECT_THAT(failure_at(damped_mass(), Eigen::RowVector3d(1.0, -1.0, 0.1)),
              HasSubstr("not positive semidefinite: the diagonal entry of row m is -1"));
  EXPECT_THAT(failure_at(damped_mass(), Eigen::RowVector3d(1.0, 0.0, 0.1)), HasSubstr("not positive definite"));
}

TEST(StructureModel, AParameterThatIsNotFiniteIsAFailureWithItsReason) {
  EXPECT_THAT(failure_at(damped_mass(), Eigen::RowVector3d(k_nan, 1.0, 0.1)), HasSubstr("not finite"));
  EXPECT_THAT(failure_at(damped_mass(), Eigen::RowVector3d(1.0, 1.0, k_nan)), HasSubstr("not finite"));
}

TEST(StructureModel, AFailureCostsItsOwnSampleAlone) {
  Eigen::MatrixXd samples = Eigen::MatrixXd::Ones(3, 3);
  samples(1, 2) = 2.5;  // critical is 2 sqrt(k m) = 2
  const Evaluation evaluation = damped_mass().evaluate(samples, {});
  ASSERT_EQ(evaluation.failures.size(), 1U);
  EXPECT_EQ(evaluation.failures[0].sample, 1);
  EXPECT_TRUE(evaluation.outputs.row(1).array().isNaN().all());
  EXPECT_TRUE(evaluation.outputs.row(0).allFinite() && evaluation.outputs.row(2).allFinite());
}

TEST(StructureModel, EvaluatesNoSampleToNothing) {
  const Evaluation evaluation = three_masses({.frequencies = {1}}).evaluate(Eigen::MatrixXd(0, 3), {});
  EXPECT_EQ(evaluation.outputs.rows(), 0);
  EXPECT_TRUE(evaluation.failures.empty());
}

std::string refusal(const OutputSelection& outputs) {
  return test::message_of<InvalidInput>([&] { three_masses(outputs); });
}

TEST(StructureModel, RefusesAModeThatIsNotThere) {
  EXPECT_EQ(refusal({.frequencies = {1, 4}}), "frequencies: mode 4 is not there, the model has modes 1 to 3");
  EXPECT_THAT(refusal({.shape_modes = {0}, .shape_degrees_of_freedom = {"m1"}}), HasSubstr("modes of shapes: mode 0"));
}

TEST(StructureModel, RefusesARepeatedMode) {
  EXPECT_EQ(refusal({.frequencies = {1, 2, 1}}), "frequencies: mode 1 is given twice");
}

TEST(StructureModel, RefusesADegreeOfFreedomThatIsNotThere) {
  EXPECT_THAT(refusal({.shape_modes = {1}, .shape_degrees_of_freedom = {"m4"}}), HasSubstr("did you mean 'm"));
}

TEST(StructureModel, RefusesARepeatedDegreeOfFreedom) {
  EXPECT_EQ(refusal({.shape_modes = {1}, .shape_degrees_of_freedom = {"m1", "m1"}}),
            "degrees of freedom of shapes: 'm1' is given twice");
}

TEST(StructureModel, NeedsAnOutput) {
  EXPECT_THAT(refusal({}), HasSubstr("outputs: none is named"));
  EXPECT_THAT(refusal({.shape_modes = {1}}), HasSubstr("degrees of freedom of shapes: none is named"));
}

TEST(StructureModel, RefusesTheDampingOfAnUndampedStructure) {
  EXPECT_EQ(refusal({.damping = {1}}), "damping ratios: the model has no damper");
}

TEST(StructureModel, RefusesAReferenceThatIsUnstable) {
  EXPECT_THAT(test::message_of<InvalidInput>([] {
                StructureModel(separate(test::three_mass_system(), one_each({"spring:k1"})), {.frequencies = {1}},
                               Eigen::VectorXd::Constant(1, -20.0));
              }),
              HasSubstr("unstable"));
}

TEST(StructureModel, RefusesAReferenceWithoutMass) {
  EXPECT_THAT(test::message_of<InvalidInput>([] {
                StructureModel(separate(test::three_mass_system(), one_each({"mass:m1"})), {.frequencies = {1}},
                               Eigen::VectorXd::Constant(1, -1.0));
              }),
              HasSubstr("not positive semidefinite: the diagonal entry of row m1 is -1"));
}

}  // namespace
}  // namespace mottle::model
