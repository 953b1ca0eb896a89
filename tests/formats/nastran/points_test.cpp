// Points, coordinate systems, numbers, settings and constraints of decks; expectations by hand.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <numbers>
#include <string>
#include <utility>
#include <vector>

#include "formats/nastran/model_of.hpp"

namespace mottle::formats {
namespace {

using test::k_cube;
using test::model_of;
using test::node;
using ::testing::ElementsAre;
using ::testing::HasSubstr;
using ::testing::IsEmpty;

constexpr double k_rounding = 1e-14;  // a few operations on numbers around 1

Eigen::Vector3d position_of(const std::string& deck, int id) {
  return node(model_of(deck).model, id).position;
}

TEST(NastranComponents, MayHaveBlanksBetweenThem) {
  const std::string cards =
      "GRID    9               1.0     2.0     3.0             12 4 6\nSPC1    1       3 5     9\n"
      "RBE2    1       1       1 2 3   2\n";
  const FiniteElementModel model = model_of(k_cube + cards).model;
  EXPECT_THAT(model.fixed, ElementsAre(std::pair<int, Components>(8, 0x3f)));
  EXPECT_EQ(model.rigid_bodies.at(0).components, 0x07);
}

TEST(NastranNumber, IsReadInEveryForm) {
  const std::vector<std::pair<std::string, double>> forms = {
      {"1.5", 1.5},  {".5", 0.5},        {"5.", 5.0},      {"-.5", -0.5},   {"+1.5", 1.5},
      {"1.+7", 1e7}, {"1.3000+2", 130.}, {"7.D-3", 7e-3},  {"7.d-3", 7e-3}, {"-1.600-2", -0.016},
      {"1E5", 1e5},  {"1.e+5", 1e5},     {"1.E-05", 1e-5}, {"70.-1", 7.0},  {"2.84441-19", 2.84441e-19},
      {"0", 0.0},    {"0.", 0.0},        {"-0.", 0.0},     {"1.-400", 0.0}, {"+.5+1", 5.0}};
  for (const auto& [text, value] : forms) {
    EXPECT_EQ(position_of("GRID,1,," + text, 1).x(), value) << text;
  }
}

TEST(NastranNumber, IsReadFromAnIntegerWithANote) {
  const NastranModel read = model_of("GRID,1,,1,2,0\n");
  EXPECT_EQ(node(read.model, 1).position, Eigen::Vector3d(1, 2, 0));
  EXPECT_THAT(read.notes, ElementsAre(HasSubstr("2 integers were read where a real number")));
}

TEST(NastranNumber, IsRefusedInOtherForms) {
  for (const std::string text :
       {"1.5.", "1+7", "1. 5", "E5", ".", "-", "1.5X", "NAN", "INF", "0X1", "1.+400", "1.E", "1.+", "--1.", "1.E5."}) {
    EXPECT_THAT(test::refusal_of("GRID,1,," + text), HasSubstr("deck.bdf:1: GRID 1: X1 is '" + text + "'")) << text;
  }
}

TEST(NastranPoints, AreSortedById) {
  const NastranModel read = model_of("GRID,30,,1.\nSPOINT,20\nGRID,10\n");
  ASSERT_EQ(read.model.nodes.size(), 3U);
  EXPECT_EQ(read.model.nodes[0].id, 10);
  EXPECT_EQ(read.model.nodes[1].id, 20);
  EXPECT_TRUE(read.model.nodes[1].is_scalar);
  EXPECT_EQ(read.model.nodes[2].position.x(), 1.0);
}

TEST(NastranPoints, TakeWhatIsBlankFromGrdset) {
  const FiniteElementModel model =
      model_of("GRDSET,,7,,,,7,345\nCORD2R,7,,1.,0.,0.,1.,0.,1.\n,2.,0.,0.\nGRID,1,,1.\nGRID,2,0,1.,,,0,6\n").model;
  EXPECT_EQ(node(model, 1).position.x(), 2.0);
  EXPECT_EQ(node(model, 1).displacement_system, 0);
  EXPECT_EQ(node(model, 2).position.x(), 1.0);
  EXPECT_EQ(node(model, 2).displacement_system, -1);
  EXPECT_THAT(model.fixed, ElementsAre(std::pair<int, Components>(0, 0x1c), std::pair<int, Components>(1, 0x20)));
}

TEST(NastranPoints, AreReadFromRanges) {
  const FiniteElementModel model = model_of("SPOINT,5,THRU,8\nSPOINT,1,3\n").model;
  std::vector<int> ids;
  for (const Node& point : model.nodes) ids.push_back(point.id);
  EXPECT_THAT(ids, ElementsAre(1, 3, 5, 6, 7, 8));
}

TEST(NastranPoints, FollowFromScalarElements) {
  const FiniteElementModel model = model_of("GRID,1\nCELAS4,1,100.,7,9\nCMASS2,2,1.,9\nCELAS2,3,1.,1,1,8,0\n").model;
  ASSERT_EQ(model.nodes.size(), 4U);
  EXPECT_TRUE(node(model, 7).is_scalar);
  EXPECT_TRUE(node(model, 8).is_scalar);
  EXPECT_FALSE(node(model, 1).is_scalar);
}

TEST(NastranPoints, AreReadOnceWhereTheyRepeat) {
  const NastranModel read = model_of("GRID,1,,1.\nGRID,1,,1.0\n");
  EXPECT_EQ(read.model.nodes.size(), 1U);
  EXPECT_THAT(read.notes, ElementsAre("1 points stand twice with equal content; read once"));
}

// x axis of the system along basic y, y along basic z, z along basic x; origin (1, 2, 3).
const std::string k_turned = ",,1.,2.,3.,2.,2.,3.\n,1.,5.,3.\n";

TEST(NastranCoordinates, FollowARectangularSystem) {
  const FiniteElementModel model = model_of("GRID,1,5,10.,20.,30.\nCORD2R,5" + k_turned).model;
  EXPECT_EQ(node(model, 1).position, Eigen::Vector3d(31, 12, 23));
  Eigen::Matrix3d axes;
  axes << 0, 0, 1, 1, 0, 0, 0, 1, 0;
  EXPECT_EQ(model.coordinate_systems.at(0).axes, axes);
  EXPECT_EQ(model.coordinate_systems[0].id, 5);
}

TEST(NastranCoordinates, FollowACylindricalSystem) {
  // radius 2 at 90 degrees is local y = basic z
  EXPECT_LT((position_of("GRID,1,5,2.,90.,30.\nCORD2C,5" + k_turned, 1) - Eigen::Vector3d(31, 2, 5)).norm(),
            10 * k_rounding);
}

TEST(NastranCoordinates, FollowASphericalSystem) {
  // radius 2, 90 degrees off the z axis, 90 degrees around it: local y again
  EXPECT_LT((position_of("GRID,1,5,2.,90.,90.\nCORD2S,5" + k_turned, 1) - Eigen::Vector3d(1, 2, 5)).norm(),
            10 * k_rounding);
}

TEST(NastranCoordinates, MayBeNestedInAnyOrder) {
  // 9 is 8 moved by (0, 0, 1) in cylindrical 8; 8 is basic moved by (0, 0, 10).
  const std::string deck =
      "GRID,1,9,0.,0.,100.\nCORD2R,9,8,0.,0.,1.,0.,0.,2.\n,1.,0.,1.\nCORD2C,8,,0.,0.,10.,0.,0.,11.\n,1.,0.,10.\n";
  EXPECT_LT((position_of(deck, 1) - Eigen::Vector3d(0, 0, 111)).norm(), 1000 * k_rounding);
}

TEST(NastranCoordinates, MayBeGivenByGridPoints) {
  const std::string deck =
      "CORD1R,5,1,2,3,6,2,1,3\nGRID,1\nGRID,2,,1.\nGRID,3,,0.,1.\nGRID,4,5,0.,0.,7.\nGRID,5,6,0.,0.,7.\n";
  EXPECT_EQ(position_of(deck, 4), Eigen::Vector3d(7, 0, 0));
  EXPECT_EQ(position_of(deck, 5), Eigen::Vector3d(-6, 0, 0));
}

TEST(NastranCoordinates, ByGridPointsInAnotherSystem) {
  const std::string deck =
      "CORD1R,6,1,2,3\nGRID,1,5\nGRID,2,5,0.,0.,1.\nGRID,3,5,1.\nGRID,4,6,10.,20.,30.\nCORD2R,5" + k_turned;
  EXPECT_EQ(position_of(deck, 4), Eigen::Vector3d(31, 12, 23));
}

TEST(NastranCoordinates, DoNotExhaustTheStackInALongChain) {
  std::string deck = "GRID,1,100000\n";
  for (int id = 100000; id > 0; --id) {
    deck += "CORD2R," + std::to_string(id) + ',' + std::to_string(id - 1) + ",0.,0.,1.,0.,0.,2.\n,1.,0.,1.\n";
  }
  EXPECT_EQ(position_of(deck, 1).z(), 100000.0);
}

using Fixed = std::vector<std::pair<int, Components>>;

Fixed fixed_by(const std::string& control, const std::string& cards) {
  return model_of(control + "GRID,1\nGRID,2\nGRID,3\nSPOINT,9\n" + cards).model.fixed;
}

const std::string k_case = "SOL 103\nCEND\nSPC = 2\nBEGIN BULK\n";

TEST(NastranConstraints, AreThoseOfTheSelectedSet) {
  EXPECT_EQ(fixed_by(k_case, "SPC,2,1,12,0.,3,6\nSPC1,2,3,2\nSPC1,1,123456,1\n"),
            (Fixed{{0, 0x03}, {1, 0x04}, {2, 0x20}}));
}

TEST(NastranConstraints, AreAddedUp) {
  EXPECT_EQ(fixed_by(k_case, "SPCADD,2,5,6\nSPC1,5,1,1\nSPC1,6,2,1,2\nSPC1,7,3,3\n"), (Fixed{{0, 0x03}, {1, 0x02}}));
}

TEST(NastranConstraints, MayNameRangesWithGaps) {
  EXPECT_EQ(fixed_by(k_case, "SPC1,2,123,2,THRU,8\n"), (Fixed{{1, 0x07}, {2, 0x07}}));
  EXPECT_EQ(fixed_by(k_case, "SPC1,2,,9\n"), (Fixed{{3, 0x01}}));
}

TEST(NastranConstraints, HoldWithoutCaseControlWhereThereIsOneSet) {
  const NastranModel read = model_of("GRID,1\nSPCADD,2,1\nSPC1,1,123,1\n");
  EXPECT_THAT(read.model.fixed, ElementsAre(std::pair<int, Components>(0, 0x07)));
  EXPECT_THAT(read.notes, ElementsAre("no case control section: the only SPC set, 2, was taken"));
}

TEST(NastranConstraints, NeedCaseControlWhereThereAreSeveralSets) {
  EXPECT_THAT(test::refusal_of("GRID,1\nSPC1,2,123,1\nSPC1,1,123,1\n"),
              HasSubstr("deck.bdf: holds 2 SPC sets and no case control section"));
}

TEST(NastranConstraints, ThatNobodySelectsHoldNothing) {
  const NastranModel read = model_of("CEND\nMETHOD = 1\nBEGIN BULK\nEIGRL,1,,,3\nGRID,1\nSPC1,1,123,1\n");
  EXPECT_THAT(read.model.fixed, IsEmpty());
  EXPECT_THAT(read.notes, ElementsAre(HasSubstr("selects no SPC set")));
}

TEST(NastranConstraints, FollowTheSubcase) {
  const std::string deck = "CEND\nSUBCASE 1\nSPC=1\nSUBCASE 7\nSPC=2\nBEGIN BULK\nGRID,1\nSPC1,1,1,1\nSPC1,2,2,1\n";
  EXPECT_EQ(model_of(deck).model.fixed, (Fixed{{0, 0x01}}));
  EXPECT_THAT(model_of(deck).notes, ElementsAre("the deck has 2 subcases; 1 was taken (SPC 1)"));
  EXPECT_EQ(model_of(deck, {.subcase = 7}).model.fixed, (Fixed{{0, 0x02}}));
  // A preload in front: the subcase with a METHOD of its own is that of the modes.
  const std::string bulk = "BEGIN BULK\nGRID,1\nSPC1,1,1,1\nSPC1,2,2,1\nEIGRL,5,,,3\nEIGRL,6,,,9\n";
  for (const std::string asks : {"METHOD=6\n", "ANALYSIS=MODES\nMETHOD(FLUID)=5\nMETHOD(STRUCTURE)=6\n"}) {
    const NastranModel read = model_of("CEND\nSUBCASE 1\nSPC=1\nLOAD=1\nSUBCASE 7\nSPC=2\n" + asks + bulk);
    EXPECT_EQ(read.model.fixed, (Fixed{{0, 0x02}}));
    EXPECT_EQ(read.model.settings.modes, 9);
    EXPECT_THAT(read.notes, ElementsAre("the deck has 2 subcases; 7 was taken (SPC 2, METHOD 6)"));
  }
  EXPECT_EQ(test::message_of<InvalidInput>([&] { model_of(deck, {.subcase = 3}); }),
            "deck.bdf: there is no subcase 3; the deck has 1, 7");
}

TEST(NastranConstraints, HaveNoDisplacementOfTheirOwn) {
  EXPECT_THAT(model_of(k_case + "GRID,1\nSPC,2,1,1,.5\n").notes,
              ElementsAre(HasSubstr("1 SPC displacements other than")));
}

TEST(NastranEquations, AreReadOverSeveralLines) {
  const auto equations =
      model_of(
          "CEND\nMPC=3\nBEGIN "
          "BULK\nGRID,1\nGRID,2\nGRID,3\nSPOINT,9\nMPC,3,1,1,1.,2,2,-.5\n,,3,6,2.,9,0,4.\nMPC,4,1,1,1.\n")
          .model.multipoint_equations;
  ASSERT_EQ(equations.size(), 1U);
  ASSERT_EQ(equations[0].terms.size(), 4U);
  EXPECT_EQ(equations[0].terms[1].node, 1);
  EXPECT_EQ(equations[0].terms[1].component, 1);
  EXPECT_EQ(equations[0].terms[1].coefficient, -0.5);
  EXPECT_EQ(equations[0].terms[2].component, 5);
  EXPECT_EQ(equations[0].terms[3].node, 3);
  EXPECT_EQ(equations[0].terms[3].coefficient, 4.0);
}

TEST(NastranEquations, AreAddedUp) {
  EXPECT_EQ(model_of("CEND\nMPC=3\nBEGIN BULK\nGRID,1\nMPCADD,3,4,5\nMPC,4,1,1,1.\nMPC,5,1,2,1.\nMPC,6,1,3,1.\n")
                .model.multipoint_equations.size(),
            2U);
}

TEST(NastranSettings, HaveNastransDefaults) {
  const AnalysisSettings settings = model_of("GRID,1\n").model.settings;
  EXPECT_EQ(settings.automatic_constraints, AutomaticConstraints::soft);
  EXPECT_FALSE(settings.coupled_mass);
  EXPECT_EQ(settings.reference_node, -1);
  EXPECT_EQ(settings.modes, 0);
}

TEST(NastranSettings, AreReadFromParameters) {
  const AnalysisSettings settings =
      model_of(
          "GRID,1\nGRID,8\nPARAM,AUTOSPC,NO\nPARAM,COUPMASS,1\nPARAM,WTMASS,.00259\nPARAM,K6ROT,10.\nPARAM,GRDPNT,8\n"
          "PARAM,POST,-1\n")
          .model.settings;
  EXPECT_EQ(settings.automatic_constraints, AutomaticConstraints::null);
  EXPECT_TRUE(settings.coupled_mass);
  EXPECT_EQ(settings.mass_factor, 0.00259);
  EXPECT_EQ(settings.drilling, 10.0);
  EXPECT_EQ(settings.reference_node, 1);
}

TEST(NastranSettings, TakeTheCaseControlSectionFirst) {
  const std::string deck =
      "CEND\nPARAM,COUPMASS,-1\nSUBCASE 1\nPARAM,K6ROT,5.\nSUBCASE 2\nPARAM,K6ROT,6.\nBEGIN BULK\n"
      "PARAM,COUPMASS,1\nGRID,1\n";
  EXPECT_FALSE(model_of(deck).model.settings.coupled_mass);
  EXPECT_EQ(model_of(deck).model.settings.drilling, 5.0);
  EXPECT_EQ(model_of(deck, {.subcase = 2}).model.settings.drilling, 6.0);
}

TEST(NastranSettings, TakeTheSelectedMethod) {
  const AnalysisSettings settings =
      model_of("CEND\nMETHOD=2\nBEGIN BULK\nGRID,1\nEIGRL,1,,,9\nEIGRL,2,.5,200.,12\n").model.settings;
  EXPECT_EQ(settings.modes, 12);
  EXPECT_EQ(settings.lowest_frequency, 0.5);
  EXPECT_EQ(settings.highest_frequency, 200.0);
  EXPECT_EQ(model_of("GRID,1\nEIGR,4,LAN,1.,50.,,8\n,MASS\n").model.settings.modes, 8);
}

}  // namespace
}  // namespace mottle::formats
