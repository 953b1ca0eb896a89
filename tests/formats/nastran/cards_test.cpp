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
using ::testing::ElementsAre;
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

TEST(NastranModel, NotesReductionsAndUnknownCards) {
  EXPECT_THAT(model_of(k_cube + "ASET1,123,1,2\nASET1,123,3\nSUPORT,1,1\nXYZZY,1\nXYZZY,2\n").notes,
              ElementsAre("2 ASET1 cards: no reduction is made, all degrees of freedom stay",
                          "1 SUPORT cards: no reduction is made, all degrees of freedom stay",
                          "2 XYZZY cards are not known here and were ignored, the first one at deck.bdf:13"));
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
