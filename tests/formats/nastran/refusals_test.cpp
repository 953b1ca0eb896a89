// What a wrong deck is told: the file, the line, the card and what is wrong with it. One row a mistake.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <filesystem>
#include <fstream>
#include <string>

#include "core/temporary_folder.hpp"
#include "formats/nastran/model_of.hpp"

namespace mottle::formats {
namespace {

using ::testing::HasSubstr;
using ::testing::Not;
using ::testing::StartsWith;

struct Mistake {
  std::string cards;    ///< behind the cube, which has nine lines: the first of them is line 10
  std::string message;  ///< behind "deck.bdf:"
};

class Mistaken : public ::testing::TestWithParam<Mistake> {};

TEST_P(Mistaken, DeckIsRefusedWithFileAndLine) {
  EXPECT_THAT(test::refusal_of(test::k_cube + GetParam().cards), StartsWith("deck.bdf:" + GetParam().message));
}

INSTANTIATE_TEST_SUITE_P(
    Points, Mistaken,
    ::testing::Values(
        Mistake{"GRID,1,,9.\n", "10: GRID 1: point 1 is given already at deck.bdf:1, with other content"},
        Mistake{"SPOINT,1\n", "10: SPOINT 1: point 1 is given already at deck.bdf:1"},
        Mistake{"GRID\n", "10: GRID: ID is blank, an integer is needed"},
        Mistake{"GRID,0\n", "10: GRID 0: ID is 0, an integer from 1 is needed"},
        Mistake{"GRID,-3\n", "10: GRID -3: ID is -3, an integer from 1 is needed"},
        Mistake{"GRID,9.\n", "10: GRID 9.: ID is '9.', an integer is needed"},
        Mistake{"GRID,99999999999\n", "10: GRID 99999999999: ID is '99999999999', an integer is needed"},
        Mistake{"GRID,9,77\n", "10: GRID 9: CP is 77, but no CORD card has that id"},
        Mistake{"GRID,9,,,,,77\n", "10: GRID 9: CD is 77, but no CORD card has that id"},
        Mistake{"GRID,9,,,,,,127\n", "10: GRID 9: PS is '127', digits from 1 to 6 are allowed, each once"},
        Mistake{"GRID,9,,,,,,113\n", "10: GRID 9: PS is '113', digits from 1 to 6 are allowed, each once"},
        Mistake{"GRID    9                1.  2.\n", "10: GRID 9: X1 is '1.  2.', a number is needed"},
        Mistake{"GRDSET,,,,,,,12\nGRDSET\n", "11: GRDSET: a second GRDSET; the first one is at deck.bdf:10"},
        Mistake{"SPOINT,9,THRU,999999999\n",
                "10: SPOINT 9: 9 THRU 999999999: more than 1000000 scalar points in all ranges"},
        Mistake{"SPOINT,19,THRU,12\n", "10: SPOINT 19: ID2 is 12, it must not be below ID1 = 19"},
        Mistake{"CORD2R,5,,0.,0.,0.,0.,0.,0.\n,1.\n", "10: CORD2R 5: degenerate: the points A and B coincide"},
        Mistake{"CORD2R,5,,0.,0.,0.,0.,0.,1.\n,0.,0.,7.\n", "10: CORD2R 5: degenerate: the point C lies on the line"},
        Mistake{"CORD2R,5,6,0.,0.,0.,0.,0.,1.\n,1.\n", "10: CORD2R 5: needs coordinate system 6, but no CORD card"},
        Mistake{"CORD2R,5,6,,,,,,1.\n,1.\nCORD2R,6,5,,,,,,1.\n,1.\n",
                "12: CORD2R 6: coordinate systems 6 and 5 need each"},
        Mistake{"CORD2R,5,5,,,,,,1.\n,1.\n", "10: CORD2R 5: coordinate systems 5 and 5 need each other"},
        Mistake{"GRID,9,5\nCORD1R,5,1,2,9\n", "11: CORD1R 5: coordinate systems 5 and 5 need each other"},
        Mistake{"CORD1R,5,1,2,90\n", "10: CORD1R 5: grid point 90 has no GRID card"},
        Mistake{"CORD1R,5,1,2,3\nCORD1C,5,1,2,3\n", "11: CORD1C 5: id 5 is used already by CORD1R at deck.bdf:10"}));

INSTANTIATE_TEST_SUITE_P(
    Properties, Mistaken,
    ::testing::Values(
        Mistake{"MAT1,1,1.\n", "10: MAT1 1: id 1 is used already by MAT1 at deck.bdf:9, with other content"},
        Mistake{"MAT1,2\n", "10: MAT1 2: E and G are both blank"},
        Mistake{"MAT1,2,1.,,.6\n", "10: MAT1 2: NU is 0.6, it must lie in (-1, 0.5] unless E and G are both given"},
        Mistake{"MAT1,2,-1.,,.3\n", "10: MAT1 2: E is negative"},
        Mistake{"MAT1,2,E,,.3\n", "10: MAT1 2: E is 'E', a number is needed"},
        Mistake{"MAT3,2,1.\nCONROD,1,1,2,2,.1\nCONROD,2,1,2,2,.1\n",
                "10: MAT3 2: this material is not supported, only MAT1, MAT2, MAT8 and MAT9; CONROD 1 at deck.bdf:11 "
                "needs it, as do 1 more elements"},
        Mistake{"MAT10,2,1.\nPSOLID,7,2\nCTETRA,3,7,1,2,3,5\n",
                "10: MAT10 2: this material is not supported, only MAT1, MAT2, MAT8 and MAT9; CTETRA 3 at deck.bdf:12 "
                "(with PSOLID 7) needs it"},
        Mistake{
            "PCOMPS,1\nCQUAD4,1,1,1,2,3,4\n",
            "10: PCOMPS 1: this laminate is not supported, only PCOMP and PCOMPG; CQUAD4 1 at deck.bdf:11 needs it"},
        Mistake{"PBCOMP,1,1,.1\nCBEAM,1,1,1,2,0.,1.,0.\n",
                "10: PBCOMP 1: this property is not supported; CBEAM 1 at deck.bdf:11 needs it"},
        Mistake{"PSOLID,1,7\n", "10: PSOLID 1: MID is 7, but no MAT1 or MAT9 card has that id"},
        Mistake{"PSOLID,1,1,,,,,PFLUID\n", "10: PSOLID 1: FCTN is 'PFLUID'; only structural solids"},
        Mistake{"PSHELL,1,1,0.\n", "10: PSHELL 1: T must be positive"},
        Mistake{"PSHELL,1,1,.1,-1\n", "10: PSHELL 1: MID2 is -1 (plane strain)"},
        Mistake{"PSHELL,1,1,.1,,,1\n", "10: PSHELL 1: MID3 is given without MID2"},
        Mistake{"PSHELL,1,1,.1\n,,,1\n", "10: PSHELL 1: MID4 couples membrane and bending; it needs MID1 and MID2"},
        Mistake{"PSHEAR,1,1\n", "10: PSHEAR 1: T must be positive"},
        Mistake{"PSHEAR,1,1,.1,,-1.\n", "10: PSHEAR 1: F1 and F2 must be 0 or positive"},
        Mistake{"PGAP,1\n", "10: PGAP 1: KA must be positive"},
        Mistake{"PGAP,1,.1,5.,1.\n", "10: PGAP 1: U0 = 0.1 says that the gap is open, F0 = 5 that it is closed"},
        Mistake{"PBARL,1,1,,STAR\n,1.\n", "10: PBARL 1: TYPE 'STAR' is not known; allowed are BAR, BOX"},
        Mistake{"PBARL,1,1,,BOX\n,1.,1.,.1\n", "10: PBARL 1: DIM4 is blank; BOX has 4 dimensions"},
        Mistake{"PBARL,1,1,,TUBE\n,1.,2.\n", "10: PBARL 1: TUBE: the inner radius"},
        Mistake{"PBAR,1,1,.1\nPBARL,1,1,,ROD\n,1.\n", "11: PBARL 1: id 1 is used already by PBAR at deck.bdf:10"},
        Mistake{"PBEAM,1,1,.1\n,,,,,,,,\n,1.,1.,,,.5\n", "10: PBEAM 1: NSI is '.5'; the inertia of nonstructural mass"},
        Mistake{"PBEAM,1,1,.1\n,,,,,,,,\n,1.,1.\n,,,,,.5,,0.\n", "10: PBEAM 1: N1(A) is 0.5, N1(B) is 0; they must be"},
        Mistake{"PBUSH,1,K,RIGID\n", "10: PBUSH 1: K1 is RIGID, which is not supported"},
        Mistake{"PBUSH,1,K,1.\n,,K,2.\n", "10: PBUSH 1: K1 is given twice"},
        Mistake{"PBUSH,1,M,2.\n", "10: PBUSH 1: M is '2.'; the mass of a bush is not supported; use CONM2"},
        Mistake{"PBUSH,1,Q,2.\n", "10: PBUSH 1: 'Q' stands where K, B, GE, M or RCV must"},
        Mistake{"PELAS,1,5.,,,1,6.\n", "10: PELAS 1: id 1 is used already by PELAS at deck.bdf:10"},
        Mistake{"PMASS,1,1.,2\n,9\nPMASS,2,7.\n", "10: PMASS 1: field 9 holds '9', but the card has 8 fields"},
        Mistake{"PTUBE,1,1,.1,.2\n", "10: PTUBE 1: T must lie in [0, OD / 2]"}));

INSTANTIATE_TEST_SUITE_P(
    Elements, Mistaken,
    ::testing::Values(
        Mistake{"PSOLID,1,1\nCHEXA,1,1,1,2,3,4,5,6\n", "11: CHEXA 1: G7 is blank, an integer is needed"},
        Mistake{"PSOLID,1,1\nCHEXA,1,1,1,2,3,4,5,6\n,7,70\n", "11: CHEXA 1: G8 is 70, but no GRID or SPOINT card"},
        Mistake{"PSOLID,1,1\nCHEXA,1,1,1,2,3,4,5,6\n,7,7\n", "11: CHEXA 1: G7 and G8 are both grid point 7"},
        Mistake{"PSOLID,1,1\nCHEXA,1,1,1,2,3,4,5,6\n,7,8,9\n",
                "11: CHEXA 1: G9 is 9, but no GRID or SPOINT card has that id"},
        Mistake{"PSOLID,1,1\nCHEXA,1,1,1,2,3,4,5,6\n,7,8,1\n", "11: CHEXA 1: G1 and G9 are both grid point 1"},
        Mistake{"PSOLID,1,1\nSPOINT,9\nCTETRA,1,1,1,2,3,9\n", "12: CTETRA 1: G4 is 9, a scalar point; a grid point"},
        Mistake{"CPENTA,1,1,1,2,3,4,5,6\n", "10: CPENTA 1: property 1 has no PSOLID card"},
        Mistake{"PSHELL,1,1\nCQUAD4,1,1,1,2,3,4\n", "11: CQUAD4 1: neither T1... nor its PSHELL's T is given"},
        Mistake{"PSHELL,1,1,.1\nCTRIA3,1,1,1,2,3\n,,,-1.\n",
                "11: CTRIA3 1: the thickness at corner 1 is -1, it must not"},
        Mistake{"PSHELL,1,1,.1\nCTRIA3,1,1,1,2,3\n,,,0.,0.,0.\n", "11: CTRIA3 1: the thickness is 0 at all corners"},
        Mistake{"PSHELL,1,1,.1\nCTRIA3,1,1,1,2,3\nCTRIA3,1,1,1,2,4\n", "12: CTRIA3 1: id 1 is used already by CTRIA3"},
        Mistake{"CQUADX,1,1,1\n", "10: CQUADX 1: this card changes the model and is not supported; read are GRID"},
        Mistake{"CWELD,1\n", "10: CWELD 1: this card changes the model and is not supported"},
        Mistake{"PSHELL,1,1,.1\nCQUAD8,1,1,1,2,3,4,1\n", "11: CQUAD8 1: G1 and G5 are both grid point 1"},
        Mistake{"PSHELL,1,1,.1\nCTRIA6,1,1,1,2,3,4,1\n", "11: CTRIA6 1: G1 and G5 are both grid point 1"},
        Mistake{"CSHEAR,1,,1,2,3,4\n", "10: CSHEAR 1: property 1 has no PSHEAR card"},
        Mistake{"GRID,9\nPGAP,1,,,1.\nCGAP,1,1,1,9\n", "12: CGAP 1: GA and GB lie at the same place"},
        Mistake{"PGAP,1,,,1.,,5.\nCGAP,1,1,1,2\n", "11: CGAP 1: the gap is closed with KT (or MU1) across a distance"},
        Mistake{"PVISC,1,1.\nCVISC,1,1,1,1\n", "11: CVISC 1: G1 and G2 are the same grid point"},
        Mistake{"PROD,1,1,.1\nCROD,1,1,1,1\n", "11: CROD 1: G1 and G2 are both grid point 1"},
        Mistake{"GRID,9\nPROD,1,1,.1\nCROD,1,1,1,9\n", "12: CROD 1: G1 and G2 lie at the same place"},
        Mistake{"PBAR,1,1,.1\nCBAR,1,1,1,2\n", "11: CBAR 1: X1, X2, X3 (or G0) are blank"},
        Mistake{"PBAR,1,1,.1\nCBAR,1,1,1,2,1.,0.,0.\n", "11: CBAR 1: the orientation vector is zero or parallel"},
        Mistake{"PBAR,1,1,.1\nCBAR,1,1,1,2,0.,1.,0.,EGG\n", "11: CBAR 1: OFFT is 'EGG'; allowed are GGG, BGG"},
        Mistake{"PBAR,1,1,.1\nCBAR,1,1,1,2,0.,1.,0.\n,17\n", "11: CBAR 1: PA is '17', digits from 1 to 6"},
        Mistake{"PBAR,1,1,.1\nCBAR,1,1,1,2,90\n", "11: CBAR 1: G0 is 90, but no GRID or SPOINT card has that id"},
        Mistake{"PBAR,1,1,.1\nCBEAM,1,1,1,2,3\n", "11: CBEAM 1: property 1 has no PBEAM or PBEAML card"},
        Mistake{"PBUSH,1,K,1.\nCBUSH,1,1,1\n",
                "11: CBUSH 1: GA and GB lie at the same place (closer than .0001), or GB"},
        Mistake{"PBUSH,1,K,1.,1.\nCBUSH,1,1,1,2\n", "11: CBUSH 1: G0, X1.. and CID are blank"},
        Mistake{"CELAS2,1,5.,1,12\n", "10: CELAS2 1: C1 names several components, one is needed"},
        Mistake{"CELAS2,1,5.,1,7\n", "10: CELAS2 1: C1 is '7', digits from 1 to 6"},
        Mistake{"CELAS2,1,5.\n", "10: CELAS2 1: both ends are grounded; one must be a point"},
        Mistake{"CELAS2,1,5.,1,2,1,2\n", "10: CELAS2 1: both ends are the same degree of freedom"},
        Mistake{"CELAS2,1,5.,1\n", "10: CELAS2 1: C1 is blank, a component from 1 to 6 is needed"},
        Mistake{"CELAS1,1,5,1,1\n", "10: CELAS1 1: property 5 has no PELAS card"},
        Mistake{"CMASS1,1,5.,1,1\n", "10: CMASS1 1: PID is '5.', an integer is needed"},
        Mistake{"CONM2,1,70,,1.\n", "10: CONM2 1: G is 70, but no GRID or SPOINT card has that id"},
        Mistake{"CONM2,7,1,,1.\n,-1.,,2.,,,3.\n", "10: CONM2 7: its inertia I11 I21 I22 I31 I32 I33 is not positive"},
        Mistake{"CONM2,7,1,,1.\n,1.,3.,2.,,,3.\n", "10: CONM2 7: its inertia I11 I21 I22 I31 I32 I33 is not positive"},
        // I = 1 - 0.9 (1 1' - 1): every two axes are sound, the direction (1, 1, 1) is not.
        Mistake{"CONM2,7,1,,1.\n,1.,.9,1.,.9,.9,1.\n", "10: CONM2 7: its inertia I11 I21 I22 I31 I32 I33 is not"},
        Mistake{"CONM2,1,1,7,1.\n", "10: CONM2 1: CID is 7, but no CORD card has that id"},
        Mistake{"RBE2,1,1,123\n", "10: RBE2 1: GM1 is blank, dependent grid points are needed"},
        Mistake{"RBE2,1,1,,2\n", "10: RBE2 1: CM is blank, digits from 1 to 6 are needed"},
        Mistake{"RBE2,1,1,123,2,1\n", "10: RBE2 1: GN stands among the dependent grid points"},
        Mistake{"RBE2,1,1,123,2,3,2\n", "10: RBE2 1: grid point 2 is given twice among GM"},
        Mistake{"RBAR,1,1,2,123,45\n", "10: RBAR 1: CNA and CNB name 5 components, together they must name 6"},
        Mistake{"RBE3,1,,8,123\n", "10: RBE3 1: WT1, C1 and G1,1 are needed"},
        Mistake{"RBE3,1,,8,123,1.,123\n", "10: RBE3 1: no grid point follows the weight 1"},
        Mistake{"RBE3,1,,8,123,1.,123,8\n", "10: RBE3 1: REFGRID stands among the grid points that it follows"},
        Mistake{"RBE1,1\n", "10: RBE1 1: this card changes the model and is not supported"},
        Mistake{"GENEL,1\n", "10: GENEL 1: UI1 and CI1 are blank, a degree of freedom is needed"},
        Mistake{"GENEL,1,,1,1\n", "10: GENEL 1: one of the matrices K and Z is needed"},
        Mistake{"GENEL,1,,1,1,2,1\n,K,1.,2.\n", "10: GENEL 1: K holds 2 numbers, but 3 are needed for 2 degrees"},
        Mistake{"GENEL,1,,1,1,1,1\n,K,1.\n", "10: GENEL 1: point 1 stands twice with component 1"},
        Mistake{"GENEL,1,,1,12\n,K,1.\n", "10: GENEL 1: CI is '12' for point 1; one component from 1 to 6 is needed"},
        Mistake{"GENEL,1,,1,1\n,K,1.\n,K,1.\n", "10: GENEL 1: K stands twice"},
        Mistake{"GENEL,1,,1,1\n,M,1.\n", "10: GENEL 1: 'M' stands where UD, K, Z, S or a number must"},
        Mistake{"GENEL,1,,1,1\n,Z,-1.\n", "10: GENEL 1: the flexibility Z is not positive definite"},
        Mistake{"GENEL,1,,1,1\n,K,1.\n,S,1.\n", "10: GENEL 1: S is given without UD"},
        Mistake{"GENEL,1,,1,1\n,UD,,2,1\n,K,1.\n", "10: GENEL 1: UD holds 1 degrees of freedom; without the matrix S"},
        Mistake{"SPOINT,9\nGENEL,1,,9,0\n,UD,,2,1,2,2,2,3\n,2,4,2,5,2,6\n,K,1.\n",
                "11: GENEL 1: point 9 is a scalar point; the matrix S is needed"}));

INSTANTIATE_TEST_SUITE_P(
    Settings, Mistaken,
    ::testing::Values(Mistake{"SPC1,1,,1\n", "10: SPC1 1: C is blank, but 1 is a grid point"},
                      Mistake{"SPC1,1,1,90\n", "10: SPC1 1: G is 90, but no GRID or SPOINT card has that id"},
                      Mistake{"SPC1,1,1,5,THRU,2\n", "10: SPC1 1: 5 THRU 2: the range runs backwards"},
                      Mistake{"SPC1,1,1,50,THRU,60\n", "10: SPC1 1: 50 THRU 60: no point in that range exists"},
                      Mistake{"SPC1,1,1,1,THRU\n", "10: SPC1 1: the end of a THRU range is blank"},
                      Mistake{"SPCADD,1,2,3\nSPC1,2,1,1\n",
                              "10: SPCADD 1: adds up set 3, but no SPC, SPC1 or SPCADD card"},
                      Mistake{"MPC,1,1,1,0.,2,1,1.\n", "10: MPC 1: A1, the coefficient of the dependent term, is zero"},
                      Mistake{"MPC,1,1,12,1.\n", "10: MPC 1: C is '12' for point 1; one component is needed"},
                      Mistake{"PARAM,K6ROT,X\n", "10: PARAM K6ROT: 'X' stands where a number is needed"},
                      Mistake{"PARAM,AUTOSPC,MAYBE\n", "10: PARAM AUTOSPC: 'MAYBE' stands where YES or NO is needed"},
                      Mistake{"PARAM,WTMASS,0.\n", "10: PARAM WTMASS: a positive number is needed"},
                      Mistake{"EIGRL,1,,,-4\n", "10: EIGRL 1: ND is -4, a number of modes from 1 is needed"}));

TEST(NastranRefusal, NamesTheCommandOfTheCaseControlSection) {
  const std::string bulk = "BEGIN BULK\nGRID,1\n";
  EXPECT_EQ(test::refusal_of("CEND\nSPC = 7\n" + bulk), "deck.bdf:2: SPC = 7: no SPC, SPC1 or SPCADD card has that id");
  EXPECT_EQ(test::refusal_of("CEND\n\nSPC = X\n" + bulk), "deck.bdf:3: SPC = 'X': the id of a set is needed");
  EXPECT_EQ(test::refusal_of("CEND\nMPC = 7\n" + bulk), "deck.bdf:2: MPC = 7: no MPC or MPCADD card has that id");
  EXPECT_EQ(test::refusal_of("CEND\nMETHOD = 7\n" + bulk),
            "deck.bdf:2: METHOD = '7': no EIGRL or EIGR card has that id");
  EXPECT_THAT(test::refusal_of("CEND\nK2GG = KX\n" + bulk), StartsWith("deck.bdf:2: K2GG = KX: matrices and masses"));
  EXPECT_THAT(test::model_of("CEND\nK2GG = KX\n" + bulk, {.ignore_cards = {"K2GG"}}).notes,
              ::testing::ElementsAre("K2GG = KX was left out, as model.ignore_cards asks"));
}

TEST(NastranRefusal, RefusesModesAboutAPreload) {
  const std::string bulk = "BEGIN BULK\nGRID,1\n";
  const std::string deck = "CEND\nSUBCASE 1\nLOAD=3\nSUBCASE 2\nMETHOD=1\nSTATSUB = 1\n" + bulk + "EIGRL,1,,,1\n";
  EXPECT_THAT(test::refusal_of(deck), StartsWith("deck.bdf:6: STATSUB = 1: modes of a preloaded structure"));
  EXPECT_NO_THROW(test::model_of(deck, {.ignore_cards = {"STATSUB"}}));
  EXPECT_THAT(test::message_of<InvalidInput>([&] { test::model_of("SOL 13\nCEND\n" + bulk); }),
              StartsWith("deck.bdf: SOL 13: modes of a preloaded structure"));
}

TEST(NastranRefusal, RefusesSuperelements) {
  for (const std::string card : {"SESET", "SECONCT", "SEQSET1", "CSUPER", "RELEASE"}) {
    EXPECT_EQ(test::refusal_of(test::k_cube + "CWELD,1\n" + card + ",3,4\n"),
              "deck.bdf:11: " + card + " 3: superelements are not supported; write the whole structure as one model");
  }
  EXPECT_THAT(
      test::model_of("GRID,1,,,,,,,3\n").notes,
      ::testing::ElementsAre("1 grid points belong to superelements (SEID), which are not formed: the structure "
                             "is solved as one"));
}

// A thin rod has no inertia about its axis, whatever its direction: here (1, 1, 1), written with seven digits.
TEST(NastranRefusal, IsNotOfAnInertiaThatIsZeroAboutOneAxis) {
  const std::string rod = "CONM2,7,1,,1.\n,.6666667,.3333333,.6666667,.3333333,.3333333,.6666667\n";
  EXPECT_EQ(test::model_of(test::k_cube + rod).model.elements<PointMassElement>().size(), 1U);
}

TEST(NastranRefusal, RefusesADeckWithoutPoints) {
  EXPECT_EQ(test::refusal_of("MAT1,1,1.\n"), "deck.bdf: holds no GRID card; a model needs grid points");
}

TEST(NastranRefusal, NamesTheIncludedFile) {
  const auto resolve = [](const std::string&, const std::string&) { return IncludedFile{"part.dat", "\nGRID,x\n"}; };
  const NastranDeck deck = parse_nastran_deck("INCLUDE part.dat\n", "deck.bdf", resolve);
  EXPECT_EQ(test::message_of<FormatError>([&] { build_nastran_model(deck); }),
            "part.dat:2: GRID X: ID is 'X', an integer is needed");
}

// Ranges that name millions of points again and again end in a refusal, not in hours of work.
TEST(NastranRefusal, RefusesRangesWithoutEnd) {
  std::string deck = "SPOINT,1,THRU,1000000\n";
  for (int i = 0; i < 1000; ++i) deck += "SPC1,1,,1,THRU,1000000\n";
  EXPECT_THAT(test::refusal_of(deck), HasSubstr("THRU ranges name more than"));
}

class NastranFiles : public ::testing::Test {
 protected:
  void SetUp() override { std::filesystem::create_directories(folder_ / "parts" / "deep"); }

