// Beams as the modal model sees them: frequencies against theory, derivatives against differences, moved geometry,
// failures.
#include "mottle/model/structures/finite_element_structure.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>
#include <memory>
#include <numbers>

#include "core/message_of.hpp"
#include "fem/models.hpp"
#include "model/structures.hpp"
#include "mottle/model/solvers/exact_solver.hpp"
#include "mottle/model/structure_model.hpp"

namespace mottle::model {
namespace {

using test::have_same_bits;
using test::one_each;
using ::testing::AllOf;
using ::testing::HasSubstr;

constexpr double k_young = 7e10, k_density = 2700.0, k_area = 4e-4, k_length = 1.2;
constexpr double k_inertia_1 = 2e-8, k_inertia_2 = 5e-9;

/// A cantilever along x of `parts` beams; plane 1 is x-y.
FiniteElementModel cantilever(int parts, double inertia_1 = k_inertia_1, double inertia_2 = k_inertia_2) {
  test::ModelMaker maker;
  maker.model.settings.coupled_mass = true;
  const int metal = maker.material(1, k_young, 0.3, k_density);
  const int section = maker.beam_property(1, metal, k_area, inertia_1, inertia_2, 1e-8);
  for (int k = 0; k <= parts; ++k) maker.node(100 + k, {k_length * k / parts, 0, 0});
  for (int k = 0; k < parts; ++k) maker.beam(k + 1, k, k + 1, section);
  maker.model.fixed.emplace_back(0, k_all_components);
  return maker.model;
}

/// f = (beta L)^2 / (2 pi L^2) sqrt(E I / (rho A)), cos(beta L) cosh(beta L) = -1.
double euler_bernoulli_hz(int mode, double inertia) {
  constexpr double k_roots[] = {1.8751040687119611, 4.694091132974174, 7.854757438237613};
  return std::pow(k_roots[mode - 1] / k_length, 2) / (2.0 * std::numbers::pi) *
         std::sqrt(k_young * inertia / (k_density * k_area));
}

/// Outputs of a structure with these parameters, whose reference is the deck.
StructureModel modal(const FiniteElementModel& model, const std::vector<ParameterTargets>& parameters,
                     OutputSelection outputs) {
  auto structure = std::make_unique<FiniteElementStructure>(
      model, parameters, Eigen::VectorXd::Zero(static_cast<Eigen::Index>(parameters.size())));
  const Eigen::VectorXd reference = structure->reference();
  return {std::make_unique<ExactSolver>(std::move(structure)), std::move(outputs), reference};
}

/// x d outputs / dx by differences of fourth order with steps of x / 1000.
Eigen::MatrixXd differences(const Model& model, const Eigen::VectorXd& x) {
  Eigen::MatrixXd result(model.outputs().size(), x.size());
  for (Eigen::Index i = 0; i < x.size(); ++i) {
    Eigen::MatrixXd samples = x.transpose().replicate(4, 1);
    const double step = 1e-3 * x(i);
    samples.col(i) += step * Eigen::Vector4d(-2, -1, 1, 2);
    const Eigen::MatrixXd y = model.evaluate(samples, {}).outputs;
    result.col(i) = (y.row(0) - 8.0 * y.row(1) + 8.0 * y.row(2) - y.row(3)).transpose() / 12.0 * 1000.0;
  }
  return result;
}

Eigen::MatrixXd scaled_jacobian(const StructureModel& model, const Eigen::VectorXd& x) {
  return model.jacobian(x) * x.asDiagonal();
}

// Consistent cubic beams of length h are too stiff by (beta h)^4 / 720 in the eigenvalue, so
// by 5e-8 and 2e-6 in these frequencies; the next term is smaller by (beta h)^2.
TEST(FiniteElementStructure, HasTheFrequenciesOfEulerAndBernoulli) {
  const StructureModel model = modal(cantilever(20), one_each({"MAT1:1:E"}), {.frequencies = {1, 2, 3, 4}});
  const Eigen::RowVectorXd f = model.evaluate(Eigen::MatrixXd::Constant(1, 1, k_young), {}).outputs;
  // Ascending: the first of plane 2, the first of plane 1 (twice as high), the second of both.
  EXPECT_NEAR(f(0) / euler_bernoulli_hz(1, k_inertia_2), 1.0 + 5.4e-8, 1e-8);
  EXPECT_NEAR(f(1) / euler_bernoulli_hz(1, k_inertia_1), 1.0 + 5.4e-8, 1e-8);
  EXPECT_NEAR(f(2) / euler_bernoulli_hz(2, k_inertia_2), 1.0 + 2.1e-6, 1e-7);
  EXPECT_NEAR(f(3) / euler_bernoulli_hz(2, k_inertia_1), 1.0 + 2.1e-6, 1e-7);
}

// Differences of fourth order are off by 1e-12, and by the solver's residual times 1000: 1e-9.
constexpr double k_difference_error = 1e-7;

TEST(FiniteElementStructure, HasTheDerivativesOfDifferences) {
  const StructureModel model =
      modal(cantilever(6), one_each({"MAT1:1:E", "MAT1:1:RHO", "PBAR:1:A", "PBAR:1:I1", "PBAR:1:I2"}),
            {.frequencies = {1, 2, 3}, .shape_modes = {1, 3}, .shape_degrees_of_freedom = {"103:+Z", "106:+RY"}});
  Eigen::VectorXd x(5);
  x << 6.5e10, 2800.0, 4.2e-4, 1.9e-8, 5.2e-9;
  const Eigen::MatrixXd jacobian = scaled_jacobian(model, x);
  const Eigen::MatrixXd difference = differences(model, x);
  for (Eigen::Index i = 0; i < jacobian.rows(); ++i) {
    const double scale = difference.row(i).cwiseAbs().maxCoeff();
    EXPECT_LT((jacobian - difference).row(i).cwiseAbs().maxCoeff(), k_difference_error * scale) << i;
  }
}

// f ~ sqrt(E): E df/dE = f / 2.
TEST(FiniteElementStructure, HasTheClosedFormDerivativeWithRespectToYoungsModulus) {
  const StructureModel model = modal(cantilever(6), one_each({"MAT1:1:E"}), {.frequencies = {1, 2, 3}});
  const Eigen::VectorXd x = Eigen::VectorXd::Constant(1, 5e10);
  const Eigen::RowVectorXd f = model.evaluate(x.transpose(), {}).outputs;
  EXPECT_LT((scaled_jacobian(model, x).transpose() - 0.5 * f).cwiseAbs().maxCoeff(), 1e-8 * f(2));
}

// The last point moves out and all parts stretch alike: f ~ L^-2 where every coordinate is a factor of the same x.
TEST(FiniteElementStructure, IsAssembledAnewWhereGeometryMoves) {
  const StructureModel model =
      modal(cantilever(4), {{"length", {"GRID:101:X", "GRID:102:X", "GRID:103:X", "GRID:104:X"}, true}},
            {.frequencies = {1, 2}});
  EXPECT_EQ(model.structure().parameter_role(0), "re-assembled for each sample");
  const Eigen::MatrixXd f = model.evaluate(Eigen::Vector2d(1.0, 1.25), {}).outputs;
  EXPECT_LT((f.row(1) * 1.5625 - f.row(0)).cwiseAbs().maxCoeff(), 1e-8 * f(0, 1));
  const Eigen::VectorXd x = Eigen::VectorXd::Ones(1);
  EXPECT_LT((scaled_jacobian(model, x).transpose() + 2.0 * f.row(0)).cwiseAbs().maxCoeff(), 1e-7 * f(0, 1));
}

// Torsion alone: f ~ sqrt(G) ~ (1 + nu)^(-1/2).
TEST(FiniteElementStructure, IsAssembledAnewWherePoissonsRatioMoves) {
  FiniteElementModel deck = cantilever(4);
  deck.settings.automatic_constraints = AutomaticConstraints::none;
  for (int k = 1; k <= 4; ++k) deck.fixed.emplace_back(k, Components{0x37});  // all but the rotation about x
  const StructureModel model = modal(deck, one_each({"MAT1:1:NU"}), {.frequencies = {1}});
  EXPECT_EQ(model.structure().parameter_role(0), "re-assembled for each sample");
  const Eigen::MatrixXd f = model.evaluate(Eigen::Vector2d(0.3, 0.1), {}).outputs;
  EXPECT_NEAR(f(1, 0) / f(0, 0), std::sqrt(1.3 / 1.1), 1e-8);
  const Eigen::VectorXd x = Eigen::VectorXd::Constant(1, 0.3);
  EXPECT_NEAR(model.jacobian(x)(0, 0), -0.5 * f(0, 0) / 1.3, 1e-6 * f(0, 0));
}

// Beside what must be assembled anew, at the deck's value of that and off it; the length as a factor and by its cards.
TEST(FiniteElementStructure, HasTheDerivativesOfDifferencesBesideWhatIsAssembledAnew) {
  for (const bool is_factor : {true, false}) {
    const std::vector<ParameterTargets> parameters = {
        {"young", {"MAT1:1:E"}, false}, {"tip", {"GRID:106:X"}, is_factor}, {"area", {"PBAR:1:A"}, true}};
    const StructureModel model =
        modal(cantilever(6), parameters,
              {.frequencies = {1, 2, 3}, .shape_modes = {1, 3}, .shape_degrees_of_freedom = {"103:+Z", "106:+RY"}});
    for (const double stretch : {1.0, 1.01}) {
      const Eigen::Vector3d x(6.5e10, is_factor ? stretch : stretch * k_length, 1.1);
      const Eigen::MatrixXd jacobian = scaled_jacobian(model, x);
      const Eigen::MatrixXd difference = differences(model, x);
      for (Eigen::Index i = 0; i < jacobian.rows(); ++i) {
        const double scale = difference.row(i).cwiseAbs().maxCoeff();
        EXPECT_LT((jacobian - difference).row(i).cwiseAbs().maxCoeff(), 1e-6 * scale) << i << " at " << stretch;
      }
    }
  }
}

// An arm along x becomes oblique: entries appear in the matrices that were zero by geometry at the deck's values, and
// a chain of rods loses the straightness for which AUTOSPC held it. Each sample must be what it is alone.
TEST(FiniteElementStructure, KeepsItsEquationsWhereGeometryFillsZeros) {
  test::ModelMaker maker{cantilever(3)};
  const int end = maker.node(110, {1.5, 0, 0});
  maker.point_mass(50, end, 0.7);
  maker.model.rigid_bodies.push_back({51, 3, k_all_components, {end}});
  const int free = maker.node(111, {1.8, 0, 0}), wall = maker.node(112, {2.1, 0, 0});
  const FieldIndex area = maker.field("PROD", 52, "A", 1e-5);
  maker.rod(52, 3, free, 0, area);
  maker.rod(53, free, wall, 0, area);
  maker.model.fixed.emplace_back(wall, k_all_components);
  const OutputSelection outputs{.frequencies = {1, 2, 3}, .tracking = ModeTracking::mac, .minimum_mac = 0.1};
  const auto f_of = [&](const Eigen::MatrixXd& samples) {
    return Eigen::MatrixXd(
        modal(maker.model, one_each({"GRID:110:Y", "GRID:111:Z"}), outputs).evaluate(samples, {}).outputs);
  };
  const Eigen::MatrixXd samples = (Eigen::MatrixXd(3, 2) << 0.0, 0.0, 0.3, 0.1, 0.0, 0.0).finished();
  const Eigen::MatrixXd f = f_of(samples);
  ASSERT_TRUE(f.allFinite());
  EXPECT_TRUE(have_same_bits(f.row(0), f.row(2)));
  EXPECT_TRUE(have_same_bits(f.row(1), f_of(samples.row(1))));
  EXPECT_GT((f.row(1) - f.row(0)).norm(), 1e-3);
}

/// A cantilever whose plane 1 is stiffer; outputs follow the shapes.
StructureModel two_planes(ModeTracking tracking) {
  return modal(cantilever(6), one_each({"PBAR:1:I2"}),
               {.frequencies = {1, 2},
                .shape_modes = {1},
                .shape_degrees_of_freedom = {"106:+Y", "106:+Z"},
                .tracking = tracking});
}

// With I2 > I1 bending in plane 2, mode 1 of the reference, is the higher one.
TEST(FiniteElementStructure, FollowsItsModesThroughACrossing) {
  const Eigen::VectorXd x = Eigen::VectorXd::Constant(1, 4e-8);
  const Evaluation tracked = two_planes(ModeTracking::mac).evaluate(x, {});
  ASSERT_TRUE(tracked.failures.empty());
  EXPECT_NEAR(tracked.outputs(0) / euler_bernoulli_hz(1, 4e-8), 1.0, 1e-5);
  EXPECT_NEAR(tracked.outputs(1) / euler_bernoulli_hz(1, k_inertia_1), 1.0, 1e-5);
  EXPECT_LT(std::abs(tracked.outputs(2)), 1e-8 * std::abs(tracked.outputs(3))) << "still across plane 1";
  ASSERT_EQ(tracked.notes.size(), 1U);
  EXPECT_THAT(tracked.notes[0].text, HasSubstr("modes 1 and 2 crossed"));
  const Evaluation ranked = two_planes(ModeTracking::order).evaluate(x, {});
  EXPECT_NEAR(ranked.outputs(0) / euler_bernoulli_hz(1, k_inertia_1), 1.0, 1e-5);
}

// The tip of a uniform cantilever moves by 2 / sqrt(m) in every mode.
TEST(FiniteElementStructure, HasMassNormalisedShapes) {
  const Eigen::RowVectorXd y =
      two_planes(ModeTracking::mac).evaluate(Eigen::VectorXd::Constant(1, k_inertia_2), {}).outputs;
  const double mass = k_density * k_area * k_length;
  EXPECT_NEAR(std::abs(y(3)) * std::sqrt(mass), 2.0, 1e-4);
}

/// A chain of two springs whose middle has a mass: a mechanism without the springs.
FiniteElementModel chain() {
  test::ModelMaker maker;
  for (int k = 1; k <= 3; ++k) maker.scalar_point(k);
  maker.spring(1, 0, 0, -1, 0, 100.0);
  maker.spring(2, 0, 0, 1, 0, 50.0);
  maker.spring(3, 1, 0, 2, 0, 50.0);
  maker.mass(4, 0, 0, 1.0);
  maker.mass(5, 2, 0, 1.0);
  return maker.model;
}

TEST(FiniteElementStructure, AFailedSampleIsAValueWithAReason) {
  const StructureModel model = modal(chain(), one_each({"CELAS2:2:K", "CELAS2:3:K"}), {.frequencies = {1, 2}});
  const Eigen::MatrixXd samples = (Eigen::MatrixXd(3, 2) << 50, 50, 0, 0, 60, 60).finished();
  const Evaluation evaluation = model.evaluate(samples, {});
  ASSERT_EQ(evaluation.failures.size(), 1U);
  EXPECT_EQ(evaluation.failures[0].sample, 1);
  EXPECT_THAT(evaluation.failures[0].reason,
              AllOf(HasSubstr("can move without stiffness and mass"), HasSubstr("(first seen at 2)")));
  EXPECT_TRUE(evaluation.outputs.row(0).allFinite() && evaluation.outputs.row(2).allFinite());
}

TEST(FiniteElementStructure, AnImpossibleGeometryIsAFailureThatNamesTheElement) {
  const StructureModel model = modal(cantilever(3), one_each({"GRID:103:X"}), {.frequencies = {1}});
  const Evaluation evaluation = model.evaluate(Eigen::Vector2d(k_length * 2.0 / 3.0, 1.3), {});
  ASSERT_EQ(evaluation.failures.size(), 1U);
  EXPECT_THAT(evaluation.failures[0].reason, HasSubstr("CBAR 3: beam: both ends lie at"));
}

TEST(FiniteElementStructure, WithoutAutomaticConstraintsNamesTheLooseDegreeOfFreedom) {
  FiniteElementModel model = cantilever(3);
  model.nodes.push_back({.id = 200, .position = {5, 0, 0}});
  model.settings.automatic_constraints = AutomaticConstraints::none;
  EXPECT_THAT(test::message_of<InvalidInput>([&] { modal(model, one_each({"MAT1:1:E"}), {.frequencies = {1}}); }),
              HasSubstr("(first seen at 200:+"));
}

TEST(FiniteElementStructure, GivesTheSameNumbersWithOneAndTwoThreads) {
  const StructureModel model =
      modal(cantilever(6), one_each({"MAT1:1:E", "PBAR:1:I1"}),
            {.frequencies = {1, 2, 3}, .shape_modes = {2}, .shape_degrees_of_freedom = {"104:+Y"}});
  Eigen::MatrixXd samples(9, 2);
  samples << k_young * Eigen::VectorXd::LinSpaced(9, 0.8, 1.2), k_inertia_1 * Eigen::VectorXd::LinSpaced(9, 1.3, 0.7);
  const Eigen::MatrixXd one = model.evaluate(samples, {.threads = 1}).outputs;
  EXPECT_TRUE(have_same_bits(one, model.evaluate(samples, {.threads = 2}).outputs));
  EXPECT_TRUE(have_same_bits(one.row(4), model.evaluate(samples.row(4), {}).outputs));
}

TEST(FiniteElementStructure, FindsDegreesOfFreedomByName) {
  FiniteElementModel model = cantilever(2);
  model.nodes.push_back({.id = 300, .is_scalar = true});
  const FiniteElementStructure structure(model, one_each({"MAT1:1:E"}), Eigen::VectorXd::Ones(1));
  EXPECT_EQ(structure.find_degree_of_freedom("101:+Z"), 8);
  EXPECT_EQ(structure.find_degree_of_freedom("102:+RX"), 15);
  EXPECT_EQ(structure.find_degree_of_freedom("300"), 18);
  for (const char* name : {"101", "101:Z", "101:+T", "101:+Z ", "300:+X", "99:+X", "", ":+X", "x"}) {
    EXPECT_EQ(structure.find_degree_of_freedom(name), -1) << name;
  }
  EXPECT_EQ(structure.unknown_degree_of_freedom("99:+X"), "'99:+X': the deck has no grid point 99");
  EXPECT_THAT(structure.unknown_degree_of_freedom("101:Z"), HasSubstr("like 101:+Z"));
}

// The dependent end of a rigid arm moves with the tip and its rotation.
TEST(FiniteElementStructure, ShowsDependentDegreesOfFreedom) {
  test::ModelMaker maker{cantilever(4)};
  maker.model.rigid_bodies.push_back({50, 4, k_all_components, {maker.node(110, {k_length + 0.5, 0, 0})}});
  const StructureModel model = modal(maker.model, one_each({"MAT1:1:E"}),
                                     {.shape_modes = {1}, .shape_degrees_of_freedom = {"104:+Z", "104:+RY", "110:+Z"}});
  const Eigen::RowVectorXd y = model.evaluate(Eigen::MatrixXd::Constant(1, 1, k_young), {}).outputs;
  EXPECT_NEAR(y(2), y(0) - 0.5 * y(1), 1e-13 * std::abs(y(2)));
}

TEST(FiniteElementStructure, RefusesAParameterThatNoElementUses) {
  test::ModelMaker maker{cantilever(2)};
  maker.material(9, 1.0, 0.3, 1.0);
  EXPECT_THAT(test::message_of<InvalidInput>(
                  [&] { FiniteElementStructure(maker.model, one_each({"MAT1:9:E"}), Eigen::VectorXd::Ones(1)); }),
              HasSubstr("parameter 'MAT1:9:E': it acts on nothing: no element uses MAT1:9:E"));
}

TEST(FiniteElementStructure, WeighsWhatTheParametersSay) {
  const FiniteElementStructure structure(cantilever(3), one_each({"MAT1:1:RHO"}), Eigen::VectorXd::Ones(1));
  EXPECT_NEAR(structure.total_mass(Eigen::VectorXd::Constant(1, 1000.0)), 1000.0 * k_area * k_length, 1e-12);
}

TEST(FiniteElementStructure, SaysHowAParameterEnters) {
  FiniteElementModel model = cantilever(3);
  test::ModelMaker maker{model};
  maker.node(200, {1.2, 1, 0});
  maker.model.elements<ShellElement>().push_back(
      {.id = 9, .nodes = {0, 3, 4, 0}, .property = maker.shell_property(9, 0, 0.01)});
  maker.node(201, {0, 1, 0});
  maker.model.elements<ShellElement>()[0].nodes[3] = 5;
  maker.model.elements<ShellElement>()[0].bending_over_shear = 2.6e-4;
  const FiniteElementStructure structure(maker.model, one_each({"MAT1:1:RHO", "PSHELL:9:T"}), Eigen::Vector2d::Ones());
  EXPECT_EQ(structure.parameter_role(0), "exactly separable, linearly: no re-assembly");
  EXPECT_EQ(structure.parameter_role(1), "exactly separable, powers up to 3: no re-assembly");
}

}  // namespace
}  // namespace mottle::model
