#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "core/message_of.hpp"
#include "core/temporary_folder.hpp"
#include "mottle/core/error.hpp"
#include "mottle/core/files.hpp"
#include "mottle/formats/calculix/deck.hpp"

namespace mottle::formats {
namespace {

using testing::HasSubstr;
using testing::Not;

constexpr const char* k_parts =
    "*Preprint, echo=NO\n"
    "*Part, name=Rod\n*Node, nset=All\n 7, 1., 2., 0.\n 8, 2., 2., 0.\n*Element, type=B31, elset=Line\n 3, 7, 8\n"
    "*Nset, nset=End, generate\n 7, 8, 1\n*Surface, type=NODE, name=Face\nEnd, 1.\n7,\n*End Part\n"
    "*Assembly, name=A\n*Instance, name=R1, part=Rod\n*End Instance\n"
    "*Instance, name=R2, part=Rod\n 10., 0., 0.\n 10., 0., 0., 10., 0., 5., 90.\n*End Instance\n"
    "*Node\n 1, 0., 0., 9.\n*Nset, nset=Held, internal, instance=R2\n 7, End\n*Nset, nset=Tip, instance=R1\n 8,\n"
    "*Element, type=SPRING2, elset=Link\n 5, R1.8, 1\n*Spring, elset=Link\n1, 1\n 1000\n"
    "*Rigid Body, ref node=Tip, tie nset=R2.All\n*End Assembly\n"
    "*Material, name=M\n*Elastic\n 1., 0.\n*Boundary\nHeld, PINNED\nR1.7, XSYMM\n1, 2, 3\n"
    "*Step, name=S\nA title\n*Frequency\n 3,\n*Output, field\n*Node Output\nU,\n*End Step\n";

class FlatDecks : public testing::Test {
 protected:
  CalculixDeck deck(const std::string& text) const {
    write_file_atomically(folder / "rods.inp", text);
    return read_calculix_deck(folder / "rods.inp");
  }
  std::string flat(const std::string& text) const { return deck_with_replacements(deck(text), {}); }
  std::string refusal(const std::string& text) const {
    return test::message_of<FormatError>([&] { flat(text); });
  }
  static std::string edited(const std::string& from, const std::string& to) {
    std::string text = k_parts;
    return text.replace(text.find(from), from.size(), to);
  }

