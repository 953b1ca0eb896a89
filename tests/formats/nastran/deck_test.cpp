#include "mottle/formats/nastran/deck.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <string>
#include <vector>

#include "core/message_of.hpp"
#include "mottle/core/error.hpp"

namespace mottle::formats {
namespace {

using ::testing::ElementsAre;
using ::testing::HasSubstr;
using ::testing::IsEmpty;

using Fields = std::vector<std::string>;

NastranDeck deck_of(const std::string& bytes) {
  return parse_nastran_deck(bytes, "deck.bdf");
}

Fields fields_of(const BulkCard& card) {
  return {card.fields.begin(), card.fields.end()};
}

/// Fields of the only card.
Fields card_of(const std::string& bytes) {
  const NastranDeck deck = deck_of(bytes);
  EXPECT_EQ(deck.cards.size(), 1U);
  return deck.cards.empty() ? Fields() : fields_of(deck.cards[0]);
}

std::string refusal_of_deck(const std::string& bytes) {
  return test::message_of<FormatError>([&] { deck_of(bytes); });
}

const Fields k_grid = {"2", "", "1.0", "-2.0", "3.0", "", "136"};
const Fields k_hexahedron = {"7", "3", "11", "12", "13", "14", "15", "16", "17", "18"};

TEST(NastranDeck, ReadsSmallFields) {
  EXPECT_EQ(card_of("GRID    2               1.0     -2.0    3.0             136\n"), k_grid);
}

TEST(NastranDeck, ReadsLargeFields) {
  EXPECT_EQ(card_of("GRID*   2                               1.0             -2.0            *G1\n"
                    "*G1     3.0                             136\n"),
            k_grid);
  EXPECT_EQ(card_of("GRID*                  2                             1.0            -2.0\n"
                    "*                    3.0                             136\n"),
            k_grid);
}

TEST(NastranDeck, ReadsFreeFields) {
  EXPECT_EQ(card_of("GRID,2,,1.0,-2.0,3.0,,136\n"), k_grid);
  EXPECT_EQ(card_of(" GRID , 2,  ,1.0 ,\t-2.0, 3.0 ,, 136 ,\n"), k_grid);
}

TEST(NastranDeck, ReadsLargeFreeFields) {
  EXPECT_EQ(card_of("GRID*,2,,1.0,-2.0\n*,3.0,,136\n"), k_grid);
  EXPECT_EQ(card_of("GRID*,2,,1.0,-2.0,*A\n*A,3.0,,136\n"), k_grid);
}

TEST(NastranDeck, ReadsEveryKindOfContinuation) {
  const std::string first = "CHEXA   7       3       11      12      13      14      15      16      ";
  EXPECT_EQ(card_of(first + "\n        17      18\n"), k_hexahedron);
  EXPECT_EQ(card_of(first + "\n+       17      18\n"), k_hexahedron);
  EXPECT_EQ(card_of(first + "+\n+       17      18\n"), k_hexahedron);
  EXPECT_EQ(card_of(first + "+A1\n+A1     17      18\n"), k_hexahedron);
  EXPECT_EQ(card_of(first + "\n*       17              18\n"), k_hexahedron);
  EXPECT_EQ(card_of(first + "\n\t17\t18\n"), k_hexahedron);
  EXPECT_EQ(card_of(first + "\n,17,18\n"), k_hexahedron);
  EXPECT_EQ(card_of("CHEXA,7,3,11,12,13,14,15,16\n,17,18\n"), k_hexahedron);
  EXPECT_EQ(card_of("CHEXA,7,3,11,12,13,14,15,16,+1\n+1,17,18\n"), k_hexahedron);
  EXPECT_EQ(card_of("CHEXA,7,3,11,12,13,14,15,16,+\n+,17,18\n"), k_hexahedron);
  EXPECT_EQ(card_of("CHEXA,7,3,11,12,13,14,15,16,\n        17      18\n"), k_hexahedron);
}

TEST(NastranDeck, LetsLongFreeLinesRunOver) {
  EXPECT_EQ(card_of("CHEXA,7,3,11,12,13,14,15,16,17,18\n"), k_hexahedron);
  EXPECT_EQ(card_of("CHEXA,7,3,11,12,\n13,14,15,16,17,18\n"), k_hexahedron);
  EXPECT_EQ(card_of("CHEXA,7,3,11,12,13,14,15,16,17,\n18\n"), k_hexahedron);
}

TEST(NastranDeck, KeepsFieldsInTheirLineOfEight) {
  EXPECT_EQ(card_of("RBE3,1,,2,123,1.0\n,UM,5,1\n"), (Fields{"1", "", "2", "123", "1.0", "", "", "", "UM", "5", "1"}));
  EXPECT_THAT(card_of("A       1\n*       9               10\n"), ::testing::SizeIs(10));
}

TEST(NastranDeck, CountsALargeLineAsHalfALine) {
  // The second half is left out: what follows in small fields begins a new line of eight.
  EXPECT_EQ(card_of("PBAR*   1               2               3.              4.\n"
                    "        C1\n"),
            (Fields{"1", "2", "3.", "4.", "", "", "", "", "C1"}));
  EXPECT_EQ(card_of("PBAR*   1\n*\n*       C1\n"), (Fields{"1", "", "", "", "", "", "", "", "C1"}));
}

TEST(NastranDeck, FindsContinuationsByTheirLabelAnywhere) {
  const NastranDeck deck = deck_of(
      "CHEXA   7       3       11      12      13      14      15      16      +A\n"
      "CHEXA   8       3       21      22      23      24      25      26      +B\n"
      "+B      27      28\n"
      "+A      17      18\n");
  ASSERT_EQ(deck.cards.size(), 2U);
  EXPECT_EQ(fields_of(deck.cards[0]), k_hexahedron);
  EXPECT_EQ(fields_of(deck.cards[1]), (Fields{"8", "3", "21", "22", "23", "24", "25", "26", "27", "28"}));
  EXPECT_THAT(deck.notes, IsEmpty());
}

// MSC's echo punches labels from column 74 on, each with a '+' of its own.
TEST(NastranDeck, FindsContinuationsByPunchedLabels) {
  const std::string first = "CHEXA   7       3       11      12      13      14      15      16       +000001\n";
  for (const std::string rest : {"++000001      17      18\n", "+000001       17      18\n"}) {
    EXPECT_EQ(card_of(first + rest), k_hexahedron) << rest;
    const NastranDeck apart = deck_of(first + "GRID    2\n" + rest);
    ASSERT_EQ(apart.cards.size(), 2U);
    EXPECT_EQ(fields_of(apart.cards[0]), k_hexahedron) << rest;
  }
}

TEST(NastranDeck, FindsContinuationsInFrontOfTheirCard) {
  const NastranDeck deck = deck_of("GRID,1\n+A,17,18\nCHEXA,7,3,11,12,13,14,15,16,+A\n");
  ASSERT_EQ(deck.cards.size(), 2U);
  EXPECT_EQ(fields_of(deck.cards[1]), k_hexahedron);
}

TEST(NastranDeck, NotesALabelThatNoLineAsksFor) {
  const NastranDeck deck = deck_of("CHEXA,7,3,11,12,13,14,15,16\n+X,17,18\n");
  EXPECT_EQ(fields_of(deck.cards[0]), k_hexahedron);
  EXPECT_THAT(deck.notes, ElementsAre(HasSubstr("1 continuation lines with a label that no line asks for")));
}

TEST(NastranDeck, LeavesOutTheFirstCharacterOfALabelWithoutPlus) {
  const std::string first = "CHEXA   7       3       11      12      13      14      15      16      KLABEL\n";
  const std::string rest = "+LABEL  17      18\n";
  EXPECT_EQ(card_of(first + rest), k_hexahedron);
  const NastranDeck apart = deck_of(first + "GRID    2\n" + rest);
  ASSERT_EQ(apart.cards.size(), 2U);
  EXPECT_EQ(fields_of(apart.cards[0]), k_hexahedron);
  // A label that agrees as a whole comes first.
  const NastranDeck both =
      deck_of(first + "CHEXA   9                                                               LABEL\n" + rest);
  ASSERT_EQ(both.cards.size(), 2U);
  EXPECT_EQ(both.cards[1].fields.size(), 10U);
}

TEST(NastranDeck, RepeatsTheCardAboveWithChanges) {
  const std::vector<Fields> expected = {{"101", "17", "1.0", "10.5", "", "17", "3456"},
                                        {"102", "17", "1.25", "10.5", "", "17", "3456"},
                                        {"103", "17", "1.5", "10.5", "", "17", "3456"},
                                        {"104", "17", "1.75", "10.5", "", "17", "3456"},
                                        {"900", "17", "1.75"}};
  for (const std::string lines : {"GRID,101,17,1.0,10.5,,17,3456\n=,*(1),=,*(0.25),==\n=(2)\n=,900,=,=\n",
                                  "GRID    101     17      1.0     10.5            17      3456\n"
                                  "=       *1      =       *.25    ==\n"
                                  "=2\n"
                                  "=       900     =       =\n"}) {
    const NastranDeck deck = deck_of(lines);
    ASSERT_EQ(deck.cards.size(), expected.size());
    for (std::size_t i = 0; i < expected.size(); ++i) {
      EXPECT_EQ(deck.cards[i].name, "GRID");
      EXPECT_EQ(fields_of(deck.cards[i]), expected[i]);
    }
    EXPECT_EQ(deck.cards[3].line, 3);
  }
  EXPECT_EQ(deck_of("A,9,12.0\n=,*-1,*-2\n").cards[1].fields[1], "10.0");
}

TEST(NastranDeck, IgnoresWhatStandsBehindColumn72) {
  EXPECT_EQ(card_of("GRID    2               1.0     -2.0    3.0             136             SEQ00010\n"), k_grid);
  EXPECT_EQ(
      card_of("GRID    2               1.0     -2.0    3.0             136             SEQ00010behind column 80\n"),
      k_grid);
}

TEST(NastranDeck, ExpandsTabs) {
  EXPECT_EQ(card_of("GRID\t2\t\t1.0\t-2.0\t3.0\t\t136\n"), k_grid);
  EXPECT_EQ(card_of("GRID*\t2\t\t\t\t1.0\t\t-2.0\n*\t3.0\t\t\t\t136\n"), k_grid);
}

TEST(NastranDeck, ReadsEveryLineEnd) {
  for (const std::string end : {"\n", "\r\n", "\r"}) {
    const NastranDeck deck = deck_of("$ x" + end + end + "GRID,1" + end + "GRID,2");
    ASSERT_EQ(deck.cards.size(), 2U);
    EXPECT_EQ(deck.cards[0].line, 3);
    EXPECT_EQ(deck.cards[1].line, 4);
  }
}

TEST(NastranDeck, SkipsCommentsAndBlankLines) {
  EXPECT_EQ(card_of("$ GRID,9\n  $ \xE4\xF6\xFC\n\n        \nGRID,2,,1.0,-2.0,3.0,,136$ x,y\n$\n"), k_grid);
}

TEST(NastranDeck, ReadsAContinuationBehindAComment) {
  EXPECT_EQ(card_of("CHEXA,7,3,11,12,13,14,15,16\n$ the rest\n\n,17,18\n"), k_hexahedron);
}

TEST(NastranDeck, PutsCardsIntoCapitals) {
  const NastranDeck deck = deck_of("pbarl,1,2,,tube\n");
  EXPECT_EQ(deck.cards[0].name, "PBARL");
  EXPECT_EQ(deck.cards[0].fields[3], "TUBE");
}

TEST(NastranDeck, EndsAtEnddata) {
  EXPECT_EQ(deck_of("GRID,1\nenddata\nGRID,2\n/ ???\n").cards.size(), 1U);
}

TEST(NastranDeck, ReadsAnEmptyFile) {
  EXPECT_THAT(deck_of("").cards, IsEmpty());
  EXPECT_THAT(deck_of("\xEF\xBB\xBF$ mark\n").cards, IsEmpty());
}

TEST(NastranDeck, IsNotTroubledByCopies) {
  NastranDeck copy;
  {
    const NastranDeck deck = deck_of("GRID,2,,1.0,-2.0,3.0,,136\n");
    copy = deck;
  }
  EXPECT_EQ(fields_of(copy.cards[0]), k_grid);
}

struct Malformed {
  std::string deck, message;
};

class MalformedDeck : public ::testing::TestWithParam<Malformed> {};

TEST_P(MalformedDeck, IsRefusedWithItsLine) {
  EXPECT_THAT(refusal_of_deck(GetParam().deck), HasSubstr(GetParam().message));
}

INSTANTIATE_TEST_SUITE_P(
    NastranDeck, MalformedDeck,
    ::testing::Values(
        Malformed{"/ 1 3\n", "deck.bdf:1: '/' deletes cards"},
        Malformed{"=,*1,=\n", "deck.bdf:1: '=' repeats the card above; there is none"},
        Malformed{"A,1\n,2\n=,*1\n",
                  "deck.bdf:3: '=' repeats the card above; this is not supported for cards of several"},
        Malformed{"A,1,,,,,,,,+X\n=,*1\n+X,2\n", "deck.bdf:2: '=' repeats the card above; this is not supported for"},
        Malformed{"A,1\n=3\n", "deck.bdf:2: '=3' repeats a line above that begins with '='; there is none"},
        Malformed{"A,1\n=,*1\nB,1\n=3\n", "deck.bdf:4: '=3' repeats a line above"},
        Malformed{"A,1\n=,*1\n=0\n", "deck.bdf:3: '=0': the number of cards behind '=' must be an integer from 1"},
        Malformed{"A,1\n=,*1\n=1000000\n", "deck.bdf:3: '=' lines make more than 1000000 cards"},
        Malformed{"A,1\n=,*.5\n", "deck.bdf:2: '*.5' cannot be added to '1' of the card above"},
        Malformed{"A,X\n=,*1\n", "deck.bdf:2: '*1' cannot be added to 'X' of the card above"},
        Malformed{"A,2147483647\n=,*1\n", "deck.bdf:2: '*1' cannot be added to '2147483647' of the card above"},
        Malformed{"$\n,1,2\n", "deck.bdf:2: a continuation line without a card"},
        Malformed{"        1.0\n", "deck.bdf:1: a continuation line without a card"},
        Malformed{"GRID 1  2\n", "deck.bdf:1: 'GRID 1' stands where a card's name must"},
        Malformed{"GRID,1\n3.0     4\n", "deck.bdf:2: a line that begins with a number continues one that ends"},
        Malformed{"GRID,1\n3,4\n", "deck.bdf:2: a line that begins with a number continues one that ends with a comma"},
        Malformed{"CHEXA,1,2,3,4,5,6,7,8,+A\nGRID,1,,,,,,,,+B\n+C,2\n", "deck.bdf:3: continuation '+C': no line ends"},
        Malformed{"A,1,,,,,,,,+L\nB,1,,,,,,,,+L\nC,1\n+L,2\n", "deck.bdf:4: continuation '+L': lines 1 and 2 both end"},
        Malformed{"A,1,,,,,,,,+L\n+L,2\n+L,3\n",
                  "deck.bdf:3: continuation '+L': the line with that label is continued already"},
        Malformed{"A,1\n+L,2,,,,,,,,+M\nB,1\n+M,2,,,,,,,,+L\n",
                  "deck.bdf:2: continuation lines that continue each other"},
        Malformed{"SOL 103\nCEND\nSPC = 1\n", "deck.bdf: no BEGIN BULK"},
        Malformed{"CEND\nBEGIN SUPER=1\n", "deck.bdf:2: 'BEGIN SUPER=1': superelements"},
        Malformed{"CEND\nSUBCASE x\nBEGIN BULK\n", "deck.bdf:2: SUBCASE 'x': a number from 1"},
        Malformed{"INCLUDE\n", "deck.bdf:1: INCLUDE without a file name"},
        Malformed{"\nINCLUDE 'x\n", "deck.bdf:2: INCLUDE: the quote is not closed"},
        Malformed{"\xFF\xFEG", "deck.bdf: is UTF-16 text"},
        Malformed{"GRID,1\n\xC3\x84,1\n", "deck.bdf:2: '?\?' stands where a card's name must"},
        Malformed{std::string("GRID,1\n\0\0,1\n", 12), "deck.bdf:2: '?\?' stands where"},
        Malformed{"GRID," + std::string(70000, '1'), "deck.bdf:1: the line has more than 65536 characters"}));

// A hostile file may be slow to write but not to read: each of these is linear in its size.
TEST(NastranDeck, ReadsManyLinesOfEveryKindInLinearTime) {
  std::string labels, rings, blanks;
  for (int i = 0; i < 100000; ++i) {
    const std::string number = std::to_string(i);
    labels += "A," + number + ",,,,,,,,+L" + number + "\n";
    blanks += "+\n";
  }
  for (int i = 99999; i >= 0; --i) labels += "+L" + std::to_string(i) + ",2\n";
  EXPECT_EQ(deck_of(labels).cards.size(), 100000U);
  EXPECT_EQ(deck_of("A,1\n" + blanks + ",9\n").cards[0].fields.size(), 8U * 100001 + 1);
  EXPECT_EQ(deck_of(std::string(1000000, '\r')).cards.size(), 0U);
}

}  // namespace
}  // namespace mottle::formats
