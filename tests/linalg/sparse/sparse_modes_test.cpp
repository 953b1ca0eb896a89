#include "mottle/linalg/sparse/sparse_modes.hpp"

#include <gtest/gtest.h>

#include <Eigen/Cholesky>
#include <Eigen/Eigenvalues>
#include <algorithm>
#include <cmath>
#include <numbers>

#include "linalg/pencils.hpp"
#include "mottle/core/error.hpp"
#include "mottle/linalg/batched/dense_modes.hpp"

namespace mottle::linalg {
namespace {

using linalg_test::lower_of;

/// Unit masses in a square grid, unit springs between neighbours, free at all edges.
SparseMatrix grid_stiffness(int side) {
  std::vector<Eigen::Triplet<double>> entries;
  const auto number = [side](int i, int j) { return i * side + j; };
  const auto spring = [&](int a, int b) {
    entries.emplace_back(a, a, 1.0);
    entries.emplace_back(b, b, 1.0);
    entries.emplace_back(std::max(a, b), std::min(a, b), -1.0);
  };
  for (int i = 0; i < side; ++i) {
    for (int j = 0; j < side; ++j) {
      if (i + 1 < side) spring(number(i, j), number(i + 1, j));
      if (j + 1 < side) spring(number(i, j), number(i, j + 1));
    }
  }
  SparseMatrix stiffness(side * side, side * side);
  stiffness.setFromTriplets(entries.begin(), entries.end());
  return stiffness;
}

SparseMatrix identity(int size) {
  SparseMatrix mass(size, size);
  mass.setIdentity();
  return mass;
}

Eigen::MatrixXd dense_of(const SparseMatrix& lower) {
  const Eigen::MatrixXd dense = lower;
  return dense.selfadjointView<Eigen::Lower>();
}

/// Eigenvalues of the free grid, ascending: 4 sin^2(pi i / 2n) + 4 sin^2(pi j / 2n), i, j = 0..n-1 [closed form].
std::vector<double> grid_eigenvalues(int side) {
  std::vector<double> values;
  const auto part = [side](int i) { return 4.0 * std::pow(std::sin(std::numbers::pi * i / (2.0 * side)), 2); };
  for (int i = 0; i < side; ++i) {
    for (int j = 0; j < side; ++j) values.push_back(part(i) + part(j));
  }
  std::sort(values.begin(), values.end());
  return values;
}

TEST(SparseModes, AgreeWithClosedFormOfAFreeGridWithRepeatedRoots) {
  constexpr int k_side = 40;
  SparseModeSolver solver;
  const SparseModes modes =
      solver.solve(grid_stiffness(k_side), identity(k_side * k_side), {.modes = 30, .counts_below = true});
  ASSERT_EQ(modes.failure, "");
  const std::vector<double> exact = grid_eigenvalues(k_side);
  for (int r = 0; r < 30; ++r) {
    // Rounding of the shift-inverted problem: 1e-15 of the largest eigenvalue, 8.
    EXPECT_NEAR(modes.values(r), exact[static_cast<std::size_t>(r)], 1e-12) << r;
  }
  EXPECT_EQ(modes.counted_below, 30);
  EXPECT_TRUE(modes.is_complete());
  EXPECT_LT(modes.residuals.maxCoeff(), 1e-10);
  const Eigen::MatrixXd gram = modes.vectors.transpose() * modes.vectors;
  EXPECT_LT((gram - Eigen::MatrixXd::Identity(30, 30)).cwiseAbs().maxCoeff(), 1e-12);
}

TEST(SparseModes, AgreeWithTheDenseSolverForAGeneralPencil) {
  Eigen::MatrixXd a = Eigen::MatrixXd::Zero(90, 90);
  for (int i = 0; i < 90; ++i) {
    for (int j = std::max(0, i - 4); j < std::min(90, i + 5); ++j) a(i, j) = std::sin(1.0 + 3.0 * i * j + i + j);
  }
  const Eigen::MatrixXd stiffness = a * a.transpose();
  const Eigen::MatrixXd mass = (a.transpose() * a) / 50.0 + Eigen::MatrixXd::Identity(90, 90);
  SparseModeSolver solver;
  const SparseModes modes = solver.solve(lower_of(stiffness), lower_of(mass), {.modes = 12, .counts_below = true});
  const DenseModes dense = solve_modes(stiffness, mass, 12);
  for (int r = 0; r < 12; ++r) {
    EXPECT_NEAR(modes.values(r), dense.values(r), 1e-10 * dense.values(11)) << r;
    EXPECT_NEAR(std::abs(modes.vectors.col(r).dot(mass * dense.vectors.col(r))), 1.0, 1e-8) << r;
  }
  EXPECT_TRUE(modes.is_complete());
}

TEST(SparseModes, MasslessDegreesOfFreedomAreNoModes) {
  // Three masses in a chain from ground, with a massless point within each spring: springs of 2 in series make 1.
  Eigen::MatrixXd stiffness = Eigen::MatrixXd::Zero(6, 6);
  for (int i = 0; i < 6; ++i) {
    stiffness(i, i) += 2.0;
    if (i == 0) continue;
    stiffness(i - 1, i - 1) += 2.0;
    stiffness(i, i - 1) = stiffness(i - 1, i) = -2.0;
  }
  Eigen::MatrixXd mass = Eigen::MatrixXd::Zero(6, 6);
  for (const int i : {1, 3, 5}) mass(i, i) = 1.0;
  SparseModeSolver solver;
  const SparseModes modes = solver.solve(lower_of(stiffness), lower_of(mass), {.modes = 6, .counts_below = true});
  ASSERT_EQ(modes.values.size(), 3) << "there are three masses, so three modes";
  for (int r = 0; r < 3; ++r) {
    const double exact = std::pow(2.0 * std::sin((2 * r + 1) * std::numbers::pi / 14.0), 2);  // fixed-free chain
    EXPECT_NEAR(modes.values(r), exact, 1e-12) << r;
  }
  EXPECT_TRUE(modes.is_complete());
}

TEST(SparseModes, MassesOfFewerMotionsThanEquationsAreNoMoreModes) {
  // As those of an element with internal motions: M = A A', K = B B' with six rigid-body motions.
  std::mt19937_64 random(5);
  const Eigen::MatrixXd motions = linalg_test::uniform(33, 24, -1.0, 1.0, random);
  const Eigen::MatrixXd mass = motions * motions.transpose();
  Eigen::MatrixXd roots = 1e4 * linalg_test::uniform(33, 33, -1.0, 1.0, random);
  const Eigen::MatrixXd rigid = linalg_test::uniform(33, 6, -1.0, 1.0, random);
  roots -= rigid * (rigid.transpose() * rigid).llt().solve(rigid.transpose() * roots);
  const Eigen::MatrixXd stiffness = roots * roots.transpose();
  for (const int wanted : {8, 10, 12, 22, 30}) {
    const SparseModes modes =
        SparseModeSolver().solve(lower_of(stiffness), lower_of(mass), {.modes = wanted, .counts_below = true});
    ASSERT_EQ(modes.failure, "");
    ASSERT_EQ(modes.values.size(), std::min(wanted, 24));
    const Eigen::GeneralizedSelfAdjointEigenSolver<Eigen::MatrixXd> exact(mass, stiffness - modes.shift * mass,
                                                                          Eigen::EigenvaluesOnly);
    for (int r = 0; r < modes.values.size(); ++r) {
      const double value = 1.0 / exact.eigenvalues()(32 - r) + modes.shift;
      // Rounding of theta is that of the rigid-body motions', 1 / shift.
      EXPECT_NEAR(modes.values(r), value, 1e-5 * std::abs(value) + 0.01 * std::abs(modes.shift)) << wanted << ", " << r;
    }
    EXPECT_TRUE(wanted > 24 || modes.is_complete()) << wanted;
  }
}

/// Every tenth mass of a clamped chain is one, the others are `light`.
SparseModes modes_of_chain(double light) {
  constexpr int k_size = 300;
  SparseMatrix stiffness(k_size, k_size), mass(k_size, k_size);
  for (int i = 0; i < k_size; ++i) {
    stiffness.insert(i, i) = 2e6;
    if (i + 1 < k_size) stiffness.insert(i + 1, i) = -1e6;
    mass.insert(i, i) = i % 10 == 9 ? 1.0 : light;
  }
  stiffness.makeCompressed();
  mass.makeCompressed();
  return SparseModeSolver().solve(stiffness, mass, {.modes = 6, .counts_below = true});
}

TEST(SparseModes, MassesNextToNothingAreAsNone) {
  // Ten springs of 1e6 in series between the masses, and before the first; one behind the last.
  Eigen::MatrixXd condensed = Eigen::MatrixXd::Zero(30, 30);
  for (int i = 0; i < 30; ++i) {
    condensed(i, i) = i < 29 ? 2e5 : 1e5 + 1e6;
    if (i > 0) condensed(i, i - 1) = condensed(i - 1, i) = -1e5;
  }
  const Eigen::VectorXd exact = Eigen::SelfAdjointEigenSolver<Eigen::MatrixXd>(condensed).eigenvalues();
  for (const double light : {0.0, 1e-25, 1e-20, 1e-17, 1e-15, 1e-13, 1e-12, 1e-11}) {
    const SparseModes modes = modes_of_chain(light);
    ASSERT_EQ(modes.failure, "");
    EXPECT_TRUE(modes.is_complete()) << light;
    for (int r = 0; r < 6; ++r)
      EXPECT_NEAR(modes.values(r) / exact(r), 1.0, 1e-10 + 10.0 * light) << light << ", " << r;
  }
}

TEST(SparseModes, RootsRepeatedMoreOftenThanTheBlockIsWideAreAllFound) {
  SparseMatrix stiffness = identity(200) * 4.0;
  SparseModeSolver solver;
  const SparseModes modes = solver.solve(stiffness, identity(200), {.modes = 40, .counts_below = false});
  ASSERT_EQ(modes.values.size(), 40);
  EXPECT_LT((modes.values.array() - 4.0).abs().maxCoeff(), 1e-12);
}

TEST(SparseModes, EachModeOfManyEqualPartsIsFoundAsOftenAsThereAreParts) {
  constexpr int k_parts = 12, k_masses = 60;  // more parts than vectors in a block
  std::vector<Eigen::Triplet<double>> entries;
  for (int i = 0; i < k_parts * k_masses; ++i) {
    const int position = i % k_masses;
    entries.emplace_back(i, i, position + 1 < k_masses ? 2.0 : 1.0);
    if (position > 0) entries.emplace_back(i, i - 1, -1.0);
  }
  SparseMatrix stiffness(k_parts * k_masses, k_parts * k_masses);
  stiffness.setFromTriplets(entries.begin(), entries.end());
  for (const double tolerance : {1e-3, 1e-9}) {
    SparseModeSolver solver;
    const SparseModes modes = solver.solve(stiffness, identity(k_parts * k_masses),
                                           {.modes = 36, .tolerance = tolerance, .counts_below = true});
    ASSERT_EQ(modes.values.size(), 36) << tolerance;
    for (int r = 0; r < 36; ++r) {
      const double angle = (2 * (r / k_parts) + 1) * std::numbers::pi / (4 * k_masses + 2);
      const double exact = std::pow(2.0 * std::sin(angle), 2);  // fixed-free chain
      EXPECT_NEAR(modes.values(r), exact, std::max(1e-2 * tolerance, 1e-11) * exact) << r << " at " << tolerance;
    }
    EXPECT_TRUE(modes.is_complete()) << tolerance;
  }
}

TEST(SparseModes, AStiffnessThatIsNotSemidefiniteIsReportedNotThrown) {
  Eigen::MatrixXd stiffness = Eigen::MatrixXd::Identity(5, 5);
  stiffness(3, 3) = -50.0;
  SparseModeSolver solver;
  const SparseModes modes = solver.solve(lower_of(stiffness), identity(5), {.modes = 2});
  EXPECT_NE(modes.failure, "");
  EXPECT_EQ(modes.failed_row, 3);
}

TEST(SparseModes, TheSymbolicFactorIsReusedWithTheSameNumbers) {
  SparseModeSolver fresh;
  SparseModeSolver reused;
  const SparseMatrix first = grid_stiffness(12);
  const SparseMatrix second = 3.0 * first;
  reused.solve(first, identity(144), {.modes = 5});
  const SparseModes again = reused.solve(second, identity(144), {.modes = 5});
  const SparseModes alone = fresh.solve(second, identity(144), {.modes = 5});
  EXPECT_EQ((again.values - alone.values).cwiseAbs().maxCoeff(), 0.0);
  EXPECT_EQ((again.vectors - alone.vectors).cwiseAbs().maxCoeff(), 0.0);
}

// i, j = 1, 2 and 2, 1 have one eigenvalue; the cut of 5 modes falls between them.
TEST(SparseModes, TheFactorAloneIsTheOneOfASolution) {
  const SparseMatrix stiffness = grid_stiffness(30);
  const SparseMatrix mass = identity(900);
  SparseModeSolver whole, alone;
  EXPECT_EQ(alone.factorise(stiffness, mass), whole.solve(stiffness, mass, {.modes = 3}).shift);
  Eigen::MatrixXd first = Eigen::MatrixXd::Identity(900, 5);
  Eigen::MatrixXd second = first;
  whole.factor().solve(first);
  alone.factor().solve(second);
  EXPECT_EQ(first, second);
}

TEST(SparseModes, AreCountedWhereTheLastOneSharesItsRoot) {
  constexpr int k_side = 20;
  const std::vector<double> exact = grid_eigenvalues(k_side);
  for (int modes = 1; modes <= 12; ++modes) {
    SparseModeSolver solver;
    const SparseModes found =
        solver.solve(grid_stiffness(k_side), identity(k_side * k_side), {.modes = modes, .counts_below = true});
    EXPECT_EQ(found.counted_below, modes) << modes;
    EXPECT_NEAR(found.values(modes - 1), exact[static_cast<std::size_t>(modes - 1)], 1e-12);
  }
}

/// A pencil with these eigenvalues (and 9, 10, 11 ... above), its shapes full.
Eigen::MatrixXd stiffness_with(std::vector<double> values, int size) {
  for (double value = 9.0; static_cast<int>(values.size()) < size; ++value) values.push_back(value);
  const Eigen::VectorXd direction = Eigen::VectorXd::LinSpaced(size, 1.0, 2.0).normalized();
  const Eigen::MatrixXd mirror = Eigen::MatrixXd::Identity(size, size) - 2.0 * direction * direction.transpose();
  return mirror * Eigen::Map<Eigen::VectorXd>(values.data(), size).asDiagonal() * mirror;
}

// Two more than wanted are sought; roots that go on beyond these leave no gap above.
TEST(SparseModes, AreCountedWhereARootGoesOnBeyondAllThatAreSought) {
  const SparseMatrix stiffness = lower_of(stiffness_with({1.0, 2.0, 3.0, 3.0, 3.0, 3.0, 3.0}, 40));
  SparseModeSolver solver;
  for (int modes = 1; modes <= 8; ++modes) {
    const SparseModes found = solver.solve(stiffness, identity(40), {.modes = modes, .counts_below = true});
    EXPECT_EQ(found.counted_below, modes) << modes;
  }
}

TEST(SparseModes, AreCountedAmongRigidBodyMotions) {
  // Values of zero differ by rounding only, so that no count between them means anything.
  const SparseMatrix stiffness = lower_of(1e6 * stiffness_with({0.0, 0.0, 0.0, 0.0, 0.0, 0.0}, 40));
  SparseModeSolver solver;
  for (int modes = 1; modes <= 7; ++modes) {
    const SparseModes found = solver.solve(stiffness, identity(40), {.modes = modes, .counts_below = true});
    EXPECT_EQ(found.counted_below, modes) << modes;
  }
}

// Eight-fold, as eight alike legs have it: more than a block of six holds.
TEST(SparseModes, WiderRootsThanTheBlockAreFoundAmongOthers) {
  const SparseMatrix stiffness = lower_of(stiffness_with({1.0, 3.0, 3.0, 3.0, 3.0, 3.0, 3.0, 3.0, 3.0, 4.0}, 200));
  SparseModeSolver solver;
  const SparseModes found = solver.solve(stiffness, identity(200), {.modes = 10, .counts_below = true});
  ASSERT_EQ(found.values.size(), 10);
  EXPECT_NEAR(found.values(8), 3.0, 1e-10);
  EXPECT_NEAR(found.values(9), 4.0, 1e-10);
  EXPECT_TRUE(found.is_complete());
}

TEST(SparseModes, SolveOneEquation) {
  SparseModeSolver solver;
  const SparseModes found = solver.solve(identity(1) * 8.0, identity(1) * 2.0, {.modes = 1, .counts_below = true});
  ASSERT_EQ(found.values.size(), 1);
  EXPECT_NEAR(found.values(0), 4.0, 1e-14);
  EXPECT_NEAR(found.vectors(0, 0), std::sqrt(0.5), 1e-15);
  EXPECT_EQ(found.counted_below, 1);
}

// Two unit masses, springs 1, 1, 1: lambda = 1 and 3. More modes than equations are asked for.
TEST(SparseModes, AreNoMoreThanTwoForTwoEquations) {
  const Eigen::MatrixXd stiffness{{2.0, -1.0}, {-1.0, 2.0}};
  for (const int modes : {1, 2, 5}) {
    SparseModeSolver solver;
    const SparseModes found = solver.solve(lower_of(stiffness), identity(2), {.modes = modes, .counts_below = true});
    ASSERT_EQ(found.values.size(), std::min(modes, 2));
    EXPECT_NEAR(found.values(0), 1.0, 1e-14);
    EXPECT_TRUE(found.is_complete());
    if (modes > 1) {
      EXPECT_NEAR(found.values(1), 3.0, 1e-14);
    }
  }
}

TEST(SparseModes, WithoutAnyMassAreAFailure) {
  SparseModeSolver solver;
  EXPECT_NE(solver.solve(identity(3), 0.0 * identity(3), {.modes = 1}).failure, "");
}

TEST(SparseModes, AgreeWithANewSolverForAnotherPattern) {
  SparseModeSolver reused;
  reused.solve(grid_stiffness(12), identity(144), {.modes = 5, .counts_below = true});
  const SparseMatrix other = lower_of(stiffness_with({1.0, 2.0}, 30));
  const SparseModes again = reused.solve(other, identity(30), {.modes = 2, .counts_below = true});
  ASSERT_EQ(again.failure, "");
  EXPECT_NEAR(again.values(1), 2.0, 1e-12);
  EXPECT_TRUE(again.is_complete());
}

// Six chains of 20 unit masses with springs of 1e8, each hung on ground by a soft spring: suspension modes from 0.01 to
// 1 Hz below elastic ones from 250 Hz. Exact by the dense solver in extended precision.
TEST(SparseModes, AreExactForAVerySoftSuspension) {
  constexpr int k_masses = 20;
  Eigen::MatrixXd stiffness = Eigen::MatrixXd::Zero(6 * k_masses, 6 * k_masses);
  for (int chain = 0; chain < 6; ++chain) {
    const int first = chain * k_masses;
    for (int i = first; i + 1 < first + k_masses; ++i) {
      stiffness.block<2, 2>(i, i) += 1e8 * Eigen::Matrix2d{{1.0, -1.0}, {-1.0, 1.0}};
    }
    stiffness(first, first) += 0.0625 * std::pow(8.0, chain);
  }
  using LongMatrix = Eigen::Matrix<long double, Eigen::Dynamic, Eigen::Dynamic>;
  const Eigen::VectorXd exact =
      Eigen::SelfAdjointEigenSolver<LongMatrix>(stiffness.cast<long double>()).eigenvalues().cast<double>();
  SparseModeSolver solver;
  const SparseModes found =
      solver.solve(lower_of(stiffness), identity(6 * k_masses), {.modes = 8, .counts_below = true});
  for (int r = 0; r < 8; ++r) EXPECT_NEAR(found.values(r) / exact(r), 1.0, 1e-8) << r << ": " << exact(r);
  EXPECT_TRUE(found.is_complete());
  const Eigen::MatrixXd gram = found.vectors.transpose() * found.vectors;
  EXPECT_LT((gram - Eigen::MatrixXd::Identity(8, 8)).cwiseAbs().maxCoeff(), 1e-12);
}

TEST(SymmetricFactor, BothPackagesSolveTheSameSystem) {
  Eigen::MatrixXd dense = dense_of(grid_stiffness(9));
  dense.diagonal().array() += 0.1;
  const Eigen::MatrixXd sides = Eigen::MatrixXd::Random(81, 3);
  const Eigen::MatrixXd exact = dense.ldlt().solve(sides);
  std::vector<std::unique_ptr<SymmetricFactor>> factors;
  factors.push_back(make_definite_factor());
  factors.push_back(make_indefinite_factor());
  for (const auto& factor : factors) {
    ASSERT_TRUE(factor->factorise(lower_of(dense)));
    Eigen::MatrixXd x = sides;
    factor->solve(x);
    EXPECT_LT((x - exact).cwiseAbs().maxCoeff(), 1e-11) << factor->name();
  }
}

TEST(SymmetricFactor, RootTimesItsTransposeIsTheInverse) {
  Eigen::MatrixXd dense = dense_of(grid_stiffness(7));
  dense.diagonal().array() += 0.2;
  const auto factor = make_definite_factor();
  ASSERT_TRUE(factor->factorise(lower_of(dense)));
  VectorRows root = VectorRows::Identity(49, 49);
  factor->solve_root(root);
  EXPECT_LT((root * root.transpose() - dense.inverse()).cwiseAbs().maxCoeff(), 1e-13);
}

TEST(SymmetricFactor, TheIndefiniteOneCountsNegativeEigenvalues) {
  const std::vector<double> exact = grid_eigenvalues(9);
  for (const double shift : {-0.1, 0.3, 2.05, 7.0}) {
    Eigen::MatrixXd dense = dense_of(grid_stiffness(9));
    dense.diagonal().array() -= shift;
    const auto factor = make_indefinite_factor();
    ASSERT_TRUE(factor->factorise(lower_of(dense)));
    EXPECT_EQ(factor->negative_eigenvalues(),
              std::count_if(exact.begin(), exact.end(), [shift](double value) { return value < shift; }))
        << shift;
  }
}

}  // namespace
}  // namespace mottle::linalg
