// What becomes of cards that are counted, skipped, noted or repeated.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <string>
#include <utility>

#include "formats/nastran/model_of.hpp"

namespace mottle::formats {
namespace {

using test::k_cube;
using test::model_of;
using test::refusal_of;
using ::testing::ElementsAre;
using ::testing::HasSubstr;
using ::testing::IsEmpty;

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

TEST(NastranModel, NotesUnknownCards) {
  EXPECT_THAT(model_of(k_cube + "SUPORT,1,1\nXYZZY,1\nXYZZY,2\n").notes,
              ElementsAre("2 XYZZY cards are not known here and were ignored, the first one at deck.bdf:11"));
}

TEST(NastranModel, NotesThatDesignVariablesAreNotEvaluated) {
  const std::string deck =
      k_cube + "DESVAR,1,X,1.\nDVPREL1,1,PSHELL,1,T\n,1,1.\n" +
      "DEQATN  1       F(A,B) = A + B**2 ;\n+       C = SIN(A), + D\n        E = F,\nCONM2,1,1,,1.\n";
  const NastranModel read = model_of(deck);
  EXPECT_THAT(read.notes, ElementsAre(HasSubstr("1 DVPREL1 cards: design variables and equations")));
  EXPECT_EQ(read.model.elements<PointMassElement>().size(), 1U) << "the card behind the equation";
}

TEST(NastranModel, ReadsTheAnalysisSet) {
  const NastranModel read = model_of(k_cube + "ASET,1,12 3,3,1\nASET1,456,2,THRU,4\nSUPORT,5,6\nOMIT1,3,8\n");
  using Pair = std::pair<int, Components>;
  EXPECT_THAT(read.model.analysis_set,
              ElementsAre(Pair{0, 7}, Pair{2, 1}, Pair{1, 56}, Pair{2, 56}, Pair{3, 56}, Pair{4, 32}));
  EXPECT_THAT(read.model.omitted_set, ElementsAre(Pair{7, 4}));
  EXPECT_THAT(read.notes, ElementsAre(HasSubstr("static (Guyan) reduction, as in Nastran")));
}

TEST(NastranModel, ReducesToNoComponentModes) {
  const NastranModel read = model_of(k_cube + "ASET1,123,1\nQSET1,0,9\nSPOINT,9\n");
  EXPECT_THAT(read.model.analysis_set, IsEmpty());
  EXPECT_THAT(read.notes, ElementsAre(HasSubstr("no reduction is made")));
}

TEST(NastranModel, RefusesAnAnalysisSetOfPointsThatAreNone) {
  EXPECT_THAT(refusal_of(k_cube + "ASET1,123,99\n"), HasSubstr("ASET1 123: G is 99, but no GRID"));
  EXPECT_THAT(refusal_of(k_cube + "OMIT,1\n"), HasSubstr("C is blank, but 1 is a grid point"));
}

TEST(NastranModel, LeavesOutWhatItIsTold) {
  const NastranModel read =
      model_of(k_cube + "CQUAD8,1,1\nCQUAD8,2,1\nCONM2,1,1,,1.\n", {.ignore_cards = {"CQUAD8", "CONM2"}});
  EXPECT_THAT(read.model.elements<PointMassElement>(), IsEmpty());
  EXPECT_THAT(read.notes, ElementsAre("1 CONM2 cards were left out, as model.ignore_cards asks",
                                      "2 CQUAD8 cards were left out, as model.ignore_cards asks"));
}

TEST(NastranModel, ReadsEqualDuplicatesOnce) {
  const NastranModel read =
      model_of(k_cube + "MAT1,1,210.+9,,.3,7850.\nPELAS,1,5.,,,1,5.0\nCONM2,1,1,,1.\nCONM2,1,1,,1.0\n");
  EXPECT_EQ(read.model.materials.size(), 1U);
  EXPECT_EQ(read.model.elements<PointMassElement>().size(), 1U);
  EXPECT_EQ(read.notes.size(), 3U);
}

}  // namespace
}  // namespace mottle::formats
