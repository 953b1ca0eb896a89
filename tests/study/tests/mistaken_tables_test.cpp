// What a table of tests may get wrong and is put right, or said: numbering, units, order, signs.
#include <gtest/gtest.h>

#include <numbers>

#include "support/study_refusals.hpp"

namespace mottle::study {
namespace {

using test::csv_text;
using test::StudyCall;
using test::StudyFolder;
using testing::ContainsRegex;
using testing::HasSubstr;
using testing::Not;

using Rows = std::vector<std::vector<double>>;

constexpr double k_two_pi = 2.0 * std::numbers::pi;

const std::vector<std::string>& good_lines() {
  static const std::vector<std::string> lines = [] {
    std::vector<std::string> all = test::lines_of(test::k_three_masses_tests);
    all.erase(all.begin());
    return all;
  }();
  return lines;
}

Rows good_rows() {
  return test::numbers_of(test::k_three_masses_tests);
}

Rows each_row(Rows rows, const std::function<std::vector<double>(const std::vector<double>&)>& change) {
  for (auto& row : rows) row = change(row);
  return rows;
}

/// The same three masses with the shapes of modes 1 and 2, simulated by examples/01-three-masses.
std::string specimens_with_shapes() {
  return read_file(std::filesystem::path(MOTTLE_SOURCE_DIR) / "examples/01-three-masses/specimens-shapes.csv");
}

/// A folder with a study of shapes and the specimens, each row changed.
void use_shapes(const StudyFolder& folder,
                const std::function<void(std::size_t number, std::vector<double>&)>& change) {
  folder.change({{"frequencies = [1, 2, 3]",
                  "frequencies = [1, 2, 3]\nshapes = { modes = [1, 2], dofs = [\"m1\", \"m2\", \"m3\"] }"}});
  const std::string specimens = specimens_with_shapes();
  Rows rows = test::numbers_of(specimens);
  for (std::size_t i = 0; i < rows.size(); ++i) change(i + 1, rows[i]);
  folder.write("tests.csv", csv_text(test::lines_of(specimens).front(), rows));
}

const std::function<void(std::size_t, std::vector<double>&)> k_unchanged = [](std::size_t, std::vector<double>&) {};

/// A quick update of the population.
StudyCall quick(const std::string& out = "out") {
  return {.out = out, .set = {"update.samples=50", "update.method=\"maximum-likelihood\""}};
}

// --- rows ---

TEST(MistakenTable, NumbersSpecimensByTheRowsOfTheFileWhereverTheyAreNamed) {
  StudyFolder folder;
  const auto& good = good_lines();
  std::vector<double> odd = good_rows()[4];
  for (double& value : odd) value *= 1.7;
  folder.write("tests.csv", fmt::format("f1,f2,f3\n{}\n,,\n{}\n\n{}\nnan,nan,nan\n# a remark\n{}\n{}\n{}\n", good[0],
                                        good[1], good[2], fmt::join(odd, ","), good[3], good[5]));
  const nlohmann::json result = folder.update(quick());
  EXPECT_EQ(result["specimens"]["numbers"], nlohmann::json({1, 3, 5, 7, 8, 9}));
  ASSERT_EQ(result["outliers"].size(), 1U);
  EXPECT_EQ(result["outliers"][0]["specimen"], 7);
  EXPECT_THAT(test::sentences(result["verdict"]["reasons"]), HasSubstr("Specimen 7 lies"));
  EXPECT_THAT(test::sentences(result["notes"]), HasSubstr("left out, 2: specimen 2, 6"));
  EXPECT_EQ(folder.table("out/tests.csv").texts("specimen"), (std::vector<std::string>{"1", "3", "5", "7", "8", "9"}));
}

TEST(MistakenTable, KeepsTheNumbersOfTheTestsThatAnUpdateWrote) {
  StudyFolder folder;
  const std::string table = test::k_three_masses_tests;
  const std::size_t second = table.find('\n', table.find('\n') + 1) + 1;
  folder.write("tests.csv", table.substr(0, second) + ",,\n" + table.substr(second));
  const nlohmann::json first = folder.update(quick());
  folder.write("tests.csv", folder.text("out/tests.csv"));
  const nlohmann::json again = folder.update(quick("again"));
  EXPECT_EQ(again["specimens"]["numbers"], nlohmann::json({1, 3, 4, 5, 6, 7}));
  EXPECT_EQ(again["parameters"]["mean"], first["parameters"]["mean"]);
}

TEST(MistakenTable, LetsASpecimenBeChosenByItsRow) {
  const StudyFolder folder;
  folder.write("tests.csv", test::edited(test::k_three_masses_tests, {{"f1,f2,f3\n", "f1,f2,f3\n,,\n"}}));
  const auto choosing = [](int specimen) {
    return StudyCall{
        .set = {"update.method=\"deterministic\"", fmt::format("update.deterministic.specimen={}", specimen)}};
  };
  EXPECT_NO_THROW(folder.check(choosing(2)));
  EXPECT_NO_THROW(folder.check(choosing(7)));
  EXPECT_THAT(folder.refusal(choosing(1)), HasSubstr("the tests have 2 to 7"));
  EXPECT_THAT(folder.refusal(choosing(8)), HasSubstr("the tests have 2 to 7"));
}

// --- units ---

TEST(MistakenTable, IsRefusedWithTheFactorWhereAColumnSaysRadiansPerSecond) {
  const StudyFolder folder;
  for (const std::string title : {"f2 [rad/s]", "f2_rad/s", "f2 (rad/s)"}) {
    folder.write("tests.csv", csv_text("f1," + title + ",f3", each_row(good_rows(), [](const auto& row) {
                                         return std::vector{row[0], k_two_pi * row[1], row[2]};
                                       })));
    EXPECT_THAT(folder.refusal(), HasSubstr("divide it by 2 pi")) << title;
  }
}

TEST(MistakenTable, IsDoubtedWhereOneColumnIsInAnotherUnit) {
  const StudyFolder folder;
  folder.write("tests.csv", csv_text("f1,f2,f3", each_row(good_rows(), [](const auto& row) {
                                       return std::vector{row[0], k_two_pi * row[1], row[2]};
                                     })));
  EXPECT_THAT(folder.check(), ContainsRegex(R"(warning: Columns that are farther from the model .*f2 \([0-9])"));
}

TEST(MistakenTable, IsDoubtedWhereNamedColumnsAreExchanged) {
  StudyFolder folder;
  folder.change({{"frequencies = [1, 2, 3]", "frequencies = [1, 2, 3]\ntracking = \"mac\""},
                 {"file = \"tests.csv\"", "file = \"tests.csv\"\npairing = \"named\""}});
  Rows rows;  // near the model's at the parameters' means
  for (int s = 0; s < 6; ++s) rows.push_back({0.2027 + 0.001 * s, 0.3499 + 0.003 * (s % 3), 0.4652 + 0.004 * (s % 2)});
  folder.write("tests.csv", csv_text("f1,f2,f3", rows));
  EXPECT_THAT(folder.check(), Not(HasSubstr("when they are exchanged")));
  for (auto& row : rows) std::swap(row[1], row[2]);
  folder.write("tests.csv", csv_text("f1,f2,f3", rows));
  EXPECT_THAT(folder.check(), HasSubstr("when they are exchanged, used as they are: f2 and f3."));
}

TEST(MistakenTable, IsDoubtedWhereItsFrequenciesAreEigenvalues) {
  StudyFolder folder;
  const auto squared = [](const std::vector<double>& row) {
    std::vector<double> values;
    for (const double f : row) values.push_back(std::pow(k_two_pi * f, 2));
    return values;
  };
  folder.write("tests.csv", csv_text("f1,f2,f3", each_row(good_rows(), squared)));
  EXPECT_THAT(folder.check(), HasSubstr("near (2 pi f)^2 of the model's, as eigenvalues are"));
  folder.write("tests.csv", csv_text("f1,f2,f3", each_row(good_rows(), [](std::vector<double> row) {
                                       for (double& f : row) f *= 1.3;
                                       return row;
                                     })));
  EXPECT_THAT(folder.check(), Not(HasSubstr("eigenvalues")));
}

TEST(MistakenTable, IsDoubtedWithTheUnitOfOneSpecimen) {
  const StudyFolder folder;
  Rows rows = good_rows();
  for (double& value : rows[3]) value *= k_two_pi;
  folder.write("tests.csv", csv_text("f1,f2,f3", rows));
  EXPECT_THAT(folder.check(), ContainsRegex("warning: Frequencies far from those of the other specimens.*"
                                            R"(f1 of specimen 4 \([^ ]+ times, as in rad/s\))"));
}

TEST(MistakenTable, HasItsDoubtsInTheUpdateAndItsResult) {
  StudyFolder folder;
  Rows rows = good_rows();
  std::swap(rows[3][0], rows[3][1]);
  folder.write("tests.csv", csv_text("f1,f2,f3", rows));
  const nlohmann::json result = folder.update({.set = {"update.samples=50"}});
  EXPECT_THAT(folder.told(), HasSubstr("warning: The model counts its modes by frequency"));
  EXPECT_THAT(test::sentences(result["notes"]), HasSubstr("specimen 4 (f1 > f2)"));
}

TEST(MistakenTable, IsNotDoubtedWhereItIsGood) {
  const StudyFolder folder;
  EXPECT_THAT(folder.check(), Not(HasSubstr("warning")));
  use_shapes(folder, k_unchanged);
  EXPECT_THAT(folder.check(), Not(HasSubstr("warning")));
}

// --- order ---

TEST(MistakenTable, MayHaveItsColumnsInAnyOrder) {
  StudyFolder folder;
  const nlohmann::json expected = folder.update(quick())["parameters"]["mean"];
  folder.write("tests.csv", csv_text("f3,f1,f2", each_row(good_rows(), [](const auto& row) {
                                       return std::vector{row[2], row[0], row[1]};
                                     })));
  EXPECT_EQ(folder.update(quick("again"))["parameters"]["mean"], expected);
}

TEST(MistakenTable, IsDoubtedWhereColumnsStandUnderOneAnothersNames) {
  const StudyFolder folder;
  folder.write("tests.csv", csv_text("f1,f2,f3", each_row(good_rows(), [](const auto& row) {
                                       return std::vector{row[1], row[0], row[2]};
                                     })));
  const std::string said = folder.check();
  EXPECT_THAT(said, HasSubstr("the frequencies of 6 of 6 specimens do not ascend so"));
  EXPECT_THAT(said, HasSubstr("test.pairing = \"frequency\" finds it"));
}

TEST(MistakenTable, OfShapesIsAskedForTheNamesWhereItHasNoHeader) {
  const StudyFolder folder;
  use_shapes(folder, k_unchanged);
  const std::string specimens = specimens_with_shapes();
  folder.write("tests.csv", specimens.substr(specimens.find('\n') + 1));
  EXPECT_THAT(folder.refusal(), HasSubstr("names its 9 columns: f1, f2, phi1:m1"));
}

// --- signs ---

TEST(MistakenTable, HasAModeThatIsUpsideDownInOneRowTurned) {
  StudyFolder folder;
  use_shapes(folder, k_unchanged);
  const nlohmann::json expected = folder.update(quick())["parameters"]["mean"];
  use_shapes(folder, [](std::size_t number, std::vector<double>& row) {
    for (std::size_t k = 3; number == 3 && k < 6; ++k) row[k] = -row[k];
  });
  EXPECT_THAT(folder.check(), HasSubstr("are turned, 1: specimen 3 mode 1"));
  EXPECT_EQ(folder.update(quick("again"))["parameters"]["mean"], expected);
}

TEST(MistakenTable, IsDoubtedWhereASensorIsUpsideDownInAllRows) {
  const StudyFolder folder;
  use_shapes(folder, [](std::size_t, std::vector<double>& row) {
    row[4] = -row[4];
    row[7] = -row[7];
  });
  const std::string said = folder.check();
  EXPECT_THAT(said, HasSubstr("warning: The shapes of 2 modes agree far better"));
  EXPECT_THAT(said, HasSubstr("if the sign of sensor m2 is reversed"));
}

TEST(MistakenTable, IsDoubtedWhereAComponentHasAWrongSignInOneRow) {
  const StudyFolder folder;
  use_shapes(folder, [](std::size_t number, std::vector<double>& row) {
    if (number == 5) row[4] = -row[4];
  });
  EXPECT_THAT(folder.check(), ContainsRegex(R"(used as they stand: specimen 5 mode 1 \(MAC 0\.[0-9]+\))"));
}

TEST(MistakenTable, IsRefusedWhereNoParameterMovesAnyOfItsOutputs) {
  StudyFolder folder;
  folder.write("tests.csv", "f1\n5.03\n5.04\n5.02\n5.05\n");
  folder.write("study.toml", R"([model]
kind = "mass-spring"
masses = { m1 = 1.0, m2 = 1.0 }
springs = [
  { name = "a", between = ["ground", "m1"], stiffness = 1000.0 },
  { name = "b", between = ["ground", "m2"], stiffness = 5000.0 },
]
[[parameter]]
name = "k"
target = "spring:b"
distribution = { kind = "normal", mean = 5000.0, std = 100.0 }
[outputs]
frequencies = [1]
[test]
file = "tests.csv"
repeatability = { f1 = 0.01 }
)");
  EXPECT_THAT(test::message_of<InvalidInput>([&] { folder.update(); }), HasSubstr("no parameter moves any of them"));
}

}  // namespace
}  // namespace mottle::study
