// Layered shells of decks, their materials and their axes; expectations by hand.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <string>
#include <vector>

#include "formats/nastran/model_of.hpp"

namespace mottle::formats {
namespace {

using test::field_name;
using test::k_cube;
using test::model_of;
using test::refusal_of;
using test::value_of;
using ::testing::ElementsAre;
using ::testing::HasSubstr;

const std::string k_ply = "MAT8,2,1.4+11,1.+10,.3,5.+9,5.+9,3.+9,1600.\n,1.-6,2.-5,,1.+9\n";

FiniteElementModel cube_with(const std::string& cards) {
  return model_of(k_cube + k_ply + cards).model;
}

const ShellProperty& only_property(const FiniteElementModel& model) {
  return model.shell_properties.at(0);
}

TEST(NastranMaterial, HasTheModuliOfAPly) {
  const FiniteElementModel model = cube_with("");
  const Material& material = model.materials.at(1);
  EXPECT_EQ(material.kind, Material::Kind::orthotropic_shell);
  std::vector<std::string> names;
  for (const FieldIndex field : material.moduli) names.push_back(field_name(model, field));
  EXPECT_THAT(names, ElementsAre("MAT8:2:E1", "MAT8:2:E2", "MAT8:2:NU12", "MAT8:2:G12", "MAT8:2:G1Z", "MAT8:2:G2Z"));
  EXPECT_EQ(value_of(model, "MAT8:2:E2"), 1e10);
  EXPECT_EQ(field_name(model, material.density), "MAT8:2:RHO");
}

TEST(NastranMaterial, MayBeAMatrix) {
  const FiniteElementModel model =
      cube_with("MAT2,3,4.,1.,,3.,,2.,9.\nMAT9,4,6.,1.,1.,,,,6.\n,1.,,,,6.,,,\n,2.,,,2.,,2.,7.\n");
  EXPECT_EQ(model.materials.at(2).kind, Material::Kind::anisotropic_shell);
  EXPECT_EQ(value_of(model, "MAT2:3:G22"), 3.0);
  EXPECT_EQ(value_of(model, "MAT2:3:RHO"), 9.0);
  EXPECT_EQ(model.materials.at(3).moduli.size(), 21U);
  EXPECT_EQ(value_of(model, "MAT9:4:G33"), 6.0);
  EXPECT_EQ(value_of(model, "MAT9:4:G66"), 2.0);
  EXPECT_EQ(value_of(model, "MAT9:4:RHO"), 7.0);
}

TEST(NastranLaminate, HasAFieldForEveryNumberGiven) {
  const FiniteElementModel model =
      cube_with("PCOMP,5,-.01,3.,1.+7,HILL,20.\n,2,.001,0.,YES,2,.002,45.\n,1,.003,-30.\n");
  const ShellProperty& property = only_property(model);
  ASSERT_EQ(property.laminate.plies.size(), 3U);
  EXPECT_EQ(field_name(model, property.laminate.bottom), "PCOMP:5:Z0");
  EXPECT_EQ(field_name(model, property.nonstructural_mass), "PCOMP:5:NSM");
  EXPECT_EQ(field_name(model, property.laminate.plies[1].thickness), "PCOMP:5:T2");
  EXPECT_EQ(value_of(model, "PCOMP:5:THETA3"), -30.0);
  EXPECT_EQ(property.laminate.plies[0].material, 1);
  EXPECT_EQ(property.laminate.plies[2].material, 0);
}

// As MSC's example of a deck with two plies a line and with blank ones.
TEST(NastranLaminate, TakesBlankMaterialAndThicknessFromThePlyBefore) {
  const FiniteElementModel model = cube_with("PCOMP,5\n,2,.001,10.,,,,20.\n,,,,,1,.002\n");
  const ShellProperty& property = only_property(model);
  ASSERT_EQ(property.laminate.plies.size(), 3U);
  EXPECT_EQ(property.laminate.plies[1].material, 1);
  EXPECT_EQ(field_name(model, property.laminate.plies[1].thickness), "PCOMP:5:T1");
  EXPECT_EQ(field_name(model, property.laminate.plies[2].thickness), "PCOMP:5:T3");
  EXPECT_EQ(property.laminate.plies[2].angle, k_no_field);
}

TEST(NastranLaminate, MayNumberItsPlies) {
  const FiniteElementModel model = cube_with("PCOMPG,5\n,101,2,.001,10.\n,103,2,.002,20.,YES\n");
  ASSERT_EQ(only_property(model).laminate.plies.size(), 2U);
  EXPECT_EQ(value_of(model, "PCOMPG:5:T2"), 0.002);
  EXPECT_EQ(value_of(model, "PCOMPG:5:THETA1"), 10.0);
}

TEST(NastranLaminate, HasBothHalvesUnderLamSym) {
  const FiniteElementModel model = cube_with("PCOMP,5,,,,,,,SYM\n,2,.001,10.,,2,.002,20.\n");
  std::vector<std::string> plies;
  for (const ShellPly& ply : only_property(model).laminate.plies) plies.push_back(field_name(model, ply.thickness));
  EXPECT_THAT(plies, ElementsAre("PCOMP:5:T1", "PCOMP:5:T2", "PCOMP:5:T2", "PCOMP:5:T1"));
}

TEST(NastranLaminate, HasItsOption) {
  using enum LaminateProperty::Option;
  const auto option_of = [](const std::string& lam) {
    return only_property(cube_with("PCOMP,5,,,,,,," + lam + "\n,2,.001\n")).laminate.option;
  };
  EXPECT_EQ(option_of(""), whole);
  EXPECT_EQ(option_of("MEM"), membrane);
  EXPECT_EQ(option_of("BEND"), bending);
  EXPECT_EQ(option_of("SMEAR"), smeared);
}

TEST(NastranShells, HaveMaterialAxesByAngleOrBySystem) {
  const FiniteElementModel model = cube_with(
      "CORD2R,7,,0.,0.,0.,0.,0.,1.\n,0.,1.,0.\nPCOMP,5\n,2,.001\n"
      "CQUAD4,1,5,1,2,3,4,30.\nCQUAD4,2,5,1,2,3,4,7\nCTRIA3,3,5,1,2,3,0\nCTRIA3,4,5,1,2,3\n");
  const auto& shells = model.elements<ShellElement>();
  EXPECT_EQ(shells.at(0).material_angle, 30.0);
  EXPECT_EQ(shells[0].material_system, ShellElement::k_by_angle);
  EXPECT_EQ(shells[1].material_system, 0);
  EXPECT_EQ(shells[2].material_system, -1);
  EXPECT_EQ(shells[3].material_system, ShellElement::k_by_angle);
}

TEST(NastranLaminate, IsRefusedWithFileAndLine) {
  const auto refusal = [](const std::string& cards) { return refusal_of(k_cube + k_ply + cards); };
  EXPECT_THAT(refusal("PCOMP,5\n"), HasSubstr("12: PCOMP 5: there is no ply; MID1 and T1 are needed at least"));
  EXPECT_THAT(refusal("PCOMP,5\n,2\n"), HasSubstr("PCOMP 5: T1 is blank"));
  EXPECT_THAT(refusal("PCOMP,5\n,2,.1,,,2,-.1\n"), HasSubstr("PCOMP 5: T2 is -0.1, it must be positive"));
  EXPECT_THAT(refusal("PCOMP,5\n,7,.1\n"), HasSubstr("MID1 is 7, but no MAT1, MAT2 or MAT8 card has that id"));
  EXPECT_THAT(refusal("PCOMP,5,,,,,,,SMCORE\n,2,.1\n"), HasSubstr("LAM is 'SMCORE'; read are blank, SYM, MEM"));
  EXPECT_THAT(refusal("PCOMP,5,.3,,,,,,SMEAR\n,2,.1\n"), HasSubstr("Z0 is 0.3, LAM = SMEAR needs -T/2 = -0.05"));
  EXPECT_THAT(refusal("PCOMP,5\n,2,.1\nPSHELL,5,1,.1\n"), HasSubstr("id 5 is used already by PCOMP"));
  EXPECT_THAT(refusal("PCOMP,5\n,2,.1\nCQUAD4,1,5,1,2,3,4\n,,,.1\n"), HasSubstr("plies of a PCOMP have thicknesses"));
  EXPECT_THAT(refusal("PCOMP,5\n,2,.1\nCQUAD4,1,5,1,2,3,4,9\n"), HasSubstr("MCID is 9, but no CORD card has"));
  EXPECT_THAT(refusal("PSOLID,1,2\n"), HasSubstr("PSOLID 1: MID is 2, a MAT8; MAT1 or MAT9 is needed here"));
  EXPECT_THAT(refusal("PROD,1,2,.1\n"), HasSubstr("MID is 2, a MAT8; MAT1 is needed here"));
  EXPECT_THAT(refusal("MAT9,4,1.\nPSOLID,1,4,-1\n"), HasSubstr("CORDM is -1 (axes of each element)"));
  EXPECT_THAT(refusal("MAT8,3,1.\n"), HasSubstr("MAT8 3: E1 is 1 and E2 is 0, both must be positive"));
  EXPECT_THAT(refusal("MAT8,3,1.,1.,1.1\n"), HasSubstr("MAT8 3: NU12 is 1.1, with E1 / E2 = 1 it must lie within +-1"));
  EXPECT_THAT(refusal("MAT8,3,1.,1.,.1,1.,-1.\n"), HasSubstr("MAT8 3: G1Z is negative"));
  EXPECT_THAT(refusal("MAT2,3,1.,2.,,1.,,1.\n"), HasSubstr("MAT2 3: the matrix of G11, G12... has the eigenvalues -1"));
  EXPECT_THAT(refusal("MAT1,2,1.,,.3\n"), HasSubstr("id 2 is used already by MAT8"));
}

TEST(NastranSolids, MayBePyramids) {
  const FiniteElementModel model = cube_with("PSOLID,5,1\nCPYRAM,3,5,1,2,3,4,8\n");
  EXPECT_EQ(model.elements<SolidElement>().at(0).shape, SolidShape::pyramid5);
  EXPECT_EQ(model.elements<SolidElement>()[0].nodes[4], 7);
}

TEST(NastranBeams, MayBeTapered) {
  const FiniteElementModel model =
      cube_with("PBEAM,3,1,4.,3.,2.,,1.,.5\n,,,,,,,,\n,NO,.25,,2.9\n,YES,1.,2.,1.,,,.5\n,1.,2.,3.,4.\n,.9,.8\n");
  const BeamProperty& property = model.beam_properties.at(0);
  ASSERT_EQ(property.stations.size(), 2U);
  EXPECT_EQ(property.stations[0].position, 0.25);
  EXPECT_EQ(property.stations[0].area, k_no_field);
  EXPECT_EQ(field_name(model, property.stations[0].inertia_1), "PBEAM:3:I1(1)");
  EXPECT_EQ(field_name(model, property.stations[1].area), "PBEAM:3:A(B)");
  EXPECT_EQ(field_name(model, property.stations[1].inertia_2), "PBEAM:3:I2");  // blank at end B: that of end A
  EXPECT_EQ(value_of(model, "PBEAM:3:J(B)"), 0.5);
  EXPECT_EQ(property.shear_1, 0.9);
}

TEST(NastranBeams, MayHaveTaperedDimensions) {
  const FiniteElementModel model = cube_with("PBEAML,3,1,,BAR\n,.1,.2,,NO,1.,.05\n");
  const BeamProperty& property = model.beam_properties.at(0);
  ASSERT_EQ(property.stations.size(), 1U);
  EXPECT_EQ(field_name(model, property.stations[0].dimensions[0]), "PBEAML:3:DIM1(B)");
  EXPECT_EQ(field_name(model, property.stations[0].dimensions[1]), "PBEAML:3:DIM2");
}

TEST(NastranBeams, AreClosedByEndAWhereNoStationIsAtEndB) {
  const FiniteElementModel model = cube_with("PBEAM,3,1,4.,3.,2.\n,,,,,,,,\n,NO,.25,2.\n");
  ASSERT_EQ(model.beam_properties.at(0).stations.size(), 2U);
  EXPECT_EQ(field_name(model, model.beam_properties[0].stations[1].area), "PBEAM:3:A");
  EXPECT_THAT(refusal_of(k_cube + "PBEAM,3,1,4.\n,,,,,,,,\n,NO,1.5,2.\n"),
              HasSubstr("X/XB is 1.5, it must lie in (0, 1]"));
  EXPECT_THAT(refusal_of(k_cube + "PBEAM,3,1,4.\n,,,,,,,,\n,NO,.5,2.\n,NO,.5,3.\n"),
              HasSubstr("two stations have X/XB = 0.5"));
}

}  // namespace
}  // namespace mottle::formats
