// Bounds of quadratic forms against dense eigenvalues.
#include "linalg/reduced/form_bounds.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <limits>

#include "linalg/pencils.hpp"
#include "linalg/sparse_families.hpp"

namespace mottle::linalg {
namespace {

using Eigen::Index;
using Eigen::MatrixXd;
using Eigen::VectorXd;
using linalg_test::lower_of;
using linalg_test::random_definite;
using linalg_test::random_symmetric;

constexpr double k_infinite = std::numeric_limits<double>::infinity();

TEST(FormBounds, ChainsThatFloatAreSemidefiniteAtAnyLength) {
  for (const int length : {2, 30, 4000}) {
    test::Entries springs;
    for (int i = 0; i + 1 < length; ++i) test::add_spring(springs, i, i + 1, 1.0 + 1e6 * (i % 7 == 0));
    EXPECT_TRUE(is_semidefinite(SupportedMatrix(test::matrix_of(length + 5, springs)))) << length;
  }
}

TEST(FormBounds, OneNegativeEigenvalueAmongManyPositiveOnesIsFound) {
  // Random quadratic forms see the trace: 599 here.
  test::Entries entries;
  for (int i = 0; i < 600; ++i) entries.emplace_back(i, i, 1.0);
  entries.emplace_back(1, 0, -1.001);
  EXPECT_FALSE(is_semidefinite(SupportedMatrix(test::matrix_of(600, entries))));
  entries.back() = {1, 0, -1.0};
  EXPECT_TRUE(is_semidefinite(SupportedMatrix(test::matrix_of(600, entries))));
  entries.emplace_back(7, 7, -1.0 - 1e-9);
  EXPECT_FALSE(is_semidefinite(SupportedMatrix(test::matrix_of(600, entries))));
}

TEST(FormBounds, RowsOfZerosAreNoReasonAndADiagonalOfZeroIs) {
  EXPECT_TRUE(is_semidefinite(SupportedMatrix(test::matrix_of(4, {{0, 0, 2.0}, {1, 1, 0.0}, {2, 1, 0.0}}))));
  EXPECT_FALSE(is_semidefinite(SupportedMatrix(test::matrix_of(4, {{0, 0, 2.0}, {1, 1, 0.0}, {1, 0, 1e-3}}))));
}

TEST(FormBounds, ExtremeEigenvaluesLieInsideAndNearTheBounds) {
  std::mt19937_64 random(4);
  for (const Index order : {3, 20, 90}) {
    const MatrixXd form = random_definite(order, random);
    MatrixXd term = random_symmetric(order, random);
    term.row(0).setZero();
    term.col(0).setZero();
    const std::unique_ptr<DefiniteFactor> factor = make_definite_factor();
    ASSERT_TRUE(factor->factorise(lower_of(form)));
    const FormBounds bounds =
        verified_bounds(lower_of(term), lower_of(form), *factor, random_symmetric(order, random).col(0));
    const Eigen::GeneralizedSelfAdjointEigenSolver<MatrixXd> exact(term, form);
    const double size = exact.eigenvalues().cwiseAbs().maxCoeff();
    EXPECT_LT(bounds.lower, exact.eigenvalues()(0));
    EXPECT_GT(bounds.upper, exact.eigenvalues()(order - 1));
    EXPECT_GT(bounds.lower, exact.eigenvalues()(0) - 0.05 * size - 0.005);
    EXPECT_LT(bounds.upper, exact.eigenvalues()(order - 1) + 0.05 * size + 0.005);
  }
}

TEST(FormBounds, RatiosOfSumsHoldForTermsOfAllKinds) {
  constexpr Index k_order = 12, k_terms = 4;
  std::mt19937_64 random(8);
  std::uniform_real_distribution<double> uniform(0.5, 1.5);
  double closest = k_infinite;
  for (int trial = 0; trial < 400; ++trial) {
    std::vector<MatrixXd> terms;
    VectorXd reference(k_terms), values(k_terms);
    MatrixXd form = MatrixXd::Zero(k_order, k_order), sum = form;
    for (Index t = 0; t < k_terms; ++t) {
      const bool is_definite = t < 2;
      terms.push_back(is_definite ? random_definite(k_order, random) : 0.02 * random_symmetric(k_order, random));
      reference(t) = t == 3 ? 0.0 : 1.0;  // a term that is not there at the reference
      values(t) = reference(t) + uniform(random) - 1.0;
      form += reference(t) * terms.back();
      sum += values(t) * terms.back();
    }
    MatrixXd bounds(k_terms, 2);
    for (Index t = 0; t < k_terms; ++t) {
      const VectorXd own =
          Eigen::GeneralizedSelfAdjointEigenSolver<MatrixXd>(terms[static_cast<std::size_t>(t)], form).eigenvalues();
      bounds.row(t) << (t < 2 ? 0.0 : own(0)), (t < 2 ? k_infinite : own(k_order - 1));
    }
    const VectorXd exact = Eigen::GeneralizedSelfAdjointEigenSolver<MatrixXd>(sum, form).eigenvalues();
    const double lower = lower_ratio(values, reference, bounds), upper = upper_ratio(values, reference, bounds);
    EXPECT_LE(lower, exact(0) + 1e-12);
    EXPECT_GE(upper, exact(k_order - 1) - 1e-12);
    closest = std::min(closest, exact(0) - lower);
  }
  EXPECT_LT(closest, 0.1);
}

TEST(FormBounds, NothingIsKnownWhereATermThatHasNoUpperBoundVanishesFromTheReference) {
  const VectorXd reference = VectorXd::Ones(1);
  const Eigen::MatrixXd unknown = (MatrixXd(1, 2) << -k_infinite, k_infinite).finished();
  EXPECT_EQ(lower_ratio(VectorXd::Constant(1, 1.2), reference, unknown), 1.2);  // the same term, only more of it
  EXPECT_EQ(lower_ratio(VectorXd::Ones(1), VectorXd::Zero(1), unknown), -k_infinite);
}

}  // namespace
}  // namespace mottle::linalg
