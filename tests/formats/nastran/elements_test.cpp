// Elements and properties of decks; expectations by hand.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <numbers>
#include <string>
#include <vector>

#include "formats/nastran/model_of.hpp"

namespace mottle::formats {
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
  ASSERT_EQ(model.elements<SolidElement>().size(), 4U);
  EXPECT_EQ(model.elements<SolidElement>()[0].shape, SolidShape::hexahedron8);
  const auto& nodes = model.elements<SolidElement>()[0].nodes;
  EXPECT_THAT(std::vector(nodes.begin(), nodes.begin() + 8), ElementsAre(0, 1, 2, 3, 4, 5, 6, 7));
  EXPECT_EQ(model.elements<SolidElement>()[1].shape, SolidShape::wedge6);
  EXPECT_EQ(model.elements<SolidElement>()[1].nodes[5], 6);
  EXPECT_EQ(model.elements<SolidElement>()[2].shape, SolidShape::tetrahedron4);
  EXPECT_EQ(model.elements<SolidElement>()[2].material, 0);
  EXPECT_EQ(model.elements<SolidElement>()[3].property_id, 9);
}

TEST(NastranSolids, AreReadWithMidsideNodesOfTetrahedra) {
  const FiniteElementModel model = cube_with("GRID,9\nGRID,10\nPSOLID,5,1\nCTETRA,3,5,1,2,3,4,5,6\n,7,8,9,10\n");
  EXPECT_EQ(model.elements<SolidElement>().at(0).shape, SolidShape::tetrahedron10);
  EXPECT_EQ(model.elements<SolidElement>()[0].nodes[9], 9);
}

TEST(NastranSolids, TakeTheirMiddleNodesInNastransOrder) {
  std::string points;
  for (int id = 9; id <= 20; ++id) points += "GRID," + std::to_string(id) + "\n";
  const FiniteElementModel model = cube_with(
      points +
      "PSOLID,5,1\nCHEXA,1,5,1,2,3,4,5,6\n,7,8,9,10,11,12,13,14\n,15,16,17,18,19,20\n"
      "CPENTA,2,5,1,2,3,5,6,7\n,9,10,11,12,13,14,15,16\n,17\nCPYRAM,3,5,1,2,3,4,8,9\n,10,11,12,13,14,15,16\n");
  const auto& solids = model.elements<SolidElement>();
  ASSERT_EQ(solids.size(), 3U);
  EXPECT_EQ(solids[0].shape, SolidShape::hexahedron20);
  for (int k = 0; k < 20; ++k) EXPECT_EQ(solids[0].nodes[static_cast<std::size_t>(k)], k);
  EXPECT_EQ(solids[1].shape, SolidShape::wedge15);
  EXPECT_THAT(solids[1].nodes, ElementsAre(0, 1, 2, 4, 5, 6, 8, 9, 10, 11, 12, 13, 14, 15, 16, 0, 0, 0, 0, 0));
  EXPECT_EQ(solids[2].shape, SolidShape::pyramid13);
  EXPECT_EQ(solids[2].nodes[12], 15);
}

TEST(NastranSolids, MayLeaveOutMiddleNodes) {
  const FiniteElementModel model =
      cube_with("GRID,9\nGRID,10\nPSOLID,5,1\nCHEXA,1,5,1,2,3,4,5,6\n,7,8,,9\nCTETRA,3,5,1,2,3,4,,0\n,,,,10\n");
  const auto& solids = model.elements<SolidElement>();
  EXPECT_EQ(solids.at(0).shape, SolidShape::hexahedron20);
  EXPECT_EQ(solids[0].nodes[8], -1);
  EXPECT_EQ(solids[0].nodes[9], 8);
  EXPECT_EQ(solids[0].nodes[19], -1);
  EXPECT_EQ(solids.at(1).shape, SolidShape::tetrahedron10);
  EXPECT_THAT(std::vector(solids[1].nodes.begin(), solids[1].nodes.begin() + 10),
              ElementsAre(0, 1, 2, 3, -1, -1, -1, -1, -1, 9));
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
  EXPECT_EQ(model.elements<ShellElement>().at(0).offset, 0.01);
  EXPECT_EQ(model.elements<ShellElement>()[0].thickness, k_no_field);
  EXPECT_EQ(model.elements<ShellElement>().at(1).node_count, 3);
  EXPECT_EQ(model.elements<ShellElement>()[1].offset, -0.01);
  EXPECT_EQ(model.elements<ShellElement>()[1].property, 1);
}

