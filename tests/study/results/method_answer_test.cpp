// The answer of methods that ask another question than for a mean and a scatter, of whole studies.
#include <gtest/gtest.h>

#include "mottle/core/files.hpp"
#include "support/study_folder.hpp"

namespace mottle::study {
namespace {

using test::StudyFolder;
using testing::HasSubstr;
using testing::StartsWith;

std::string example(const std::string& name) {
  return read_file(std::filesystem::path(MOTTLE_SOURCE_DIR) / "examples/01-three-masses" / name);
}

/// The example with frequencies and shapes, whose model is right.
void write_shapes(StudyFolder& folder) {
  folder.write("study.toml", example("shapes.toml"));
  folder.write("specimens-shapes.csv", example("specimens-shapes.csv"));
}

std::string answer_of(StudyFolder& folder, const std::vector<std::string>& set) {
  return folder.update({.set = set})["verdict"]["answer"];
}

TEST(MethodAnswer, IsNoneWhereTheVerdictAndTheParametersAreTheAnswer) {
  EXPECT_TRUE(StudyFolder().update()["verdict"]["answer"].is_null());
}

TEST(MethodAnswer, OfBatchesNamesTheirSpecimensAndWhatTellsThemApart) {
  StudyFolder folder;
  write_shapes(folder);
  const std::vector<double> k1{1.50, 1.55, 1.62, 1.66, 1.70, 1.58, 2.60, 2.64, 2.70, 2.75, 2.67, 2.71};
  const std::vector<double> k2{2.04, 2.11, 1.95, 2.02, 1.89, 1.98, 2.03, 1.92, 2.08, 1.97, 2.10, 1.94};
  const std::vector<double> k5{1.97, 2.06, 2.02, 1.91, 2.04, 1.94, 1.99, 2.08, 1.93, 2.05, 1.96, 2.01};
  std::string points = "k1,k2,k5\n";
  for (std::size_t s = 0; s < k1.size(); ++s) points += fmt::format("{},{},{}\n", k1[s], k2[s], k5[s]);
  const test::WrittenTable cloud = folder.propagate(points);
  const std::string header = test::lines_of(example("specimens-shapes.csv")).front();
  std::vector<std::vector<double>> rows(k1.size());
  for (const std::string& name : test::split(header, ',')) {
    const std::vector<double> column = cloud.numbers(name);
    for (std::size_t s = 0; s < rows.size(); ++s) rows[s].push_back(column[s]);
  }
  folder.write("specimens-shapes.csv", test::csv_text(header, rows));
  const std::string answer =
      answer_of(folder, {"update.method=\"mixture\"", "update.mixture.components=2", "update.samples=200"});
  EXPECT_THAT(answer, StartsWith("The specimens were divided into 2 batches, as the study asks."));
  EXPECT_THAT(answer, HasSubstr("specimens 1 to 6"));
  EXPECT_THAT(answer, HasSubstr("specimens 7 to 12"));
  EXPECT_THAT(answer, HasSubstr("They differ most in k1: means "));
}

TEST(MethodAnswer, OfABoxNamesTheOutputsThatItDoesNotCoverAndTheSpecimensOutside) {
  StudyFolder folder;
  folder.write("study.toml", example("case1.toml"));
  folder.write("specimens-case1.csv", example("specimens-case1.csv"));
  const nlohmann::json result = folder.update({.set = {"update.method=\"interval\""}});
  ASSERT_EQ(result["interval"]["outside"], nlohmann::json::array({1, 4}));
  EXPECT_EQ(
      result["verdict"]["answer"],
      "The box covers the bounds of 1 of 3 outputs, and not those of f2, f3. The parameters that fit specimens 1, 4 "
      "alone lie outside it.");
}

TEST(MethodAnswer, OfAPosteriorSaysWhetherTheChainsMixedAndWhichParametersItTies) {
  StudyFolder folder;
  write_shapes(folder);
  const nlohmann::json result = folder.update({.set = {"update.method=\"bayes\"", "update.bayes.particles=200"}});
  const std::string answer = result["verdict"]["answer"];
  EXPECT_THAT(answer,
              StartsWith(result["status"] == "converged" ? "The chains mixed: R-hat is at most 1." : "The chains "));
  EXPECT_THAT(answer, HasSubstr("8 chains of 200 draws are worth "));
  EXPECT_EQ(answer.find("correlated") != std::string::npos, [&] {
    double largest = 0.0;
    const nlohmann::json& correlation = result["parameters"]["correlation"];
    for (std::size_t i = 0; i < correlation.size(); ++i) {
      for (std::size_t j = 0; j < i; ++j) largest = std::max(largest, std::abs(correlation[i][j].get<double>()));
    }
    return largest >= 0.9;
  }());
}

TEST(MethodAnswer, OfSimulationsHasTheAcceptedFractionAndTheTolerance) {
  StudyFolder folder;
  write_shapes(folder);
  const nlohmann::json result = folder.update({.set = {"update.method=\"abc\"", "update.samples=300"}});
  const nlohmann::json& last = result["abc"]["stages"].back();
  EXPECT_THAT(result["verdict"]["answer"].get<std::string>(),
              StartsWith(fmt::format("{} of {} simulated sets of tests were accepted (", last["accepted"].get<int>(),
                                     last["simulations"].get<int>())));
}

TEST(MethodAnswer, IsTheSecondLineOfTheTerminal) {
  StudyFolder folder;
  folder.write("study.toml", example("case1.toml"));
  folder.write("specimens-case1.csv", example("specimens-case1.csv"));
  const UpdateOutcome outcome = update(folder.study({.set = {"update.method=\"interval\""}}), {});
  const std::vector<std::string> lines = summarise(outcome, folder / "out").lines;
  EXPECT_THAT(lines[0], StartsWith("verdict: "));
  EXPECT_THAT(lines[1], StartsWith("  The box covers the bounds of 1 of 3 outputs"));
}

}  // namespace
}  // namespace mottle::study
