// Modes of pencils near a nominal one against the dense solver, and pencils whose modes the block would miss.
#include "linalg/reduced/batched_davidson.hpp"

#include <gtest/gtest.h>

#include <Eigen/Cholesky>
#include <Eigen/Eigenvalues>
#include <Eigen/QR>
#include <cmath>
#include <cstring>
#include <limits>
#include <random>

#include "linalg/pencils.hpp"
#include "support/instrumented.hpp"

namespace mottle::linalg {
namespace {

using namespace linalg_test;

constexpr Index k_modes = 14, k_converged = 11, k_sketch = 64;
constexpr double k_shift = -0.5, k_smallest = 0.01;

/// Positive semidefinite parts of the identity.
std::vector<MatrixXd> parts_of_identity(Index order, Index count, std::mt19937_64& random) {
  std::vector<MatrixXd> parts;
  MatrixXd sum = MatrixXd::Zero(order, order);
  for (Index t = 0; t < count; ++t) {
    const MatrixXd factor = uniform(order, order / count + 3, -1.0, 1.0, random);
    parts.emplace_back(factor * factor.transpose());
    sum += parts.back();
  }
  const MatrixXd root = Eigen::SelfAdjointEigenSolver<MatrixXd>(sum).operatorInverseSqrt();
  for (MatrixXd& part : parts) part = root * part * root;
  return parts;
}

/// A family in coordinates in which K - shift M is the identity for coefficients 1: `turned` ones, or the modes'.
struct Family {
  std::vector<MatrixXd> stiffness, mass, stiffness_sketch, mass_sketch;
  VectorXd nominal_stiffness, nominal_mass;

  Family(Index order, Index terms, bool is_mass_parametric, bool is_turned, std::mt19937_64& random) {
    VectorXd masses(order);
    for (Index k = 0; k < order; ++k) masses(k) = 1.0 / std::pow(static_cast<double>(k + 3), 2.0);
    const MatrixXd turn =
        is_turned ? MatrixXd(Eigen::HouseholderQR<MatrixXd>(uniform(order, order, -1.0, 1.0, random)).householderQ())
                  : MatrixXd::Identity(order, order);
    const MatrixXd root = turn * masses.cwiseSqrt().asDiagonal() * turn.transpose();
    mass.emplace_back(is_mass_parametric ? MatrixXd::Zero(order, order) : MatrixXd(root * root));
    if (!is_turned && !is_mass_parametric) mass[0] = masses.asDiagonal();
    if (is_mass_parametric) {
      for (const MatrixXd& part : parts_of_identity(order, terms, random)) mass.emplace_back(root * part * root);
    }
    // K = 1 + shift M: the shifted part is a constant.
    stiffness.emplace_back(k_shift * root * root);
    for (const MatrixXd& part : parts_of_identity(order, terms, random)) stiffness.push_back(part);
    nominal_stiffness = VectorXd::Ones(terms + 1);
    nominal_mass = VectorXd::Ones(static_cast<Index>(mass.size()));
    for (std::size_t t = 0; t < stiffness.size(); ++t) {
      stiffness_sketch.push_back(uniform(k_sketch, order, -1.0, 1.0, random));
    }
    for (std::size_t t = 0; t < mass.size(); ++t) mass_sketch.push_back(uniform(k_sketch, order, -1.0, 1.0, random));
  }

