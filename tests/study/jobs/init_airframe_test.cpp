// Studies that are proposed of the airframe of the examples and its tests.
#include <gtest/gtest.h>

#include <numbers>
#include <regex>
#include <set>

#include "support/study_airframe.hpp"
#include "support/study_proposals.hpp"

namespace mottle::study {
namespace {

using test::notes_of;
using test::ProposalFolder;
using test::proposed_outputs;
using test::proposed_targets;
using testing::HasSubstr;
using testing::IsSupersetOf;
using testing::Not;
using testing::UnorderedElementsAreArray;

const std::vector<int> k_elastic{7, 8, 9, 10, 11, 12, 13, 14, 15, 16};

/// The airframe and, as specimens.csv, its tests with mass-normalised shapes.
struct AirframeProposal : ProposalFolder {
  AirframeProposal() {
    folder.write("airframe.bdf", read_file(test::examples() / "02-airframe/airframe.bdf"));
    folder.write("specimens.csv", read_file(test::examples() / "02-airframe/specimens.csv"));
  }
};

/// The tests with their numbers changed by the name of their column, gaps as they are.
std::string with_numbers(const std::function<double(const std::string& name, double)>& change) {
  const test::WrittenTable table = test::table_of(read_file(test::examples() / "02-airframe/specimens.csv"));
  std::string text = fmt::format("{}\n", fmt::join(table.header, ","));
  for (const auto& row : table.rows) {
    std::vector<std::string> cells;
    for (std::size_t k = 0; k < row.size(); ++k) {
      cells.push_back(row[k].empty() ? "" : fmt::format("{}", change(table.header[k], std::stod(row[k]))));
    }
    text += fmt::format("{}\n", fmt::join(cells, ","));
  }
  return text;
}

/// The tests with modes numbered from 1 in the names of columns that fit `kind`.
std::string counted_from_one(const std::string& kind) {
  const std::string text = read_file(test::examples() / "02-airframe/specimens.csv");
  const std::size_t end = text.find('\n');
  const std::string header = text.substr(0, end);
  const std::regex number("\\b(" + kind + ")([0-9]+)");
  std::string counted;
  std::size_t last = 0;
  for (std::sregex_iterator found(header.begin(), header.end(), number), none; found != none; ++found) {
    counted += header.substr(last, static_cast<std::size_t>(found->position()) - last) + (*found)[1].str() +
               std::to_string(std::stoi((*found)[2].str()) - 6);
    last = static_cast<std::size_t>(found->position() + found->length());
  }
  return counted + header.substr(last) + text.substr(end);
}

TEST(ProposeStudy, OfTablesPairsByFrequencyWhateverTheirNumbers) {
  const AirframeProposal proposal;
  const InitOutcome expected = proposal.propose("airframe.bdf", {"specimens.csv"});
  EXPECT_EQ(expected.pairing, "named");
  EXPECT_EQ(proposed_outputs(expected), k_elastic);
  // Shapes of columns that count as the model does are outputs.
  EXPECT_THAT(expected.text, HasSubstr("pairing = \"named\""));
  EXPECT_THAT(expected.text,
              HasSubstr(R"(shapes = { modes = [8, 9, 11, 13], dofs = ["105:+Z", "111:+Z", "112:+Z", "303:+Z"] })"));
  EXPECT_THAT(expected.text, HasSubstr("Taken as mass-normalised"));
  EXPECT_NO_THROW(proposal.check());
  // Mass on either wing would move the same modes alike.
  const std::vector<std::string> targets = proposed_targets(expected);
  EXPECT_EQ(std::set<std::string>(targets.begin(), targets.end()).size(), targets.size());
  EXPECT_LT(std::ranges::count(targets, "CONM2:7001:M") + std::ranges::count(targets, "CONM2:7002:M"), 2);

  proposal.folder.write("b.csv", counted_from_one("f"));
  const InitOutcome again = proposal.propose("airframe.bdf", {"b.csv"});
  EXPECT_EQ(proposed_outputs(again), k_elastic);
  EXPECT_THAT(proposed_targets(again), UnorderedElementsAreArray(targets));  // without shapes, in another order
  EXPECT_NO_THROW(proposal.check());
}

// The eight numbers from which truth.toml of the example drew its aeroplanes, the tip masses as one parameter.
TEST(ProposeStudy, TakesTheNumbersThatMadeTheTests) {
  const AirframeProposal proposal;
  const InitOutcome found = proposal.propose("airframe.bdf", {"specimens.csv"});
  EXPECT_THAT(proposed_targets(found), IsSupersetOf({"MAT1:1:E", "PSHELL:1:T", "MAT1:3:E", "PBUSH:101:K4",
                                                     "PBUSH:101:K6", "PBUSH:102:K4", "PBUSH:103:K6", "CONM2:7001:M"}));
  EXPECT_THAT(found.text, HasSubstr(R"(target = ["CONM2:7001:M", "CONM2:7002:M"])"));
  EXPECT_THAT(found.text, HasSubstr("without it the tests' ln likelihood would be"));
}

// One aeroplane whose third frequency is 30 % low: it would make every other number's scatter look small.
TEST(ProposeStudy, ChoosesTheSameBesideAnOutlier) {
  const AirframeProposal proposal;
  const std::vector<std::string> expected = proposed_targets(proposal.propose("airframe.bdf", {"specimens.csv"}));
  int row = 0;
  proposal.folder.write("t.csv", with_numbers([&](const std::string& name, double value) {
                          if (name == "f7") ++row;
                          return name == "f9" && row == 2 ? 0.7 * value : value;
                        }));
  const InitOutcome found = proposal.propose("airframe.bdf", {"t.csv"});
  EXPECT_THAT(notes_of(found), HasSubstr("Specimens far from the others do not count in the choice of parameters: 2."));
  EXPECT_THAT(proposed_targets(found), IsSupersetOf({"PBUSH:101:K4", "PBUSH:101:K6", "PBUSH:103:K6"}));
  EXPECT_GE(proposed_targets(found).size() + 1, expected.size());
}

TEST(ProposeStudy, OfTablesThatCountOtherwiseLeavesOutShapesAndSaysSo) {
  const AirframeProposal proposal;
  proposal.folder.write("t.csv", counted_from_one("f|phi"));
  const InitOutcome found = proposal.propose("airframe.bdf", {"t.csv"});
  EXPECT_EQ(found.pairing, "frequency");
  EXPECT_THAT(notes_of(found), HasSubstr("f2 is the model's f8"));
  EXPECT_THAT(found.text, Not(HasSubstr("shapes = {")));
  EXPECT_NO_THROW(proposal.check());
}

TEST(ProposeStudy, TakesOutputsAndTargetsThatAreNamed) {
  const AirframeProposal proposal;
  const auto with = [](std::vector<int> modes, std::vector<std::string> targets) {
    InitSettings settings;
    if (!modes.empty()) settings.modes = std::move(modes);
    if (!targets.empty()) settings.targets = std::move(targets);
    return settings;
  };
  const InitOutcome found =
      proposal.propose("airframe.bdf", {"specimens.csv"}, with({7, 8, 10}, {"mat1:1:e", "PBUSH:101:K4"}));
  EXPECT_EQ(proposed_outputs(found), (std::vector<int>{7, 8, 10}));
  EXPECT_EQ(proposed_targets(found), (std::vector<std::string>{"MAT1:1:E", "PBUSH:101:K4"}));
  EXPECT_THAT(proposal.refusal("airframe.bdf", {}, with({}, {"MAT1:1:EE"})), HasSubstr("did you mean 'MAT1:1:E'?"));
  EXPECT_THAT(proposal.refusal("airframe.bdf", {}, with({77}, {})), HasSubstr("mode 77 cannot be an output"));
}

TEST(ProposeStudy, TakesShapesOfAnotherSizeByTheirDirections) {
  const AirframeProposal proposal;
  proposal.folder.write("t.csv", with_numbers([](const std::string& name, double value) {
                          return name.starts_with("phi") ? 50.0 * value : value;
                        }));
  EXPECT_THAT(proposal.propose("airframe.bdf", {"t.csv"}).text, HasSubstr("size = \"free\""));
  EXPECT_THAT(proposal.check(), HasSubstr("compared after scaling"));
}

TEST(ProposeStudy, RefusesTestsInAnotherUnit) {
  const AirframeProposal proposal;
  std::string frequencies;
  for (const std::string& line :
       test::lines_of(with_numbers([](const std::string&, double value) { return 2.0 * std::numbers::pi * value; }))) {
    std::vector<std::string> cells = test::split(line, ',');
    cells.resize(10);
    frequencies += fmt::format("{}\n", fmt::join(cells, ","));
  }
  proposal.folder.write("t.csv", frequencies);
  EXPECT_THAT(proposal.refusal("airframe.bdf", {"t.csv"}), HasSubstr("(rad/s)"));
}

TEST(ProposeStudy, OfUniversalFilesRuns) {
  AirframeProposal proposal;
  std::filesystem::copy(test::examples() / "05-uff-population/specimens", proposal.folder / "specimens");
  const InitOutcome found = proposal.propose("airframe.bdf", {"specimens"});
  EXPECT_EQ(found.pairing, "mac");
  EXPECT_EQ(found.specimens, 10);
  EXPECT_EQ(proposed_outputs(found), k_elastic);  // as truth.toml of the example made them
  for (const InitMode& mode : found.modes) {
    if (mode.doubt.empty()) {
      EXPECT_GT(mode.mac, 0.95);
    }
  }
  EXPECT_LE(proposed_targets(found).size(), 8U);  // two fewer than outputs
  EXPECT_THAT(notes_of(found), Not(HasSubstr("does not run")));
  EXPECT_NO_THROW(proposal.check());
  EXPECT_EQ(proposal.folder.update({.study = "s.toml", .set = {"update.samples=50"}})["status"], "converged");
}

}  // namespace
}  // namespace mottle::study
