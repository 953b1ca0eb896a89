#include "mottle/formats/nastran_deck.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <map>
#include <string>
#include <vector>

#include "core/message_of.hpp"
#include "mottle/core/error.hpp"

namespace mottle {
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

std::string refusal_of(const std::string& bytes) {
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

const std::string k_control =
    "ID A,B\nSOL 103\nTIME 5\nCEND\nTITLE = Bob's wing, $ a comment\nSET 1 = 1,2,\n  3\nSPC = 1\nPARAM,K6ROT,10.\n"
    "METH(STRUCTURE) = 7\nSUBCASE 4\n SPC = 2\n DISP(SORT1,REAL)=ALL\nSUBCASE 9\n MPC = 5\nbegin "
    "bulk\nGRID,1\nENDDATA\n";

TEST(NastranCaseControl, ReadsTheSolution) {
  EXPECT_EQ(deck_of(k_control).solution, "103");
  EXPECT_EQ(deck_of("SOL SEMODES\nCEND\nBEGIN BULK\n").solution, "SEMODES");
  EXPECT_EQ(deck_of("GRID,1\n").solution, "");
}

TEST(NastranCaseControl, TakesTheFirstSubcaseUnlessTold) {
  const NastranDeck deck = deck_of(k_control);
  EXPECT_THAT(deck.subcases, ElementsAre(4, 9));
  EXPECT_EQ(deck.find_command("SPC")->value, "2");
  EXPECT_EQ(deck.find_command("SPC", 1)->value, "1");
  EXPECT_EQ(deck.find_command("MPC"), nullptr);
  EXPECT_EQ(deck.find_command("MPC", 1)->value, "5");
}

TEST(NastranCaseControl, KnowsCommandsByFourLetters) {
  const NastranDeck deck = deck_of(k_control);
  ASSERT_NE(deck.find_command("METHOD"), nullptr);
  EXPECT_EQ(deck.find_command("METHOD")->value, "7");
  EXPECT_EQ(deck.find_command("METHOD")->line, 10);
  EXPECT_EQ(deck.find_command("DISPLACEMENT")->value, "ALL");
}

TEST(NastranCaseControl, JoinsLinesButNotTitles) {
  const NastranDeck deck = deck_of(k_control);
  EXPECT_EQ(deck.find_command("SET")->value, "1 = 1,2, 3");
  EXPECT_EQ(deck.find_command("TITLE")->value, "Bob's wing,");
}

TEST(NastranCaseControl, ReadsParametersInEveryForm) {
  for (const std::string form : {"PARAM,K6ROT,10.", "param = k6rot , 10.", "PARAM K6ROT 10."}) {
    EXPECT_EQ(deck_of("CEND\n" + form + "\nBEGIN BULK\n").case_control.at(0).value, "K6ROT,10.") << form;
  }
}

TEST(NastranCaseControl, IsReadWithoutCend) {
  EXPECT_EQ(deck_of("SPC = 3\nBEGIN BULK\nGRID,1\n").find_command("SPC")->value, "3");
}

/// A deck whose includes come from a map.
NastranDeck deck_with(const std::map<std::string, std::string>& files) {
  const auto resolve = [&](const std::string& written, const std::string&) -> std::optional<IncludedFile> {
    const auto found = files.find(written);
    if (found == files.end()) return std::nullopt;
    return IncludedFile{written, found->second};
  };
  return parse_nastran_deck(files.at("main"), "main", resolve);
}

TEST(NastranInclude, ReadsTheNameInEveryForm) {
  for (const std::string form : {"INCLUDE a b.dat", "include 'a b.dat'", "Include \"a b.dat\" $ x", "INCLUDE='a b.dat'",
                                 "INCLUDE 'a \n   b.dat'", "  INCLUDE   'a b.dat'"}) {
    // Blanks at a line's ends do not count: the broken name is "ab.dat".
    const NastranDeck deck =
        deck_with({{"main", form + "\nGRID,2\n"}, {"a b.dat", "GRID,1\n"}, {"ab.dat", "GRID,1\n"}});
    ASSERT_EQ(deck.cards.size(), 2U) << form;
    EXPECT_EQ(deck.cards[0].fields[0], "1");
    EXPECT_EQ(deck.cards[0].file, 1);
    EXPECT_EQ(deck.cards[1].file, 0);
  }
}

TEST(NastranInclude, WorksInEverySection) {
  const NastranDeck deck = deck_with({{"main", "INCLUDE 'exec'\nCEND\nINCLUDE case\nBEGIN BULK\nINCLUDE bulk\n"},
                                      {"exec", "SOL 103\n"},
                                      {"case", "SPC = 7\n"},
                                      {"bulk", "GRID,1\n"}});
  EXPECT_EQ(deck.solution, "103");
  EXPECT_EQ(deck.find_command("SPC")->value, "7");
  EXPECT_EQ(deck.find_command("SPC")->file, 2);
  EXPECT_EQ(deck.cards.size(), 1U);
  EXPECT_THAT(deck.files, ElementsAre("main", "exec", "case", "bulk"));
}

TEST(NastranInclude, MayBeRepeated) {
  EXPECT_EQ(deck_with({{"main", "INCLUDE a\nINCLUDE a\n"}, {"a", "GRID,1\n"}}).cards.size(), 2U);
}

TEST(NastranInclude, RefusesCircles) {
  const std::map<std::string, std::string> files = {
      {"main", "INCLUDE a\n"}, {"a", "\nINCLUDE b\n"}, {"b", "INCLUDE a\n"}};
  EXPECT_EQ(test::message_of<FormatError>([&] { deck_with(files); }),
            "b:1: INCLUDE 'a': that file is being read already, it would include itself without end");
  EXPECT_THAT(test::message_of<FormatError>([&] { deck_with({{"main", "INCLUDE main\n"}}); }), HasSubstr("main:1: "));
}

TEST(NastranInclude, RefusesAMissingFile) {
  EXPECT_EQ(refusal_of("GRID,1\nINCLUDE 'no such file.dat'\n"),
            "deck.bdf:2: INCLUDE 'no such file.dat': no such file beside this file or the main one");
}

TEST(NastranInclude, RefusesTooManyFilesAndLevels) {
  std::map<std::string, std::string> chain = {{"main", "INCLUDE 1\n"}};
  for (int i = 1; i < 100; ++i) chain[std::to_string(i)] = "INCLUDE " + std::to_string(i + 1) + "\n";
  EXPECT_THAT(test::message_of<FormatError>([&] { deck_with(chain); }), HasSubstr("31:1: files include each other"));
  std::string many;
  for (int i = 0; i < 2000; ++i) many += "INCLUDE a\n";
  EXPECT_THAT(test::message_of<FormatError>([&] {
                deck_with({{"main", many}, {"a", ""}});
              }),
              HasSubstr("main:1001: more than 1000 included files"));
}

struct Malformed {
  std::string deck, message;
};

class MalformedDeck : public ::testing::TestWithParam<Malformed> {};

TEST_P(MalformedDeck, IsRefusedWithItsLine) {
  EXPECT_THAT(refusal_of(GetParam().deck), HasSubstr(GetParam().message));
}

INSTANTIATE_TEST_SUITE_P(
    NastranDeck, MalformedDeck,
    ::testing::Values(
        Malformed{"/ 1 3\n", "deck.bdf:1: '/' deletes cards"},
        Malformed{"GRID,1\n=,*1,=\n", "deck.bdf:2: '=' repeats the card above"},
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
}  // namespace mottle
