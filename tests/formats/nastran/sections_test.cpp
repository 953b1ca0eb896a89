// The executive and case control sections, and files that include others.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <map>
#include <string>

#include "core/message_of.hpp"
#include "mottle/core/error.hpp"
#include "mottle/formats/nastran/deck.hpp"

namespace mottle::formats {
namespace {

using ::testing::ElementsAre;
using ::testing::HasSubstr;

NastranDeck deck_of(const std::string& bytes) {
  return parse_nastran_deck(bytes, "deck.bdf");
}

std::string refusal_of(const std::string& bytes) {
  return test::message_of<FormatError>([&] { deck_of(bytes); });
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
  EXPECT_EQ(deck_of("CEND\nSUBT = MACH 0.45,\nSPC = 1\nBEGIN BULK\n").find_command("SPC")->value, "1");
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
            "deck.bdf:2: INCLUDE 'no such file.dat': there is no such file; looked for no such file.dat");
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

}  // namespace
}  // namespace mottle::formats
