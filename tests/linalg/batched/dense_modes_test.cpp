#include "mottle/linalg/batched/dense_modes.hpp"

#include <gtest/gtest.h>

#include <limits>
#include <random>

#include "linalg/pencils.hpp"
#include "mottle/core/error.hpp"

namespace mottle::linalg {
namespace {

using namespace linalg_test;

TEST(SolveModes, GivesTheModesOfOnePencil) {
  std::mt19937_64 random(17);
  const MatrixXd stiffness = random_symmetric(20, random), mass = random_definite(20, random);
  const DenseModes modes = solve_modes(stiffness, mass, 6);
  ASSERT_FALSE(modes.failed);
  EXPECT_LT((stiffness * modes.vectors - mass * modes.vectors * modes.values.asDiagonal()).norm() / stiffness.norm(),
            1e-13);
  EXPECT_LT((modes.vectors.transpose() * mass * modes.vectors - MatrixXd::Identity(6, 6)).norm(), 1e-13);
}

TEST(SolveModes, MarksAPencilThatHasNone) {
  const MatrixXd identity = MatrixXd::Identity(3, 3);
  EXPECT_TRUE(solve_modes(identity, -identity).failed);
  EXPECT_TRUE(solve_modes(identity * std::numeric_limits<double>::infinity(), identity).failed);
}

TEST(SolveModes, RefusesShapesThatDoNotFit) {
  EXPECT_THROW(solve_modes(MatrixXd::Identity(3, 3), MatrixXd::Identity(2, 2)), InvalidInput);
  EXPECT_THROW(solve_modes(MatrixXd::Identity(3, 3), MatrixXd::Identity(3, 3), 4), InvalidInput);
}

}  // namespace
}  // namespace mottle::linalg
