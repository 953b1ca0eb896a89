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
  EXPECT_THAT(model.elements<SolidElement>()[0].nodes, ElementsAre(0, 1, 2, 3, 4, 5, 6, 7, 0, 0));
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
