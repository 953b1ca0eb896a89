#include "mottle/model/reference_sizes.hpp"

#include <gtest/gtest.h>

namespace mottle::model {
namespace {

TEST(ReferenceSizes, TakeTheLargestComponentNearANodeAndTheValueElsewhere) {
  const auto component = [](int mode, const std::string& place) {
    return shape_component(mode, place, QuantityKind::displacement, "-");
  };
  const std::vector<Quantity> outputs{natural_frequency(1, "Hz"), component(1, "a"),          component(1, "b"),
                                      component(1, "c"),          natural_frequency(2, "Hz"), component(2, "a")};
  Eigen::VectorXd values(6);
  values << 1e-3, -2.0, 1e-16, 0.5, 30.0, 1e-16;
  Eigen::VectorXd expected(6);
  expected << 1e-3, 2.0, 2.0, 0.5, 30.0, 1e-16;
  EXPECT_EQ(reference_sizes(outputs, values), expected);
}

}  // namespace
}  // namespace mottle::model
