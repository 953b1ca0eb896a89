// Clouds of a finite-element structure with the reduced model against the same clouds solved exactly.
#include "mottle/model/solvers/reduced_solver.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <limits>
#include <memory>
#include <random>

#include "fem/models.hpp"
#include "model/structures.hpp"
#include "mottle/model/structure_model.hpp"
#include "mottle/model/structures/finite_element_structure.hpp"

namespace mottle::model {
namespace {

using Eigen::Index;
using Eigen::MatrixXd;
using test::have_same_bits;

constexpr int k_parts = 100;  // 600 equations

/// A cantilever of two metals; plane 1 and plane 2 have nearly the same stiffness, so their modes cross.
FiniteElementModel cantilever() {
  test::ModelMaker maker;
  maker.model.settings.coupled_mass = true;
  const int metals[] = {maker.material(1, 7e10, 0.3, 2700.0), maker.material(2, 7e10, 0.3, 2700.0)};
  const int sections[] = {maker.beam_property(1, metals[0], 4e-4, 2e-8, 2.1e-8, 1e-8),
                          maker.beam_property(2, metals[1], 4e-4, 2e-8, 1.8e-8, 1e-8)};
  for (int k = 0; k <= k_parts; ++k) maker.node(100 + k, {1.2 * k / k_parts, 0, 0});
  for (int k = 0; k < k_parts; ++k) maker.beam(k + 1, k, k + 1, sections[2 * k / k_parts]);
  maker.model.fixed.emplace_back(0, k_all_components);
  return maker.model;
}

const std::vector<ParameterTargets> k_parameters{
    {"E1", {"MAT1:1:E"}, true}, {"E2", {"MAT1:2:E"}, true}, {"I1", {"PBAR:1:I1"}, true}, {"rho", {"MAT1:2:RHO"}, true}};

MatrixXd uniform(Index samples, double half_width, unsigned seed) {
  std::mt19937_64 random(seed);
  std::uniform_real_distribution<double> distribution(1.0 - half_width, 1.0 + half_width);
  MatrixXd x(samples, static_cast<Index>(k_parameters.size()));
  for (double& value : x.reshaped()) value = distribution(random);
  return x;
}

StructureModel make_model(bool reduces, double half_width = 0.15,
                          const std::vector<ParameterTargets>& parameters = k_parameters,
                          const std::vector<int>& frequencies = {1, 2, 3, 4, 5, 6}) {
  const auto count = static_cast<Index>(parameters.size());
  auto structure = std::make_unique<FiniteElementStructure>(cantilever(), parameters, Eigen::VectorXd::Ones(count));
  std::optional<ReductionSettings> reduction;
  if (reduces) {
    reduction = {.prior = {Eigen::VectorXd::Ones(count), uniform(200, half_width, 1).leftCols(count)}};
  }
  const Eigen::VectorXd reference = structure->reference();
  return {make_sparse_solver(std::move(structure), std::move(reduction)),
          {.frequencies = frequencies,
           .shape_modes = {1, 3},
           .shape_degrees_of_freedom = {"150:+Y", "200:+Y", "200:+Z", "200:+RZ"},
           .tracking = ModeTracking::mac},
          reference};
}

/// The reduced cloud against the exact one: frequencies by their bound, shapes by what that means for them.
void expect_close(const Evaluation& reduced, const Evaluation& exact) {
  ASSERT_TRUE(exact.failures.empty());
  EXPECT_TRUE(reduced.failures.empty());
  const MatrixXd ratio = (reduced.outputs.leftCols(6).array() / exact.outputs.leftCols(6).array() - 1.0).abs();
  EXPECT_LE(ratio.maxCoeff(), 1e-4);
  const double largest = exact.outputs.rightCols(8).cwiseAbs().maxCoeff();
  EXPECT_LE((reduced.outputs - exact.outputs).rightCols(8).cwiseAbs().maxCoeff(), 0.01 * largest);
  ASSERT_EQ(reduced.notes.size(), exact.notes.size());
  for (std::size_t i = 0; i < exact.notes.size(); ++i) {
    EXPECT_EQ(reduced.notes[i].sample, exact.notes[i].sample);
    EXPECT_EQ(reduced.notes[i].text, exact.notes[i].text);
  }
}

TEST(ReducedSolver, IsTheExactOneWithinItsBound) {
  const MatrixXd x = uniform(60, 0.15, 2);
  const Evaluation exact = make_model(false).evaluate(x, {});
  const Evaluation reduced = make_model(true).evaluate(x, {});
  expect_close(reduced, exact);
  EXPECT_FALSE(exact.notes.empty());  // planes 1 and 2 did cross
  EXPECT_EQ(exact.use.reduced, 0);
  EXPECT_EQ(exact.use.exact, 60);
  EXPECT_GE(reduced.use.reduced, 58);
  EXPECT_EQ(reduced.use.reduced + reduced.use.exact, 60);
  EXPECT_LE(reduced.use.frequency_error, 1e-4);
  EXPECT_GT(reduced.use.basis, 6);
}

TEST(ReducedSolver, ModesAboveTheOutputsAreCertifiedWhereOneTakesTheirPlace) {
  const std::vector<int> frequencies{1, 2, 3};  // of the pair 3 and 4, which cross, one is an output
  const MatrixXd x = uniform(80, 0.15, 2);
  const Evaluation exact = make_model(false, 0.15, k_parameters, frequencies).evaluate(x, {});
  const StructureModel model = make_model(true, 0.15, k_parameters, frequencies);
  const Evaluation reduced = model.evaluate(x, {});
  ASSERT_TRUE(exact.failures.empty() && reduced.failures.empty());
  EXPECT_LE((reduced.outputs.leftCols(3).array() / exact.outputs.leftCols(3).array() - 1.0).abs().maxCoeff(), 1e-4);
  EXPECT_GE(reduced.use.reduced, 78);
  EXPECT_TRUE(have_same_bits(reduced.outputs, model.evaluate(x, {.threads = 3}).outputs));
  const MatrixXd all = make_model(false).evaluate(x, {}).outputs.leftCols(6);
  const auto is_crossed = [&](Index s) {
    return (all.row(s).array() < exact.outputs(s, 2) * (1.0 - 1e-6)).count() > 2;
  };
  std::vector<Index> crossed, others;
  for (Index s = 0; s < x.rows(); ++s) (is_crossed(s) ? crossed : others).push_back(s);
  ASSERT_GT(crossed.size(), 5);
  ASSERT_GT(others.size(), 5);
  // A basis for as many modes as are compared is larger, and is used where it is needed only.
  EXPECT_LT(model.evaluate(x(others, Eigen::all), {}).use.basis, model.evaluate(x(crossed, Eigen::all), {}).use.basis);
  EXPECT_TRUE(have_same_bits(reduced.outputs(crossed, Eigen::all), model.evaluate(x(crossed, Eigen::all), {}).outputs));
}

TEST(ReducedSolver, LearnsWhereTheCloudHasMoved) {
  const MatrixXd x = (uniform(60, 0.15, 3).array() + 0.6).matrix();
  const Evaluation exact = make_model(false).evaluate(x, {});
  const StructureModel model = make_model(true, 0.02);
  const Evaluation reduced = model.evaluate(x, {});
  expect_close(reduced, exact);
  EXPECT_GE(reduced.use.reduced, 50);
  // And forgets it again: what a batch gives depends on nothing before it.
  const MatrixXd near = uniform(40, 0.02, 4);
  EXPECT_TRUE(have_same_bits(model.evaluate(near, {}).outputs, make_model(true, 0.02).evaluate(near, {}).outputs));
}

TEST(ReducedSolver, InARegionSingleSamplesAreReducedAndHaveTheSameBitsAsInABatch) {
  const SampleRegion region(Eigen::VectorXd::Constant(4, 1.6), (uniform(200, 0.15, 9).array() + 0.6).matrix());
  const MatrixXd x = (uniform(40, 0.12, 3).array() + 0.6).matrix();
  const StructureModel model = make_model(true, 0.02);
  const Evaluation batch = model.evaluate_in(region, x, {});
  expect_close(batch, make_model(false).evaluate(x, {}));
  EXPECT_EQ(batch.use.exact, 0);
  for (const Index s : {0, 17}) {
    const Evaluation alone = model.evaluate_in(region, x.row(s), {});
    EXPECT_EQ(alone.use.exact, 0);
    EXPECT_TRUE(have_same_bits(alone.outputs, batch.outputs.row(s)));
  }
}

TEST(ReducedSolver, ARegionLeavesNothingBehind) {
  const SampleRegion region(Eigen::VectorXd::Constant(4, 1.6), (uniform(200, 0.15, 9).array() + 0.6).matrix());
  const SampleRegion other(Eigen::VectorXd::Constant(4, 2.0), (uniform(200, 0.15, 10).array() + 1.0).matrix());
  const MatrixXd x = (uniform(20, 0.12, 3).array() + 0.6).matrix(), near = uniform(40, 0.02, 4);
  const StructureModel model = make_model(true, 0.02);
  const Evaluation first = model.evaluate_in(region, x, {});
  model.evaluate_in(other, (x.array() + 0.4).matrix(), {});
  EXPECT_TRUE(have_same_bits(model.evaluate_in(region, x, {.threads = 3}).outputs, first.outputs));
  EXPECT_TRUE(have_same_bits(model.evaluate(near, {}).outputs, make_model(true, 0.02).evaluate(near, {}).outputs));
}

TEST(ReducedSolver, ARegionWhoseCentreHasNoModesIsServedByThePrior) {
  const SampleRegion region(-Eigen::VectorXd::Ones(4), uniform(50, 0.02, 9));
  const MatrixXd x = uniform(10, 0.02, 3);
  const StructureModel model = make_model(true, 0.02);
  EXPECT_TRUE(have_same_bits(model.evaluate_in(region, x, {}).outputs, model.evaluate(x, {}).outputs));
}

TEST(ReducedSolver, OneBadSampleCostsThatSample) {
  MatrixXd x = uniform(40, 0.1, 5);
  x(3, 0) = std::numeric_limits<double>::quiet_NaN();
  x(7, 1) = -1.0;
  const Evaluation exact = make_model(false).evaluate(x, {});
  const Evaluation reduced = make_model(true).evaluate(x, {});
  ASSERT_EQ(reduced.failures.size(), 2U);
  for (std::size_t i = 0; i < 2; ++i) {
    EXPECT_EQ(reduced.failures[i].sample, exact.failures[i].sample);
    EXPECT_EQ(reduced.failures[i].reason, exact.failures[i].reason);
  }
  EXPECT_TRUE(reduced.outputs.row(8).allFinite());
}

TEST(ReducedSolver, AHandfulOfSamplesIsSolvedExactly) {
  const MatrixXd x = uniform(3, 0.1, 6);
  const Evaluation few = make_model(true).evaluate(x, {});
  EXPECT_EQ(few.use.reduced, 0);
  EXPECT_TRUE(have_same_bits(few.outputs, make_model(false).evaluate(x, {}).outputs));
}

TEST(ReducedSolver, IsTheSameAtAnyNumberOfThreads) {
  const MatrixXd x = uniform(80, 0.25, 7);
  const Evaluation one = make_model(true, 0.05).evaluate(x, {.threads = 1});
  const Evaluation three = make_model(true, 0.05).evaluate(x, {.threads = 3});
  EXPECT_TRUE(have_same_bits(one.outputs, three.outputs));
  EXPECT_EQ(one.use.exact, three.use.exact);
}

TEST(ReducedSolver, WhatIsNotSeparableIsLeftAlone) {
  const std::vector<ParameterTargets> moved{{"E1", {"MAT1:1:E"}, true}, {"nu", {"MAT1:2:NU"}, true}};
  const MatrixXd x = uniform(32, 0.05, 8).leftCols(2);
  const Evaluation evaluation = make_model(true, 0.1, moved).evaluate(x, {});
  EXPECT_EQ(evaluation.use.reduced, 0);
  EXPECT_EQ(evaluation.use.exact, 32);
}

TEST(ReducedSolver, ANominalModelWithoutModesLeavesAllToTheFullOne) {
  auto structure = std::make_unique<FiniteElementStructure>(cantilever(), k_parameters, Eigen::VectorXd::Ones(4));
  const ReductionSettings reduction{.prior = {-Eigen::VectorXd::Ones(4), uniform(50, 0.1, 1)}};
  const StructureModel model(make_sparse_solver(std::move(structure), reduction), {.frequencies = {1, 2}},
                             Eigen::VectorXd::Ones(4));
  const Evaluation evaluation = model.evaluate(uniform(31, 0.1, 2), {});
  EXPECT_TRUE(evaluation.failures.empty());
  EXPECT_EQ(evaluation.use.exact, 31);
}

}  // namespace
}  // namespace mottle::model
