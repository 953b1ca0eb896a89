#include "mottle/model/quantity.hpp"

#include <gtest/gtest.h>

namespace mottle::model {
namespace {

TEST(Quantity, ANameFollowsFromKindModeAndPlace) {
  EXPECT_EQ(natural_frequency(7, "Hz").name(), "f7");
  EXPECT_EQ(shape_component(2, "101:+Z", QuantityKind::displacement, "1/sqrt(kg)").name(), "phi2:101:+Z");
  EXPECT_EQ(damping_ratio(1).name(), "zeta1");
  EXPECT_EQ(damping_ratio(1).unit, "-");
  EXPECT_EQ(natural_eigenvalue(3, "(rad/s)^2").name(), "lambda3");
  EXPECT_EQ(shape_ratio(2, "101:+Z", "m1", "m").name(), "ratio2:101:+Z/m1");
  EXPECT_EQ(named_quantity("tip", "mm").name(), "tip");
  EXPECT_EQ(shape_component(2, "m1", QuantityKind::rotation, "").number, 2);
}

TEST(Quantity, EveryNameThatIsMadeMayNameAnOutputAndOthersMayNot) {
  for (const Quantity& output : {natural_frequency(12, "Hz"), shape_component(3, "m1", QuantityKind::displacement, ""),
                                 damping_ratio(4), natural_eigenvalue(5, ""), shape_ratio(6, "m1", "m2", "m")}) {
    EXPECT_TRUE(may_name_quantity(output.name())) << output.name();
  }
  for (const char* name :
       {"", "f", "phi", "zeta", "force", "f1:m2", "1", "phi:3", "zeta1:m1", "F1", "lambda", "lambda1:m1", "ratio"})
    EXPECT_FALSE(may_name_quantity(name)) << name;
}

}  // namespace
}  // namespace mottle::model
