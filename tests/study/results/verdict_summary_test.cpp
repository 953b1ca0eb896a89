// The first screen of a report, of whole studies: it must never sound better than what was found.
#include "study/results/verdict_summary.hpp"

#include <gtest/gtest.h>

#include <nlohmann/json.hpp>

#include "core/temporary_folder.hpp"
#include "mottle/core/files.hpp"
#include "mottle/core/shell_word.hpp"
#include "mottle/study/jobs/forward.hpp"
#include "mottle/study/jobs/update.hpp"
#include "study/results/next_steps.hpp"

namespace mottle::study {
namespace {

nlohmann::json result_of(const std::string& example, const std::vector<std::string>& assignments = {}) {
  const test::TemporaryFolder folder;
  const auto file = std::filesystem::path(MOTTLE_SOURCE_DIR) / "examples/01-three-masses" / example;
  write_results(update(read_study(file, {.assignments = assignments, .seed = std::nullopt}), {}), folder.path());
  return nlohmann::json::parse(read_file(folder / "result.json"));
}

TEST(VerdictSummary, OfAScatterThatIsNotReproducedSaysSo) {
  const nlohmann::json result = result_of("case4.toml");
  const nlohmann::json& verdict = result["verdict"];
  EXPECT_EQ(verdict["conclusion"], "undecided");
  EXPECT_EQ(verdict["headline"], "The scatter of the tests is not explained.");
  EXPECT_FALSE(verdict["is_reassuring"]);
  const std::string scatter = verdict["summary"][1];
  EXPECT_NE(scatter.find("f3's standard deviation in the updated model is 14 % of the tests'"), std::string::npos);
  EXPECT_NE(scatter.find("1 of 10 tests lie within the region"), std::string::npos);
  EXPECT_NE(scatter.find("Method 'mares' does not estimate the scatter."), std::string::npos);
  EXPECT_FALSE(result["agreement"]["is_scatter_reproduced"]);
  EXPECT_EQ(result["agreement"]["outputs"][0]["name"], "f3");
  // Ten specimens do not tell the means of k1 and k2 better than the prior does.
  const nlohmann::json& findings = result["parameters"]["findings"];
  EXPECT_EQ(findings[0]["mark"], "not-seen");
  EXPECT_EQ(findings[1]["mark"], "not-seen");
  EXPECT_EQ(findings[2]["mark"], "mean-only");
}

TEST(VerdictSummary, NamesAMethodThatEstimatesTheScatterAsTheNextCommand) {
  EXPECT_EQ(result_of("case4.toml")["verdict"]["next"][0]["command"],
            "mottle update case4.toml --set 'update.method=\"maximum-likelihood\"'");
}

TEST(VerdictSummary, AsksForMoreOutputsWhereParametersCanMatchAnyMeans) {
  const nlohmann::json result = result_of("case1.toml", {R"(update.method="maximum-likelihood")"});
  EXPECT_EQ(result["verdict"]["next"][0]["command"], "mottle check case1.toml");
  const nlohmann::json tested = result_of("shapes.toml");
  EXPECT_NE(tested["verdict"]["next"][0]["command"], "mottle check shapes.toml");
}

TEST(VerdictSummary, OfARefusedModelDoubtsEveryParameterThatNoBoundStopped) {
  const nlohmann::json result = result_of("case2.toml");
  EXPECT_EQ(result["verdict"]["conclusion"], "inadequate");
  EXPECT_EQ(result["verdict"]["headline"], "The model does not explain the tests.");
  EXPECT_EQ(result["verdict"]["next"][0]["command"], "mottle diagnose case2.toml");
  const nlohmann::json& findings = result["parameters"]["findings"];
  EXPECT_EQ(findings[0]["mark"], "doubtful");
  EXPECT_EQ(findings[1]["mark"], "at-bound");
  EXPECT_NE(findings[1]["reason"].get<std::string>().find("lower bound, 0.5"), std::string::npos);
}

TEST(VerdictSummary, ReassuresWhereEverythingWasTestedAndIsReproduced) {
  const nlohmann::json result = result_of("shapes.toml");
  EXPECT_EQ(result["verdict"]["conclusion"], "adequate");
  EXPECT_TRUE(result["verdict"]["is_reassuring"]);
  for (const nlohmann::json& finding : result["parameters"]["findings"]) EXPECT_EQ(finding["mark"], "found");
  const std::string assumptions = result["verdict"]["summary"][2];
  EXPECT_EQ(assumptions.rfind("Assumed: specimens are independent", 0), 0U);
}

TEST(VerdictSummary, OfAnUnfinishedUpdateAsksForMoreIterations) {
  const nlohmann::json result = result_of("case1.toml", {"update.iterations=3"});
  EXPECT_EQ(result["verdict"]["next"][0]["command"], "mottle update case1.toml --set update.iterations=6");
  EXPECT_EQ(result["parameters"]["findings"][0]["mark"], "doubtful");
}

TEST(VerdictSummary, SensitivityInPercentIsThatOfTheLogarithms) {
  // All stiffnesses times 1.01 raise every frequency by half a percent; k1, k2 and k5 alone raise it by less.
  const nlohmann::json result = result_of("shapes.toml");
  const nlohmann::json& regression = result["regression"];
  const double x = result["parameters"]["mean"][0];
  const double y = result["outputs"]["final_mean"][0];
  const double slope = regression["sensitivity"][0][0];
  EXPECT_NEAR(regression["percent_per_percent"][0][0].get<double>(), slope * x / y, 0.02 * slope * x / y);
  double sum = 0.0;
  for (const nlohmann::json& share : regression["percent_per_percent"][0]) sum += share.get<double>();
  EXPECT_GT(sum, 0.0);
  EXPECT_LT(sum, 0.5);
}

TEST(NextSteps, QuoteAWordThatAShellWouldTakeApart) {
  EXPECT_EQ(shell_word("case4.toml"), "case4.toml");
  EXPECT_EQ(shell_word("my study.toml"), "'my study.toml'");
  EXPECT_EQ(shell_word("it's.toml"), "'it'\\''s.toml'");
  EXPECT_EQ(shell_word("$(rm).toml"), "'$(rm).toml'");
}

TEST(Propagation, SaysWhatNinetyFivePercentOfTheSamplesLieWithinAndWhatToRunNext) {
  const test::TemporaryFolder folder;
  const auto file = std::filesystem::path(MOTTLE_SOURCE_DIR) / "examples/01-three-masses/case1.toml";
  write_results(propagate(read_study(file), std::nullopt, {}), folder.path());
  const nlohmann::json result = nlohmann::json::parse(read_file(folder / "result.json"));
  const nlohmann::json& outputs = result["outputs"];
  const double mean = outputs["initial_mean"][0];
  const double deviation = std::sqrt(outputs["initial_covariance"][0][0].get<double>());
  // Nearly normal: the ends are about two standard deviations off.
  EXPECT_NEAR(outputs["interval95"][0][0].get<double>(), mean - 1.96 * deviation, 0.25 * deviation);
  EXPECT_NEAR(outputs["interval95"][0][1].get<double>(), mean + 1.96 * deviation, 0.25 * deviation);
  EXPECT_NEAR(outputs["coefficient_of_variation"][0].get<double>(), deviation / mean, 1e-12);
  EXPECT_EQ(result["next"][0]["command"], "mottle update case1.toml");
}

}  // namespace
}  // namespace mottle::study
