// Cards that no rule reads: which refuse a deck, in one message, and which are noted.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <string>

#include "formats/nastran/model_of.hpp"

namespace mottle::formats {
namespace {

using ::testing::HasSubstr;
using ::testing::Not;
using ::testing::StartsWith;

TEST(NastranRefusal, NamesEveryUnsupportedKindOfCardAtOnce) {
  const std::string message = test::refusal_of(test::k_cube + "CWELD,1\nCQUADX,2\nCQUADX,3\nFORCE,1\n");
  EXPECT_THAT(message,
              StartsWith("deck.bdf:10: 2 kinds of cards change the model and are not supported: "
                         "CWELD (1, the first at deck.bdf:10), CQUADX (2, the first at deck.bdf:11); read are"));
  EXPECT_THAT(message, HasSubstr("; model.ignore_cards = [\"CWELD\", \"CQUADX\"] goes on without them"));
}

TEST(NastranRefusal, NamesThePropertiesAndMaterialsOfElementsInTheSameMessage) {
  const std::string message = test::refusal_of(
      test::k_cube + "MAT10,2,1.\nPSOLID,7,2\nCWELD,1\nPBCOMP,5,1,.1\nCTETRA,3,7,1,2,3,5\nCBEAM,4,5,1,2,0.,1.,0.\n");
  EXPECT_THAT(message, StartsWith("deck.bdf:10: 3 kinds of cards change the model and are not supported: "
                                  "MAT10 2 (deck.bdf:10; CTETRA 3 at deck.bdf:14 (with PSOLID 7) needs it), "
                                  "CWELD (1, the first at deck.bdf:12), "
                                  "PBCOMP 5 (deck.bdf:13; CBEAM 4 at deck.bdf:15 needs it); read are"));
}

TEST(NastranRefusal, IsNotOfPropertiesAndMaterialsThatNoElementNeeds) {
  const NastranModel read = test::model_of(
      test::k_cube + "MAT10,2,1.\nMATS1,1,,PLASTIC,0.\nPSOLID,7,2\nPBCOMP,5,1,.1\nPBCOMP,6,1,.1\nPBEAM3,8,1,.1\n");
  EXPECT_THAT(read.notes,
              ::testing::ElementsAre("1 MAT10 cards are not supported; no element that is read needs them",
                                     "2 PBCOMP cards are not supported; no element that is read needs them",
                                     "1 PBEAM3 cards are not supported; no element that is read needs them"));
}

// A missing point may be one that a card which is not read would make: what is not read is told first.
TEST(NastranRefusal, NamesWhatIsNotReadBeforeWhatFollowsFromIt) {
  EXPECT_THAT(test::refusal_of(test::k_cube + "GRIDB,90\nCELAS2,1,5.,90,1\n"), StartsWith("deck.bdf:10: GRIDB 90:"));
}

// Elements refer to properties and materials: without PCOMPS the deck would be refused for its CQUAD4.
TEST(NastranRefusal, AdvisesToIgnoreCardsOnlyWhereThatHelps) {
  for (const std::string cards : {"PCOMPS,1\nCQUAD4,1,1,1,2,3,4\n", "MAT3,2,1.\nCONROD,1,1,2,2,.1\n",
                                  "PCOMPS,1\nCWELD,1\nCQUAD4,1,1,1,2,3,4\n"}) {
    EXPECT_THAT(test::refusal_of(test::k_cube + cards), Not(HasSubstr("ignore_cards"))) << cards;
  }
  EXPECT_THAT(test::refusal_of(test::k_cube + "CWELD,1\n"), HasSubstr("model.ignore_cards = [\"CWELD\"]"));
}

}  // namespace
}  // namespace mottle::formats
