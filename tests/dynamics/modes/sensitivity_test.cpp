#include "mottle/dynamics/modes/sensitivity.hpp"

#include <gtest/gtest.h>

#include <Eigen/Eigenvalues>
#include <cmath>
#include <random>

#include "mottle/core/error.hpp"

namespace mottle::dynamics {
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
TEST(EigenvalueSensitivity, HasTheClosedFormOfOneMass) {
  const ModeSet modes{Eigen::VectorXd::Constant(1, 2.0), Eigen::MatrixXd::Constant(1, 1, 0.5)};
  const Eigen::MatrixXd one = Eigen::MatrixXd::Ones(1, 1), zero = Eigen::MatrixXd::Zero(1, 1);
  EXPECT_DOUBLE_EQ(eigenvalue_sensitivity(modes, one, zero)(0), 0.25);
  EXPECT_DOUBLE_EQ(eigenvalue_sensitivity(modes, zero, one)(0), -0.5);
}

TEST(ShapeSensitivity, HasTheClosedFormOfOneMass) {
  const ModeSet modes{Eigen::VectorXd::Constant(1, 2.0), Eigen::MatrixXd::Constant(1, 1, 0.5)};
  const Eigen::MatrixXd one = Eigen::MatrixXd::Ones(1, 1), zero = Eigen::MatrixXd::Zero(1, 1);
  EXPECT_DOUBLE_EQ(shape_sensitivity(modes, zero, one)(0, 0), -0.0625);
  EXPECT_EQ(shape_sensitivity(modes, one, zero)(0, 0), 0.0);
}

// K = [1, x; x, 3], M = I at x = 0: the shapes turn by x / (lambda_1 - lambda_2) = -x/2, eigenvalues stand still.
TEST(ShapeSensitivity, IsTheRotationOfPerturbationTheoryForACoupling) {
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

/// Sparse lower triangle of a dense symmetric matrix.
SparseMatrix lower_of(const Eigen::MatrixXd& dense) {
  SparseMatrix sparse = Eigen::MatrixXd(dense.triangularView<Eigen::Lower>()).sparseView();
  sparse.makeCompressed();
  return sparse;
}

/// Nelson's derivative of a pencil's mode from that mode and the eigenvalues alone.
Eigen::VectorXd nelson(const Pencil& pencil, int mode) {
  ModeSet modes = pencil.modes();
  const Eigen::VectorXd shape = modes.shapes.col(mode);
  modes.shapes.setConstant(1e300);  // the other shapes must not be looked at
  modes.shapes.col(mode) = shape;
  return nelson_shape_sensitivity(lower_of(pencil.stiffness), lower_of(pencil.mass), modes, mode, pencil.dK * shape,
                                  pencil.dM * shape);
}

TEST(NelsonShapeSensitivity, IsThatOfDifferencesInExtendedPrecision) {
  for (std::uint64_t seed = 1; seed <= 5; ++seed) {
    const Pencil pencil(seed);
    const LongMatrix shapes = pencil.at(0).shapes;
    const LongMatrix difference = (pencil.at(k_step, shapes).shapes - pencil.at(-k_step, shapes).shapes) / (2 * k_step);
    for (int mode = 0; mode < 4; ++mode) {
      EXPECT_LT((nelson(pencil, mode) - difference.col(mode).cast<double>()).norm(), k_difference_error)
          << seed << ", mode " << mode;
    }
  }
}

// K singular: the shape of the rigid body motion, by whose own component of largest magnitude the system is fixed.
TEST(NelsonShapeSensitivity, AgreesWithTheExpansionForARigidBodyMode) {
  const Eigen::MatrixXd stiffness{{1.0, -1.0, 0.0}, {-1.0, 3.0, -2.0}, {0.0, -2.0, 2.0}};
  const Eigen::MatrixXd mass = Eigen::Vector3d(1.0, 2.0, 3.0).asDiagonal();
  const Eigen::MatrixXd dM = Eigen::Vector3d(0.0, 1.0, 0.0).asDiagonal(), dK = Eigen::Matrix3d::Zero();
  const Modes<LongMatrix> exact = solve(stiffness.cast<long double>(), mass.cast<long double>());
  const ModeSet modes{exact.values.cast<double>(), exact.shapes.cast<double>()};
  const Eigen::VectorXd shape = modes.shapes.col(0);
  const Eigen::VectorXd derivative =
      nelson_shape_sensitivity(lower_of(stiffness), lower_of(mass), modes, 0, dK * shape, dM * shape);
  // phi = (1, 1, 1) / sqrt(sum of masses): d phi = -phi / (2 sum of masses).
  EXPECT_LT((derivative + shape / 12.0).norm(), 1e-14);
}

TEST(NelsonShapeSensitivity, IsEachParametersOwn) {
  const Pencil pencil(6);
  const ModeSet modes = pencil.modes();
  const Eigen::VectorXd shape = modes.shapes.col(1);
  Eigen::MatrixXd elastic(4, 2), inertial(4, 2);
  elastic << pencil.dK * shape, Eigen::VectorXd::Zero(4);
  inertial << Eigen::VectorXd::Zero(4), pencil.dM * shape;
  const Eigen::MatrixXd both =
      nelson_shape_sensitivity(lower_of(pencil.stiffness), lower_of(pencil.mass), modes, 1, elastic, inertial);
  EXPECT_LT((both.rowwise().sum() - nelson(pencil, 1)).norm(), 1e-13) << "derivatives add up";
}

TEST(NelsonShapeSensitivity, IsNotANumberForARepeatedEigenvalueAlone) {
  const SparseMatrix stiffness = lower_of(Eigen::Vector3d(1.0, 1.0, 3.0).asDiagonal());
  const SparseMatrix mass = lower_of(Eigen::Matrix3d::Identity());
  const auto of_mode = [&](int mode) {
    return nelson_shape_sensitivity(stiffness, mass, repeated_modes(), mode, Eigen::Vector3d::Ones(),
                                    Eigen::Vector3d::Zero());
  };
  EXPECT_TRUE(of_mode(0).array().isNaN().all() && of_mode(1).array().isNaN().all());
  EXPECT_TRUE(of_mode(2).allFinite());
}

/// Modes 2 and 3 of K phi = lambda phi share an eigenvalue; K is full.
struct RepeatedPencil {
  RepeatedPencil() {
    std::mt19937_64 random(7);
    std::uniform_real_distribution<double> uniform(-1.0, 1.0);
    Eigen::MatrixXd full(4, 4);
    for (Eigen::MatrixXd* matrix : {&full, &dK, &dM}) {
      matrix->resize(4, 4);
      for (double& entry : matrix->reshaped()) entry = uniform(random);
      *matrix = (*matrix + matrix->transpose()).eval();
    }
    const Eigen::MatrixXd axes = Eigen::SelfAdjointEigenSolver<Eigen::MatrixXd>(full).eigenvectors();
    modes = {Eigen::Vector4d(1.0, 2.0, 2.0, 5.0), axes};
    stiffness = axes * modes.eigenvalues.asDiagonal() * axes.transpose();
  }
  /// Eigenvalues 2 and 3 at a distance h.
  Eigen::Vector2d pair_at(long double h) const {
    const LongMatrix identity = LongMatrix::Identity(4, 4);
    return solve(stiffness.cast<long double>() + h * dK.cast<long double>(), identity + h * dM.cast<long double>())
        .values.col(0)
        .segment(1, 2)
        .cast<double>();
  }
  ModeSet modes;
  Eigen::MatrixXd stiffness, dK, dM;
};

// Forward the smaller derivative leads to the smaller eigenvalue, backward to the larger one. The one-sided difference
// is off by h times the second derivative, of order one; rounding of the shapes 1e-16 / h = 1e-9.
TEST(RepeatedEigenvalueSensitivity, IsHowThePairSplits) {
  constexpr double k_small = 1e-7;
  const RepeatedPencil pencil;
  const Eigen::MatrixXd pair = pencil.modes.shapes.middleCols(1, 2);
  const Eigen::VectorXd split =
      repeated_eigenvalue_sensitivity(pencil.modes, {1, 2}, pencil.dK * pair, pencil.dM * pair);
  ASSERT_GT(split(1) - split(0), 0.1);
  const Eigen::Vector2d forward = (pencil.pair_at(k_small).array() - 2.0) / k_small;
  const Eigen::Vector2d backward = (2.0 - pencil.pair_at(-k_small).array()) / k_small;
  EXPECT_LT((split - forward).norm(), 1e-5);
  EXPECT_LT((split - backward.reverse()).norm(), 1e-5);
}

// The split does not depend on which pair of shapes the solver happened to find.
TEST(RepeatedEigenvalueSensitivity, IsTheSameForTurnedShapes) {
  RepeatedPencil pencil;
  const auto split = [&] {
    const Eigen::MatrixXd pair = pencil.modes.shapes.middleCols(1, 2);
    return repeated_eigenvalue_sensitivity(pencil.modes, {1, 2}, pencil.dK * pair, pencil.dM * pair);
  };
  const Eigen::VectorXd before = split();
  const double c = std::cos(0.8), s = std::sin(0.8);
  pencil.modes.shapes.middleCols(1, 2) *= Eigen::Matrix2d{{c, -s}, {s, c}};
  EXPECT_LT((split() - before).norm(), 1e-14);
}

TEST(RepeatedEigenvalueSensitivity, NeedsAProductForEachMember) {
  const Eigen::MatrixXd one = Eigen::MatrixXd::Ones(3, 1);
  EXPECT_THROW(repeated_eigenvalue_sensitivity(repeated_modes(), {0, 1}, one, one), InvalidInput);
  EXPECT_THROW(repeated_eigenvalue_sensitivity(repeated_modes(), {}, Eigen::MatrixXd(3, 0), Eigen::MatrixXd(3, 0)),
               InvalidInput);
}

}  // namespace
}  // namespace mottle::dynamics
