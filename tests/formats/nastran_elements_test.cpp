// Elements and properties of decks; expectations by hand.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <numbers>
#include <string>
#include <vector>

#include "formats/nastran/model_of.hpp"

namespace mottle {
namespace {

using test::field_name;
using test::k_cube;
using test::model_of;
using test::value_of;
using ::testing::ElementsAre;
using ::testing::HasSubstr;
using ::testing::IsEmpty;

constexpr double k_rounding = 1e-14;  // a few operations on numbers around 1

FiniteElementModel cube_with(const std::string& cards) {
  return model_of(k_cube + cards).model;
}

TEST(NastranMaterial, HasAFieldForEveryNumberGiven) {
  const FiniteElementModel model = cube_with("MAT1,2,,80.+9,.25\n");
  EXPECT_EQ(value_of(model, "MAT1:1:E"), 2.1e11);
  EXPECT_EQ(value_of(model, "MAT1:1:NU"), 0.3);
  EXPECT_EQ(value_of(model, "MAT1:1:RHO"), 7850.0);
  EXPECT_EQ(value_of(model, "MAT1:2:G"), 80e9);
  ASSERT_EQ(model.materials.size(), 2U);
  EXPECT_EQ(field_name(model, model.materials[0].young), "MAT1:1:E");
  EXPECT_EQ(model.materials[0].shear, k_no_field);
  EXPECT_EQ(model.materials[1].density, k_no_field);
}

TEST(NastranSolids, AreReadWithTheirCorners) {
  const FiniteElementModel model = cube_with(
      "PSOLID,5,1,,,,,SMECH\nCHEXA,1,5,1,2,3,4,5,6,\n7,8\nCPENTA,2,5,1,2,3,5,6,7\nCTETRA,3,5,1,2,3,8\nPSOLID,9,1\n"
      "CTETRA,9,,1,2,3,8\n");
  ASSERT_EQ(model.solids.size(), 4U);
  EXPECT_EQ(model.solids[0].shape, SolidShape::hexahedron8);
  EXPECT_THAT(model.solids[0].nodes, ElementsAre(0, 1, 2, 3, 4, 5, 6, 7, 0, 0));
  EXPECT_EQ(model.solids[1].shape, SolidShape::wedge6);
  EXPECT_EQ(model.solids[1].nodes[5], 6);
  EXPECT_EQ(model.solids[2].shape, SolidShape::tetrahedron4);
  EXPECT_EQ(model.solids[2].material, 0);
  EXPECT_EQ(model.solids[3].property_id, 9);
}

TEST(NastranSolids, AreReadWithMidsideNodesOfTetrahedra) {
  const FiniteElementModel model = cube_with("GRID,9\nGRID,10\nPSOLID,5,1\nCTETRA,3,5,1,2,3,4,5,6\n,7,8,9,10\n");
  EXPECT_EQ(model.solids.at(0).shape, SolidShape::tetrahedron10);
  EXPECT_EQ(model.solids[0].nodes[9], 9);
}

TEST(NastranShells, AreReadWithTheirProperty) {
  const FiniteElementModel model =
      cube_with("PSHELL,3,1,.002,1,2.,1,.5,12.\nPSHELL,4,,.1,1\nCQUAD4,1,3,1,2,3,4,30.,.01\nCTRIA3,2,4,1,2,3,,-.01\n");
  ASSERT_EQ(model.shell_properties.size(), 2U);
  const ShellProperty& property = model.shell_properties[0];
  EXPECT_EQ(property.membrane_material, 0);
  EXPECT_EQ(property.bending_ratio, 2.0);
  EXPECT_EQ(property.shear_ratio, 0.5);
  EXPECT_EQ(value_of(model, "PSHELL:3:T"), 0.002);
  EXPECT_EQ(value_of(model, "PSHELL:3:NSM"), 12.0);
  EXPECT_EQ(model.shell_properties[1].membrane_material, -1);
  EXPECT_EQ(model.shell_properties[1].shear_material, -1);
  EXPECT_DOUBLE_EQ(model.shell_properties[1].shear_ratio, 5.0 / 6.0);
  EXPECT_EQ(model.shells.at(0).offset, 0.01);
  EXPECT_EQ(model.shells[0].thickness, k_no_field);
  EXPECT_EQ(model.shells.at(1).node_count, 3);
  EXPECT_EQ(model.shells[1].offset, -0.01);
  EXPECT_EQ(model.shells[1].property, 1);
}

TEST(NastranShells, MayHaveAThicknessOfTheirOwn) {
  const FiniteElementModel model = cube_with(
      "PSHELL,3,1,.002\nCQUAD4,1,3,1,2,3,4\n,,,.001,.001,.001,.001\n"
      "CTRIA3,2,3,1,2,3\n,,1,.5,.5,2.\n");
  EXPECT_EQ(field_name(model, model.shells.at(0).thickness), "CQUAD4:1:T");
  EXPECT_EQ(value_of(model, "CQUAD4:1:T"), 0.001);
  EXPECT_NEAR(value_of(model, "CTRIA3:2:T"), 0.002, 1e-17);  // mean of .001, .001, .004; two roundings
}

TEST(NastranShells, TakeBlankCornersFromTheProperty) {
  const NastranModel read = model_of(k_cube + "PSHELL,3,1,.002\nCQUAD4,1,3,1,2,3,4\n,,,.004,.004\n");
  EXPECT_NEAR(value_of(read.model, "CQUAD4:1:T"), 0.003, 1e-17);
  EXPECT_THAT(read.notes, ElementsAre(HasSubstr("1 shells have different thicknesses at their corners")));
}

TEST(NastranRods, AreReadFromEveryCard) {
  const FiniteElementModel model =
      cube_with("PROD,1,1,.1,.2,,.3\nCROD,1,1,1,2\nCONROD,2,3,4,1,.5,.6,,.7\nPTUBE,3,1,.2,.05,.4\nCTUBE,3,3,5,6\n");
  ASSERT_EQ(model.rods.size(), 3U);
  EXPECT_EQ(field_name(model, model.rods[0].area), "PROD:1:A");
  EXPECT_EQ(value_of(model, "PROD:1:NSM"), 0.3);
  EXPECT_EQ(field_name(model, model.rods[1].torsion), "CONROD:2:J");
  EXPECT_EQ(value_of(model, "CONROD:2:NSM"), 0.7);
  EXPECT_THAT(model.rods[1].nodes, ElementsAre(2, 3));
  // outer radius .1, inner .05: A = pi (.01 - .0025), J = pi / 2 (1e-4 - 6.25e-6)
  EXPECT_NEAR(value_of(model, "PTUBE:3:A"), std::numbers::pi * 0.0075, k_rounding);
  EXPECT_NEAR(value_of(model, "PTUBE:3:J"), std::numbers::pi / 2.0 * 9.375e-5, k_rounding);
  EXPECT_EQ(value_of(model, "PTUBE:3:NSM"), 0.4);
}

TEST(NastranScalars, AreReadFromEveryCard) {
  const FiniteElementModel model = cube_with(
      "SPOINT,21,22\nPELAS,1,100.,,,2,200.\nPMASS,1,1.,2,2.,3,3.,4,4.\nPDAMP,1,.1,,,,,2,.2\n"
      "CELAS1,1,2,1,3,2,6\nCELAS2,2,300.,,,3,1\nCELAS3,3,1,21,22\nCELAS4,4,400.,22\n"
      "CMASS1,1,4,1,1\nCMASS2,2,5.,2,2\nCMASS3,3,3,21\nCMASS4,4,6.,21,22\n"
      "CDAMP1,1,2,1,1,2,1\nCDAMP2,2,.3,2,2\nCDAMP3,3,1,21,0\nCDAMP4,4,.4,21,22\n");
  ASSERT_EQ(model.scalars.size(), 12U);
  const ScalarElement& spring = model.scalars[0];
  EXPECT_EQ(field_name(model, spring.value), "PELAS:2:K");
  EXPECT_THAT(spring.nodes, ElementsAre(0, 1));
  EXPECT_THAT(spring.components, ElementsAre(2, 5));
  EXPECT_EQ(field_name(model, model.scalars[1].value), "CELAS2:2:K");
  EXPECT_THAT(model.scalars[1].nodes, ElementsAre(2, -1));
  EXPECT_THAT(model.scalars[2].nodes, ElementsAre(8, 9));
  EXPECT_THAT(model.scalars[3].nodes, ElementsAre(9, -1));
  EXPECT_EQ(model.scalars[4].kind, ScalarElement::Kind::mass);
  EXPECT_EQ(value_of(model, "PMASS:4:M"), 4.0);
  EXPECT_EQ(field_name(model, model.scalars[5].value), "CMASS2:2:M");
  EXPECT_EQ(field_name(model, model.scalars[7].value), "CMASS4:4:M");
  EXPECT_EQ(model.scalars[8].kind, ScalarElement::Kind::damper);
  EXPECT_EQ(value_of(model, "PDAMP:2:B"), 0.2);
  EXPECT_EQ(field_name(model, model.scalars[9].value), "CDAMP2:2:B");
  EXPECT_EQ(value_of(model, "CDAMP4:4:B"), 0.4);
}

TEST(NastranPointMass, IsReadWithItsInertia) {
  const FiniteElementModel model = cube_with("CONM2,7,3,,12.,.1,.2,.3\n,1.,,2.,-.5,,3.\n");
  const PointMassElement& mass = model.point_masses.at(0);
  EXPECT_EQ(mass.node, 2);
  EXPECT_EQ(mass.offset, Eigen::Vector3d(0.1, 0.2, 0.3));
  EXPECT_EQ(mass.axes, Eigen::Matrix3d::Identity());
  EXPECT_EQ(value_of(model, "CONM2:7:M"), 12.0);
  EXPECT_EQ(field_name(model, mass.inertia[0]), "CONM2:7:I11");
  EXPECT_EQ(mass.inertia[1], k_no_field);
  EXPECT_EQ(value_of(model, "CONM2:7:I31"), -0.5);
  EXPECT_EQ(value_of(model, "CONM2:7:I33"), 3.0);
}

TEST(NastranPointMass, MayGiveItsCentreInBasicCoordinates) {
  EXPECT_EQ(cube_with("CONM2,7,3,-1,12.,2.5,2.,.3\n").point_masses.at(0).offset, Eigen::Vector3d(0.5, 0, 0.3));
}

// Local x is basic y, local y is basic -x.
const std::string k_quarter_turn = "CORD2R,4,,0.,0.,0.,0.,0.,1.\n,0.,1.,0.\n";

TEST(NastranPointMass, TurnsWithItsSystem) {
  const FiniteElementModel model = cube_with(k_quarter_turn + "CONM2,7,3,4,12.,1.\n");
  EXPECT_EQ(Eigen::Vector3d(model.point_masses.at(0).axes * model.point_masses[0].offset), Eigen::Vector3d(0, 1, 0));
}

TEST(NastranPointMass, MayBeAWholeMatrix) {
  const FiniteElementModel model =
      cube_with("CONM1,7,3,,11.,21.,22.,31.,32.\n,33.,41.,42.,43.,44.,51.,52.,53.\n,54.,55.,61.,62.,63.,64.,65.,66.\n");
  const PointMassElement& mass = model.point_masses.at(0);
  ASSERT_EQ(mass.matrix.size(), 21U);
  EXPECT_EQ(field_name(model, mass.matrix[2]), "CONM1:7:M22");
  for (const int number : {11, 21, 33, 44, 53, 55, 61, 66}) {
    EXPECT_EQ(value_of(model, "CONM1:7:M" + std::to_string(number)), number);
  }
}

const std::string k_bar = "PBAR,1,1,.1,.2,.3,.4,.5\n";

TEST(NastranBeams, HaveAPropertyOfNumbers) {
  const FiniteElementModel model = cube_with("PBAR,1,1,.1,.2,.3,.4,.5\n,,,,,,,,\n,.8,.9,.01\n");
  EXPECT_EQ(value_of(model, "PBAR:1:A"), 0.1);
  EXPECT_EQ(value_of(model, "PBAR:1:I1"), 0.2);
  EXPECT_EQ(value_of(model, "PBAR:1:I2"), 0.3);
  EXPECT_EQ(value_of(model, "PBAR:1:J"), 0.4);
  EXPECT_EQ(value_of(model, "PBAR:1:NSM"), 0.5);
  EXPECT_EQ(value_of(model, "PBAR:1:I12"), 0.01);
  EXPECT_EQ(model.beam_properties.at(0).shear_1, 0.8);
  EXPECT_EQ(model.beam_properties[0].shear_2, 0.9);
  EXPECT_EQ(model.beam_properties[0].section, "");
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

TEST(NastranBeams, AreReadWithEndsAndOrientation) {
  const FiniteElementModel model =
      cube_with(k_bar + "CBAR,1,,1,2,0.,1.,0.\n,6,45,0.,.1,0.,0.,.2,0.\nPBEAM,1,1,.1,.2,.3\nCBEAM,2,1,1,2,8\n");
  const BeamElement& bar = model.beams.at(0);
  EXPECT_THAT(bar.nodes, ElementsAre(0, 1));
  EXPECT_EQ(bar.orientation, Eigen::Vector3d(0, 1, 0));
  EXPECT_EQ(bar.pins[0], 0x20);
  EXPECT_EQ(bar.pins[1], 0x18);
  EXPECT_EQ(bar.offsets[0], Eigen::Vector3d(0, 0.1, 0));
  EXPECT_EQ(bar.offsets[1], Eigen::Vector3d(0, 0.2, 0));
  EXPECT_EQ(model.beams.at(1).card, "CBEAM");
  EXPECT_EQ(model.beams[1].orientation, Eigen::Vector3d(0, 2, 2));
  EXPECT_EQ(model.beams[1].property, 1);
}

TEST(NastranBeams, TurnWithTheDisplacementSystem) {
  const std::string points = "GRID,11,,0.,0.,0.,4\nGRID,12,,1.,0.,0.\n" + k_quarter_turn;
  const FiniteElementModel model =
      cube_with(k_bar + points + "CBAR,1,,11,12,1.,0.,0.\n,,,.1,0.,0.,0.,.3,0.\nCBAR,2,1,11,12,0.,0.,1.,BGG\n");
  EXPECT_EQ(model.beams.at(0).orientation, Eigen::Vector3d(0, 1, 0));
  EXPECT_EQ(model.beams[0].offsets[0], Eigen::Vector3d(0, 0.1, 0));
  EXPECT_EQ(model.beams[0].offsets[1], Eigen::Vector3d(0, 0.3, 0));  // end B has basic directions
  EXPECT_EQ(model.beams.at(1).orientation, Eigen::Vector3d(0, 0, 1));
}

TEST(NastranBeams, MayHaveOffsetsAlongThemselves) {
  // From 2 to 3 the axis is basic y; v = basic z; then z of the beam is y cross z = basic x.
  const FiniteElementModel model = cube_with(k_bar + "CBAR,1,,2,3,0.,0.,1.,GOO\n,,,.1,.2,.3,0.,0.,.4\n");
  EXPECT_LT((model.beams.at(0).offsets[0] - Eigen::Vector3d(0.3, 0.1, 0.2)).norm(), k_rounding);
  EXPECT_LT((model.beams[0].offsets[1] - Eigen::Vector3d(0.4, 0, 0)).norm(), k_rounding);
}

TEST(NastranBeams, TakeWhatIsBlankFromTheirDefaults) {
  const FiniteElementModel model =
      cube_with("PBAR,9,1,.1\nBAROR,,9,,,0.,0.,1.,BGG\nCBAR,1,,1,2\nCBAR,2,,1,2,0.,1.,0.\n");
  EXPECT_EQ(model.beams.at(0).orientation, Eigen::Vector3d(0, 0, 1));
  EXPECT_EQ(model.beams.at(1).orientation, Eigen::Vector3d(0, 1, 0));
  EXPECT_EQ(model.beam_properties.at(static_cast<std::size_t>(model.beams[0].property)).id, 9);
}

const std::string k_bush = "PBUSH,1,K,1.,2.,3.,4.,5.,6.\n,,B,.1\n,,GE,.02\nPBUSH,2,K,1.\n";

TEST(NastranBushes, HaveStiffnessAndDamping) {
  const NastranModel read = model_of(k_cube + k_bush + "CBUSH,1,1,1,2,,,,0\n");
  EXPECT_EQ(value_of(read.model, "PBUSH:1:K6"), 6.0);
  EXPECT_EQ(value_of(read.model, "PBUSH:1:B1"), 0.1);
  EXPECT_EQ(field_name(read.model, read.model.bushes.at(0).stiffness[4]), "PBUSH:1:K5");
  EXPECT_EQ(read.model.bushes[0].damping[1], k_no_field);
  EXPECT_THAT(read.notes, ElementsAre("1 PBUSH lines of structural damping (GE) were ignored"));
}

TEST(NastranBushes, LieAlongTheirPointsOrTheirSystem) {
  const FiniteElementModel model = cube_with(
      k_bush + k_quarter_turn + "CBUSH,1,1,2,3,0.,0.,1.\nCBUSH,2,1,2,3,6\nCBUSH,3,1,1,,,,,4\nCBUSH,4,2,1,2\n");
  Eigen::Matrix3d along;  // x = basic y, y = basic z, z = basic x
  along << 0, 0, 1, 1, 0, 0, 0, 1, 0;
  EXPECT_EQ(model.bushes.at(0).axes, along);
  EXPECT_EQ(model.bushes.at(1).axes, along);
  EXPECT_EQ(model.bushes.at(2).axes, model.coordinate_systems.at(0).axes);
  EXPECT_THAT(model.bushes[2].nodes, ElementsAre(0, -1));
  EXPECT_EQ(model.bushes.at(3).axes.col(0), Eigen::Vector3d::UnitX());
}

TEST(NastranBushes, SitWhereTheCardSays) {
  const FiniteElementModel model = cube_with(
      k_bush + k_quarter_turn + "CBUSH,1,1,1,2,,,,0\nCBUSH,2,1,1,2,,,,0\n,.25\nCBUSH,3,1,1,2,,,,0\n,,4,1.,0.,3.\n");
  EXPECT_EQ(model.bushes.at(0).location, Eigen::Vector3d(1, 0, 0));
  EXPECT_EQ(model.bushes.at(1).location, Eigen::Vector3d(0.5, 0, 0));
  EXPECT_EQ(model.bushes.at(2).location, Eigen::Vector3d(0, 1, 3));
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

TEST(NastranModel, CountsElements) {
  const NastranModel read = model_of(k_cube + "CONM2,1,1,,1.\nCONM2,2,1,,1.\nRBAR,3,1,2,123456\n");
  EXPECT_THAT(read.element_counts,
              ElementsAre(std::pair<std::string, int>("CONM2", 2), std::pair<std::string, int>("RBAR", 1)));
  EXPECT_THAT(read.files, ElementsAre("deck.bdf"));
}

TEST(NastranModel, SkipsWhatDoesNotChangeTheMatrices) {
  const NastranModel read =
      model_of(k_cube + "FORCE,1,1,,1.,1.,0.,0.\nPLOAD4,1,2,3.\nTABLED1,1\nPLOTEL,1,1,2\nDESVAR,1,X,1.\n");
  EXPECT_THAT(read.notes, IsEmpty());
}

TEST(NastranModel, NotesReductionsAndUnknownCards) {
  EXPECT_THAT(model_of(k_cube + "ASET1,123,1,2\nASET1,123,3\nSUPORT,1,1\nXYZZY,1\nXYZZY,2\n").notes,
              ElementsAre("2 ASET1 cards: no reduction is made, all degrees of freedom stay",
                          "1 SUPORT cards: no reduction is made, all degrees of freedom stay",
                          "2 XYZZY cards are not known here and were ignored, the first one at deck.bdf:13"));
}

TEST(NastranModel, LeavesOutWhatItIsTold) {
  const NastranModel read =
      model_of(k_cube + "CQUAD8,1,1\nCQUAD8,2,1\nCONM2,1,1,,1.\n", {.ignore_cards = {"CQUAD8", "CONM2"}});
  EXPECT_THAT(read.model.point_masses, IsEmpty());
  EXPECT_THAT(read.notes, ElementsAre("1 CONM2 cards were left out, as model.ignore_cards asks",
                                      "2 CQUAD8 cards were left out, as model.ignore_cards asks"));
}

TEST(NastranModel, ReadsEqualDuplicatesOnce) {
  const NastranModel read =
      model_of(k_cube + "MAT1,1,210.+9,,.3,7850.\nPELAS,1,5.,,,1,5.0\nCONM2,1,1,,1.\nCONM2,1,1,,1.0\n");
  EXPECT_EQ(read.model.materials.size(), 1U);
  EXPECT_EQ(read.model.point_masses.size(), 1U);
  EXPECT_EQ(read.notes.size(), 3U);
}

}  // namespace
}  // namespace mottle