// E / G = 2.6, T = .002, 12I/T3 = 2, TS/T = .5: 2.6 * 4e-6 * 4. A triangle takes it anew.
TEST(NastranShells, HoldTheShareOfTheirEdges) {
  const FiniteElementModel model = cube_with(
      "PSHELL,3,1,.002,1,2.,1,.5\nPSHELL,4,1,.1,1\nCQUAD4,1,3,1,2,3,4\nCQUAD4,2,4,1,2,3,4\nCTRIA3,3,3,1,2,3\n");
  EXPECT_NEAR(model.elements<ShellElement>().at(0).bending_over_shear, 4.16e-5, 1e-18);
  EXPECT_EQ(model.elements<ShellElement>()[1].bending_over_shear, 0.0);
  EXPECT_EQ(model.elements<ShellElement>()[2].bending_over_shear, 0.0);
}

TEST(NastranShells, MayHaveAThicknessOfTheirOwn) {
  const FiniteElementModel model = cube_with(
      "PSHELL,3,1,.002\nCQUAD4,1,3,1,2,3,4\n,,,.001,.001,.001,.001\n"
      "CTRIA3,2,3,1,2,3\n,,1,.5,.5,2.\n");
  EXPECT_EQ(field_name(model, model.elements<ShellElement>().at(0).thickness), "CQUAD4:1:T");
  EXPECT_EQ(value_of(model, "CQUAD4:1:T"), 0.001);
  EXPECT_NEAR(value_of(model, "CTRIA3:2:T"), 0.002, 1e-17);  // mean of .001, .001, .004; two roundings
}

TEST(NastranShells, TakeBlankCornersFromTheProperty) {
  const NastranModel read = model_of(k_cube + "PSHELL,3,1,.002\nCQUAD4,1,3,1,2,3,4\n,,,.004,.004\n");
  EXPECT_NEAR(value_of(read.model, "CQUAD4:1:T"), 0.003, 1e-17);
  EXPECT_THAT(read.notes, ElementsAre(HasSubstr("1 shells have different thicknesses at their corners")));
}

TEST(NastranShells, MayHaveMiddleNodes) {
  const FiniteElementModel model = cube_with(
      "PSHELL,3,1,.002,1,,1\nGRID,9,,1.,0.,0.\nGRID,10,,2.,1.,0.\nGRID,11,,1.,2.,0.\n"
      "CQUAD8,1,3,1,2,3,4,9,10\n,11,,.001,.001,.001,.003,30.,.5\n"
      "CTRIA6,2,3,1,2,3,9,10\n,,.25,.5,.5,.5,1\nCQUAD8,3,3,1,2,3,4\n");
  const auto& shells = model.elements<ShellElement>();
  ASSERT_EQ(shells.size(), 3U);
  EXPECT_THAT(shells[0].nodes, ElementsAre(0, 1, 2, 3, 8, 9, 10, -1));
  EXPECT_EQ(shells[0].node_count, 8);
  EXPECT_NEAR(value_of(model, "CQUAD8:1:T"), 0.0015, 1e-17);
  EXPECT_EQ(shells[0].material_angle, 30.0);
  EXPECT_EQ(shells[0].offset, 0.5);
  EXPECT_NEAR(shells[0].bending_over_membrane, 0.0015 * 0.0015, 1e-20);
  EXPECT_EQ(shells[1].node_count, 6);
  EXPECT_EQ(shells[1].nodes[5], -1);
  EXPECT_EQ(shells[1].offset, 0.25);
  EXPECT_NEAR(value_of(model, "CTRIA6:2:T"), 0.001, 1e-17);
  EXPECT_EQ(shells[2].node_count, 4) << "as a CQUAD4";
}

TEST(NastranShells, ReadTheRKindAsTheOthersWithANote) {
  const NastranModel read = model_of(k_cube + "PSHELL,3,1,.002\nCQUADR,1,3,1,2,3,4,,.01\nCTRIAR,2,3,1,2,3\n");
  EXPECT_EQ(read.model.elements<ShellElement>().at(0).offset, 0.01);
  EXPECT_STREQ(read.model.elements<ShellElement>()[1].card, "CTRIAR");
  EXPECT_THAT(read.notes, ElementsAre(HasSubstr("2 CQUADR and CTRIAR were taken as CQUAD4 and CTRIA3")));
}

