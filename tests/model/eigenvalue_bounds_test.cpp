#include "mottle/model/eigenvalue_bounds.hpp"

#include <gtest/gtest.h>

#include <cmath>

#include "model/structures.hpp"
#include "mottle/core/error.hpp"
#include "mottle/fem/assembly/mass_spring.hpp"
#include "mottle/model/structures/affine_matrices.hpp"
#include "support/parameter_pencils.hpp"

namespace mottle::model {
namespace {

constexpr double k_rounding = 1e-12;  // of a solver of a few equations, and its bound on that

StructureModel springs(const MassSpringSystem& system, const std::vector<std::string>& targets,
                       const Eigen::VectorXd& reference) {
  return {separate(system, test::one_each(targets)), OutputSelection{.eigenvalues = {1}}, reference};
}

TEST(EigenvalueBounds, AreStiffnessByMassForOneMass) {
  const MassSpringSystem system{.masses = {{"m", 1.0}}, .springs = {{"k", k_ground, 0, 1.0}}, .dampers = {}};
  const StructureModel model = springs(system, {"spring:k", "mass:m"}, Eigen::Vector2d(1.0, 1.0));
  const EigenvalueBounds bounds(model);
  EXPECT_EQ(bounds.trends(), (std::vector{EigenvalueTrend::rising, EigenvalueTrend::falling}));
  const EigenvalueRanges found = bounds.over({Eigen::Vector2d(1.0, 2.0), Eigen::Vector2d(2.0, 4.0)}, 1, {}, {});
  EXPECT_NEAR(found.proven_lower(0), 0.25, k_rounding);
  EXPECT_NEAR(found.proven_upper(0), 1.0, k_rounding);
  EXPECT_EQ(found.at_lower.row(0), Eigen::RowVector2d(1.0, 4.0));
  EXPECT_EQ(found.at_upper.row(0), Eigen::RowVector2d(2.0, 2.0));
}

/// lambda = ((a + 2 b) -+ sqrt(a^2 + 4 b^2)) / 2, both rising in a and b.
TEST(EigenvalueBounds, HaveTheClosedFormOfTwoMasses) {
  const MassSpringSystem system{
      .masses = {{"m1", 1.0}, {"m2", 1.0}}, .springs = {{"a", k_ground, 0, 1.0}, {"b", 0, 1, 1.0}}, .dampers = {}};
  const StructureModel model = springs(system, {"spring:a", "spring:b"}, Eigen::Vector2d(1.0, 1.0));
  const EigenvalueRanges found =
      EigenvalueBounds(model).over({Eigen::Vector2d(0.7, 1.1), Eigen::Vector2d(1.6, 3.0)}, 2, {}, {});
  const auto closed = [](double a, double b, double sign) {
    return 0.5 * (a + 2.0 * b + sign * std::sqrt(a * a + 4.0 * b * b));
  };
  for (const int mode : {0, 1}) {
    const double sign = mode == 0 ? -1.0 : 1.0;
    EXPECT_NEAR(found.proven_lower(mode), closed(0.7, 1.1, sign), k_rounding);
    EXPECT_NEAR(found.proven_upper(mode), closed(1.6, 3.0, sign), k_rounding);
    EXPECT_LE(found.proven_lower(mode), closed(0.7, 1.1, sign));
    EXPECT_GE(found.proven_upper(mode), closed(1.6, 3.0, sign));
  }
}

const Eigen::MatrixXd k_one = Eigen::MatrixXd::Ones(1, 1);

/// A thickness t of a plate by itself: K = t K1 + t^3 K3, M = t M1. Divided by t, K rises and M stays.
TEST(EigenvalueBounds, RiseWithAThicknessThatAllMassHas) {
  const auto model =
      test::model_of({{{{0, 1}}, 2.0 * k_one}, {{{0, 3}}, k_one}}, {{{{0, 1}}, k_one}}, Eigen::VectorXd::Ones(1), {1});
  const EigenvalueBounds bounds(*model);
  EXPECT_EQ(bounds.trends().front(), EigenvalueTrend::rising);
  const EigenvalueRanges found =
      bounds.over({Eigen::VectorXd::Constant(1, 0.5), Eigen::VectorXd::Constant(1, 2.0)}, 1, {}, {});
  EXPECT_NEAR(found.proven_lower(0), 2.25, 1e-8);
  EXPECT_NEAR(found.proven_upper(0), 6.0, 1e-8);
  EXPECT_EQ(found.solutions, 4);
}

/// lambda = (1 + 2 t^3) / (1 + t): falls to 0.8453 at t = 0.4781 (4 t^3 + 6 t^2 = 1), then rises.
TEST(EigenvalueBounds, FindAMinimumInsideOfTheBox) {
  const auto model = test::model_of({{{}, k_one}, {{{0, 3}}, 2.0 * k_one}}, {{{}, k_one}, {{{0, 1}}, k_one}},
                                    Eigen::VectorXd::Ones(1), {1});
  const EigenvalueBounds bounds(*model);
  EXPECT_EQ(bounds.trends().front(), EigenvalueTrend::mixed);
  const ParameterBox box{Eigen::VectorXd::Constant(1, 0.2), Eigen::VectorXd::Constant(1, 1.5)};
  double least = 1e9;
  for (double t = 0.2; t <= 1.5; t += 1e-5) least = std::min(least, (1.0 + 2.0 * t * t * t) / (1.0 + t));
  double gap_before = 1.0;
  for (const double tolerance : {1e-1, 1e-3}) {
    const EigenvalueRanges found = bounds.over(box, 1, {.tolerance = tolerance}, {});
    EXPECT_TRUE(found.reaches_tolerance);
    EXPECT_LE(found.proven_lower(0), least);
    EXPECT_GE(found.proven_lower(0), (1.0 - 2.0 * tolerance) * least);
    EXPECT_NEAR(found.proven_upper(0), (1.0 + 2.0 * 3.375) / 2.5, 1e-8 + tolerance * 3.1);
    EXPECT_LT(least - found.proven_lower(0), gap_before);
    gap_before = least - found.proven_lower(0);
  }
}

TEST(EigenvalueBounds, StayProvenWhereSolutionsRunOut) {
  const auto model = test::model_of({{{}, k_one}, {{{0, 3}}, 2.0 * k_one}}, {{{}, k_one}, {{{0, 1}}, k_one}},
                                    Eigen::VectorXd::Ones(1), {1});
  const ParameterBox box{Eigen::VectorXd::Constant(1, 0.2), Eigen::VectorXd::Constant(1, 1.5)};
  const EigenvalueRanges found = EigenvalueBounds(*model).over(box, 1, {.tolerance = 1e-6, .max_solutions = 60}, {});
  EXPECT_FALSE(found.reaches_tolerance);
  EXPECT_LT(found.proven_lower(0), 0.846);
  EXPECT_GT(found.proven_upper(0), 3.0999);
}

TEST(EigenvalueBounds, HoldAllSamplesOfRandomBoxes) {
  constexpr std::uint32_t k_cases = 300;  // 10,000 of them in validation/interval
  int mixed = 0;
  for (std::uint32_t number = 0; number < k_cases; ++number) {
    test::RandomPencil random(11, number);
    const EigenvalueBounds bounds(*random.model);
    ASSERT_EQ(bounds.obstacle(), "") << number;
    const EigenvalueRanges found = bounds.over(random.box, random.order, {.tolerance = 1e-2}, {});
    for (const EigenvalueTrend trend : bounds.trends()) mixed += trend == EigenvalueTrend::mixed ? 1 : 0;
    Eigen::MatrixXd points(50, random.parameters);
    for (Eigen::Index s = 0; s < points.rows(); ++s) points.row(s) = random.inside().transpose();
    const Eigen::MatrixXd values = bounds.at(points, random.order, {});
    for (Eigen::Index k = 0; k < random.order; ++k) {
      EXPECT_GE(values.col(k).minCoeff(), found.proven_lower(k)) << number;
      EXPECT_LE(values.col(k).maxCoeff(), found.proven_upper(k)) << number;
      EXPECT_LE(found.proven_lower(k), found.attained_lower(k)) << number;
      EXPECT_GE(found.proven_upper(k), found.attained_upper(k)) << number;
      if (!found.reaches_tolerance) continue;
      EXPECT_LT(found.attained_lower(k) - found.proven_lower(k), 0.0101 * found.attained_lower(k)) << number;
      EXPECT_LT(found.proven_upper(k) - found.attained_upper(k), 0.0101 * found.attained_upper(k)) << number;
    }
  }
  EXPECT_GT(mixed, 100);
}

TEST(EigenvalueBounds, AreTheSameAtAnyNumberOfThreads) {
  const test::RandomPencil random(11, 5);
  const EigenvalueBounds bounds(*random.model);
  const EigenvalueRanges one = bounds.over(random.box, random.order, {}, {.threads = 1});
  const EigenvalueRanges three = bounds.over(random.box, random.order, {}, {.threads = 3});
  EXPECT_TRUE(test::have_same_bits(one.proven_lower, three.proven_lower));
  EXPECT_TRUE(test::have_same_bits(one.proven_upper, three.proven_upper));
  EXPECT_TRUE(test::have_same_bits(one.at_lower, three.at_lower));
}

TEST(EigenvalueBounds, AreNotGivenWhereATermIsIndefinite) {
  Eigen::Matrix2d indefinite;
  indefinite << 0.1, 0.3, 0.3, 0.1;
  const auto model = test::model_of({{{}, 2.0 * Eigen::Matrix2d::Identity()}, {{{0, 1}}, indefinite}},
                                    {{{}, Eigen::Matrix2d::Identity()}}, Eigen::VectorXd::Ones(1), {1});
  const EigenvalueBounds bounds(*model);
  EXPECT_NE(bounds.obstacle().find("stiffness is not positive semidefinite"), std::string::npos);
  EXPECT_THROW(bounds.over({Eigen::VectorXd::Ones(1), Eigen::VectorXd::Ones(1)}, 1, {}, {}), InvalidInput);
}

}  // namespace
}  // namespace mottle::model
