#include "mottle/formats/calculix/deck.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>

#include "core/message_of.hpp"
#include "core/temporary_folder.hpp"
#include "mottle/core/error.hpp"
#include "mottle/core/files.hpp"

namespace mottle::formats {
namespace {

using testing::HasSubstr;

constexpr const char* k_deck =
    "*Node\n1, 0, 0, 0\n"
    "*MATERIAL, NAME = Steel\n*ELASTIC\n2.1e11, 0.3\n** 2.1e11 of a comment\n*DENSITY\n7800.\n"
    "*MATERIAL, NAME=RUBBER\n*ELASTIC\n{{soft}}, 0.4\n"
    "*SPRING, ELSET=BOLTS\n3\n1000.0\n*SPRING,ELSET=CABLES\n5.D3\n"
    "*SHELL SECTION, ELSET=PLATE, MATERIAL=STEEL, OFFSET=0.5\n0.002\n"
    "*STEP\n*FREQUENCY\n10\n*END STEP\n";

class CalculixDecks : public testing::Test {
 protected:
  CalculixDeck deck(const std::string& text) const {
    write_file_atomically(folder / "plate.inp", text);
    return read_calculix_deck(folder / "plate.inp");
  }
  static double value(const CalculixDeck& deck, const std::string& target) {
    return find_calculix_numbers(deck, target).at(0).value;
  }

