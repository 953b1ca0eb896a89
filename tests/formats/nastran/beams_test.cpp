// Beams, bushes and rigid links of decks; expectations by hand.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <string>
#include <utility>

#include "formats/nastran/model_of.hpp"

namespace mottle::formats {
namespace {

using test::field_name;
using test::k_cube;
using test::model_of;
using test::value_of;
using ::testing::ElementsAre;

constexpr double k_rounding = 1e-14;  // a few operations on numbers around 1

FiniteElementModel cube_with(const std::string& cards) {
  return model_of(k_cube + cards).model;
}

// Local x is basic y, local y is basic -x.
const std::string k_quarter_turn = "CORD2R,4,,0.,0.,0.,0.,0.,1.\n,0.,1.,0.\n";

const std::string k_bar = "PBAR,1,1,.1,.2,.3,.4,.5\n";

TEST(NastranBeams, HaveAPropertyOfNumbers) {
  const FiniteElementModel model = cube_with("PBAR,1,1,.1,.2,.3,.4,.5\n,,,,,,,,\n,.8,.9,.01\n");
  EXPECT_EQ(value_of(model, "PBAR:1:A"), 0.1);
  EXPECT_EQ(value_of(model, "PBAR:1:I1"), 0.2);
  EXPECT_EQ(value_of(model, "PBAR:1:I2"), 0.3);
  EXPECT_EQ(value_of(model, "PBAR:1:J"), 0.4);
  EXPECT_EQ(value_of(model, "PBAR:1:NSM"), 0.5);
  EXPECT_EQ(value_of(model, "PBAR:1:I12"), 0.01);
  EXPECT_EQ(model.beam_properties.at(0).shear_1, 0.0) << "Nastran takes K1 and K2 for 0 where I12 is not";
  EXPECT_EQ(model.beam_properties[0].shear_2, 0.0);
  EXPECT_EQ(model.beam_properties[0].section, "");
}

TEST(NastranBeams, HaveShearWhereTheAxesArePrincipal) {
  const FiniteElementModel model = cube_with("PBAR,1,1,.1,.2,.3,.4,.5\n,,,,,,,,\n,.8,.9\n");
  EXPECT_EQ(model.beam_properties.at(0).shear_1, 0.8);
  EXPECT_EQ(model.beam_properties[0].shear_2, 0.9);
}

// Field 9 of old decks: 1 says that a vector stands in fields 6 to 8, 2 that field 6 names a grid point.
TEST(NastranBeams, TakeTheOldFlagOfTheirOrientation) {
  const FiniteElementModel model =
      cube_with(k_bar +
                "CBAR,1,1,1,2,.0,.0,1.0,1\nCBAR,2,1,1,2,0,1,0,1\nCBAR,3,1,1,2,3,,,2\nBAROR,,,,,0.,1.,0.,1\n"
                "CBAR,4,1,1,2\n");
  EXPECT_EQ(model.elements<BeamElement>()[0].orientation, Eigen::Vector3d(0.0, 0.0, 1.0));
  EXPECT_EQ(model.elements<BeamElement>()[1].orientation, Eigen::Vector3d(0.0, 1.0, 0.0));
  EXPECT_EQ(model.elements<BeamElement>()[2].orientation, Eigen::Vector3d(2.0, 2.0, 0.0));
  EXPECT_EQ(model.elements<BeamElement>()[3].orientation, Eigen::Vector3d(0.0, 1.0, 0.0));
}

TEST(NastranBeams, HaveTorsionalInertiaIfTheyAreCbeam) {
  const FiniteElementModel model = cube_with(k_bar + "PBEAM,1,1,.1,.2,.3,,.4\nCBAR,1,1,1,2,3\nCBEAM,2,1,1,2,3\n");
  EXPECT_FALSE(model.elements<BeamElement>().at(0).has_torsional_inertia);
  EXPECT_TRUE(model.elements<BeamElement>().at(1).has_torsional_inertia);
}

TEST(NastranBeams, HaveAPropertyOfDimensions) {
  const FiniteElementModel model = cube_with("PBARL,1,1,,TUBE\n,.1,.08,5.\nPBEAML,1,1,,bar\n,.1,.2\n");
  EXPECT_EQ(model.beam_properties.at(0).section, "TUBE");
  ASSERT_EQ(model.beam_properties[0].dimensions.size(), 2U);
  EXPECT_EQ(field_name(model, model.beam_properties[0].dimensions[1]), "PBARL:1:DIM2");
  EXPECT_EQ(value_of(model, "PBARL:1:NSM"), 5.0);
  EXPECT_EQ(model.beam_properties.at(1).card, "PBEAML");
  EXPECT_EQ(value_of(model, "PBEAML:1:DIM2"), 0.2);
}

TEST(NastranBeams, HaveAPropertyThatRepeatsEndA) {
  const FiniteElementModel model = cube_with(
      "PBEAM,1,1,.1,.2,.3,,.4,.5\n,,,,,,,,\n,YESA,.5,.1,.2\n,NO,1.,,,.3,0.\n,.7,.6\n"
      "PBEAM,2,1,.1,.2,.3\nPBEAML,3,1,,BAR\n,.1,.2,,YES,1.,.1,.2\n");
  ASSERT_EQ(model.beam_properties.size(), 3U);
  EXPECT_EQ(value_of(model, "PBEAM:1:J"), 0.4);
  EXPECT_EQ(model.beam_properties[0].shear_1, 0.7);
  EXPECT_EQ(model.beam_properties[0].shear_2, 0.6);
  EXPECT_EQ(model.beam_properties[1].shear_1, 1.0);  // Nastran's default, unlike PBAR's
}

// K1.., then M1(A) M2(A) M1(B) M2(B) N1(A) N2(A) N1(B) N2(B); blank at end B as at end A.
TEST(NastranBeams, MayHaveTheirNeutralAxisBesideTheShearCentre) {
  const BeamProperty property =
      test::model_of(test::k_cube + "PBEAM,1,1,.1,.2,.3,,.4\n,\n,1.,1.\n,.5,.6,,,.7,.8,.7,.8\n")
          .model.beam_properties.front();
  EXPECT_EQ(property.nonstructural_center, Eigen::Vector2d(0.5, 0.6));
  EXPECT_EQ(property.neutral_axis, Eigen::Vector2d(0.7, 0.8));
  EXPECT_THAT(test::refusal_of(test::k_cube + "PBEAM,1,1,.1,.2,.3,,.4\n,\n,YES,1.,.2,.2,.3,,.4\n,\n,\n,,,,,.7\n"),
              ::testing::HasSubstr("N1, N2 are given for a tapered beam; they are supported for constant beams only"));
}

TEST(NastranBeams, AreReadWithEndsAndOrientation) {
  const FiniteElementModel model =
      cube_with(k_bar + "CBAR,1,,1,2,0.,1.,0.\n,6,45,0.,.1,0.,0.,.2,0.\nPBEAM,1,1,.1,.2,.3\nCBEAM,2,1,1,2,8\n");
  const BeamElement& bar = model.elements<BeamElement>().at(0);
  EXPECT_THAT(bar.nodes, ElementsAre(0, 1));
  EXPECT_EQ(bar.orientation, Eigen::Vector3d(0, 1, 0));
  EXPECT_EQ(bar.pins[0], 0x20);
  EXPECT_EQ(bar.pins[1], 0x18);
  EXPECT_EQ(bar.offsets[0], Eigen::Vector3d(0, 0.1, 0));
  EXPECT_EQ(bar.offsets[1], Eigen::Vector3d(0, 0.2, 0));
  EXPECT_EQ(model.elements<BeamElement>().at(1).card, "CBEAM");
  EXPECT_EQ(model.elements<BeamElement>()[1].orientation, Eigen::Vector3d(0, 2, 2));
  EXPECT_EQ(model.elements<BeamElement>()[1].property, 1);
}

TEST(NastranBeams, TurnWithTheDisplacementSystem) {
  const std::string points = "GRID,11,,0.,0.,0.,4\nGRID,12,,1.,0.,0.\n" + k_quarter_turn;
  const FiniteElementModel model =
      cube_with(k_bar + points + "CBAR,1,,11,12,1.,0.,0.\n,,,.1,0.,0.,0.,.3,0.\nCBAR,2,1,11,12,0.,0.,1.,BGG\n");
  EXPECT_EQ(model.elements<BeamElement>().at(0).orientation, Eigen::Vector3d(0, 1, 0));
  EXPECT_EQ(model.elements<BeamElement>()[0].offsets[0], Eigen::Vector3d(0, 0.1, 0));
  EXPECT_EQ(model.elements<BeamElement>()[0].offsets[1], Eigen::Vector3d(0, 0.3, 0));  // end B has basic directions
  EXPECT_EQ(model.elements<BeamElement>().at(1).orientation, Eigen::Vector3d(0, 0, 1));
}

TEST(NastranBeams, MayHaveOffsetsAlongThemselves) {
  // From 2 to 3 the axis is basic y; v = basic z; then z of the beam is y cross z = basic x.
  const FiniteElementModel model = cube_with(k_bar + "CBAR,1,,2,3,0.,0.,1.,GOO\n,,,.1,.2,.3,0.,0.,.4\n");
  EXPECT_LT((model.elements<BeamElement>().at(0).offsets[0] - Eigen::Vector3d(0.3, 0.1, 0.2)).norm(), k_rounding);
  EXPECT_LT((model.elements<BeamElement>()[0].offsets[1] - Eigen::Vector3d(0.4, 0, 0)).norm(), k_rounding);
}

TEST(NastranBeams, TakeWhatIsBlankFromTheirDefaults) {
  const FiniteElementModel model =
      cube_with("PBAR,9,1,.1\nBAROR,,9,,,0.,0.,1.,BGG\nCBAR,1,,1,2\nCBAR,2,,1,2,0.,1.,0.\n");
  EXPECT_EQ(model.elements<BeamElement>().at(0).orientation, Eigen::Vector3d(0, 0, 1));
  EXPECT_EQ(model.elements<BeamElement>().at(1).orientation, Eigen::Vector3d(0, 1, 0));
  EXPECT_EQ(model.beam_properties.at(static_cast<std::size_t>(model.elements<BeamElement>()[0].property)).id, 9);
}

const std::string k_bush = "PBUSH,1,K,1.,2.,3.,4.,5.,6.\n,,B,.1\n,,GE,.02\nPBUSH,2,K,1.\n";

TEST(NastranBushes, HaveStiffnessAndDamping) {
  const NastranModel read = model_of(k_cube + k_bush + "CBUSH,1,1,1,2,,,,0\n");
  EXPECT_EQ(value_of(read.model, "PBUSH:1:K6"), 6.0);
  EXPECT_EQ(value_of(read.model, "PBUSH:1:B1"), 0.1);
  EXPECT_EQ(field_name(read.model, read.model.elements<BushElement>().at(0).stiffness[4]), "PBUSH:1:K5");
  EXPECT_EQ(read.model.elements<BushElement>()[0].damping[1], k_no_field);
  EXPECT_THAT(read.notes, ElementsAre("1 PBUSH lines of structural damping (GE) were ignored"));
}

TEST(NastranBushes, LieAlongTheirPointsOrTheirSystem) {
  const FiniteElementModel model = cube_with(
      k_bush + k_quarter_turn + "CBUSH,1,1,2,3,0.,0.,1.\nCBUSH,2,1,2,3,6\nCBUSH,3,1,1,,,,,4\nCBUSH,4,2,1,2\n");
  Eigen::Matrix3d along;  // x = basic y, y = basic z, z = basic x
  along << 0, 0, 1, 1, 0, 0, 0, 1, 0;
  EXPECT_EQ(model.elements<BushElement>().at(0).axes, along);
  EXPECT_EQ(model.elements<BushElement>().at(1).axes, along);
  EXPECT_EQ(model.elements<BushElement>().at(2).axes, model.coordinate_systems.at(0).axes);
  EXPECT_THAT(model.elements<BushElement>()[2].nodes, ElementsAre(0, -1));
  EXPECT_EQ(model.elements<BushElement>().at(3).axes.col(0), Eigen::Vector3d::UnitX());
}

TEST(NastranBushes, SitWhereTheCardSays) {
  const FiniteElementModel model = cube_with(
      k_bush + k_quarter_turn + "CBUSH,1,1,1,2,,,,0\nCBUSH,2,1,1,2,,,,0\n,.25\nCBUSH,3,1,1,2,,,,0\n,,4,1.,0.,3.\n");
  EXPECT_EQ(model.elements<BushElement>().at(0).location, Eigen::Vector3d(1, 0, 0));
  EXPECT_EQ(model.elements<BushElement>().at(1).location, Eigen::Vector3d(0.5, 0, 0));
  EXPECT_EQ(model.elements<BushElement>().at(2).location, Eigen::Vector3d(0, 1, 3));
}

TEST(NastranRigid, BodyHasItsDependents) {
  const FiniteElementModel model = cube_with("RBE2,1,8,123,1,2,THRU,4,6.5-6\n");
  EXPECT_EQ(model.rigid_bodies.at(0).independent, 7);
  EXPECT_EQ(model.rigid_bodies[0].components, 0x07);
  EXPECT_THAT(model.rigid_bodies[0].dependents, ElementsAre(0, 1, 2, 3));
}

TEST(NastranRigid, BarHasItsComponents) {
  const FiniteElementModel model = cube_with("RBAR,1,1,2,123456\nRBAR,2,1,2,1234,56,,12\nRBAR1,3,1,2,123\n");
  EXPECT_THAT(model.rigid_bars.at(0).independent, ElementsAre(0x3f, 0));
  EXPECT_THAT(model.rigid_bars[0].dependent, ElementsAre(0, 0x3f));
  EXPECT_THAT(model.rigid_bars.at(1).independent, ElementsAre(0x0f, 0x30));
  EXPECT_THAT(model.rigid_bars[1].dependent, ElementsAre(0, 0x03));
  EXPECT_THAT(model.rigid_bars.at(2).dependent, ElementsAre(0, 0x07));
}

TEST(NastranRigid, InterpolationHasItsGroups) {
  const FiniteElementModel model =
      cube_with("RBE3,1,,8,123456,1.,123,1,2\n,3,.5,12,4,5\nRBE3,2,,8,123,1.,123,1,2\n,UM,1,12,2,3\n,ALPHA,1.-6\n");
  const Interpolation& first = model.interpolations.at(0);
  EXPECT_EQ(first.reference, 7);
  EXPECT_EQ(first.reference_components, 0x3f);
  ASSERT_EQ(first.sources.size(), 5U);
  EXPECT_EQ(first.sources[2].node, 2);
  EXPECT_EQ(first.sources[2].weight, 1.0);
  EXPECT_EQ(first.sources[3].weight, 0.5);
  EXPECT_EQ(first.sources[3].components, 0x03);
  EXPECT_THAT(model.interpolations.at(1).dependents,
              ElementsAre(std::pair<int, Components>(0, 0x03), std::pair<int, Components>(1, 0x04)));
}

}  // namespace
}  // namespace mottle::formats