TEST(NastranShells, MayCoupleMembraneAndBending) {
  const FiniteElementModel model = cube_with("MAT1,2,1.+9,,.3\nPSHELL,3,1,.002,1,,1\n,,,2\nCQUAD4,1,3,1,2,3,4\n");
  EXPECT_EQ(model.shell_properties.at(0).coupling_material, 1);
}

TEST(NastranShearPanels, AreReadWithTheirProperty) {
  const FiniteElementModel model = cube_with("PSHEAR,3,1,.002,5.,1.,20.\nCSHEAR,1,3,1,2,3,4\n");
  const ShearPanelElement& panel = model.elements<ShearPanelElement>().at(0);
  EXPECT_THAT(panel.nodes, ElementsAre(0, 1, 2, 3));
  EXPECT_EQ(value_of(model, "PSHEAR:3:T"), 0.002);
  EXPECT_EQ(value_of(model, "PSHEAR:3:NSM"), 5.0);
  EXPECT_THAT(panel.effectiveness, ElementsAre(1.0, 20.0));
}

TEST(NastranGaps, AreSpringsInTheStateOfTheDeck) {
  const NastranModel read = model_of(k_cube +
                                     "GRID,9\nPGAP,1,,5.,100.,.1\nPGAP,2,.5,,100.,.25\nPGAP,3,.5,,100.\n"
                                     "PGAP,4,,,100.,,,.2\nCORD2R,7,,,,,1.,,,\n,,,1.\n"
                                     "CGAP,1,1,1,2\nCGAP,2,2,1,4\nCGAP,3,3,1,4\nCGAP,4,4,1,9,,,,7\n");
  const auto& gaps = read.model.elements<BushElement>();
  ASSERT_EQ(gaps.size(), 4U);
  EXPECT_EQ(field_name(read.model, gaps[0].stiffness[0]), "PGAP:1:KA") << "closed by F0";
  EXPECT_EQ(gaps[0].stiffness[1], k_no_field);
  EXPECT_EQ(gaps[0].axes.col(0), Eigen::Vector3d::UnitX());
  EXPECT_EQ(field_name(read.model, gaps[1].stiffness[0]), "PGAP:2:KB") << "open";
  EXPECT_EQ(gaps[1].axes.col(0), Eigen::Vector3d::UnitY());
  EXPECT_EQ(gaps[2].stiffness[0], k_no_field) << "open without KB";
  EXPECT_EQ(value_of(read.model, "PGAP:4:KT"), 20.0) << "MU1 KA";
  EXPECT_EQ(field_name(read.model, gaps[3].stiffness[2]), "PGAP:4:KT");
  EXPECT_THAT(read.notes, ElementsAre(HasSubstr("2 CGAP are closed"), HasSubstr("2 CGAP are open")));
}

TEST(NastranDampers, MayActAlongAndAboutALine) {
  const FiniteElementModel model = cube_with("PVISC,1,3.,4.,,2,5.\nCVISC,7,1,1,4\nCVISC,8,2,1,2\n");
  const auto& dampers = model.elements<BushElement>();
  ASSERT_EQ(dampers.size(), 2U);
  EXPECT_EQ(value_of(model, "PVISC:1:CR"), 4.0);
  EXPECT_EQ(field_name(model, dampers[0].damping[3]), "PVISC:1:CR");
  EXPECT_EQ(dampers[0].axes.col(0), Eigen::Vector3d::UnitY());
  EXPECT_EQ(field_name(model, dampers[1].damping[0]), "PVISC:2:CE");
  EXPECT_EQ(dampers[1].damping[3], k_no_field);
  EXPECT_EQ(dampers[0].stiffness[0], k_no_field);
}

TEST(NastranShells, MayTaperToNothingAtACorner) {
  const FiniteElementModel model = cube_with("PSHELL,3,1,.002\nCTRIA3,1,3,1,2,3\n,,,0.,.003,.003\n");
  EXPECT_NEAR(value_of(model, "CTRIA3:1:T"), 0.002, 1e-17);
}