  test::TemporaryFolder folder;
};

TEST_F(CalculixDecks, FindsTheNumbersOfCards) {
  const CalculixDeck read = deck(k_deck);
  EXPECT_EQ(value(read, "*ELASTIC:STEEL:E"), 2.1e11);
  EXPECT_EQ(value(read, "*elastic:steel:nu"), 0.3);
  EXPECT_EQ(value(read, "*DENSITY:Steel"), 7800.0);
  EXPECT_EQ(value(read, "*SPRING:BOLTS"), 1000.0);
  EXPECT_EQ(value(read, "*SPRING:CABLES"), 5000.0);
  EXPECT_EQ(value(read, "*SHELL SECTION:PLATE:T"), 0.002);
  EXPECT_TRUE(find_calculix_numbers(read, "{{soft}}").at(0).is_placeholder);
}

TEST_F(CalculixDecks, ListTheNumbersThatAParameterCanSet) {
  const CalculixDeck read = deck(std::string(k_deck) + "*ELASTIC, TYPE=ORTHO\n1,2,3\n*MASS, ELSET=NONE\n0.\n");
  EXPECT_THAT(list_calculix_targets(read), testing::ElementsAre("*ELASTIC:STEEL:E", "*DENSITY:STEEL", "*SPRING:BOLTS",
                                                                "*SPRING:CABLES", "*SHELL SECTION:PLATE:T"));
}

TEST_F(CalculixDecks, WritesOtherNumbersInTwentyCharactersAndTheStepThatStoresMatrices) {
  const CalculixDeck read = deck(k_deck);
  const std::string text = matrix_storage_deck(read, {{find_calculix_numbers(read, "*ELASTIC:STEEL:E")[0], 1.0 / 3e-11},
                                                      {find_calculix_numbers(read, "{{soft}}")[0], 7e5}});
  EXPECT_THAT(text, HasSubstr("*ELASTIC\n3.3333333333333e+10, 0.3\n"));
  EXPECT_THAT(text, HasSubstr("*ELASTIC\n7.0000000000000e+05, 0.4\n"));
  EXPECT_THAT(text, HasSubstr("*STEP\n*FREQUENCY, SOLVER=MATRIXSTORAGE\n**\n*END STEP\n"));
}

TEST_F(CalculixDecks, PutsTextsInPlaceOfNumbersAndLeavesTheStep) {
  const CalculixDeck read = deck(k_deck);
  const std::string text = deck_with_replacements(read, {{find_calculix_numbers(read, "*ELASTIC:STEEL:NU")[0], "<nu>"},
                                                         {find_calculix_numbers(read, "*ELASTIC:STEEL:E")[0], "<E>"}});
  EXPECT_THAT(text, HasSubstr("*ELASTIC\n<E>,<nu>\n**\n*DENSITY"));
  EXPECT_THAT(text, HasSubstr("*STEP\n*FREQUENCY\n10\n*END STEP\n"));
  EXPECT_THAT(test::message_of<FormatError>([&] { deck_with_replacements(deck("*NODE\n1, 0, 0, 0\n"), {}); }),
              HasSubstr("has no step"));
}

TEST_F(CalculixDecks, LeaveOutAllStepsButTheFirstOfModes) {
  const CalculixDeck read = deck(
      "*NODE\n1, 0, 0, 0\n*STEP\n*STATIC\n*CLOAD\n1, 1, 5.\n*END STEP\n*STEP\n*FREQUENCY\n10\n*NODE FILE\nRF\n*END "
      "STEP\n"
      "*STEP\n*STEADY STATE DYNAMICS\n1., 2.\n*NODE FILE\nU\n*END STEP\n*STEP\n*FREQUENCY\n20\n*END STEP\n");
  EXPECT_EQ(matrix_storage_deck(read, {}),
            "*NODE\n1, 0, 0, 0\n**\n**\n**\n**\n**\n*STEP\n*FREQUENCY, SOLVER=MATRIXSTORAGE\n**\n*NODE FILE\nRF\n*END "
            "STEP\n**\n**\n**\n**\n**\n**\n**\n**\n**\n**\n");
  const std::string text = deck_with_replacements(read, {});
  EXPECT_THAT(text, HasSubstr("*STEP\n*FREQUENCY\n10\n*NODE FILE\nRF\n*END STEP\n**\n"));
  EXPECT_THAT(text, testing::Not(HasSubstr("STATIC")));
  EXPECT_FALSE(writes_displacements(read)) << "the step that does is left out";
  EXPECT_EQ(left_out_steps(read),
            "Of the deck's steps the first *FREQUENCY is used; left out: *STATIC, *STEADY STATE DYNAMICS, *FREQUENCY.");
  EXPECT_EQ(left_out_steps(deck(k_deck)), "");
  const CalculixDeck twice = deck("*STEP\n*FREQUENCY\n10\n*END STEP\n*STEP\n*DYNAMIC\n{{a}}\n*END STEP\n");
  EXPECT_THAT(test::message_of<InvalidInput>([&] { find_calculix_numbers(twice, "{{a}}"); }),
              HasSubstr("'{{a}}' does not stand in"))
      << "it would change nothing";
}

TEST_F(CalculixDecks, KeepTheStepsThatTheModesStartFrom) {
  const std::string preloaded =
      "*NODE\n1, 0, 0, 0\n*STEP, NLGEOM\n*STATIC\n*CLOAD\n1, 1, {{pull}}\n*END STEP\n"
      "*STEP, PERTURBATION\n*FREQUENCY\n10\n*END STEP\n";
  const CalculixDeck read = deck(preloaded + "*STEP\n*BUCKLE\n3\n*END STEP\n");
  EXPECT_THAT(needs_earlier_steps(read), HasSubstr("PERTURBATION of the state after *STATIC"));
  EXPECT_EQ(deck_with_replacements(read, {}), preloaded + "**\n**\n**\n**\n");
  EXPECT_EQ(find_calculix_numbers(read, "{{pull}}").size(), 1U);
  EXPECT_EQ(left_out_steps(read),
            "Of the deck's steps the first *FREQUENCY is used with those before it; left out: *BUCKLE.");
  EXPECT_THAT(needs_earlier_steps(deck("*STEP\n*STATIC\n*BOUNDARY\n1, 1\n*END STEP\n*STEP\n*FREQUENCY\n*END STEP\n")),
              HasSubstr("has a *BOUNDARY"));
  EXPECT_EQ(needs_earlier_steps(deck(k_deck)), "");
}

TEST_F(CalculixDecks, FindsTheNumbersOfMaterialsThatAreNotIsotropic) {
  const CalculixDeck read = deck(
      "*MATERIAL, NAME=PLY\n*ELASTIC, TYPE=ENGINEERING CONSTANTS\n1.,2.,3.,.4,.5,.6,7.,8.\n9., 20.\n"
      "*MATERIAL, NAME=WOOD\n*ELASTIC, TYPE=ORTHO\n11.,12.,13.,14.,15.,16.,17.,18.\n19.\n"
      "*MATERIAL, NAME=SALT\n*ELASTIC, TYPE=ANISO\n31.,32.,33.,34.,35.,36.,37.,38.\n"
      "39.,40.,41.,42.,43.,44.,45.,46.\n47.,48.,49.,50.,51.\n");
  EXPECT_EQ(value(read, "*ELASTIC:PLY:E1"), 1.0);
  EXPECT_EQ(value(read, "*ELASTIC:PLY:NU23"), 0.6);
  EXPECT_EQ(value(read, "*elastic:ply:g23"), 9.0);
  EXPECT_EQ(value(read, "*ELASTIC:WOOD:D3333"), 16.0);
  EXPECT_EQ(value(read, "*ELASTIC:WOOD:D2323"), 19.0);
  EXPECT_EQ(value(read, "*ELASTIC:SALT:D1212"), 40.0);
  EXPECT_EQ(value(read, "*ELASTIC:SALT:D2323"), 51.0);
}

TEST_F(CalculixDecks, FindsANumberAtEachTemperature) {
  const CalculixDeck read =
      deck("*MATERIAL, NAME=M\n*ELASTIC\n1.,0.3,0.\n2.,0.35,100.\n*DENSITY\n7.,0.\n8.,100.\n9.,200.\n");
  const std::vector<CalculixNumber> young = find_calculix_numbers(read, "*ELASTIC:M:E");
  ASSERT_EQ(young.size(), 2U);
  EXPECT_EQ(young[1].value, 2.0);
  EXPECT_EQ(young[0].temperatures, 2);
  EXPECT_EQ(find_calculix_numbers(read, "*DENSITY:M").back().temperatures, 3);
}

TEST_F(CalculixDecks, KnowWhetherDisplacementsAreWritten) {
  EXPECT_FALSE(writes_displacements(deck(k_deck)));
  EXPECT_TRUE(writes_displacements(deck("*STEP\n*FREQUENCY\n3\n*NODE FILE\nRF, u\n*END STEP\n")));
  EXPECT_FALSE(writes_displacements(deck("*STEP\n*FREQUENCY\n3\n*NODE FILE\nRF\n*EL FILE\nU\n*END STEP\n")));
}

TEST_F(CalculixDecks, TakesIncludedFilesIn) {
  write_file_atomically(folder / "material.inc", "*MATERIAL, NAME=M\n*DENSITY\nx\n");
  const CalculixDeck read = deck("*NODE\n*INCLUDE, INPUT=material.inc\n");
  EXPECT_EQ(read.lines.size(), 4U);
  EXPECT_THAT(test::message_of<FormatError>([&] { find_calculix_numbers(read, "*DENSITY:M"); }),
              HasSubstr("material.inc:3: 'x' is not a number"));
  EXPECT_THAT(test::message_of<FormatError>([&] { deck("*NODE\n*INCLUDE, INPUT=plate.inp\n"); }),
              HasSubstr("plate.inp:2: includes"));
}

struct Refused {
  const char* target;
  const char* text;
  const char* message;
};

TEST_F(CalculixDecks, RefusesTargetsThatAreNotThere) {
  const CalculixDeck read = deck(k_deck);
  for (const Refused& each :
       {Refused{"*ELASTIC:STEAL:E", "", "did you mean 'STEEL'?"},
        Refused{"*ELASTIC:STEEL", "", "is none that is known"},
        Refused{"*ELASTIC:STEEL:G", "", "is none that is known"}, Refused{"MAT1:1:E", "", "is none that is known"},
        Refused{"{{hard}}", "", "does not stand in"}}) {
    EXPECT_THAT(test::message_of<InvalidInput>([&] { find_calculix_numbers(read, each.target); }),
                HasSubstr(each.message));
  }
}

TEST_F(CalculixDecks, RefusesCardsWhoseNumberCannotBeMoved) {
  for (const Refused& each :
       {Refused{"*ELASTIC:M:E", "*MATERIAL,NAME=M\n*ELASTIC,TYPE=ORTHO\n1.,2.,3.,4.,5.,6.,7.,8.\n9.\n",
                "plate.inp:2: this *ELASTIC is of type ORTHO, whose numbers are D1111 D1122"},
        Refused{"*ELASTIC:M:E", "*MATERIAL,NAME=M\n*ELASTIC,TYPE=CUBIC\n1.,2.\n",
                "plate.inp:2: the numbers of *ELASTIC of type CUBIC are not known here"},
        Refused{"*ELASTIC:M:G23", "*MATERIAL,NAME=M\n*ELASTIC,TYPE=ENGINEERING CONSTANTS\n1.,2.,3.,.1,.2,.3,4.,5.\n",
                "plate.inp:2: *ELASTIC has 1 data lines, 2 for each temperature are needed"},
        Refused{"*SPRING:S", "*SPRING,ELSET=S,NONLINEAR\n1.,2.\n", "plate.inp:1: a nonlinear spring"},
        Refused{"*DENSITY:M", "*MATERIAL,NAME=M\n*DENSITY\n*STEP\n", "plate.inp:2: *DENSITY has no data line"}}) {
    const CalculixDeck read = deck(each.text);
    EXPECT_THAT(test::message_of<FormatError>([&] { find_calculix_numbers(read, each.target); }),
                HasSubstr(each.message));
  }
}

TEST_F(CalculixDecks, RefusesStepsThatStoreNoMatrices) {
  for (const Refused& each : {Refused{"", "*STEP\n*STATIC\n*END STEP\n", "plate.inp:2: *STATIC instead of *FREQUENCY"},
                              Refused{"", "*CYCLIC SYMMETRY MODEL, N=8, TIE=T\n*STEP\n*FREQUENCY\n5\n*END STEP\n",
                                      "plate.inp:1: *CYCLIC SYMMETRY MODEL: the modes of a sector are not read"},
                              Refused{"", "*STEP\n*END STEP\n", "plate.inp:1: the step has no *FREQUENCY"},
                              Refused{"", "*NODE\n1, {{a}}, 0\n", "plate.inp:2: no parameter fills '{{a}}'"}}) {
    EXPECT_THAT(test::message_of<FormatError>([&] { matrix_storage_deck(deck(each.text), {}); }),
                HasSubstr(each.message));
  }
}

}  // namespace
}  // namespace mottle::formats
