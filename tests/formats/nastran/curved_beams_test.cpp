// CBEND with PBEND: what the cards say.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <string>

#include "formats/nastran/model_of.hpp"

namespace mottle::formats {
namespace {

using ::testing::HasSubstr;
using ::testing::StartsWith;

const std::string k_property = "PBEND,5,1,.1,.2,.3,.4,10.,90.\n,\n,.5,.6,7.,.8,.9,.01\n";

TEST(NastranCurvedBeams, AreReadWithTheirProperty) {
  const NastranModel read =
      test::model_of(test::k_cube + k_property + "CBEND,3,5,1,2,0.,1.,0.,3\nCBEND,4,5,1,2,6,,,1\n");
  ASSERT_EQ(read.model.elements<CurvedBeamElement>().size(), 2U);
  const CurvedBeamElement& beam = read.model.elements<CurvedBeamElement>().front();
  EXPECT_EQ(read.model.value(beam.area), 0.1);
  EXPECT_EQ(read.model.value(beam.inertia_1), 0.2);
  EXPECT_EQ(read.model.value(beam.inertia_2), 0.3);
  EXPECT_EQ(read.model.value(beam.torsion), 0.4);
  EXPECT_EQ(test::field_name(read.model, beam.nonstructural_mass), "PBEND:5:NSM");
  EXPECT_EQ(beam.radius, 10.0);
  EXPECT_EQ(beam.angle, 90.0);
  EXPECT_EQ(beam.shear_1, 0.5);
  EXPECT_EQ(beam.shear_2, 0.6);
  EXPECT_EQ(beam.radial_offset, 0.8);
  EXPECT_EQ(beam.normal_offset, 0.9);
  EXPECT_EQ(beam.neutral_offset, 0.01);
  EXPECT_EQ(beam.rule, ArcRule::radius);
  EXPECT_EQ(beam.orientation, Eigen::Vector3d::UnitY());
  const CurvedBeamElement& other = read.model.elements<CurvedBeamElement>().back();
  EXPECT_EQ(other.rule, ArcRule::center);
  EXPECT_EQ(other.orientation, Eigen::Vector3d(2.0, 0.0, 2.0)) << "from GA to G0, grid point 6";
}

TEST(NastranCurvedBeams, AreRefusedWhereAFieldCannotBe) {
  const auto refusal = [](const std::string& cards) { return test::refusal_of(test::k_cube + cards); };
  EXPECT_THAT(refusal("PBEND,5,1,1,.5,.02\n"), StartsWith("deck.bdf:10: PBEND 5: the form for pipes (FSI, RM, T)"));
  EXPECT_THAT(refusal("PBEND,5,1,.1,.2,.3\n"), HasSubstr("A, I1, I2 and J must be positive"));
  const std::string property = "PBEND,5,1,.1,.2,.3,.4\n";
  EXPECT_THAT(refusal(property + "CBEND,3,5,1,2,0.,1.,0.\n"), StartsWith("deck.bdf:11: CBEND 3: GEOM is blank"));
  EXPECT_THAT(refusal(property + "CBEND,3,5,1,2,0.,1.,0.,5\n"), HasSubstr("GEOM is 5, it must be 1, 2, 3 or 4"));
  EXPECT_THAT(refusal(property + "CBEND,3,5,1,2,0.,1.,0.,3\n"), HasSubstr("GEOM is 3, which needs RB of its PBEND"));
  EXPECT_THAT(refusal(property + "CBEND,3,5,1,2,0.,1.,0.,4\n"), HasSubstr("GEOM is 4, which needs THETAB"));
  EXPECT_THAT(refusal(property + "CBEND,3,5,1,2,,,,1\n"), HasSubstr("X1, X2, X3 (or G0) are blank"));
  EXPECT_THAT(refusal("CBEND,3,5,1,2,0.,1.,0.,1\n"), HasSubstr("property 5 has no PBEND card"));
}

}  // namespace
}  // namespace mottle::formats