  test::TemporaryFolder folder;
};

TEST_F(FlatDecks, NumberInstancesAndTheAssemblyThrough) {
  const std::string text = flat(k_parts);
  EXPECT_THAT(text, HasSubstr("*NODE, NSET=R1.ALL\n7, 1., 2., 0.\n8, 2., 2., 0.\n"));
  EXPECT_THAT(text, HasSubstr("*ELEMENT, ELSET=R2.LINE, TYPE=B31\n1003, 1007, 1008\n"));
  EXPECT_THAT(text, HasSubstr("*NODE\n2001, 0., 0., 9.\n"));
  EXPECT_THAT(text, HasSubstr("*ELEMENT, ELSET=LINK, TYPE=SPRING2\n2005, 8, 2001\n"));
  EXPECT_THAT(
      element_notes(deck(k_parts)),
      testing::ElementsAre("Abaqus deck: left out *PREPRINT, *OUTPUT, *NODE OUTPUT.",
                           "Abaqus deck: nodes and elements of instance R2 have 1000 added to their numbers.",
                           "Abaqus deck: nodes and elements of the assembly have 2000 added to their numbers."));
}

/// (1, 2, 0) moved to (11, 2, 0), turned by 90 degrees about the axis z through (10, 0, 0): (10 - 2, 1, 0).
TEST_F(FlatDecks, MoveAnInstanceBeforeTheyTurnIt) {
  EXPECT_THAT(flat(k_parts), testing::ContainsRegex("\n1007, 8\\.0000000*e\\+00, 1\\.0000000*e\\+00, -?0\\.0000000*e"));
}

TEST_F(FlatDecks, CallSetsAsAbaqusDoesFromOutside) {
  const std::string text = flat(k_parts);
  EXPECT_THAT(text, HasSubstr("*NSET, NSET=R1.END, GENERATE\n7, 8, 1\n")) << "its name in front";
  EXPECT_THAT(text, HasSubstr("*SURFACE, NAME=R2.FACE, TYPE=NODE\nR2.END, 1.\n1007, \n"));
  EXPECT_THAT(text, HasSubstr("*NSET, NSET=HELD\n1007, R2.END\n"));
  EXPECT_THAT(text, HasSubstr("*RIGID BODY, NSET=R2.ALL, REF NODE=8\n")) << "the one node of the set";
}

TEST_F(FlatDecks, PutSupportsAndSpringsInCalculixTerms) {
  const std::string text = flat(k_parts);
  EXPECT_THAT(text, HasSubstr("*BOUNDARY\nHELD, 1, 3\n7, 1, 1\n7, 5, 6\n2001, 2, 3\n"));
  EXPECT_THAT(text, HasSubstr("*SPRING, ELSET=LINK\n1, 1\n1000.\n"));
}

TEST_F(FlatDecks, CoupleDisplacementsAlone) {
  const std::string coupling = "*Coupling, constraint name=C, ref node=R1.7, surface=R2.Face\n*Kinematic\n";
  EXPECT_THAT(flat(edited("*End Assembly", coupling + "*End Assembly")),
              HasSubstr("REF NODE=7, SURFACE=R2.FACE\n*KINEMATIC\n1, 3\n"));
  EXPECT_THAT(flat(edited("*End Assembly", coupling + "2, 2\n3, 6\n4, 4\n*End Assembly")),
              HasSubstr("*KINEMATIC\n2, 2\n3, 3\n*STEP"));
}

TEST_F(FlatDecks, LeaveOutRequestsOfOutputAndAskForDisplacements) {
  const std::string text = flat(k_parts);
  EXPECT_THAT(text, HasSubstr("*STEP\n*Frequency\n 3,\n*NODE FILE\nU\n*End Step\n"));
  EXPECT_THAT(text, Not(HasSubstr("Output")));
  EXPECT_THAT(text, Not(HasSubstr("Preprint")));
  EXPECT_TRUE(writes_displacements(deck(k_parts)));
}

TEST_F(FlatDecks, PutSectionsBehindMaterials) {
  const std::string text =
      flat(edited("*End Part", "*Shell General Section, elset=Line, material=M\n0.1, 5\n*End Part"));
  EXPECT_LT(text.find("*Material, name=M"), text.find("*SHELL SECTION, ELSET=R1.LINE, MATERIAL=M\n0.1, 5\n"));
  EXPECT_LT(text.find("*ELEMENT"), text.find("*Material, name=M"));
}

TEST_F(FlatDecks, NameElementsThatAreOthersInCalculix) {
  EXPECT_THAT(flat(edited("type=B31", "type=S3R")), HasSubstr("TYPE=S3\n"));
  EXPECT_THAT(flat(edited("type=B31", "type=S4R")), HasSubstr("TYPE=S4\n"));
  const std::string tetrahedra = edited("type=B31", "type=C3D10M");
  EXPECT_THAT(flat(tetrahedra), HasSubstr("TYPE=C3D10\n"));
  EXPECT_THAT(element_notes(deck(tetrahedra)), testing::Contains("Abaqus deck: C3D10M is solved as C3D10."));
}

/// Abaqus' rule: the preload counts where its step is geometrically nonlinear. CalculiX': where the modes' step is a
/// perturbation.
TEST_F(FlatDecks, KeepAPreloadWhereItsStepIsNonlinear) {
  const std::string loaded = "*Step, nlgeom=YES\n*Static\n*Cload\nTip, 1, 5.\n*End Step\n*Step, name=S";
  EXPECT_THAT(flat(edited("*Step, name=S", loaded)), HasSubstr("*Step, nlgeom=YES\n*Static\n*CLOAD\nTIP, 1, 5.\n"));
  EXPECT_THAT(flat(edited("*Step, name=S", loaded)), HasSubstr("*STEP, PERTURBATION\n*Frequency"));
  const std::string linear = "*Step, nlgeom=NO\n*Static\n*Cload\nTip, 1, 5.\n*End Step\n*Step, perturbation";
  EXPECT_THAT(flat(edited("*Step, name=S", linear)), Not(HasSubstr("CLOAD")));
  EXPECT_EQ(needs_earlier_steps(deck(edited("*Step, name=S", linear))), "");
  EXPECT_THAT(flat(edited("*Step, name=S", linear)), HasSubstr("*STEP\n*Frequency"));
}

TEST_F(FlatDecks, WarnOfElementsWithoutBendingStiffness) {
  EXPECT_THAT(element_notes(deck("*ELEMENT, TYPE=S4R, ELSET=A\n1, 1, 2, 3, 4\n")),
              testing::ElementsAre(HasSubstr("S4R has no stiffness in bending")));
}

TEST_F(FlatDecks, LeaveDecksOfCalculixAsTheyAre) {
  const std::string own = "*NODE\n1, 0, 0, 0\n*OUTPUT, FREQUENCY=2\n*STEP\n*FREQUENCY\n3\n*NODE OUTPUT\nU\n*END STEP\n";
  EXPECT_EQ(flat(own), own);
  EXPECT_TRUE(element_notes(deck(own)).empty());
}

TEST_F(FlatDecks, RefuseWhatHasNoPlaceThere) {
  EXPECT_THAT(refusal(edited("part=Rod", "part=Rot")),
              HasSubstr("rods.inp:15: *PART 'ROT' is not known here; did you mean 'ROD'?"));
  EXPECT_THAT(refusal(edited("*End Part", "*Orientation, name=O\n1,0,0,0,1,0\n*End Part")),
              HasSubstr("*ORIENTATION has a direction, and instance R2 is rotated"));
  EXPECT_THAT(refusal(edited("*End Part", "*Connector Section\n*End Part")),
              HasSubstr("rods.inp:13: *CONNECTOR SECTION inside a part is not read"));
  EXPECT_THAT(refusal(edited("*End Part\n", "")), HasSubstr("*ASSEMBLY inside of a PART"));
  EXPECT_THAT(refusal(edited(" 7, 1., 2.", " 7, one, 2.")), HasSubstr("rods.inp:4: 'one' is not a number"));
  EXPECT_THAT(refusal(edited("*Node\n 1, 0.", "*Node\n 2147483000, 0.")), HasSubstr("cannot be numbered through"));
  EXPECT_THAT(refusal(edited("*Node, nset=All", "*Node, system=C")),
              HasSubstr("does not take SYSTEM of *NODE, only NSET"));
  EXPECT_THAT(refusal(edited("nset=Tip, instance=R1", "nset=Tip, elset=Link")),
              HasSubstr("does not take ELSET of *NSET"));
  EXPECT_THAT(refusal(edited("ref node=Tip", "ref node=Held")), HasSubstr("REF NODE=HELD is no set of one node"));
  EXPECT_THAT(refusal(edited("10., 0., 0., 10., 0., 5., 90.", "1., 0., 0., 10.")), HasSubstr("needs seven numbers"));
}

TEST_F(FlatDecks, RefuseNodesThatAreNotThere) {
  EXPECT_THAT(refusal(edited("R1.8, 1", "R1.9, 1")), HasSubstr("instance R1 has no node 9"));
  EXPECT_THAT(refusal(edited("instance=R2\n 7,", "instance=R2\n 17,")), HasSubstr("instance R2 has no node 17"));
  EXPECT_THAT(refusal(edited("\n1, 2, 3\n", "\n4, 2, 3\n")), HasSubstr("the assembly has no node 4"));
}

TEST_F(FlatDecks, TellCardsOfPartsApart) {
  const std::string section = "*Shell Section, elset=Line, material=M\n0.1, 5\n*End Part\n";
  const CalculixDeck one = deck(edited("*End Part\n", section));
  EXPECT_EQ(find_calculix_numbers(one, "*SHELL SECTION:LINE:T").size(), 1U);
  EXPECT_EQ(find_calculix_numbers(one, "*SHELL SECTION:ROD.LINE:T").size(), 1U);
  EXPECT_THAT(list_calculix_targets(one), testing::Contains("*SHELL SECTION:ROD.LINE:T"));
  const CalculixDeck two = deck(edited("*End Part\n", section + "*Part, name=Bar\n" + section));
  EXPECT_THAT(test::message_of<InvalidInput>([&] { find_calculix_numbers(two, "*SHELL SECTION:LINE:T"); }),
              HasSubstr("there are BAR.LINE, ROD.LINE; name one"));
}

}  // namespace
}  // namespace mottle::formats
