#include "mottle/model/quantity.hpp"

#include <gtest/gtest.h>

namespace mottle {
namespace {

TEST(Quantity, ANameFollowsFromKindModeAndPlace) {
  EXPECT_EQ(frequency_output(7, "Hz").name, "f7");
  EXPECT_EQ(shape_output(2, "101:+Z", OutputKind::displacement, "1/sqrt(kg)").name, "phi2:101:+Z");
  EXPECT_EQ(damping_output(1).name, "zeta1");
  EXPECT_EQ(damping_output(1).unit, "-");
  EXPECT_EQ(shape_output(2, "m1", OutputKind::rotation, "").mode, 2);
}

TEST(Quantity, EveryNameThatIsMadeMayNameAnOutputAndOthersMayNot) {
  for (const Output& output :
       {frequency_output(12, "Hz"), shape_output(3, "m1", OutputKind::displacement, ""), damping_output(4)}) {
    EXPECT_TRUE(may_name_output(output.name)) << output.name;
  }
  for (const char* name : {"", "f", "phi", "zeta", "force", "f1:m2", "1", "phi:3", "zeta1:m1", "F1"})
    EXPECT_FALSE(may_name_output(name)) << name;
}

}  // namespace
}  // namespace mottle