  void write(const std::string& name, const std::string& text) const { std::ofstream(folder_ / name) << text; }

  const test::TemporaryFolder folder_;
};

TEST_F(NastranFiles, AreFoundBesideTheIncludingFileThenTheMainOne) {
  write("main.bdf", "INCLUDE 'parts/a.dat'\n");
  write("parts/a.dat", "INCLUDE 'deep/b.dat'\nINCLUDE 'beside_main.dat'\n");
  write("parts/deep/b.dat", "GRID,1\n");
  write("beside_main.dat", "GRID,2\n");
  EXPECT_EQ(read_nastran_model(folder_ / "main.bdf").model.nodes.size(), 2U);
}

TEST_F(NastranFiles, AreFoundUnderTheNamesOfWindows) {
  write("main.bdf", "INCLUDE 'PARTS\\..\\parts\\A.DAT'\nINCLUDE 'parts\\A.DAT'\n");
  write("parts/a.dat", "GRID,1\n");
  std::filesystem::create_directories(folder_ / "PARTS");
  EXPECT_EQ(read_nastran_model(folder_ / "main.bdf").model.nodes.size(), 1U);
}

TEST_F(NastranFiles, ThatIncludeThemselvesAreRefused) {
  write("main.bdf", "INCLUDE 'parts/../main.bdf'\n");
  EXPECT_THAT(test::message_of<FormatError>([&] { read_nastran_model(folder_ / "main.bdf"); }),
              HasSubstr("main.bdf:1: INCLUDE 'parts/../main.bdf': that file is being read already"));
}

TEST_F(NastranFiles, ThatDoNotExistAreRefused) {
  write("main.bdf", "\nINCLUDE 'parts/a.dat'\n");
  write("parts/a.dat", "\n\nINCLUDE 'deep\\b.dat'\n");
  const std::string folder = folder_.path().string();
  EXPECT_EQ(test::message_of<FormatError>([&] { read_nastran_model(folder_ / "main.bdf"); }),
            folder + "/parts/a.dat:3: INCLUDE 'deep\\b.dat': there is no such file; looked for " + folder +
                "/parts/deep/b.dat and " + folder + "/deep/b.dat");
  EXPECT_THAT(test::message_of<InvalidInput>([&] { read_nastran_model(folder_ / "none.bdf"); }),
              HasSubstr("no such file"));
}

}  // namespace
}  // namespace mottle::formats
