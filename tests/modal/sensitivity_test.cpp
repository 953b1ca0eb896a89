#include "mottle/modal/sensitivity.hpp"

#include <gtest/gtest.h>

#include <Eigen/Eigenvalues>
#include <cmath>
#include <random>

#include "mottle/core/error.hpp"

namespace mottle {
namespace {

using LongMatrix = Eigen::Matrix<long double, Eigen::Dynamic, Eigen::Dynamic>;

template <typename Matrix>
struct Modes {
  Matrix values;
  Matrix shapes;
};

/// Modes of K phi = lambda M phi, each shape with a positive product with `sign_of` where that is given.
Modes<LongMatrix> solve(const LongMatrix& stiffness, const LongMatrix& mass, const LongMatrix& sign_of = {}) {
  const Eigen::GeneralizedSelfAdjointEigenSolver<LongMatrix> solver(stiffness, mass);
  Modes<LongMatrix> modes{solver.eigenvalues(), solver.eigenvectors()};
  for (Eigen::Index r = 0; r < sign_of.cols(); ++r) {
    if (modes.shapes.col(r).dot(sign_of.col(r)) < 0) modes.shapes.col(r) *= -1;
  }
  return modes;
}

/// A pencil K + h dK, M + h dM of four degrees of freedom with distinct eigenvalues.
struct Pencil {
  explicit Pencil(std::uint64_t seed) {
    std::mt19937_64 random(seed);
    std::uniform_real_distribution<double> uniform(-0.5, 0.5);
    for (Eigen::MatrixXd* matrix : {&stiffness, &mass, &dK, &dM}) {
      matrix->resize(4, 4);
      for (double& entry : matrix->reshaped()) entry = uniform(random);
      *matrix = (*matrix + matrix->transpose()).eval();
    }
    stiffness.diagonal() += Eigen::Vector4d(10.0, 20.0, 30.0, 40.0);
    mass.diagonal().array() += 4.0;
  }

  Modes<LongMatrix> at(long double h, const LongMatrix& sign_of = {}) const {
    return solve(stiffness.cast<long double>() + h * dK.cast<long double>(),
                 mass.cast<long double>() + h * dM.cast<long double>(), sign_of);
  }
  ModeSet modes() const {
    const Modes<LongMatrix> exact = at(0);
    return {exact.values.cast<double>(), exact.shapes.cast<double>()};
  }

  Eigen::MatrixXd stiffness, mass, dK, dM;
};

// Central differences in 64-bit mantissas with h = 1e-5: truncation of order h^2 = 1e-10, rounding 1e-19 / h = 1e-14.
constexpr long double k_step = 1e-5L;
constexpr double k_difference_error = 1e-9;

TEST(EigenvalueSensitivity, IsThatOfDifferencesInExtendedPrecision) {
  for (std::uint64_t seed = 1; seed <= 5; ++seed) {
    const Pencil pencil(seed);
    const LongMatrix difference = (pencil.at(k_step).values - pencil.at(-k_step).values) / (2 * k_step);
    const Eigen::VectorXd derivative = eigenvalue_sensitivity(pencil.modes(), pencil.dK, pencil.dM);
    EXPECT_LT((derivative - difference.cast<double>()).norm(), k_difference_error) << seed;
  }
}

TEST(ShapeSensitivity, IsThatOfDifferencesInExtendedPrecision) {
  for (std::uint64_t seed = 1; seed <= 5; ++seed) {
    const Pencil pencil(seed);
    const LongMatrix shapes = pencil.at(0).shapes;
    const LongMatrix difference = (pencil.at(k_step, shapes).shapes - pencil.at(-k_step, shapes).shapes) / (2 * k_step);
    const Eigen::MatrixXd derivative = shape_sensitivity(pencil.modes(), pencil.dK, pencil.dM);
    EXPECT_LT((derivative - difference.cast<double>()).norm(), k_difference_error) << seed;
  }
}

// lambda = k / m, phi = m^(-1/2) at k = 8, m = 4: d lambda/dk = 1/4, d lambda/dm = -1/2, d phi/dm = -1/16.
TEST(EigenvalueSensitivity, OfOneMassIsTheClosedForm) {
  const ModeSet modes{Eigen::VectorXd::Constant(1, 2.0), Eigen::MatrixXd::Constant(1, 1, 0.5)};
  const Eigen::MatrixXd one = Eigen::MatrixXd::Ones(1, 1), zero = Eigen::MatrixXd::Zero(1, 1);
  EXPECT_DOUBLE_EQ(eigenvalue_sensitivity(modes, one, zero)(0), 0.25);
  EXPECT_DOUBLE_EQ(eigenvalue_sensitivity(modes, zero, one)(0), -0.5);
}

TEST(ShapeSensitivity, OfOneMassIsTheClosedForm) {
  const ModeSet modes{Eigen::VectorXd::Constant(1, 2.0), Eigen::MatrixXd::Constant(1, 1, 0.5)};
  const Eigen::MatrixXd one = Eigen::MatrixXd::Ones(1, 1), zero = Eigen::MatrixXd::Zero(1, 1);
  EXPECT_DOUBLE_EQ(shape_sensitivity(modes, zero, one)(0, 0), -0.0625);
  EXPECT_EQ(shape_sensitivity(modes, one, zero)(0, 0), 0.0);
}

// K = [1, x; x, 3], M = I at x = 0: the shapes turn by x / (lambda_1 - lambda_2) = -x/2, eigenvalues stand still.
TEST(ShapeSensitivity, OfACouplingIsTheRotationOfPerturbationTheory) {
  const ModeSet modes{Eigen::Vector2d(1.0, 3.0), Eigen::Matrix2d::Identity()};
  const Eigen::Matrix2d dK = (Eigen::Matrix2d() << 0.0, 1.0, 1.0, 0.0).finished();
  const Eigen::Matrix2d expected = (Eigen::Matrix2d() << 0.0, 0.5, -0.5, 0.0).finished();
  EXPECT_EQ(shape_sensitivity(modes, dK, Eigen::Matrix2d::Zero()), expected);
}

/// Eigenvalues 1, 1, 3 with their shapes.
ModeSet repeated_modes() {
  return {Eigen::Vector3d(1.0, 1.0, 3.0), Eigen::Matrix3d::Identity()};
}

TEST(ShapeSensitivity, IsNotANumberForRepeatedEigenvaluesAlone) {
  const Eigen::MatrixXd derivative =
      shape_sensitivity(repeated_modes(), Eigen::Matrix3d::Ones(), Eigen::Matrix3d::Zero());
  EXPECT_TRUE(derivative.leftCols(2).array().isNaN().all());
  EXPECT_TRUE(derivative.col(2).allFinite());
}

// Within the pair any rotation of the shapes is as good, and each gives another phi' dK phi.
TEST(EigenvalueSensitivity, IsNotANumberForRepeatedEigenvaluesAlone) {
  const Eigen::VectorXd derivative =
      eigenvalue_sensitivity(repeated_modes(), Eigen::Matrix3d::Ones(), Eigen::Matrix3d::Zero());
  EXPECT_TRUE(derivative.head(2).array().isNaN().all());
  EXPECT_EQ(derivative(2), 1.0);
}

TEST(ShapeSensitivity, NeedsAllModes) {
  const ModeSet modes{Eigen::VectorXd::Ones(1), Eigen::MatrixXd::Ones(2, 1)};
  EXPECT_THROW(shape_sensitivity(modes, Eigen::Matrix2d::Zero(), Eigen::Matrix2d::Zero()), InvalidInput);
}

}  // namespace
}  // namespace mottle