  BatchedDavidson solver(SimdLevel simd) const {
    return {{stiffness, mass, nominal_stiffness, nominal_mass, k_shift, k_smallest, stiffness_sketch, mass_sketch},
            {.modes = k_modes, .converged = k_converged, .simd = simd}};
  }
  MatrixXd sum(const std::vector<MatrixXd>& terms, const MatrixXd& coefficients, Index sample) const {
    MatrixXd result = terms[0];
    for (std::size_t t = 1; t < terms.size(); ++t) {
      result += coefficients(static_cast<Index>(t) - 1, sample) * terms[t];
    }
    return result;
  }
};

/// Lognormal coefficients. K - shift M >= the smallest of them, up to the constant part, times the nominal one.
TermCoefficients coefficients(const Family& family, Index samples, double variation, std::mt19937_64& random) {
  std::lognormal_distribution<double> factor(0.0, variation);
  TermCoefficients result{MatrixXd(family.nominal_stiffness.size() - 1, samples),
                          MatrixXd(family.nominal_mass.size() - 1, samples)};
  for (double& entry : result.stiffness.reshaped()) entry = factor(random);
  for (double& entry : result.mass.reshaped()) entry = factor(random);
  return result;
}

DavidsonBounds bounds_of(const TermCoefficients& samples) {
  constexpr double k_constant = 0.8;  // the constant term takes a little away, and the mass adds
  VectorXd mass_ratios = VectorXd::Ones(samples.samples());
  if (samples.mass.rows() > 0) mass_ratios = mass_ratios.cwiseMax(samples.mass.colwise().maxCoeff().transpose());
  return {k_constant * samples.stiffness.colwise().minCoeff().transpose(), mass_ratios};
}

class NearbyModesTest : public AtEveryLevel {};
INSTANTIATE_TEST_SUITE_P(Levels, NearbyModesTest, every_level(), level_name);

/// Values of the lowest modes by Eigen's dense solver.
VectorXd dense_values(const MatrixXd& k, const MatrixXd& m) {
  return Eigen::GeneralizedSelfAdjointEigenSolver<MatrixXd>(k, m, Eigen::EigenvaluesOnly).eigenvalues().head(k_modes);
}

TEST_P(NearbyModesTest, AgreesWithTheDenseSolver) {
  if (test::k_is_instrumented) GTEST_SKIP() << test::k_left_to_optimised_build;
  constexpr double k_limit = 1e-7;
  std::mt19937_64 random(1);
  for (const Index order : {96, 109}) {
    for (const bool is_mass_parametric : {false, true}) {
      for (const bool is_turned : {false, true}) {
        const Family family(order, 5, is_mass_parametric, is_turned, random);
        const TermCoefficients samples = coefficients(family, 37, 0.1, random);
        const DavidsonBounds bounds = bounds_of(samples);
        const BatchedDavidson solver = family.solver(GetParam());
        ASSERT_TRUE(solver.is_useful());
        const SketchedModes found = solver.solve(samples, bounds, k_limit, 1);
        Index solved = 0;
        for (Index s = 0; s < samples.samples(); ++s) {
          if (found.modes.failed[static_cast<std::size_t>(s)] != 0) continue;
          ++solved;
          const MatrixXd k = family.sum(family.stiffness, samples.stiffness, s);
          const MatrixXd m = family.sum(family.mass, samples.mass, s);
          const VectorXd exact = dense_values(k, m);
          const auto y = found.modes.sample_vectors(s);
          const auto lambda = found.modes.values.col(s);
          const MatrixXd residuals = k * y - m * y * lambda.asDiagonal();
          // The squared residual over the gap, which is a thousandth of lambda or more in 37 random samples' modes.
          EXPECT_LT(((lambda - exact).array() / exact.array()).head(k_converged).abs().maxCoeff(), 1e3 * k_limit);
          EXPECT_LT(((lambda - exact).array() / exact.array()).abs().maxCoeff(), 1e-3);
          for (Index mode = 0; mode < k_converged; ++mode) {
            EXPECT_LE(residuals.col(mode).squaredNorm(),
                      1.001 * k_limit * bounds.ratios(s) * std::max(lambda(mode), k_smallest));
          }
          EXPECT_LT((y.transpose() * m * y - MatrixXd::Identity(k_modes, k_modes)).cwiseAbs().maxCoeff(), 1e-11);
          const MatrixXd sketched = family.sum(family.stiffness_sketch, samples.stiffness, s) * y -
                                    family.sum(family.mass_sketch, samples.mass, s) * y * lambda.asDiagonal();
          EXPECT_LT((found.residuals.middleCols(s * k_modes, k_modes) - sketched).cwiseAbs().maxCoeff(),
                    1e-10 * sketched.cwiseAbs().maxCoeff());
        }
        EXPECT_GE(solved, 33);  // some samples' modes above the wanted ones are too close to count between them
      }
    }
  }
}

TEST_P(NearbyModesTest, GivesOnlyTheLowestModesHoweverFarTheSamplesAre) {
  if (test::k_is_instrumented) GTEST_SKIP() << test::k_left_to_optimised_build;
  std::mt19937_64 random(2);
  Index solved = 0, refused = 0;
  for (const double variation : {0.1, 0.25, 0.5}) {
    for (Index family_index = 0; family_index < 4; ++family_index) {
      const Family family(96, 4, family_index % 2 == 1, true, random);
      const TermCoefficients samples = coefficients(family, 60, variation, random);
      const SketchedModes found = family.solver(GetParam()).solve(samples, bounds_of(samples), 1e-6, 1);
      for (Index s = 0; s < samples.samples(); ++s) {
        if (found.modes.failed[static_cast<std::size_t>(s)] != 0) {
          ++refused;
          continue;
        }
        ++solved;
        const VectorXd exact =
            dense_values(family.sum(family.stiffness, samples.stiffness, s), family.sum(family.mass, samples.mass, s));
        EXPECT_LT(((found.modes.values.col(s) - exact).array() / exact.array()).head(k_converged).abs().maxCoeff(),
                  1e-3);
      }
    }
  }
  EXPECT_GT(solved, 200);
  EXPECT_GT(refused, 50);
}

TEST_P(NearbyModesTest, RefusesASampleWhoseLowestModeSharesNothingWithTheBlock) {
  // All terms diagonal: no residual ever shows mode 60, which one term alone carries.
  constexpr Index k_order = 96, k_lone = 60;
  std::mt19937_64 random(3);
  Family family(k_order, 2, false, false, random);
  family.stiffness[0] = k_shift * family.mass[0];
  family.stiffness[1] = MatrixXd::Identity(k_order, k_order);
  family.stiffness[1](k_lone, k_lone) = 0.0;
  family.stiffness[2] = MatrixXd::Zero(k_order, k_order);
  family.stiffness[2](k_lone, k_lone) = 1.0;
  TermCoefficients samples{MatrixXd::Ones(2, 3), MatrixXd(0, 3)};
  const double as_low_as_mode_4 = family.mass[0](k_lone, k_lone) / family.mass[0](4, 4);
  samples.stiffness(1, 1) = as_low_as_mode_4;
  samples.stiffness(1, 2) = std::numeric_limits<double>::quiet_NaN();
  // The same sample scaled so that it is not refused for its coefficients alone: the count has to refuse it.
  for (const double other : {1.0, 2.9 * as_low_as_mode_4}) {
    samples.stiffness(0, 1) = other;
    const SketchedModes found = family.solver(GetParam()).solve(samples, bounds_of(samples), 1e-6, 1);
    EXPECT_EQ(found.modes.failed[0], 0);
    EXPECT_EQ(found.modes.failed[1], 1);
    EXPECT_EQ(found.modes.failed[2], 1);
  }
}

TEST_P(NearbyModesTest, ASampleHasTheSameBitsWhateverItsNeighboursAndTheThreads) {
  std::mt19937_64 random(4);
  const Family family(96, 13, true, true, random);
  const TermCoefficients samples = coefficients(family, 70, 0.12, random);
  const DavidsonBounds bounds = bounds_of(samples);
  const BatchedDavidson solver = family.solver(GetParam());
  const SketchedModes together = solver.solve(samples, bounds, 1e-6, 2);
  for (const Index s : {0, 1, 9, 33, 69}) {
    const SketchedModes alone =
        solver.solve(samples.range(s, 1), {bounds.ratios.segment(s, 1), bounds.mass_ratios.segment(s, 1)}, 1e-6, 1);
    EXPECT_EQ(alone.modes.failed[0], together.modes.failed[static_cast<std::size_t>(s)]);
    if (alone.modes.failed[0] != 0) continue;
    EXPECT_EQ(alone.modes.values.col(0), together.modes.values.col(s));
    EXPECT_EQ(alone.modes.vectors.col(0), together.modes.vectors.col(s));
    EXPECT_EQ(alone.residuals, together.residuals.middleCols(s * k_modes, k_modes));
  }
}

TEST(BatchedDavidson, IsNoUseWherePencilsAreHardlyLargerThanTheBlock) {
  std::mt19937_64 random(5);
  const Family family(30, 3, false, true, random);
  const BatchedDavidson solver = family.solver(SimdLevel::automatic);
  EXPECT_FALSE(solver.is_useful());
  const TermCoefficients samples = coefficients(family, 5, 0.1, random);
  for (const auto failed : solver.solve(samples, bounds_of(samples), 1e-6, 1).modes.failed) EXPECT_EQ(failed, 1);
}

}  // namespace
}  // namespace mottle::linalg
