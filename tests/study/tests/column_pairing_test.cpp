// Tables of frequencies paired with the model's modes, and what is said of doubtful numbers.
#include <gtest/gtest.h>

#include <numbers>

#include "support/study_refusals.hpp"

namespace mottle::study {
namespace {

using test::k_three_masses_tests;
using test::StudyFolder;
using test::TextChange;
using testing::ContainsRegex;
using testing::HasSubstr;
using testing::Not;

const TextChange k_by_frequency{"file = \"tests.csv\"\n", "file = \"tests.csv\"\npairing = \"frequency\"\n"};

/// The good table with its columns in another order under another header; without a header where that is empty.
std::string rearranged(const std::string& header, const std::vector<std::size_t>& columns) {
  std::string table = header.empty() ? "" : header + "\n";
  for (const auto& row : test::table_of(k_three_masses_tests).rows) {
    std::vector<std::string> cells;
    for (const std::size_t column : columns) cells.push_back(row[column]);
    table += fmt::format("{}\n", fmt::join(cells, ","));
  }
  return table;
}

/// What is said of tests and a study with changes.
std::string said_of(const std::string& table, const std::vector<TextChange>& changes) {
  const StudyFolder folder;
  folder.change(changes);
  folder.write("tests.csv", table);
  return folder.check();
}

std::string refusal_of(const std::string& table, const std::vector<TextChange>& changes) {
  const StudyFolder folder;
  folder.change(changes);
  folder.write("tests.csv", table);
  return folder.refusal();
}

TEST(PairColumns, GivesTheSameNumbersInAnotherOrderAndNumbering) {
  StudyFolder folder;
  const auto estimate = [&] {
    const nlohmann::json parameters = folder.update()["parameters"];
    return std::pair{parameters["mean"], parameters["std"]};
  };
  const auto expected = estimate();
  folder.change({k_by_frequency});
  for (const auto& [header, columns] :
       std::vector<std::pair<std::string, std::vector<std::size_t>>>{{"f1,f2,f3", {0, 1, 2}},
                                                                     {"f3_Hz,f9 [Hz],f12", {0, 1, 2}},
                                                                     {"f7,f2,f5", {2, 0, 1}},
                                                                     {"", {0, 1, 2}},
                                                                     {"", {1, 2, 0}}}) {
    SCOPED_TRACE(header);
    folder.write("tests.csv", rearranged(header, columns));
    EXPECT_EQ(estimate(), expected);
  }
}

TEST(PairColumns, SaysThePairs) {
  EXPECT_THAT(said_of(rearranged("f4,f5,f6", {0, 1, 2}), {k_by_frequency}),
              ContainsRegex(R"(f4 is the model's f1 \([+-][0-9]+\.[0-9] %\))"));
}

TEST(PairColumns, PassesOverAModeThatTheTestsMissed) {
  EXPECT_THAT(said_of(rearranged("f1,f2", {0, 2}), {k_by_frequency, {"[1, 2, 3]", "[1, 3]"}}),
              HasSubstr("f2 is the model's f3"));
}

TEST(PairColumns, NamesUnusedModesAsTheTestsDo) {
  const std::string said = said_of(rearranged("f4,f5,f6", {0, 1, 2}), {k_by_frequency, {"[1, 2, 3]", "[1, 3]"}});
  EXPECT_THAT(said, HasSubstr("not used, by the tests' own numbers: f5."));
  EXPECT_THAT(said, Not(HasSubstr("Columns of the test file that are not used")));
}

TEST(PairColumns, RefusesAnOutputWithoutPartner) {
  EXPECT_THAT(refusal_of(rearranged("f1,f2", {0, 2}), {k_by_frequency}), HasSubstr("output 'f2' has no column"));
}

TEST(PairColumns, AsksHowATableWithoutHeaderIsPaired) {
  const std::string table = rearranged("", {0, 1, 2});
  test::expect_message(refusal_of(table, {}),
                       {"tests.csv:1: has no line with the names of the columns", "pairing = \"frequency\""});
  EXPECT_NO_THROW(said_of(table, {{"file = \"tests.csv\"\n", "file = \"tests.csv\"\npairing = \"order\"\n"}}));
}

TEST(PairColumns, NotesNumbersThatFrequenciesContradict) {
  // Each column is more than 15 % away from the mode of its number and near the next one.
  const std::string table = rearranged("f1,f2", {1, 2});
  EXPECT_THAT(said_of(table, {{"[1, 2, 3]", "[1, 2]"}}),
              HasSubstr("outputs.frequencies = [2, 3] with test.pairing = \"frequency\" takes them so"));
  EXPECT_NO_THROW(said_of(table, {k_by_frequency, {"[1, 2, 3]", "[2, 3]"}}));
}

/// What is said of four oscillators of 5.033, 8.717, 15.099 and 20.000 Hz in the deck, the third of k3.
std::string said_of_oscillators(double mean, const std::string& table, const std::vector<TextChange>& changes = {}) {
  const StudyFolder folder;
  folder.write("model.bdf",
               "SOL 103\nCEND\nMETHOD = 10\nBEGIN BULK\nEIGRL,10,,,4\nSPOINT,1,2,3,4\nCELAS2,1,1000.,1\n"
               "CELAS2,2,3000.,2\nCELAS2,3,9000.,3\nCELAS2,4,15791.,4\nCMASS2,5,1.,1\nCMASS2,6,1.,2\nCMASS2,7,1.,3\n"
               "CMASS2,8,1.,4\nENDDATA\n");
  folder.write("study.toml",
               test::edited(fmt::format("[model]\nkind = \"nastran\"\nfile = \"model.bdf\"\n[[parameter]]\nname = "
                                        "\"k3\"\ntarget = \"CELAS2:3:K\"\ndistribution = {{ kind = \"normal\", mean = "
                                        "{}, std = 300 }}\n[outputs]\nfrequencies = [1, 2, 3]\n[test]\nfile = "
                                        "\"tests.csv\"\n",
                                        mean),
                            changes));
  folder.write("tests.csv", table);
  return folder.check();
}

TEST(PairColumns, DoubtsNoNumbersWhereThePriorMeansAgree) {
  // 18.12 Hz is nearer to the deck's fourth mode; with the prior's mean of k3 the third has 18.118 Hz.
  const std::string table = "f1,f2,f3\n5.03,8.72,18.12\n5.035,8.725,18.2\n5.025,8.715,18.05\n";
  EXPECT_THAT(said_of_oscillators(12960, table), Not(HasSubstr("Columns of the tests")));
  EXPECT_THAT(said_of_oscillators(9000, table), HasSubstr("By frequency f3 (18.12 Hz) is mode 4 (20), not 3 (15.1)."));
}

TEST(PairColumns, NamesOnlyColumnsThatDifferAndGivesAdviceThatWorks) {
  const std::string table = "f1,f2,f3\n5.03,8.72,20.1\n5.035,8.725,20.2\n5.025,8.715,20.05\n";
  EXPECT_THAT(said_of_oscillators(9000, table),
              HasSubstr("By frequency f3 (20.12 Hz) is mode 4 (20), not 3 (15.1). outputs.frequencies = [1, 2, 4] with "
                        "test.pairing = \"frequency\" takes them so"));
  EXPECT_THAT(said_of_oscillators(9000, table, {k_by_frequency, {"[1, 2, 3]", "[1, 2, 4]"}}),
              HasSubstr("f3 is the model's f4"));
  const std::string permuted = "f1,f3,f2\n5.03,8.72,15.1\n5.035,8.725,15.2\n5.025,8.715,15.05\n";
  EXPECT_THAT(said_of_oscillators(9000, permuted), HasSubstr("test.pairing = \"frequency\" pairs them so"));
  EXPECT_THAT(said_of_oscillators(9000, permuted, {k_by_frequency}), HasSubstr("f2 is the model's f3"));
}

TEST(TestTable, HasItsRowsOfOneSpecimenNamed) {
  std::string table = "specimen,f1,f2,f3\n";
  const std::vector<std::string> lines = test::lines_of(k_three_masses_tests);
  for (std::size_t k = 1; k < lines.size(); ++k) table += fmt::format("{},{}\n", 1 + (k - 1) / 2, lines[k]);
  const std::string said = said_of(table, {});
  EXPECT_THAT(said, HasSubstr("a specimen of its own: 1 in 2 rows, 2 in 2 rows, 3 in 2 rows."));
  EXPECT_THAT(said, Not(HasSubstr("as copies do")));
}

TEST(TestTable, HasItsCopiedRowsNamed) {
  // A gap is equal to a gap, 0.30800 to 0.308; a row with one value tells nothing.
  const std::string second = test::lines_of(k_three_masses_tests)[2];
  StudyFolder folder;
  folder.write("tests.csv", k_three_masses_tests + "0.16,0.308,\n0.16,0.30800,\n" + second + "\n0.161,,\n0.161,,\n");
  EXPECT_THAT(folder.check(), HasSubstr("as copies do: specimen 8 equals 7, specimen 9 equals 2. Each"));
  folder.update();
  EXPECT_THAT(folder.told(), HasSubstr("as copies do: specimen 8 equals 7"));
}

TEST(TestTable, OfEqualValuesHasNoScatter) {
  const StudyFolder folder;
  const std::string row = "0.1655,0.31,0.4484\n";  // the mean of three of these is not quite the number itself
  folder.write("tests.csv", "f1,f2,f3\n" + row + row + row);
  int seen = 0;
  for (const std::string& line : test::lines_of(folder.check_lines({.set = {"update.method=\"deterministic\""}}))) {
    if (!line.starts_with("f1 ") && !line.starts_with("f2 ") && !line.starts_with("f3 ")) continue;
    EXPECT_EQ(test::split(test::on_one_line(line), ' ').at(5), "0") << line;
    ++seen;
  }
  EXPECT_EQ(seen, 3);
}

TEST(PairColumns, PairsNoTestsInAnotherUnitWithOtherModes) {
  for (const auto& [factor, unit] : {std::pair{2.0 * std::numbers::pi, "rad/s"}, {60.0, "1/min"}, {0.001, "kHz"}}) {
    auto rows = test::numbers_of(k_three_masses_tests);
    for (auto& row : rows) {
      for (double& value : row) value *= factor;
    }
    EXPECT_THAT(refusal_of(test::csv_text("f1,f2,f3", rows), {k_by_frequency}), HasSubstr(fmt::format("({})", unit)));
  }
}

TEST(PairColumns, LeavesShapesToPairingByShape) {
  EXPECT_THAT(
      refusal_of("f1,phi1:m1,phi1:m2\n0.16,0.5,0.6\n0.17,0.5,0.6\n",
                 {k_by_frequency,
                  {"frequencies = [1, 2, 3]", "frequencies = [1]\nshapes = { modes = [1], dofs = [\"m1\", \"m2\"] }"}}),
      HasSubstr("say \"mac\""));
}

}  // namespace
}  // namespace mottle::study
