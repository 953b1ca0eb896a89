// Samples refined with the nominal factor against Eigen's dense solver of the full pencils.
#include <gtest/gtest.h>

#include <cmath>
#include <limits>

#include "linalg/sparse_families.hpp"

namespace mottle::linalg {
namespace {

using Eigen::Index;
using Eigen::MatrixXd;
using Eigen::VectorXd;
using test::Family;
using test::grid;
using test::GridOptions;
using test::trained;
using test::two_bars;

std::vector<RefinedModes> refined(const ReducedModel& model, const TermCoefficients& samples, int threads = 1) {
  std::vector<RefinedModes> all(static_cast<std::size_t>(samples.samples()));
  model.refine(samples, threads, [&](Index s, const RefinedModes& modes) { all[static_cast<std::size_t>(s)] = modes; });
  return all;
}

struct Outcome {
  int sure = 0, unknown = 0;
};

/// Values, bounds and shapes of each sample against the full pencil's.
Outcome compare(const Family& family, const ReducedModel& model, const TermCoefficients& samples, int modes,
                double tolerance) {
  Outcome outcome;
  const std::vector<RefinedModes> all = refined(model, samples);
  for (Index s = 0; s < samples.samples(); ++s) {
    const RefinedModes& found = all[static_cast<std::size_t>(s)];
    if (found.vectors.cols() == 0) {
      ++outcome.unknown;
      EXPECT_TRUE(std::isinf(found.bounds.maxCoeff()));
      continue;
    }
    const test::Exact exact = test::exact_modes(family, samples, s, modes);
    const bool is_sure = found.bounds.maxCoeff() <= tolerance;
    if (is_sure) ++outcome.sure;
    for (int k = 0; k < modes; ++k) {
      const double scale = std::max(exact.values(k), 1e-3 * exact.values(modes - 1));  // zero for a body that moves
      const double error = (found.values(k) - exact.values(k)) / scale;
      EXPECT_GE(error, -1e-9) << s << ", " << k;
      EXPECT_LE(error, found.bounds(k) + 1e-9) << s << ", " << k;
      EXPECT_LE(error, is_sure ? tolerance : 1.0) << s << ", " << k;
    }
    EXPECT_EQ(found.vectors.rows(), family.size());
  }
  return outcome;
}

struct Case {
  const char* name;
  GridOptions options;
};

class Refinement : public testing::TestWithParam<Case> {};

TEST_P(Refinement, MakesSureOfWhatTheReducedModelKnowsRoughly) {
  constexpr int k_modes = 8;
  constexpr double k_tolerance = 1e-6;
  const Family family = grid(GetParam().options);
  ReducedModel model(family.terms, family.nominal(), family.stiffness, family.mass,
                     {.modes = k_modes, .tolerance = k_tolerance, .max_vectors = 32});
  model.train(family.lognormal(20, 0.03, 1), 1);
  const TermCoefficients samples = family.lognormal(12, 0.1, 2);
  EXPECT_GT(model.solve(samples, 1).bounds.colwise().maxCoeff().maxCoeff(), k_tolerance);
  const Outcome outcome = compare(family, model, samples, k_modes, k_tolerance);
  EXPECT_EQ(outcome.sure + outcome.unknown, 12);
  // With twelve patches what is not seen may be nearly as low as the wanted modes: most samples are for a full
  // solution.
  EXPECT_GE(outcome.sure, family.terms.stiffness.size() < 12 ? 5 : 2);
}

INSTANTIATE_TEST_SUITE_P(ReducedModel, Refinement,
                         testing::Values(Case{"held", {}}, Case{"free", {.is_free = true}},
                                         Case{"mass", {.moves_mass = true}},
                                         Case{"free_mass", {.is_free = true, .moves_mass = true}},
                                         Case{"square", {.length = 12, .width = 12, .patches = 3, .is_free = true}},
                                         Case{"many", {.patches = 12}}, Case{"indefinite", {.coupling = 0.02}}),
                         [](const testing::TestParamInfo<Case>& instance) { return instance.param.name; });

TEST(Refinement, FollowsModesThatCrossWithinTheBandAndAtItsEdge) {
  constexpr int k_modes = 5;  // an odd number: the fifth and the sixth are a pair
  const Family family = two_bars(60);
  const ReducedModel model = trained(family, {.modes = k_modes, .tolerance = 1e-7}, 0.01);
  const Outcome outcome = compare(family, model, family.lognormal(20, 0.05, 5), k_modes, 1e-7);
  EXPECT_GE(outcome.sure, 15);
  EXPECT_EQ(outcome.sure + outcome.unknown, 20);
}

TEST(Refinement, RepeatedRootsAreFoundAsOftenAsTheyAre) {
  Family family = two_bars(60);
  family.terms.mass_constant.setIdentity();
  family.mass.setIdentity();
  const ReducedModel model = trained(family, {.modes = 6}, 0.01);
  TermCoefficients equal = family.constant(3, 1.0);
  equal.stiffness.col(1).setConstant(1.05);
  equal.stiffness.col(2).setConstant(0.96);
  const Outcome outcome = compare(family, model, equal, 6, 2e-4);
  EXPECT_EQ(outcome.sure, 3);
}

TEST(Refinement, ShapesAreThoseOfTheFullModel) {
  constexpr int k_modes = 6;
  const Family family = grid({});
  const ReducedModel model = trained(family, {.modes = k_modes}, 0.02);
  const TermCoefficients samples = family.lognormal(4, 0.1, 7);
  const std::vector<RefinedModes> all = refined(model, samples);
  for (Index s = 0; s < 4; ++s) {
    const MatrixXd exact = test::exact_modes(family, samples, s, k_modes).vectors;
    const MatrixXd& shapes = all[static_cast<std::size_t>(s)].vectors;
    ASSERT_EQ(shapes.cols(), k_modes);
    for (int k = 0; k < k_modes; ++k) {
      EXPECT_NEAR(shapes.col(k).squaredNorm(), 1.0, 1e-9);  // unit masses
      EXPECT_NEAR(std::abs(shapes.col(k).dot(exact.col(k))), 1.0, 1e-4) << s << ", " << k;
      EXPECT_GT(shapes.col(k).maxCoeff(), -shapes.col(k).minCoeff());
    }
  }
}

TEST(Refinement, TakesNoStepWhereTheReducedModelMayMissAMode) {
  const Family family = grid({});
  const ReducedModel model = trained(family, {.modes = 5}, 0.1);
  TermCoefficients samples = family.constant(1, 1.0);
  samples.stiffness(1, 0) = -0.5;
  const std::vector<RefinedModes> all = refined(model, samples);
  EXPECT_TRUE(std::isinf(all[0].bounds.maxCoeff()));
  EXPECT_EQ(all[0].vectors.cols(), 0);
}

TEST(Refinement, ASampleIsTheSameAloneAndInABatchAtAnyNumberOfThreads) {
  const Family family = grid({.moves_mass = true});
  const ReducedModel model = trained(family, {.modes = 5, .tolerance = 1e-6}, 0.02);
  const TermCoefficients samples = family.lognormal(9, 0.1, 2);
  const std::vector<RefinedModes> one = refined(model, samples, 1);
  const std::vector<RefinedModes> three = refined(model, samples, 3);
  for (std::size_t s = 0; s < one.size(); ++s) {
    EXPECT_EQ(one[s].values, three[s].values);
    EXPECT_EQ(one[s].vectors, three[s].vectors);
    EXPECT_EQ(one[s].bounds, three[s].bounds);
  }
  EXPECT_EQ(refined(model, samples.range(4, 1))[0].values, one[4].values);
}

}  // namespace
}  // namespace mottle::linalg
