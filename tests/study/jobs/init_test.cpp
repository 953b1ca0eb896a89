// Studies that are proposed of small decks: units, pairs, numbers that the outputs cannot tell apart.
#include "mottle/study/jobs/init.hpp"

#include <gtest/gtest.h>

#include <cmath>

#include "support/study_proposals.hpp"

namespace mottle::study {
namespace {

using test::edited;
using test::k_cantilever_deck;
using test::notes_of;
using test::ProposalFolder;
using test::proposed_outputs;
using test::reason_against;
using testing::ContainsRegex;
using testing::HasSubstr;
using testing::Not;

// A mass on a spring along X and one along Y, and two oscillators far above.
const std::string k_repeated =
    "SOL 103\nCEND\nMETHOD = 10\nSPC = 1\nBEGIN BULK\nEIGRL,10,,,4\nGRID,1,,0.,0.,0.\nSPC1,1,3456,1\nPELAS,1,1000.\n"
    "PELAS,2,1000.\nCELAS1,1,1,1,1\nCELAS1,2,2,1,2\nCONM2,3,1,,2.\nSPOINT,11,12\nCELAS2,11,9000.,11\nCMASS2,12,1.,11\n"
    "CELAS2,21,30000.,12\nCMASS2,22,1.,12\nENDDATA\n";
const std::string k_repeated_tests = "f1,f2,f3,f4\n3.50,3.60,15.1,27.1\n3.51,3.64,15.4,27.3\n3.58,3.67,15.2,27.6\n";

TEST(ProposeStudy, SaysThatItsUnitsAreGuessed) {
  const ProposalFolder proposal;
  proposal.folder.write("beam.bdf", k_cantilever_deck);
  const InitOutcome guessed = proposal.propose("beam.bdf");
  EXPECT_EQ(guessed.settings.units, "mm-t-s");
  EXPECT_EQ(nlohmann::json::parse(summarise(guessed).json)["units"], "mm-t-s");
  EXPECT_THAT(guessed.text, HasSubstr("units = \"mm-t-s\"   # GUESSED from E = 7e+04 MPa"));
  EXPECT_EQ(proposal.propose("beam.bdf", {}, {.model = {}, .units = "SI"}).settings.units, "SI");
}

TEST(ProposeStudy, PropagatesWithoutTests) {
  ProposalFolder proposal;
  proposal.folder.write("beam.bdf", k_cantilever_deck);
  EXPECT_THAT(proposal.propose("beam.bdf").text, HasSubstr("UNKNOWN: no tests were given"));
  EXPECT_EQ(proposal.folder.propagate(std::nullopt, {.study = "s.toml", .set = {"update.samples=20"}}).rows.size(),
            20U);
}

TEST(ProposeStudy, CallsNumbersThatSplitOneFrequencyNotAlike) {
  const ProposalFolder proposal;
  proposal.folder.write("repeated.bdf", k_repeated);
  proposal.folder.write("tests.csv", k_repeated_tests);
  const InitOutcome found = proposal.propose("repeated.bdf", {"tests.csv"});
  for (const char* target : {"PELAS:1:K", "PELAS:2:K"}) {
    EXPECT_THAT(reason_against(found, target), Not(HasSubstr("hardly tell")));
  }
  // Of one oscillator.
  EXPECT_THAT(reason_against(found, "CELAS2:21:K") + reason_against(found, "CMASS2:22:M"),
              HasSubstr("hardly tell it from"));
  EXPECT_THAT(notes_of(found), HasSubstr("any combination is a mode: f1, f2."));
}

// One spring property in both directions, and the mass: whatever combination, f1 and f2 move together.
TEST(ProposeStudy, CallsNumbersThatMoveOneFrequencyAsAWholeAlike) {
  const ProposalFolder proposal;
  proposal.folder.write("repeated.bdf",
                        edited(k_repeated, {{"CELAS1,2,2,1,2", "CELAS1,2,1,1,2"}, {"PELAS,2,1000.\n", ""}}));
  proposal.folder.write("tests.csv", k_repeated_tests);
  const InitOutcome found =
      proposal.propose("repeated.bdf", {"tests.csv"}, {.model = {}, .targets = std::vector<std::string>{"PELAS:1:K"}});
  EXPECT_EQ(reason_against(found, "CONM2:3:M"), "the outputs can hardly tell it from K_PELAS_1");
}

TEST(ProposeStudy, TellsTheUnitFromShapesThatAgree) {
  const ProposalFolder proposal;
  proposal.folder.write("chain.bdf", test::k_chain_deck);
  const std::string shapes = "1:+X,9.2975,14.7955,-26.356\n2:+X,14.637,11.923,11.963\n3:+X,17.97,-18.17,-3.90\n";
  for (const auto& [factor, question] : {std::pair{6.2832, "are the tests in rad/s? Divide them by 2 pi."},
                                         {1000.0, "--units names others"},
                                         {60.0, "are the tests in 1/min (rpm)?"}}) {
    for (const int k : {1, 2}) {
      std::string table = "dof";
      for (const double frequency : {1.90, 5.78, 8.98}) {
        table += fmt::format(",{:.6g}", factor * (frequency + 0.01 * k));
      }
      proposal.folder.write(fmt::format("t{}.csv", k), table + "\n" + shapes);
    }
    const std::string said = proposal.refusal("chain.bdf", {"t1.csv", "t2.csv"});
    EXPECT_THAT(said, HasSubstr("in the 3 modes whose shapes are those of the model the frequencies are"));
    EXPECT_THAT(said, HasSubstr(question));
    EXPECT_THAT(said, Not(HasSubstr("by chance")));
  }
}

TEST(ProposeStudy, RefusesTestsThatAreNoModesOfTheModel) {
  const ProposalFolder proposal;
  proposal.folder.write("beam.bdf", k_cantilever_deck);
  proposal.folder.write("far.csv", "f1,f2\n1e6,2e6\n1.1e6,2.1e6\n");
  EXPECT_THAT(proposal.refusal("beam.bdf", {"far.csv"}),
              HasSubstr("no mode of the model is found in the tests beyond doubt"));
}

// A cantilever of nearly equal sides has each bending mode twice, 20 % apart; the tests' lowest is midway.
TEST(ProposeStudy, SaysThatModesAreAtEqualDistance) {
  const ProposalFolder proposal;
  proposal.folder.write("square.bdf", edited(k_cantilever_deck, {{"20.,30.", "20.,24."}}));
  std::vector<double> f;
  for (const InitMode& mode : proposal.propose("square.bdf").modes) f.push_back(mode.model);
  const double midway = std::sqrt(f[0] * f[1]);
  std::vector<std::vector<double>> rows;
  for (const double x : {1.0, 1.001}) rows.push_back({midway * x, f[2] * x, f[3] * x});
  proposal.folder.write("t.csv", test::csv_text("f1,f2,f3", rows));
  const InitOutcome found = proposal.propose("square.bdf", {"t.csv"});
  EXPECT_EQ(proposed_outputs(found), (std::vector<int>{2, 3, 4}));
  EXPECT_THAT(found.text, ContainsRegex("f2 .*DOUBTFUL: f1 at [^ ]+ is as near"));
  // Where nothing at all tells the two apart, the pair is no output.
  proposal.folder.write("one.csv", test::csv_text("f1", {{midway * 0.999}, {midway * 1.001}}));
  EXPECT_THAT(proposal.refusal("square.bdf", {"one.csv"}), HasSubstr("is as near"));
}

// Whatever is unknown is refused, all of it in one message; filled in, it runs.
TEST(ProposeStudy, MarksTheUnknownsOfASolversInput) {
  const ProposalFolder proposal;
  const std::filesystem::path example = std::filesystem::path(MOTTLE_SOURCE_DIR) / "examples/04-any-solver";
  for (const char* name : {"tower.inp.in", "tower.py", "specimens.csv"}) {
    proposal.folder.write(name, read_file(example / name));
  }
  const InitOutcome found = proposal.propose("tower.inp.in", {"specimens.csv"});
  EXPECT_EQ(found.kind, "command");
  std::vector<std::string> names;
  for (const InitParameter& parameter : found.parameters) names.push_back(parameter.name);
  EXPECT_EQ(names, (std::vector<std::string>{"m_roof", "k_base", "k_upper"}));
  EXPECT_EQ(proposed_outputs(found), (std::vector<int>{1, 2, 3, 4}));
  std::string text = found.text;
  const std::string said = proposal.folder.refusal({.study = "s.toml"});
  const auto line = [&](const std::string& part) { return test::line_of(text, part); };
  EXPECT_THAT(said, HasSubstr(fmt::format("s.toml:{}: model.command[0] still says UNKNOWN", line("command = "))));
  EXPECT_THAT(said, HasSubstr(fmt::format("model.frequencies.file (line {})", line("file = \"UNKNOWN\""))));
  EXPECT_THAT(said, HasSubstr(fmt::format("model.frequencies.column (line {})", line("column = \"UNKNOWN\""))));
  for (int number = 0; number < 3; ++number) {
    EXPECT_THAT(said, HasSubstr(fmt::format("parameter[{}].distribution.mean (line ", number)));
  }
  const std::string unknown = R"(mean = "UNKNOWN", std = "UNKNOWN")";
  for (const auto& [old, known] : std::vector<std::pair<std::string, std::string>>{
           {R"(["UNKNOWN", "tower.inp"])", R"(["python3", "tower.py", "tower.inp"])"},
           {"file = \"UNKNOWN\" ", "file = \"tower.out\" "},
           {unknown, "mean = 2e4, std = 2e3"},
           {unknown, "mean = 4e7, std = 8e6"},
           {unknown, "mean = 4e7, std = 8e6"},
           {"# files = [\"mesh.inc\"] ", "files = [\"tower.py\"] "},
           {"line = 1 ", "after = \"NATURAL FREQUENCIES\"\nline = 3 "}}) {
    ASSERT_NE(text.find(old), std::string::npos) << old;
    text.replace(text.find(old), old.size(), known);
  }
  const auto with_column = [&](int column) {
    proposal.folder.write("s.toml", edited(text, {{"column = \"UNKNOWN\" ", fmt::format("column = {} ", column)}}));
    return proposal.check();
  };
  EXPECT_THAT(with_column(1), HasSubstr("as if the column of the modes' numbers had been read"));
  const std::string checked = with_column(3);
  EXPECT_THAT(checked, Not(HasSubstr("numbers had been read")));
  EXPECT_THAT(checked, ContainsRegex("one model run took [0-9.]+ s"));
  EXPECT_THAT(checked,
              ContainsRegex("the update would take about [0-9]+ runs, some [0-9]+ (s|min) with [0-9]+ at a time"));
}

}  // namespace
}  // namespace mottle::study
