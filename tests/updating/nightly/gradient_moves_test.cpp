// Moves along gradients in as many dimensions as `bayes` takes.
#include <gtest/gtest.h>

#include "support/linear_normal.hpp"

namespace mottle::updating {
namespace {

TEST(GradientMoves, HaveTheClosedFormOfALinearModelOfSixtyParameters) {
  test::expect_closed_form_along_gradients(60);
}

}  // namespace
}  // namespace mottle::updating
