// Shapes of free size: the same outputs for every size and sign, derivatives, which component is no output, refusals.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>
#include <limits>

#include "core/message_of.hpp"
#include "fem/models.hpp"
#include "model/structures.hpp"
#include "mottle/model/solvers/exact_solver.hpp"
#include "mottle/model/structure_model.hpp"
#include "mottle/model/structures/affine_matrices.hpp"
#include "mottle/model/structures/finite_element_structure.hpp"

namespace mottle::model {
namespace {

using test::message_of;
using test::one_each;
using ::testing::ElementsAre;
using ::testing::HasSubstr;

StructureModel springs(ShapeSize size, std::vector<std::string> locations = {"m1", "m2", "m3"}) {
  return {separate(test::three_mass_system(), one_each({"spring:k1", "spring:k6", "mass:m2"})),
          {.frequencies = {1},
           .shape_modes = {1, 2},
           .shape_degrees_of_freedom = std::move(locations),
           .shape_size = size,
           .damping = {}},
          Eigen::Vector3d(1.0, 3.0, 1.0)};
}

std::vector<std::string> names(const std::vector<Quantity>& quantities) {
  std::vector<std::string> names;
  for (const Quantity& quantity : quantities) names.push_back(quantity.name());
  return names;
}

/// A cantilever of two beams along x whose parameter is Young's modulus of the outer one, in metres or millimetres.
StructureModel cantilever(double metre, std::vector<std::string> locations) {
  test::ModelMaker maker;
  maker.model.settings.coupled_mass = true;

  const double pressure = 1.0 / (metre * metre);  // newtons in both, tonnes where lengths are millimetres
  const double density = (metre == 1.0 ? 1.0 : 1e-3) / std::pow(metre, 3);
  const int inner = maker.material(1, 7e10 * pressure, 0.3, 2700.0 * density);
  const int outer = maker.material(2, 7e10 * pressure, 0.3, 2700.0 * density);
  const double length4 = std::pow(metre, 4);
  const int first = maker.beam_property(1, inner, 4e-4 * metre * metre, 2e-8 * length4, 5e-9 * length4, 1e-8 * length4);
  const int second =
      maker.beam_property(2, outer, 4e-4 * metre * metre, 2e-8 * length4, 5e-9 * length4, 1e-8 * length4);
  for (int k = 0; k < 3; ++k) maker.node(100 + k, {0.6 * metre * k, 0, 0});
  maker.beam(1, 0, 1, first);
  maker.beam(2, 1, 2, second);
  maker.model.fixed.emplace_back(0, k_all_components);
  const Eigen::VectorXd one = Eigen::VectorXd::Ones(1);
  auto structure = std::make_unique<FiniteElementStructure>(
      maker.model, std::vector<ParameterTargets>{{"E", {"MAT1:2:E"}, true}}, one);
  return {std::make_unique<ExactSolver>(std::move(structure)),
          {.shape_modes = {2}, .shape_degrees_of_freedom = std::move(locations), .shape_size = ShapeSize::free},
          one};
}

TEST(ShapeDirections, TheLargestComponentOfTheReferenceIsNoOutput) {
  const StructureModel model = springs(ShapeSize::free);
  // Mode 1 of k1..k5 = 1, k6 = 3 is (1 1 1) / sqrt(3): of equal components the first. Mode 2 is (1 -2 1) / sqrt(6).
  EXPECT_THAT(names(model.outputs()), ElementsAre("f1", "phi1:m2", "phi1:m3", "phi2:m1", "phi2:m3"));
  EXPECT_THAT(names(model.measured()),
              ElementsAre("f1", "phi1:m1", "phi1:m2", "phi1:m3", "phi2:m1", "phi2:m2", "phi2:m3"));
}

TEST(ShapeDirections, AtTheReferenceAreItsShapes) {
  const Eigen::RowVector3d reference(1.0, 3.0, 1.0);
  const Eigen::RowVectorXd whole = springs(ShapeSize::mass_normalised).evaluate(reference, {}).outputs;
  const Eigen::RowVectorXd directions = springs(ShapeSize::free).evaluate(reference, {}).outputs;
  EXPECT_NEAR(directions(1), whole(2), 1e-14);
  EXPECT_NEAR(directions(4), whole(6), 1e-14);
}

TEST(ShapeDirections, DoNotDependOnSizeAndSignOfTheMeasuredShape) {
  const StructureModel model = springs(ShapeSize::free);
  const Eigen::RowVector3d parameters(1.4, 2.5, 1.3);
  Eigen::RowVectorXd test = springs(ShapeSize::mass_normalised).evaluate(parameters, {}).outputs;
  test.segment(1, 3) *= -250.0;
  test.segment(4, 3) *= 1e-6;
  const Eigen::MatrixXd outputs = model.outputs_of(test);
  EXPECT_TRUE(outputs.isApprox(model.evaluate(parameters, {}).outputs, 1e-13)) << outputs;
}

TEST(ShapeDirections, DifferForEveryDirection) {
  const StructureModel model = springs(ShapeSize::free, {"m1", "m2"});
  // Mode 1 at m1 and m2 from -39 to 39 degrees about the reference's (1 1): phi(m2) / phi(m1), the first is no output.
  double last = -1.0;
  for (double angle = 6.0; angle < 85.0; angle += 1.0) {
    const double radians = angle * std::acos(-1.0) / 180.0;
    Eigen::RowVectorXd test = Eigen::RowVectorXd::Ones(5);
    test.segment(1, 2) << 7.0 * std::cos(radians), 7.0 * std::sin(radians);
    const double output = model.outputs_of(test)(1);
    EXPECT_GT(output, last) << angle;
    last = output;
  }
}

TEST(ShapeDirections, StayRightForZeroOrthogonalAndHugeShapes) {
  const StructureModel model = springs(ShapeSize::free, {"m1", "m2"});
  const auto output = [&](double one, double other) {
    Eigen::RowVectorXd test = Eigen::RowVectorXd::Ones(5);
    test.segment(1, 2) << one, other;
    return model.outputs_of(test)(1);
  };
  EXPECT_TRUE(std::isnan(output(0.0, 0.0)));
  EXPECT_TRUE(std::isnan(output(1.0, -0.9)));
  EXPECT_NEAR(output(1e-200, 2e-200), output(1.0, 2.0), 1e-14);
  EXPECT_NEAR(output(-1e180, -2e180), output(1.0, 2.0), 1e-14);
}

TEST(ShapeDirections, AreMissingWhereAComponentIsMissing) {
  const StructureModel model = springs(ShapeSize::free);
  Eigen::RowVectorXd test = springs(ShapeSize::mass_normalised).evaluate(Eigen::RowVector3d(1, 3, 1), {}).outputs;
  test(1) = std::numeric_limits<double>::quiet_NaN();
  const Eigen::MatrixXd outputs = model.outputs_of(test);
  EXPECT_TRUE(std::isnan(outputs(1)) && std::isnan(outputs(2))) << outputs;
  EXPECT_FALSE(outputs.rightCols(2).hasNaN() || std::isnan(outputs(0))) << outputs;
}

TEST(ShapeDirections, HaveTheDerivativesOfDifferences) {
  const StructureModel model = springs(ShapeSize::free);
  const Eigen::Vector3d point(1.4, 2.5, 1.3);
  const Eigen::MatrixXd jacobian = model.jacobian(point);
  constexpr double k_step = 1e-5;
  for (Eigen::Index i = 0; i < 3; ++i) {
    const Eigen::Vector3d step = k_step * Eigen::Vector3d::Unit(i);
    const Eigen::VectorXd difference = (model.evaluate((point + step).transpose(), {}).outputs -
                                        model.evaluate((point - step).transpose(), {}).outputs)
                                           .transpose() /
                                       (2.0 * k_step);
    // Central differences: truncation 1e-10 and rounding 1e-11 of outputs of size 1.
    EXPECT_TRUE(difference.isApprox(jacobian.col(i), 1e-8)) << difference << "\n\n" << jacobian.col(i);
  }
}

TEST(ShapeDirections, ScaleByTranslationsSoThatTheUnitOfLengthDoesNotMatter) {
  const std::vector<std::string> locations{"101:+Y", "101:+RZ", "102:+Y"};
  const Eigen::MatrixXd sample = Eigen::MatrixXd::Constant(1, 1, 1.7);
  const StructureModel metres = cantilever(1.0, locations);
  const StructureModel millimetres = cantilever(1000.0, locations);
  ASSERT_EQ(names(metres.outputs()), names(millimetres.outputs()));
  const auto change = [&](const StructureModel& model) {
    const Eigen::ArrayXXd moved = model.evaluate(sample, {}).outputs.array();
    return (moved / model.evaluate(Eigen::MatrixXd::Ones(1, 1), {}).outputs.array()).matrix().eval();
  };
  EXPECT_TRUE(change(metres).isApprox(change(millimetres), 1e-8)) << change(metres) << "\n" << change(millimetres);
  EXPECT_GT((change(metres).array() - 1.0).abs().minCoeff(), 1e-3);  // it is a change that is compared
}

TEST(ShapeDirections, RefuseASingleComponent) {
  EXPECT_THAT(message_of<InvalidInput>([] { springs(ShapeSize::free, {"m2"}); }), HasSubstr("one component alone"));
}

}  // namespace
}  // namespace mottle::model
