// Displacements under loads against closed forms: springs, a cantilever, structures that cannot carry the load.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>
#include <memory>
#include <utility>

#include "core/message_of.hpp"
#include "fem/models.hpp"
#include "model/structures.hpp"
#include "mottle/model/solvers/reduced_solver.hpp"
#include "mottle/model/structure_model.hpp"
#include "mottle/model/structures/affine_matrices.hpp"
#include "mottle/model/structures/finite_element_structure.hpp"

namespace mottle::model {
namespace {

using test::one_each;
using ::testing::HasSubstr;

constexpr double k_young = 7e10, k_inertia = 2e-8, k_length = 1.2;

StructureModel springs(const std::vector<std::string>& targets, OutputSelection outputs,
                       MassSpringSystem system = test::three_mass_system()) {
  return {separate(system, one_each(targets)), std::move(outputs),
          Eigen::VectorXd::Ones(static_cast<Eigen::Index>(targets.size()))};
}

/// A cantilever along x of `parts` beams whose parameters are factors on Young's modulus and on the density.
StructureModel cantilever(int parts, OutputSelection outputs, bool reduces = false, bool is_fixed = true) {
  test::ModelMaker maker;
  maker.model.settings.coupled_mass = true;
  const int metal = maker.material(1, k_young, 0.3, 2700.0);
  const int section = maker.beam_property(1, metal, 4e-4, k_inertia, 5e-9, 1e-8);
  for (int k = 0; k <= parts; ++k) maker.node(100 + k, {k_length * k / parts, 0, 0});
  for (int k = 0; k < parts; ++k) maker.beam(k + 1, k, k + 1, section);
  if (is_fixed) maker.model.fixed.emplace_back(0, k_all_components);
  const std::vector<ParameterTargets> parameters{{"E", {"MAT1:1:E"}, true}, {"rho", {"MAT1:1:RHO"}, true}};
  auto structure = std::make_unique<FiniteElementStructure>(maker.model, parameters, Eigen::Vector2d::Ones());
  std::optional<ReductionSettings> reduction;
  if (reduces) {
    Eigen::MatrixXd training(20, 2);
    training.col(0) = Eigen::VectorXd::LinSpaced(20, 0.8, 1.2);
    training.col(1) = Eigen::VectorXd::LinSpaced(20, 1.1, 0.9);
    reduction = {.prior = {Eigen::Vector2d::Ones(), training}};
  }
  return {make_sparse_solver(std::move(structure), std::move(reduction)), std::move(outputs), Eigen::Vector2d::Ones()};
}

// K = [5 -1 -3; -1 3 -1; -3 -1 5], det K = 32: K^-1 by its cofactors.
TEST(StaticDisplacements, AreCofactorsOverTheDeterminantForThreeMasses) {
  const StructureModel model = springs(
      {"spring:k1"}, {.static_loads = {{{{"m3", 1.0}}, {"m1", "m2", "m3"}}, {{{"m1", 2.0}, {"m2", -4.0}}, {"m2"}}}});
  const Eigen::MatrixXd u = model.evaluate(Eigen::MatrixXd::Ones(1, 1), {}).outputs;
  EXPECT_NEAR(u(0), 10.0 / 32.0, 1e-15);
  EXPECT_NEAR(u(1), 8.0 / 32.0, 1e-15);
  EXPECT_NEAR(u(2), 14.0 / 32.0, 1e-15);
  EXPECT_NEAR(u(3), (2.0 * 8.0 - 4.0 * 16.0) / 32.0, 1e-15);
}

TEST(StaticDisplacements, AreNamedByLoadAndDegreeOfFreedom) {
  const StructureModel model =
      cantilever(2, {.frequencies = {1},
                     .static_loads = {{{{"102:+Y", 1.0}}, {"102:+Y", "102:+RZ"}}, {{{"102:+RZ", 1.0}}, {"101:+Y"}}},
                     .units = unit_names("mm-t-s")});
  std::vector<std::string> names;
  for (const Quantity& output : model.outputs()) names.push_back(output.name() + " " + output.unit);
  EXPECT_EQ(names, (std::vector<std::string>{"f1 Hz", "u1:102:+Y mm", "u1:102:+RZ rad", "u2:101:+Y mm"}));
  EXPECT_EQ(model.outputs()[1].kind, QuantityKind::static_displacement);
  EXPECT_EQ(model.outputs()[2].kind, QuantityKind::static_rotation);
}

// w(L) = F L^3 / (3 E I), w'(L) = F L^2 / (2 E I); under a moment w(L) = M L^2 / (2 E I). One element is exact.
TEST(StaticDisplacements, AgreeWithBeamTheoryForACantilever) {
  for (const int parts : {1, 7}) {
    const std::string tip = std::to_string(100 + parts);
    const StructureModel model =
        cantilever(parts, {.static_loads = {{{{tip + ":+Y", 30.0}}, {tip + ":+Y", tip + ":+RZ"}},
                                            {{{tip + ":+RZ", 5.0}}, {tip + ":+Y"}}}});
    constexpr double k_factor = 1.25;  // on E
    const Eigen::MatrixXd u = model.evaluate(Eigen::RowVector2d(k_factor, 0.7), {}).outputs;
    const double bending = k_factor * k_young * k_inertia;
    // Relative rounding of a factor whose condition number is about 1e6.
    EXPECT_NEAR(u(0) / (30.0 * std::pow(k_length, 3) / (3.0 * bending)), 1.0, 1e-9);
    EXPECT_NEAR(u(1) / (30.0 * std::pow(k_length, 2) / (2.0 * bending)), 1.0, 1e-9);
    EXPECT_NEAR(u(2) / (5.0 * std::pow(k_length, 2) / (2.0 * bending)), 1.0, 1e-9);
  }
}

// u is proportional to 1 / E and does not know the density.
TEST(StaticDisplacements, HaveTheDerivativesOfBeamTheory) {
  const StructureModel model =
      cantilever(5, {.frequencies = {1}, .static_loads = {{{{"105:+Y", 30.0}}, {"105:+Y", "103:+RZ"}}}});
  const Eigen::Vector2d x(1.25, 0.7);
  const Eigen::MatrixXd u = model.evaluate(x.transpose(), {}).outputs;
  const Eigen::MatrixXd jacobian = model.jacobian(x);
  for (const Eigen::Index k : {1, 2}) {
    EXPECT_NEAR(jacobian(k, 0) / (-u(k) / x(0)), 1.0, 1e-9);
    EXPECT_NEAR(jacobian(k, 1), 0.0, 1e-12 * std::abs(u(k)));
  }
  EXPECT_NEAR(jacobian(0, 0) / (0.5 * u(0) / x(0)), 1.0, 1e-8);  // f is proportional to sqrt(E / rho)
}

TEST(StaticDisplacements, HaveTheDerivativesOfDifferences) {
  const StructureModel model =
      springs({"spring:k1", "spring:k6", "mass:m1"},
              {.static_loads = {{{{"m3", 1.0}}, {"m1", "m3"}}, {{{"m1", 2.0}, {"m2", -4.0}}, {"m2"}}}});
  const Eigen::Vector3d x(1.3, 2.0, 1.0);
  const Eigen::MatrixXd jacobian = model.jacobian(x);
  constexpr double k_step = 1e-5;  // errors: truncation k_step^2, rounding 1e-16 / k_step
  for (Eigen::Index i = 0; i < 3; ++i) {
    Eigen::MatrixXd samples = x.transpose().replicate(2, 1);
    samples(0, i) += k_step;
    samples(1, i) -= k_step;
    const Eigen::MatrixXd u = model.evaluate(samples, {}).outputs;
    for (Eigen::Index k = 0; k < 3; ++k) EXPECT_NEAR(jacobian(k, i), (u(0, k) - u(1, k)) / (2.0 * k_step), 1e-9);
  }
}

TEST(StaticDisplacements, AreTheSameByAReducedModelAndByFullMatrices) {
  const OutputSelection outputs{.frequencies = {1, 2, 3}, .static_loads = {{{{"200:+Y", 30.0}}, {"150:+Y", "200:+Y"}}}};
  Eigen::MatrixXd x(30, 2);
  x.col(0) = Eigen::VectorXd::LinSpaced(30, 0.85, 1.15);
  x.col(1) = Eigen::VectorXd::LinSpaced(30, 1.05, 0.95);
  const Evaluation exact = cantilever(100, outputs).evaluate(x, {});
  const Evaluation reduced = cantilever(100, outputs, true).evaluate(x, {});
  ASSERT_TRUE(exact.failures.empty() && reduced.failures.empty());
  EXPECT_EQ(reduced.use.reduced, 30);
  EXPECT_TRUE(test::have_same_bits(reduced.outputs.rightCols(2), exact.outputs.rightCols(2)));
  EXPECT_LE((reduced.outputs.leftCols(3).array() / exact.outputs.leftCols(3).array() - 1.0).abs().maxCoeff(), 1e-4);
}

TEST(StaticDisplacements, FailOnlyForTheSampleThatCarriesNoLoad) {
  MassSpringSystem system{.masses = {{"m", 1.0}}, .springs = {{"k", k_ground, 0, 1.0}}, .dampers = {}};
  const StructureModel model = springs({"spring:k"}, {.static_loads = {{{{"m", 3.0}}, {"m"}}}}, system);
  const Evaluation result = model.evaluate(Eigen::Vector4d(2.0, 0.0, -1.0, 4.0), {});
  ASSERT_EQ(result.failures.size(), 2);
  EXPECT_EQ(result.failures[0].sample, 1);
  EXPECT_EQ(result.failures[1].sample, 2);
  EXPECT_THAT(result.failures[0].reason, HasSubstr("not supported"));
  EXPECT_DOUBLE_EQ(result.outputs(0), 1.5);
  EXPECT_TRUE(std::isnan(result.outputs(1)));
  EXPECT_DOUBLE_EQ(result.outputs(3), 0.75);
}

TEST(StaticDisplacements, RefuseAFreeStructure) {
  const OutputSelection outputs{.static_loads = {{{{"105:+Y", 1.0}}, {"105:+Y"}}}};
  EXPECT_THAT(test::message_of<InvalidInput>([&] { cantilever(5, outputs, false, false); }),
              HasSubstr("no static solution under the outputs' loads at the parameters' means"));
  // Balanced forces, too: the rigid-body motion stays open.
  const OutputSelection balanced{.static_loads = {{{{"100:+X", -1.0}, {"105:+X", 1.0}}, {"105:+X"}}}};
  EXPECT_THAT(test::message_of<InvalidInput>([&] { cantilever(5, balanced, false, false); }),
              HasSubstr("not supported"));
  // Of these stiffnesses the last pivot of K, which is singular, rounds to a positive number in many samples.
  MassSpringSystem ring{.masses = {{"m1", 1.0}, {"m2", 1.0}, {"m3", 1.0}, {"m4", 1.0}},
                        .springs = {{"k", 0, 1, 2.3}, {"k2", 1, 2, 1.1}, {"k3", 2, 3, 0.7}, {"k4", 3, 0, 1.9}},
                        .dampers = {}};
  MassSpringSystem held = ring;
  held.springs.push_back({"ground", k_ground, 0, 1.0});
  const StructureModel model =
      springs({"spring:k", "spring:ground"}, {.static_loads = {{{{"m1", 1.0}, {"m4", -1.0}}, {"m1", "m2"}}}}, held);
  Eigen::MatrixXd samples(200, 2);
  samples.col(0) = Eigen::VectorXd::LinSpaced(200, 1.0, 3.0);
  samples.col(1).setZero();  // no ground
  EXPECT_EQ(model.evaluate(samples, {}).failures.size(), 200);
  samples.col(1).setConstant(1e-14);  // lost where K is summed
  EXPECT_EQ(model.evaluate(samples, {}).failures.size(), 200);
  samples.col(1).setConstant(1e-8);  // soft, but there: balanced forces leave m1 at rest
  const Evaluation soft = model.evaluate(samples, {});
  EXPECT_TRUE(soft.failures.empty());
  EXPECT_LT(soft.outputs.col(0).cwiseAbs().maxCoeff(), 1e-6);
  MassSpringSystem free{.masses = {{"m1", 1.0}, {"m2", 1.0}}, .springs = {{"k", 0, 1, 0.3}}, .dampers = {}};
  EXPECT_THAT(test::message_of<InvalidInput>([&] {
                springs({"spring:k"}, {.static_loads = {{{{"m1", 1.0}}, {"m2"}}}}, free);
              }),
              HasSubstr("not supported"));
}

// In series on a ground spring, force 1 at the end: u1 = 1 / 1.3 whatever comes behind it, as long as doubles can hold
// both.
TEST(StaticDisplacements, FailWhereAStiffnessIsLostBesideAnother) {
  for (const auto& [stiff, is_lost] : {std::pair{1e10, false}, std::pair{1e16, true}}) {
    MassSpringSystem chain{.masses = {{"m1", 1.0}, {"m2", 1.0}, {"m3", 1.0}},
                           .springs = {{"k1", k_ground, 0, 1.3}, {"k2", 0, 1, stiff}, {"k3", 1, 2, 3.0}},
                           .dampers = {}};
    const StructureModel model = springs({"spring:k2"}, {.static_loads = {{{{"m3", 1.0}}, {"m1", "m3"}}}}, chain);
    const Evaluation found = model.evaluate(Eigen::MatrixXd::Constant(1, 1, stiff), {});
    EXPECT_EQ(!found.failures.empty(), is_lost);
    if (is_lost) continue;
    EXPECT_NEAR(found.outputs(0), 1.0 / 1.3, 1e-5);
    EXPECT_NEAR(found.outputs(1), 1.0 / 1.3 + 1.0 / 3.0, 1e-5);
  }
}

TEST(StaticDisplacements, RefuseWhatTheStructureDoesNotHave) {
  const auto message = [](StaticLoad load) {
    return test::message_of<InvalidInput>([&] { cantilever(2, {.static_loads = {std::move(load)}}); });
  };
  EXPECT_THAT(message({{{"999:+Y", 1.0}}, {"102:+Y"}}),
              HasSubstr("static.1.forces: '999:+Y': the deck has no grid point 999"));
  EXPECT_THAT(message({{{"102:+Y", 1.0}}, {"102:+W"}}), HasSubstr("static.1.dofs: '102:+W' is not known here"));
  EXPECT_THAT(message({{{"100:+Y", 1.0}}, {"102:+Y"}}), HasSubstr("static.1.forces: '100:+Y' is fixed"));
  EXPECT_THAT(message({{{"102:+Y", 1.0}}, {"100:+Y"}}), HasSubstr("static.1.dofs: '100:+Y' is fixed"));
  EXPECT_THAT(message({{{"102:+Y", 0.0}}, {"102:+Y"}}), HasSubstr("no force that is not 0"));
  EXPECT_THAT(message({{}, {"102:+Y"}}), HasSubstr("no force that is not 0"));
  EXPECT_THAT(message({{{"102:+Y", 1.0}}, {"102:+Y", "102:+Y"}}), HasSubstr("given twice"));
}

}  // namespace
}  // namespace mottle::model
