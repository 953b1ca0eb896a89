// The keys of result.json of an update, their shapes and what they agree with.
#include <gtest/gtest.h>

#include "mottle/study/jobs/study_objects.hpp"
#include "support/study_folder.hpp"

namespace mottle::study {
namespace {

using test::StudyFolder;
using testing::AnyOf;

/// The result of the study of three masses.
const nlohmann::json& good_result() {
  static const nlohmann::json result = StudyFolder().update();
  return result;
}

void expect_vector(const nlohmann::json& value, std::size_t size) {
  ASSERT_EQ(value.size(), size) << value;
  for (const nlohmann::json& entry : value) EXPECT_TRUE(entry.is_number()) << value;
}

void expect_matrix(const nlohmann::json& value, std::size_t rows, std::size_t columns) {
  ASSERT_EQ(value.size(), rows) << value;
  for (const nlohmann::json& row : value) expect_vector(row, columns);
}

void expect_sentences(const nlohmann::json& list) {
  EXPECT_FALSE(list.empty());
  for (const nlohmann::json& sentence : list) EXPECT_TRUE(sentence.get<std::string>().ends_with('.')) << sentence;
}

TEST(ResultJson, NamesVersionStudyMethodAndSeed) {
  const nlohmann::json& result = good_result();
  EXPECT_EQ(result["schema"], 1);
  EXPECT_EQ(result["mottle"], version());
  EXPECT_EQ(result["title"], "A study for tests");
  EXPECT_EQ(result["method"], "mares");
  EXPECT_EQ(result["seed"], 7);
  EXPECT_THAT(result["status"].get<std::string>(),
              AnyOf("converged", "max-iterations", "stalled", "stopped", "failed"));
  EXPECT_TRUE(result["message"].is_string());
}

TEST(ResultJson, HoldsPriorAndEstimateOfTheParameters) {
  const nlohmann::json& parameters = good_result()["parameters"];
  EXPECT_EQ(parameters["names"], nlohmann::json({"k1", "k2"}));
  for (const char* key : {"prior_mean", "prior_std", "mean", "std"}) expect_vector(parameters[key], 2);
  expect_matrix(parameters["covariance"], 2, 2);
  for (const char* key : {"mean_ci95", "std_ci95"}) {
    ASSERT_TRUE(parameters.contains(key));
    if (!parameters[key].is_null()) expect_matrix(parameters[key], 2, 2);
  }
  ASSERT_EQ(parameters["at_bound"].size(), 2U);
  for (const nlohmann::json& bound : parameters["at_bound"]) {
    EXPECT_TRUE(bound.is_null() || bound == "lower" || bound == "upper") << bound;
  }
  EXPECT_EQ(parameters["prior_mean"], nlohmann::json({2.0, 2.0}));
  EXPECT_EQ(parameters["scale"], nlohmann::json({"identity", "identity"}));
  for (std::size_t i = 0; i < 2; ++i) {
    EXPECT_EQ(parameters["prior"][i]["kind"], "normal");
    EXPECT_EQ(parameters["prior"][i]["mean"], 2.0);
    // The deviation is printed, the covariance is computed: the same to rounding.
    EXPECT_NEAR(std::pow(parameters["std"][i].get<double>(), 2), parameters["covariance"][i][i].get<double>(), 1e-15);
  }
}

TEST(ResultJson, HoldsMeansAndCovariancesOfTheOutputs) {
  const nlohmann::json& outputs = good_result()["outputs"];
  EXPECT_EQ(outputs["names"], nlohmann::json({"f1", "f2", "f3"}));
  EXPECT_EQ(outputs["units"], nlohmann::json({"Hz", "Hz", "Hz"}));
  EXPECT_EQ(outputs["test_count"], nlohmann::json({6, 6, 6}));
  for (const char* key : {"test_mean", "initial_mean", "final_mean"}) expect_vector(outputs[key], 3);
  for (const char* key : {"test_covariance", "initial_covariance", "final_covariance"}) {
    expect_matrix(outputs[key], 3, 3);
  }
}

TEST(ResultJson, HoldsEachIteration) {
  const nlohmann::json& iterations = good_result()["iterations"];
  for (std::size_t i = 0; i < iterations.size(); ++i) {
    const nlohmann::json& state = iterations[i];
    EXPECT_EQ(state["index"], i);
    EXPECT_TRUE(state["distance_euclidean"].is_number());
    EXPECT_TRUE(state["distance_mahalanobis"].is_number());
    expect_vector(state["parameter_mean"], 2);
    expect_vector(state["parameter_std"], 2);
    expect_vector(state["output_mean"], 3);
    expect_vector(state["output_std"], 3);
  }
}

TEST(ResultJson, HoldsTheAnalysisOfTheLastCloud) {
  const nlohmann::json& result = good_result();
  expect_matrix(result["regression"]["sensitivity"], 3, 2);
  expect_vector(result["regression"]["r_squared"], 3);
  EXPECT_TRUE(result["regression"]["condition"].is_number());
  expect_matrix(result["spearman"], 2, 3);
  for (const nlohmann::json& row : result["spearman"]) {
    for (const nlohmann::json& value : row) EXPECT_LE(std::abs(value.get<double>()), 1.0);
  }
  const nlohmann::json& size = result["sample_size"];
  EXPECT_EQ(size["alpha"], 0.05);
  EXPECT_EQ(size["n_test"], 6);
  EXPECT_EQ(size["n_model"], 200);
  EXPECT_TRUE(size["t_critical"].is_number());
  expect_vector(size["monte_carlo_error"], 3);
}

TEST(ResultJson, HoldsTheVerdictWithItsTestsAndReasons) {
  const nlohmann::json& verdict = good_result()["verdict"];
  EXPECT_EQ(verdict["conclusion"], "undecided");  // mares does not estimate the scatter
  EXPECT_TRUE(verdict["adequate"].is_null());
  EXPECT_EQ(verdict["level"], 0.05);
  EXPECT_FALSE(verdict["tests"].empty());
  for (const nlohmann::json& hypothesis : verdict["tests"]) {
    for (const char* key : {"name", "statistic", "critical", "p_value", "passed", "meaning"}) {
      EXPECT_TRUE(hypothesis.contains(key)) << key;
    }
  }
  expect_sentences(verdict["reasons"]);
  expect_sentences(verdict["not_tested"]);
}

TEST(ResultJson, HoldsIdentifiabilityAndCounts) {
  const nlohmann::json& result = good_result();
  EXPECT_EQ(result["identifiability"]["rank"], 2);
  expect_vector(result["identifiability"]["singular_values"], 2);
  EXPECT_TRUE(result["identifiability"]["unseen_directions"].empty());
  // And the mean, the point nearest to the tests, and two beside it for each parameter, for the test of the means.
  // Before it, the search for solutions: some ten steps from each of its starts.
  const int apart = result["model_evaluations"].get<int>() - 200 * static_cast<int>(result["iterations"].size()) - 6;
  EXPECT_GT(apart, result["search"]["starts"].get<int>());
  EXPECT_LT(apart, 20 * result["search"]["starts"].get<int>());
  EXPECT_TRUE(result["failed_evaluations"].empty());
  EXPECT_FALSE(result["timings_s"].empty());
  for (const auto& [phase, seconds] : result["timings_s"].items()) {
    if (phase == "finished") continue;
    EXPECT_GE(seconds.get<double>(), 0.0) << phase;
  }
  EXPECT_THAT(result["timings_s"]["finished"].get<std::string>(), testing::MatchesRegex("20..-..-..T..:..:..Z"));
  EXPECT_EQ(result["study_files"][0]["name"], "study.toml");
  EXPECT_EQ(result["study_files"][1]["name"], "tests.csv");
  EXPECT_EQ(result["study_files"][1]["digest"].get<std::string>().size(), 32U);
}

TEST(ResultJson, ShowsAFactorWithTheNumberThatItGives) {
  StudyFolder folder;
  folder.change(
      {{"target = \"spring:k1\"\ndistribution = { kind = \"normal\", mean = 2.0, std = 0.3 }\nbounds = [0.5, 3.0]",
        "target = [\"spring:k4\", \"spring:k5\"]\nrelative = true\n"
        "distribution = { kind = \"normal\", mean = 1.0, std = 0.3 }"},
       {"target = \"spring:k2\"\n", "target = [\"spring:k2\", \"spring:k6\"]\nrelative = true\n"},
       {"\"mares\"\nsamples", "\"perturbation\"\nsamples"}});
  const UpdateOutcome outcome = update(folder.study(), {});
  const nlohmann::json parameters = nlohmann::json::parse(result_text(outcome))["parameters"];
  EXPECT_EQ(parameters["factor_of"], nlohmann::json({1.0, nullptr}));  // k2 and k6 are different numbers
  EXPECT_EQ(parameters["factor_units"], nlohmann::json({"N/m", nullptr}));
  const std::string lines = fmt::format("{}\n", fmt::join(summarise(outcome, folder / "out").lines, "\n"));
  EXPECT_THAT(lines, testing::HasSubstr(fmt::format(" {:.5g} N/m\n", parameters["mean"][0].get<double>())));
  EXPECT_THAT(lines, testing::ContainsRegex("\nnext .in [^ ]+.: mottle [a-z]+ study.toml\n"));
}

TEST(UpdateSummary, NamesTheScatterThatAMethodDoesNotEstimate) {
  const StudyFolder folder;
  const auto said = [&](const std::string& method) {
    const Study study = folder.study({.set = {"update.method=\"" + method + "\""}});
    return fmt::format("{}", fmt::join(summarise(update(study, {}), "out").lines, "\n"));
  };
  EXPECT_THAT(said("mares"), testing::HasSubstr("std (Eq. 12)"));
  EXPECT_THAT(said("deterministic"), testing::HasSubstr("std (mean's)"));
  EXPECT_THAT(said("deterministic"), testing::Not(testing::HasSubstr("std, 95 %")));
  EXPECT_THAT(said("maximum-likelihood"), testing::Not(testing::HasSubstr("std (")));
}

}  // namespace
}  // namespace mottle::study
