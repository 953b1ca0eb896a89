// Tables of tests that are read: other programs' habits, gaps, columns that are not used, tests far from the model.
#include <gtest/gtest.h>

#include <cmath>

#include "support/study_folder.hpp"

namespace mottle::study {
namespace {

using test::edited;
using test::k_three_masses_tests;
using test::StudyFolder;
using testing::HasSubstr;

std::string replaced(std::string text, const std::string& part, const std::string& other) {
  for (std::size_t at = text.find(part); at != std::string::npos; at = text.find(part, at + other.size())) {
    text.replace(at, part.size(), other);
  }
  return text;
}

/// Each line of the good table as `change` puts it.
std::string each_line(const std::function<std::string(std::size_t number, const std::string&)>& change) {
  std::string text;
  const std::vector<std::string> lines = test::lines_of(k_three_masses_tests);
  for (std::size_t i = 0; i < lines.size(); ++i) text += change(i, lines[i]) + "\n";
  return text;
}

/// The good table with its frequencies times a factor.
std::string scaled(double factor) {
  std::vector<std::vector<double>> rows = test::numbers_of(k_three_masses_tests);
  for (auto& row : rows) {
    for (double& value : row) value *= factor;
  }
  return test::csv_text("f1,f2,f3", rows);
}

/// A result but for its notes, which tell of the table.
nlohmann::json numbers(nlohmann::json result) {
  result.erase("notes");
  return test::untimed(std::move(result));
}

TEST(TestTable, IsTheSameInTheHabitsOfOtherPrograms) {
  StudyFolder folder;
  const nlohmann::json expected = numbers(folder.update());
  const std::string good = k_three_masses_tests;
  for (const auto& [habit, table] : std::vector<std::pair<std::string, std::string>>{
           {"semicolons", replaced(good, ",", ";")},
           {"tabs", replaced(good, ",", "\t")},
           {"Windows line ends", replaced(good, "\n", "\r\n")},
           {"a byte order mark", "\xef\xbb\xbf" + good},
           {"comments and empty lines", "# measured in May\n\n" + edited(good, {{"\n0.165", "\n# next day\n0.165"}})},
           {"units in the header", edited(good, {{"f1,f2,f3", "f1_Hz,f2 [Hz],f3 (Hz)"}})},
           {"quoted cells",
            each_line([](std::size_t, const std::string& line) { return "\"" + replaced(line, ",", "\",\"") + "\""; })},
           {"columns in another order", each_line([](std::size_t, const std::string& line) {
              const std::vector<std::string> cells = test::split(line, ',');
              return cells[2] + "," + cells[1] + "," + cells[0];
            })},
           {"no line end at the end", good.substr(0, good.size() - 1)},
       }) {
    SCOPED_TRACE(habit);
    folder.write("tests.csv", table);
    EXPECT_EQ(numbers(folder.update()), expected);
  }
}

TEST(TestTable, MayHaveGaps) {
  StudyFolder folder;
  folder.write("tests.csv", edited(k_three_masses_tests, {{"0.3080098662667982", ""}, {"0.44854953970272743", "nan"}}));
  const nlohmann::json outputs = folder.update()["outputs"];
  EXPECT_EQ(outputs["test_count"], nlohmann::json({6, 5, 5}));
  double sum = 0.0;
  const auto rows = test::numbers_of(k_three_masses_tests);
  for (std::size_t i = 0; i < rows.size(); ++i) sum += i == 1 ? 0.0 : rows[i][1];
  EXPECT_NEAR(outputs["test_mean"][1].get<double>(), sum / 5.0, 1e-15);
}

TEST(TestTable, HasItsUnusedColumnsNoted) {
  StudyFolder folder;
  folder.write("tests.csv", each_line([](std::size_t number, const std::string& line) {
                 return line + (number == 0 ? ",f4,k1,specimen" : fmt::format(",0.6,1.0,S{}", number));
               }));
  const nlohmann::json notes = folder.update()["notes"];
  EXPECT_TRUE(std::any_of(notes.begin(), notes.end(), [](const nlohmann::json& note) {
    const std::string text = note;
    return text.find("f4") != std::string::npos && text.find("k1") != std::string::npos;
  })) << notes;
}

TEST(TestTable, MayBeFarFromTheModelByAStiffnessThatIsTrulyDouble) {
  StudyFolder folder;
  folder.write("tests.csv", scaled(std::sqrt(2.0)));
  EXPECT_NO_THROW(folder.update());
}

TEST(TestTable, MayBeFarFromTheModelByAFactorNearTwoPiThatThePriorGives) {
  const StudyFolder folder;
  const std::string good = test::k_three_masses_study;
  folder.write("study.toml",
               good.substr(0, good.find("[[parameter]]")) +
                   "[[parameter]]\nname = \"k\"\ntarget = [\"spring:k1\", \"spring:k2\", \"spring:k3\", \"spring:k4\", "
                   "\"spring:k5\", \"spring:k6\"]\nrelative = true\n"
                   "distribution = { kind = \"uniform\", lower = 0.02, upper = 1.0 }\n\n" +
                   good.substr(good.find("[outputs]")));
  folder.write("tests.csv", scaled(0.15));
  EXPECT_NO_THROW(folder.check());
}

TEST(TestTable, OfIdenticalSpecimensWithUnknownNoiseLeavesTheVerdictUndecided) {
  StudyFolder folder;
  const std::vector<std::string> lines = test::lines_of(k_three_masses_tests);
  folder.write("tests.csv", fmt::format("{}\n{}\n{}\n{}\n", lines[0], lines[1], lines[1], lines[1]));
  const nlohmann::json verdict = folder.update({.set = {"update.method=\"maximum-likelihood\""}})["verdict"];
  EXPECT_EQ(verdict["conclusion"], "undecided");
  EXPECT_THAT(test::sentences(verdict["not_tested"]), HasSubstr("the specimens are the same to the last digits"));
}

TEST(TestTable, OfCase2IsNotExplainedByItsModel) {
  StudyFolder folder;
  const std::filesystem::path example = std::filesystem::path(MOTTLE_SOURCE_DIR) / "examples/01-three-masses";
  for (const char* name : {"case2.toml", "specimens-case2.csv"}) folder.write(name, read_file(example / name));
  const nlohmann::json result = folder.update({.study = "case2.toml"});
  EXPECT_EQ(result["verdict"]["adequate"], false);
  EXPECT_EQ(result["parameters"]["at_bound"][1], "lower");
}

}  // namespace
}  // namespace mottle::study