TEST(NastranRods, AreReadFromEveryCard) {
  const FiniteElementModel model =
      cube_with("PROD,1,1,.1,.2,,.3\nCROD,1,1,1,2\nCONROD,2,3,4,1,.5,.6,,.7\nPTUBE,3,1,.2,.05,.4\nCTUBE,3,3,5,6\n");
  ASSERT_EQ(model.elements<RodElement>().size(), 3U);
  EXPECT_EQ(field_name(model, model.elements<RodElement>()[0].area), "PROD:1:A");
  EXPECT_EQ(value_of(model, "PROD:1:NSM"), 0.3);
  EXPECT_EQ(field_name(model, model.elements<RodElement>()[1].torsion), "CONROD:2:J");
  EXPECT_EQ(value_of(model, "CONROD:2:NSM"), 0.7);
  EXPECT_THAT(model.elements<RodElement>()[1].nodes, ElementsAre(2, 3));
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
  ASSERT_EQ(model.elements<ScalarElement>().size(), 12U);
  const ScalarElement& spring = model.elements<ScalarElement>()[0];
  EXPECT_EQ(field_name(model, spring.value), "PELAS:2:K");
  EXPECT_THAT(spring.nodes, ElementsAre(0, 1));
  EXPECT_THAT(spring.components, ElementsAre(2, 5));
  EXPECT_EQ(field_name(model, model.elements<ScalarElement>()[1].value), "CELAS2:2:K");
  EXPECT_THAT(model.elements<ScalarElement>()[1].nodes, ElementsAre(2, -1));
  EXPECT_THAT(model.elements<ScalarElement>()[2].nodes, ElementsAre(8, 9));
  EXPECT_THAT(model.elements<ScalarElement>()[3].nodes, ElementsAre(9, -1));
  EXPECT_EQ(model.elements<ScalarElement>()[4].kind, ScalarElement::Kind::mass);
  EXPECT_EQ(value_of(model, "PMASS:4:M"), 4.0);
  EXPECT_EQ(field_name(model, model.elements<ScalarElement>()[5].value), "CMASS2:2:M");
  EXPECT_EQ(field_name(model, model.elements<ScalarElement>()[7].value), "CMASS4:4:M");
  EXPECT_EQ(model.elements<ScalarElement>()[8].kind, ScalarElement::Kind::damper);
  EXPECT_EQ(value_of(model, "PDAMP:2:B"), 0.2);
  EXPECT_EQ(field_name(model, model.elements<ScalarElement>()[9].value), "CDAMP2:2:B");
  EXPECT_EQ(value_of(model, "CDAMP4:4:B"), 0.4);
}

TEST(NastranPointMass, IsReadWithItsInertia) {
  const FiniteElementModel model = cube_with("CONM2,7,3,,12.,.1,.2,.3\n,1.,,2.,-.5,,3.\n");
  const PointMassElement& mass = model.elements<PointMassElement>().at(0);
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
  EXPECT_EQ(cube_with("CONM2,7,3,-1,12.,2.5,2.,.3\n").elements<PointMassElement>().at(0).offset,
            Eigen::Vector3d(0.5, 0, 0.3));
}

// Local x is basic y, local y is basic -x.
const std::string k_quarter_turn = "CORD2R,4,,0.,0.,0.,0.,0.,1.\n,0.,1.,0.\n";

TEST(NastranPointMass, TurnsWithItsSystem) {
  const FiniteElementModel model = cube_with(k_quarter_turn + "CONM2,7,3,4,12.,1.\n");
  EXPECT_EQ(
      Eigen::Vector3d(model.elements<PointMassElement>().at(0).axes * model.elements<PointMassElement>()[0].offset),
      Eigen::Vector3d(0, 1, 0));
}

TEST(NastranPointMass, MayBeAWholeMatrix) {
  const FiniteElementModel model =
      cube_with("CONM1,7,3,,11.,21.,22.,31.,32.\n,33.,41.,42.,43.,44.,51.,52.,53.\n,54.,55.,61.,62.,63.,64.,65.,66.\n");
  const PointMassElement& mass = model.elements<PointMassElement>().at(0);
  ASSERT_EQ(mass.matrix.size(), 21U);
  EXPECT_EQ(field_name(model, mass.matrix[2]), "CONM1:7:M22");
  for (const int number : {11, 21, 33, 44, 53, 55, 61, 66}) {
    EXPECT_EQ(value_of(model, "CONM1:7:M" + std::to_string(number)), number);
  }
}

}  // namespace
}  // namespace mottle::formats
