// Bounds on Ritz values against exact eigenvalues of random dense pencils, with exact residual norms.
#include "linalg/reduced/certificate.hpp"

#include <gtest/gtest.h>

#include <Eigen/Cholesky>
#include <Eigen/Eigenvalues>
#include <algorithm>
#include <cmath>
#include <limits>
#include <random>
#include <vector>

namespace mottle::linalg {
namespace {

using Eigen::Index;
using Eigen::MatrixXd;
using Eigen::VectorXd;

constexpr Index k_equations = 40;
constexpr double k_unseen = std::numeric_limits<double>::infinity();  // nothing is hidden from these residuals

MatrixXd random_matrix(Index rows, Index columns, std::mt19937_64& random) {
  std::normal_distribution<double> normal;
  MatrixXd matrix(rows, columns);
  for (double& entry : matrix.reshaped()) entry = normal(random);
  return matrix;
}

/// A pencil with given eigenvalues: A = T diag(lambda) T', M = T T'.
struct Pencil {
  MatrixXd a, m, shapes;

  Pencil(const VectorXd& values, std::mt19937_64& random) {
    const MatrixXd t =
        random_matrix(values.size(), values.size(), random) / std::sqrt(static_cast<double>(k_equations)) +
        2.0 * MatrixXd::Identity(values.size(), values.size());
    a = t * values.asDiagonal() * t.transpose();
    m = t * t.transpose();
    shapes = t.transpose().inverse();
  }
};

struct Ritz {
  VectorXd values;
  VectorXd squares;  ///< r' A^-1 r / mu
};

/// Ritz pairs of the lowest shapes disturbed by `disturbance`, with some random vectors in the space as well.
Ritz ritz(const Pencil& pencil, Index modes, double disturbance, std::mt19937_64& random) {
  MatrixXd space(k_equations, modes + 3);
  space.leftCols(modes) =
      pencil.shapes.leftCols(modes) + disturbance * pencil.shapes * random_matrix(k_equations, modes, random);
  space.rightCols(3) = random_matrix(k_equations, 3, random);
  const Eigen::GeneralizedSelfAdjointEigenSolver<MatrixXd> solver(space.transpose() * pencil.a * space,
                                                                  space.transpose() * pencil.m * space);
  Ritz result{solver.eigenvalues().head(modes), {}};
  const MatrixXd u = space * solver.eigenvectors().leftCols(modes);
  const MatrixXd residuals = pencil.a * u - pencil.m * u * result.values.asDiagonal();
  result.squares =
      residuals.cwiseProduct(pencil.a.llt().solve(residuals)).colwise().sum().transpose().cwiseQuotient(result.values);
  return result;
}

/// Ascending eigenvalues of which some come close or are equal.
VectorXd spectrum(std::mt19937_64& random) {
  std::uniform_real_distribution<double> uniform(0.0, 1.0);
  VectorXd values(k_equations);
  double value = 1.0;
  for (Index i = 0; i < k_equations; ++i) {
    const double kind = uniform(random);
    value *= kind < 0.15 ? 1.0 : kind < 0.3 ? 1.0 + 1e-4 * uniform(random) : 1.0 + 0.4 * uniform(random);
    values(i) = value;
  }
  return values;
}

TEST(ErrorBounds, HoldForRandomPencilsWithCloseAndEqualEigenvalues) {
  constexpr Index k_modes = 8;
  constexpr Index k_wanted = 5;
  std::mt19937_64 random(3);
  std::vector<double> overestimates;
  int finite = 0;
  for (int trial = 0; trial < 1000; ++trial) {
    const VectorXd exact = spectrum(random);
    const Pencil pencil(exact, random);
    const double disturbance = std::pow(10.0, -4.0 + 2.5 * static_cast<double>(trial % 100) / 100.0);
    const Ritz found = ritz(pencil, k_modes, disturbance, random);
    const VectorXd bounds = error_bounds(found.values, found.squares, k_unseen, k_wanted);
    for (Index k = 0; k < k_wanted; ++k) {
      if (!std::isfinite(bounds(k))) continue;
      ++finite;
      const double error = 1.0 - exact(k) / found.values(k);
      EXPECT_GE(error, -1e-10);
      EXPECT_LE(error, bounds(k) + 1e-10) << "trial " << trial << ", mode " << k;
      if (error > 1e-9) overestimates.push_back(bounds(k) / error);
    }
  }
  EXPECT_GT(finite, 1500);
  std::nth_element(overestimates.begin(), overestimates.begin() + static_cast<long>(overestimates.size() / 2),
                   overestimates.end());
  EXPECT_LT(overestimates[overestimates.size() / 2], 4.0);
}

TEST(ErrorBounds, EqualEigenvaluesNeedNoGapBetweenEachOther) {
  const VectorXd values = (VectorXd(5) << 1.0, 2.0, 2.0, 2.0, 5.0).finished();
  const VectorXd bounds = error_bounds(values, VectorXd::Constant(5, 1e-6), k_unseen, 4);
  EXPECT_LT(bounds.maxCoeff(), 6e-6);  // of three at once over a gap of 0.6
}

TEST(ErrorBounds, WhatIsEnoughIsNotSoughtSmaller) {
  const VectorXd values = (VectorXd(5) << 1.0, 1.9, 2.0, 2.1, 5.0).finished();
  const VectorXd squares = VectorXd::Constant(5, 1e-6);
  const VectorXd least = error_bounds(values, squares, k_unseen, 4);
  const VectorXd first = error_bounds(values, squares, k_unseen, 4, 1.0);
  EXPECT_LT(least(1), 0.5 * first(1));
  EXPECT_LE(first(1), 1.1 * 1e-6 / (1.0 - 1.9 / 2.0));  // Kato and Temple's, with the next mode's own error
  const VectorXd some = error_bounds(values, squares, k_unseen, 4, 1e-9);
  EXPECT_EQ(some, least);
}

TEST(ErrorBounds, ClaimNothingWhereTheNextModeIsAsLow) {
  const VectorXd values = (VectorXd(3) << 1.0, 2.0, 2.0).finished();
  const VectorXd bounds = error_bounds(values, VectorXd::Constant(3, 1e-6), k_unseen, 2);
  EXPECT_LT(bounds(0), 3e-6);
  EXPECT_TRUE(std::isinf(bounds(1)));
}

TEST(ErrorBounds, ClaimNothingWhereResidualsAreLarge) {
  const VectorXd values = (VectorXd(3) << 1.0, 2.0, 8.0).finished();
  const VectorXd bounds = error_bounds(values, VectorXd::Constant(3, 0.5), k_unseen, 2);
  EXPECT_TRUE(std::isinf(bounds(0)));
  EXPECT_TRUE(std::isinf(bounds(1)));
}

TEST(ErrorBounds, AModeThatIsNotSeenJustAboveItsFloorIsCounted) {
  // A^-1 M in the basis of Ritz vectors 1, 2 and of what is not seen: the first couples with that, the second does not.
  for (const double above : {0.1, 0.02, 0.005}) {
    for (const double coupling : {1e-4, 1e-3, 3e-3}) {
      Eigen::Matrix3d inverse = Eigen::Vector3d(1.0, 0.5, 1.0 / (1.0 + above)).asDiagonal();
      inverse(0, 2) = inverse(2, 0) = coupling;
      const double exact = 1.0 / Eigen::SelfAdjointEigenSolver<Eigen::Matrix3d>(inverse).eigenvalues()(2);
      const VectorXd values = Eigen::Vector2d(1.0, 2.0), squares = Eigen::Vector2d(coupling * coupling, 0.0);
      const double bound = error_bounds(values, squares, 1.0 + above, 1)(0);
      EXPECT_GE(bound, 1.0 - exact) << above << ", " << coupling;
      EXPECT_LT(error_bounds(values, squares, k_unseen, 1)(0), 1.0 - exact) << "the test would show nothing";
    }
  }
}

TEST(ErrorBounds, AGuardThatCouplesWithWhatIsNotSeenLowersTheNextEigenvalue) {
  // Two Ritz vectors with residuals; the guard and the unseen mode push each other below both.
  for (const double unseen : {1.05, 1.1, 1.2, 1.5}) {
    for (const double guard : {1.05, 1.1, 1.2, 1.5}) {
      Eigen::Matrix3d inverse = Eigen::Vector3d(1.0, 1.0 / guard, 1.0 / unseen).asDiagonal();
      inverse(0, 2) = inverse(2, 0) = 2e-3;
      inverse(1, 2) = inverse(2, 1) = 0.02 / guard;
      const double exact = 1.0 / Eigen::SelfAdjointEigenSolver<Eigen::Matrix3d>(inverse).eigenvalues()(2);
      const VectorXd values = Eigen::Vector2d(1.0, guard), squares = Eigen::Vector2d(4e-6, 4e-4);
      EXPECT_GE(error_bounds(values, squares, unseen, 1)(0), 1.0 - exact) << unseen << ", " << guard;
    }
  }
}

}  // namespace
}  // namespace mottle::linalg
