// Closed forms, Eigen as outside reference, and the pencils that eigensolvers find hard.
#include "mottle/linalg/batched/batch_eigen.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <Eigen/Eigenvalues>
#include <cmath>
#include <numbers>
#include <random>

#include "linalg/pencils.hpp"
#include "mottle/core/error.hpp"

namespace mottle::linalg {
namespace {

using namespace linalg_test;

/// Largest of |K phi - lambda M phi| over |K|, and of |phi' M phi - I|.
double worst_defect(const Batch& batch, const BatchModes& modes) {
  double worst = 0.0;
  for (Index sample = 0; sample < modes.values.cols(); ++sample) {
    const MatrixXd stiffness = batch.stiffness(sample), mass = batch.mass(sample);
    const MatrixXd vectors = modes.sample_vectors(sample);
    const MatrixXd residual = stiffness * vectors - mass * vectors * modes.values.col(sample).asDiagonal();
    worst = std::max(worst, residual.norm() / stiffness.norm());
    const MatrixXd gram = vectors.transpose() * mass * vectors;
    worst = std::max(worst, (gram - MatrixXd::Identity(gram.rows(), gram.cols())).cwiseAbs().maxCoeff());
  }
  return worst;
}

/// Largest relative difference of eigenvalues from Eigen's generalised solver.
double worst_difference_from_eigen(const Batch& batch, const BatchModes& modes) {
  double worst = 0.0;
  for (Index sample = 0; sample < modes.values.cols(); ++sample) {
    const Eigen::GeneralizedSelfAdjointEigenSolver<MatrixXd> reference(batch.stiffness(sample), batch.mass(sample),
                                                                       Eigen::EigenvaluesOnly);
    for (Index mode = 0; mode < modes.values.rows(); ++mode) {
      const double expected = reference.eigenvalues()(mode);
      worst = std::max(worst, std::abs(modes.values(mode, sample) / expected - 1.0));
    }
  }
  return worst;
}

class BatchEigen : public AtEveryLevel {};
INSTANTIATE_TEST_SUITE_P(Levels, BatchEigen, every_level(), level_name);

TEST_P(BatchEigen, ThreeMassesWithIntegerEigenvaluesGiveThem) {
  MatrixXd stiffness(3, 3);
  stiffness << 5, -1, -3, -1, 3, -1, -3, -1, 5;
  const BatchModes modes = repeated(stiffness, MatrixXd::Identity(3, 3), 11).solve(options());
  for (Index sample = 0; sample < 11; ++sample) {
    // A few rounding errors of |K| = 8.
    EXPECT_NEAR(modes.values(0, sample), 1.0, 1e-14);
    EXPECT_NEAR(modes.values(1, sample), 4.0, 1e-14);
    EXPECT_NEAR(modes.values(2, sample), 8.0, 1e-14);
    const VectorXd first = modes.sample_vectors(sample).col(0);
    EXPECT_NEAR((first - VectorXd::Constant(3, 1.0 / std::sqrt(3.0))).norm(), 0.0, 1e-14)
        << "rows of K sum to 1, so (1, 1, 1) is the first mode";
  }
}

TEST_P(BatchEigen, FixedFreeChainsFollowTheirClosedForm) {
  for (const Index order : {1, 2, 3, 4, 5, 6, 7, 8, 9, 10, 20, 60, 120}) {
    const BatchModes modes = repeated(fixed_free_chain(order), MatrixXd::Identity(order, order), 3).solve(options());
    const auto n = static_cast<double>(order);
    for (Index mode = 0; mode < order; ++mode) {
      const double sine =
          std::sin((2.0 * static_cast<double>(mode) + 1.0) * std::numbers::pi / (2.0 * (2.0 * n + 1.0)));
      // Backward stable: some rounding errors of |K| = 4, relative to lambda_1 = 1.7e-4 at n = 120 that is 1e-11.
      EXPECT_NEAR(modes.values(mode, 2), 4.0 * sine * sine, 2e-15 + 1e-16 * n) << order << " masses, mode " << mode;
    }
    EXPECT_LT(worst_defect(repeated(fixed_free_chain(order), MatrixXd::Identity(order, order), 3), modes), 1e-12);
  }
}

TEST_P(BatchEigen, RandomPencilsAgreeWithEigenForEveryKindOfMass) {
  std::mt19937_64 random(7);
  for (const Index order : {1, 2, 3, 4, 5, 6, 7, 8, 9, 13, 30, 61}) {
    for (const Mass mass : {Mass::identity, Mass::constant_diagonal, Mass::constant_full, Mass::parametric_diagonal,
                            Mass::parametric_full}) {
      const Batch batch = random_batch(order, mass, 13, random);
      const BatchModes modes = batch.solve(options());
      // Eigenvalues spread over two decades: both solvers err by some 1e-14.
      EXPECT_LT(worst_difference_from_eigen(batch, modes), 1e-12) << order << " dof, mass " << static_cast<int>(mass);
      EXPECT_LT(worst_defect(batch, modes), 1e-12) << order << " dof, mass " << static_cast<int>(mass);
      EXPECT_THAT(modes.failed, testing::Each(0));
    }
  }
}

TEST_P(BatchEigen, LowestModesEqualTheFirstOfAll) {
  std::mt19937_64 random(8);
  for (const Index order : {6, 40, 110}) {
    const Batch batch = random_batch(order, Mass::constant_full, 9, random);
    const BatchModes modes = batch.solve(options(5));
    ASSERT_EQ(modes.values.rows(), 5);
    ASSERT_EQ(modes.vectors.rows(), 5 * order);
    EXPECT_LT(worst_difference_from_eigen(batch, modes), 1e-12);
    EXPECT_LT(worst_defect(batch, modes), 1e-12);
  }
}

TEST_P(BatchEigen, ValuesAloneAgreeWithValuesAndVectors) {
  std::mt19937_64 random(9);
  for (const Index order : {4, 25}) {
    const Batch batch = random_batch(order, Mass::parametric_full, 10, random);
    const BatchModes values_only = batch.solve(options(3, false));
    EXPECT_EQ(values_only.vectors.size(), 0);
    // The same arithmetic, but compiled separately: fused operations may differ.
    EXPECT_LT((values_only.values - batch.solve(options(3)).values).cwiseAbs().maxCoeff(), 1e-13);
  }
}

TEST_P(BatchEigen, IndefiniteStiffnessHasItsNegativeEigenvaluesFirst) {
  std::mt19937_64 random(10);
  for (const Index order : {3, 7, 24}) {
    const Batch batch = repeated(random_symmetric(order, random), random_definite(order, random), 5);
    const BatchModes modes = batch.solve(options());
    EXPECT_LT(modes.values(0, 0), 0.0);
    EXPECT_LT(worst_defect(batch, modes), 1e-12);
  }
}

TEST_P(BatchEigen, ExactlyRepeatedEigenvaluesHaveOrthonormalModes) {
  std::mt19937_64 random(11);
  for (const Index order : {4, 8, 12, 36, 64}) {
    // H = I - 2 u u' is orthogonal: K = H D H has eigenvalues 1, 1, 1, 2, 2, 2, ... up to rounding.
    const VectorXd u = uniform(order, 1, -1.0, 1.0, random).col(0).normalized();
    const MatrixXd reflection = MatrixXd::Identity(order, order) - 2.0 * u * u.transpose();
    VectorXd levels(order);
    for (Index i = 0; i < order; ++i) levels(i) = 1.0 + static_cast<double>(i / 3);
    const Batch batch = repeated(reflection * levels.asDiagonal() * reflection, MatrixXd::Identity(order, order), 9);
    const BatchModes modes = batch.solve(options());
    EXPECT_LT((modes.values.col(8) - levels).cwiseAbs().maxCoeff(), 1e-12) << order;
    EXPECT_LT(worst_defect(batch, modes), 1e-12) << order;
  }
}

TEST_P(BatchEigen, UncoupledCopiesOfOneStructureHaveOrthonormalModes) {
  for (const Index copies : {2, 3, 8}) {
    // Block diagonal: the tridiagonal matrix splits, and each eigenvalue occurs once in every block.
    const Index order = 12 * copies;
    MatrixXd stiffness = MatrixXd::Zero(order, order);
    for (Index copy = 0; copy < copies; ++copy) stiffness.block(12 * copy, 12 * copy, 12, 12) = fixed_free_chain(12);
    const Batch batch = repeated(stiffness, MatrixXd::Identity(order, order), 8);
    const BatchModes modes = batch.solve(options());
    EXPECT_LT(worst_defect(batch, modes), 1e-12) << copies;
    EXPECT_LT(worst_difference_from_eigen(batch, modes), 1e-12) << copies;
  }
}

TEST_P(BatchEigen, DiagonalAndZeroMatricesAreSolved) {
  for (const Index order : {1, 3, 8, 15}) {
    const MatrixXd identity = MatrixXd::Identity(order, order);
    for (const double level : {0.0, 1.0, -3.0, 1e12}) {
      const Batch batch = repeated(level * identity, identity, 3);
      const BatchModes modes = batch.solve(options());
      // Exact for Jacobi; bisection ends within 1 eps of the bound.
      EXPECT_LE((modes.values.array() - level).abs().maxCoeff(), 1e-15 * std::abs(level) + 1e-280);
      for (Index sample = 0; sample < 3; ++sample) {
        const MatrixXd vectors = modes.sample_vectors(sample);
        EXPECT_LT((vectors.transpose() * vectors - identity).cwiseAbs().maxCoeff(), 1e-13);
      }
    }
  }
}

TEST_P(BatchEigen, WilkinsonPairsAgreeingToRoundingHaveOrthonormalModes) {
  // W21+ : tridiagonal, |i - 10| on the diagonal; its highest eigenvalues agree in pairs to 14 digits [Wilkinson1965].
  MatrixXd stiffness = MatrixXd::Zero(21, 21);
  for (Index i = 0; i < 21; ++i) {
    stiffness(i, i) = std::abs(static_cast<double>(i) - 10.0);
    if (i > 0) stiffness(i, i - 1) = stiffness(i - 1, i) = 1.0;
  }
  const Batch batch = repeated(stiffness, MatrixXd::Identity(21, 21), 8);
  const BatchModes modes = batch.solve(options());
  EXPECT_NEAR(modes.values(20, 0), 10.746194182903393, 1e-13);  // published, 15 digits
  EXPECT_LT(worst_defect(batch, modes), 1e-12);
}

TEST_P(BatchEigen, FreeStructuresHaveRigidBodyModesAtZero) {
  for (const Index order : {3, 8, 50}) {
    MatrixXd stiffness = fixed_free_chain(order);
    stiffness(0, 0) = 1.0;  // nothing tied to the ground
    const BatchModes modes = repeated(stiffness, MatrixXd::Identity(order, order), 4).solve(options(2));
    const auto n = static_cast<double>(order);
    EXPECT_NEAR(modes.values(0, 0), 0.0, 1e-14) << "a few rounding errors of |K| = 4";
    EXPECT_NEAR(modes.values(1, 0), 4.0 * std::pow(std::sin(std::numbers::pi / (2.0 * n)), 2), 1e-14);
    const VectorXd rigid = VectorXd::Constant(order, 1.0 / std::sqrt(n));
    EXPECT_NEAR((modes.sample_vectors(0).col(0) - rigid).cwiseAbs().maxCoeff(), 0.0, 1e-12);
  }
}

TEST_P(BatchEigen, DiagonalMassScalesAnUncoupledStiffnessExactly) {
  const VectorXd masses = VectorXd::Constant(3, 3.0), springs = (VectorXd(3) << 6.0, 9.0, 21.0).finished();
  const BatchModes modes = repeated(springs.asDiagonal(), masses.asDiagonal(), 8).solve(options());
  EXPECT_EQ(modes.values.col(0), (VectorXd(3) << 2.0, 3.0, 7.0).finished());
}

TEST_P(BatchEigen, LargestComponentOfAModeIsPositiveAndTiesGoToTheFirst) {
  std::mt19937_64 random(12);
  for (const Index order : {2, 5, 8, 20}) {
    const Batch batch = random_batch(order, Mass::constant_full, 8, random);
    const BatchModes modes = batch.solve(options());
    for (Index sample = 0; sample < 8; ++sample) {
      const MatrixXd vectors = modes.sample_vectors(sample);
      for (Index mode = 0; mode < order; ++mode) {
        Index largest = 0;
        vectors.col(mode).cwiseAbs().maxCoeff(&largest);
        EXPECT_GT(vectors(largest, mode), 0.0);
      }
    }
  }
  const MatrixXd pair = (MatrixXd(2, 2) << 2.0, -1.0, -1.0, 2.0).finished();
  const BatchModes modes = repeated(pair, MatrixXd::Identity(2, 2), 1).solve(options());
  EXPECT_GT(modes.sample_vectors(0)(0, 1), 0.0) << "(1, -1) / sqrt(2), equal magnitudes";
}

TEST_P(BatchEigen, UnitsOfAnyPracticalSizeCauseNoOverflow) {
  std::mt19937_64 random(16);
  for (const Index order : {4, 18}) {
    const MatrixXd stiffness = random_definite(order, random), mass = random_definite(order, random);
    const Batch plain = repeated(stiffness, mass, 2);
    for (const double scale : {0x1p-100, 0x1p100}) {
      const BatchModes scaled = repeated(stiffness * scale, mass, 2).solve(options());
      EXPECT_THAT(scaled.failed, testing::Each(0));
      EXPECT_LT((scaled.values / scale - plain.solve(options()).values).cwiseAbs().maxCoeff(), 1e-13);
    }
  }
}

TEST_P(BatchEigen, GradedStiffnessKeepsItsLowEigenvaluesAccurateUpTo8Dof) {
  // K = D C D with D = diag(1, 1e-3, 1e-6): a well-conditioned C fixes every eigenvalue to relative accuracy
  // [BarlowDemmel1990]; the reference is the 2 x 2 and 1 x 1 Schur complements, exact here to 1e-6 relative terms.
  const VectorXd scale = (VectorXd(3) << 1.0, 1e-3, 1e-6).finished();
  const MatrixXd core = (MatrixXd(3, 3) << 2, 1, 1, 1, 2, 1, 1, 1, 2).finished();
  const BatchModes modes =
      repeated(scale.asDiagonal() * core * scale.asDiagonal(), MatrixXd::Identity(3, 3), 1).solve(options());
  // det C = 4, its leading minors 2 and 3; so lambda = 2, 3/2 * 1e-6, 4/3 * 1e-12 to first order in 1e-6.
  EXPECT_NEAR(modes.values(0, 0) / (4.0 / 3.0 * 1e-12), 1.0, 2e-6);
  EXPECT_NEAR(modes.values(1, 0) / (1.5e-6), 1.0, 2e-6);
  EXPECT_NEAR(modes.values.col(0).prod() / 4e-18, 1.0, 1e-14) << "det K = det C * 1e-18";
}

TEST(BatchEigenSizes, OrdersBeyondTheLanesAreSolvedToo) {
  const BatchModes modes = repeated(fixed_free_chain(201), MatrixXd::Identity(201, 201), 2).solve({.modes = 3});
  for (Index mode = 0; mode < 3; ++mode) {
    const double sine = std::sin((2.0 * static_cast<double>(mode) + 1.0) * std::numbers::pi / 806.0);
    EXPECT_NEAR(modes.values(mode, 1), 4.0 * sine * sine, 2e-14) << "some rounding errors of |K| = 4";
  }
}

TEST(BatchEigenSizes, AnEmptyBatchHasNoResults) {
  const BatchModes modes = repeated(MatrixXd::Identity(3, 3), MatrixXd::Identity(3, 3), 0).solve();
  EXPECT_EQ(modes.values.rows(), 3);
  EXPECT_EQ(modes.values.cols(), 0);
}

TEST(BatchEigenInput, ShapesThatDoNotFitAreRefused) {
  const MatrixXd two = MatrixXd::Identity(2, 2), three = MatrixXd::Identity(3, 3);
  EXPECT_THROW(repeated(three, two, 1).solve(), InvalidInput);
  EXPECT_THROW(repeated(three, three, 1).solve({.modes = 4}), InvalidInput);
  EXPECT_THROW(repeated(three, three, 1).solve({.threads = 0}), InvalidInput);
  EXPECT_THROW(solve_batch({three, {three}, three, {}}, MatrixXd(2, 4), MatrixXd()), InvalidInput);
  EXPECT_THROW(solve_batch({three, {three}, three, {three}}, MatrixXd(1, 4), MatrixXd(1, 5)), InvalidInput);
  EXPECT_THROW(solve_batch({three, {two}, three, {}}, MatrixXd(1, 4), MatrixXd()), InvalidInput);
}

}  // namespace
}  // namespace mottle::linalg
