// Inertia of mass matrices against closed forms and congruence transforms of known inertia.
#include "mottle/linalg/sparse/negative_mass.hpp"

#include <fmt/format.h>
#include <gtest/gtest.h>

#include <Eigen/LU>
#include <algorithm>
#include <cmath>
#include <optional>
#include <random>
#include <string>
#include <vector>

#include "linalg/pencils.hpp"
#include "mottle/linalg/sparse/sparse_modes.hpp"

namespace mottle::linalg {
namespace {

using Eigen::Index;
using Eigen::MatrixXd;
using Eigen::VectorXd;
using linalg_test::fixed_free_chain;
using linalg_test::lower_of;
using Kind = NegativeMass::Kind;

std::optional<NegativeMass> negative_in(const MatrixXd& mass) {
  return find_negative_mass(lower_of(fixed_free_chain(mass.rows())), lower_of(mass));
}

/// Consistent mass of a free rod of unit elements: its sum of entries is the number of elements.
MatrixXd rod_mass(Index elements) {
  MatrixXd mass = MatrixXd::Zero(elements + 1, elements + 1);
  for (Index e = 0; e < elements; ++e) {
    mass(e, e) += 2.0 / 6.0;
    mass(e + 1, e + 1) += 2.0 / 6.0;
    mass(e, e + 1) += 1.0 / 6.0;
    mass(e + 1, e) += 1.0 / 6.0;
  }
  return mass;
}

TEST(NegativeMass, OfADiagonalIsItsLowestEntry) {
  const auto found = negative_in(Eigen::Vector4d(2.0, -0.5, 1.0, -3.0).asDiagonal());
  ASSERT_TRUE(found);
  EXPECT_EQ(found->kind, Kind::diagonal);
  EXPECT_EQ(found->row, 3);
  EXPECT_EQ(found->value, -3.0);
  EXPECT_EQ(describe(*found, "101:+Z"),
            "the mass matrix is not positive semidefinite: the diagonal entry of row 101:+Z is -3");
}

TEST(NegativeMass, IsNotThatOfRowsWithoutMass) {
  EXPECT_FALSE(negative_in(Eigen::Vector4d(2.0, 0.0, 1.0, 0.0).asDiagonal()));
  MatrixXd mass = MatrixXd::Zero(9, 9);
  mass.block(2, 2, 5, 5) = rod_mass(4);
  EXPECT_FALSE(negative_in(mass));
}

// M - c (M 1)(M 1)' has the eigenvalue zero along 1 at c = 1 / (1' M 1): the total mass.
TEST(NegativeMass, OfARankOneUpdateBeginsAtItsExactThreshold) {
  constexpr Index k_elements = 60;
  const MatrixXd mass = rod_mass(k_elements);
  const VectorXd momentum = mass.rowwise().sum();
  const auto updated = [&](double part) -> MatrixXd {
    return mass - part / static_cast<double>(k_elements) * momentum * momentum.transpose();
  };
  EXPECT_FALSE(negative_in(updated(1.0 - 1e-6)));
  EXPECT_FALSE(negative_in(updated(1.0)));
  const auto found = negative_in(updated(1.0 + 1e-6));
  ASSERT_TRUE(found);
  EXPECT_EQ(found->kind, Kind::pivot);
  // The last pivot, 1 / (M^-1)_rr, is x' M x along 1 but for terms of the square of what M lacks, and D.
  EXPECT_NEAR(found->value, -1e-6 * static_cast<double>(k_elements), 1e-7 * static_cast<double>(k_elements));
}

// [2 1 0; 1 a 1; 0 1 2] has the determinant 4 (a - 1).
TEST(NegativeMass, OfOneRowBeginsWhereTheDeterminantVanishes) {
  const auto mass = [](double a) {
    MatrixXd result(3, 3);
    result << 2, 1, 0, 1, a, 1, 0, 1, 2;
    return result;
  };
  EXPECT_FALSE(negative_in(mass(1.0)));
  EXPECT_FALSE(negative_in(mass(1.0 + 1e-6)));
  EXPECT_TRUE(negative_in(mass(1.0 - 1e-6)));
}

TEST(NegativeMass, IsThatOfAnEntryBesideAZeroOnTheDiagonal) {
  MatrixXd mass(3, 3);
  mass << 1, 0, 0, 0, 0, 0.5, 0, 0.5, 1;
  const auto found = negative_in(mass);
  ASSERT_TRUE(found);
  EXPECT_EQ(found->kind, Kind::coupling);
  EXPECT_EQ(found->row, 1);
  EXPECT_EQ(found->value, 0.5);
}

/// L' diag(d) L with a random sparse unit triangle L, and rows in units between 1e-6 and 1e6.
MatrixXd congruent(const VectorXd& diagonal, std::mt19937_64& random) {
  std::uniform_real_distribution<double> entries(-0.5, 0.5), exponents(-6.0, 6.0);
  const Index size = diagonal.size();
  MatrixXd triangle = MatrixXd::Identity(size, size);
  for (Index j = 0; j < size; ++j) {
    for (Index i = j + 1; i < std::min(j + 4, size); ++i) triangle(i, j) = entries(random);
  }
  VectorXd units(size);
  for (double& unit : units) unit = std::pow(10.0, exponents(random));
  const MatrixXd mass = triangle.transpose() * diagonal.asDiagonal() * triangle;
  return units.asDiagonal() * mass * units.asDiagonal();
}

// Sylvester's law: congruence keeps the number of negative eigenvalues.
TEST(NegativeMass, IsFoundInCongruenceTransformsWhateverTheUnits) {
  std::mt19937_64 random(5);
  std::uniform_real_distribution<double> positive(0.5, 2.0), exponents(-5.0, 0.0);
  for (int trial = 0; trial < 300; ++trial) {
    VectorXd diagonal(40);
    for (double& entry : diagonal) entry = random() % 4 == 0 ? 0.0 : positive(random);
    const bool is_indefinite = trial % 2 == 1;
    if (is_indefinite) diagonal(static_cast<Index>(random() % 40)) = -std::pow(10.0, exponents(random));
    const MatrixXd mass = congruent(diagonal, random);
    const SparseMatrix stiffness = lower_of(mass.diagonal().cwiseAbs().asDiagonal());
    const auto found = find_negative_mass(stiffness, lower_of(mass));
    ASSERT_EQ(found.has_value(), is_indefinite) << trial;
    if (found && found->kind != Kind::coupling) {
      EXPECT_LT(found->value, 0.0) << trial;
    }
  }
}

// A point mass about another point: rank one, and singular but for the digits that a file keeps.
TEST(NegativeMass, IsNotWhatTenDigitsLeaveOfASingularMass) {
  for (const double arm : {1.0 / 3.0, 123.456789, 1e-4 / 7.0}) {
    MatrixXd mass(2, 2);
    mass << 1.0, arm, arm, arm * arm;
    for (double& entry : mass.reshaped()) entry = std::stod(fmt::format("{:.9e}", entry));
    EXPECT_FALSE(negative_in(mass)) << arm;
    mass(1, 1) *= 1.0 - 1e-6;
    EXPECT_TRUE(negative_in(mass)) << arm;
  }
}

// Terms of a stiff row that cancel leave 1e-17 of the masses beside it.
TEST(NegativeMass, IsNotRoundingBesideMassesInTheSameUnits) {
  EXPECT_FALSE(negative_in(Eigen::Vector4d(1.0, -1e-17, 2.0, 1.0).asDiagonal()));
  EXPECT_TRUE(negative_in(Eigen::Vector4d(1.0, -1e-9, 2.0, 1.0).asDiagonal()));
  EXPECT_TRUE(negative_in(1e-12 * MatrixXd(Eigen::Vector4d(1.0, -1e-9, 2.0, 1.0).asDiagonal())));
}

TEST(NegativeMass, IsThePivotInAnyOrderOfElimination) {
  const VectorXd momentum = rod_mass(3).rowwise().sum();
  const MatrixXd mass = rod_mass(3) - 1.1 / 3.0 * momentum * momentum.transpose();  // only along all rows negative
  const MatrixXd inverse = mass.inverse();
  const SparseMatrix stiffness = lower_of(fixed_free_chain(4));
  for (const std::vector<int>& order : std::vector<std::vector<int>>{{0, 1, 2, 3}, {3, 2, 1, 0}, {2, 0, 3, 1}}) {
    const auto found = find_negative_mass(stiffness, lower_of(mass), order);
    ASSERT_TRUE(found);
    EXPECT_EQ(found->row, order.back());
    EXPECT_NEAR(found->value, 1.0 / inverse(found->row, found->row), 1e-6);  // the last pivot
  }
}

TEST(SparseModes, AreNoneWhereTheMassIsNotSemidefinite) {
  // K - s M is definite for the small shift s, and Lanczos' vectors have real lengths.
  constexpr Index k_size = 540, k_negative = 40;
  VectorXd masses = VectorXd::Ones(k_size);
  masses.tail(k_negative).setConstant(-0.04);
  const SparseMatrix stiffness = lower_of(fixed_free_chain(k_size));
  const SparseMatrix mass = lower_of(masses.asDiagonal());
  const SparseModes modes = SparseModeSolver().solve(stiffness, mass, {.modes = 6});
  EXPECT_EQ(modes.failure, "the mass matrix is not positive semidefinite: the diagonal entry of row 501 is -0.04");
  EXPECT_EQ(modes.failed_row, 500);
  EXPECT_EQ(modes.values.size(), 0);
}

TEST(SparseModes, OfASemidefiniteMassAreTheSameBitsWhetherThatIsKnownOrNot) {
  const SparseMatrix stiffness = lower_of(fixed_free_chain(61));
  MatrixXd masses = rod_mass(60);
  for (const Index massless : {7, 30}) {
    masses.row(massless).setZero();
    masses.col(massless).setZero();
  }
  const SparseModes seen = SparseModeSolver().solve(stiffness, lower_of(masses), {.modes = 5});
  const SparseModes known =
      SparseModeSolver().solve(stiffness, lower_of(masses), {.modes = 5, .is_mass_semidefinite = true});
  ASSERT_EQ(seen.failure, "");
  EXPECT_EQ(seen.values, known.values);
  EXPECT_EQ(seen.vectors, known.vectors);
}

}  // namespace
}  // namespace mottle::linalg
