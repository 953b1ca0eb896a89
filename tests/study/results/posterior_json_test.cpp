// A posterior in the result of an update, in posterior.csv and in ArviZ's layout.
#include <gtest/gtest.h>

#include <cmath>
#include <numeric>
#include <set>

#include "support/study_refusals.hpp"

namespace mottle::study {
namespace {

using test::StudyFolder;
using test::TextChange;
using test::WrittenTable;
using testing::HasSubstr;

const std::string k_repeatability = "repeatability = { \"f*\" = 0.02 }\n";

/// The study of three masses by a method of posteriors, with changes.
std::string posterior_study(const std::string& method = "bayes", const std::vector<TextChange>& changes = {}) {
  return test::edited(test::three_masses({{"method = \"mares\"", "method = \"" + method + "\""},
                                          {"[update.mares]\nweighting = \"mahalanobis\"\n",
                                           "[update." + method + "]\nparticles = 200\n"},
                                          {"file = \"tests.csv\"\n", "file = \"tests.csv\"\n" + k_repeatability}}),
                      changes);
}

/// One update for all tests of its files.
struct PosteriorRun {
  PosteriorRun() {
    folder.write("study.toml", posterior_study());
    result = folder.update();
  }
  StudyFolder folder;
  nlohmann::json result;
};

const PosteriorRun& good_run() {
  static const PosteriorRun run;
  return run;
}

TEST(PosteriorFiles, HoldWhatTheResultSays) {
  const nlohmann::json& result = good_run().result;
  const nlohmann::json& posterior = result["posterior"];
  EXPECT_EQ(posterior["chains"], 8);
  EXPECT_EQ(posterior["draws"], 200);
  const WrittenTable draws = good_run().folder.table("out/" + posterior["file"].get<std::string>());
  std::vector<std::string> header{"chain", "draw"};
  for (const nlohmann::json& name : posterior["names"]) header.push_back(name);
  EXPECT_EQ(draws.header, header);
  ASSERT_EQ(draws.rows.size(), 1600U);
  for (std::size_t i = 0; i < draws.rows.size(); ++i) {
    EXPECT_EQ(draws.rows[i][0], std::to_string(i / 200 + 1));
    EXPECT_EQ(draws.rows[i][1], std::to_string(i % 200 + 1));
  }
  for (std::size_t k = 0; k < 2; ++k) {
    const std::vector<double> values = draws.numbers(result["parameters"]["names"][k]);
    const double mean = std::accumulate(values.begin(), values.end(), 0.0) / 1600.0;
    double squares = 0.0;
    for (const double value : values) squares += (value - mean) * (value - mean);
    EXPECT_NEAR(mean, result["parameters"]["mean"][k].get<double>(), 1e-12);
    EXPECT_NEAR(std::sqrt(squares / 1600.0), result["parameters"]["std"][k].get<double>(), 1e-12);
  }
  for (const char* key : {"r_hat", "ess_bulk", "ess_tail"}) EXPECT_EQ(posterior[key].size(), posterior["names"].size());
}

TEST(PosteriorFiles, HaveAnEvidenceWithItsInterval) {
  const nlohmann::json& result = good_run().result;
  const nlohmann::json& evidence = result["evidence"];
  EXPECT_LT(evidence["ci95"][0], evidence["ln_evidence"]);
  EXPECT_LT(evidence["ln_evidence"], evidence["ci95"][1]);
  EXPECT_EQ(result["parameters"]["estimate"]["log_evidence"], evidence["ln_evidence"]);
  double probability = 0.0;
  for (const nlohmann::json& mode : result["modes"]) probability += mode["probability"].get<double>();
  EXPECT_NEAR(probability, 1.0, 1e-12);
}

TEST(PosteriorFiles, AreInTheLayoutOfArviz) {
  const nlohmann::json groups = nlohmann::json::parse(good_run().folder.text("out/posterior.json"));
  std::set<std::string> names;
  for (const auto& [name, group] : groups.items()) names.insert(name);
  EXPECT_EQ(names, (std::set<std::string>{"posterior", "log_likelihood", "posterior_predictive", "observed_data"}));
  const auto ordered = nlohmann::ordered_json::parse(good_run().folder.text("out/posterior.json"));
  std::vector<std::string> parameters;
  for (const auto& [name, chains] : ordered["posterior"].items()) parameters.push_back(name);
  parameters.emplace_back("log_likelihood");
  EXPECT_EQ(nlohmann::json(parameters), good_run().result["posterior"]["names"]);
  for (const char* group : {"posterior", "log_likelihood", "posterior_predictive"}) {
    for (const nlohmann::json& variable : groups[group]) {
      ASSERT_EQ(variable.size(), 8U);
      for (const nlohmann::json& chain : variable) EXPECT_EQ(chain.size(), 200U);
    }
  }
  for (const nlohmann::json& values : groups["observed_data"]) EXPECT_EQ(values.size(), 6U);
}

TEST(PosteriorFiles, HaveSpecimensWhoseLogLikelihoodsAddUpToThatOfTheTable) {
  const nlohmann::json& posterior = good_run().result["posterior"];
  const nlohmann::json groups = nlohmann::json::parse(good_run().folder.text("out/posterior.json"));
  const std::vector<double> sums = good_run().folder.table("out/posterior.csv").numbers("log_likelihood");
  std::size_t draw = 0;
  for (const nlohmann::json& chain : groups["log_likelihood"]["tests"]) {
    for (const nlohmann::json& specimens : chain) {
      const std::vector<double> values = test::doubles(specimens);
      EXPECT_NEAR(std::accumulate(values.begin(), values.end(), 0.0), sums.at(draw++), 1e-9);
    }
  }
  EXPECT_EQ(draw, sums.size());
  const std::vector<double> pointwise = test::doubles(posterior["leave_one_out"]["pointwise"]);
  EXPECT_EQ(pointwise.size(), 6U);
  EXPECT_NEAR(std::accumulate(pointwise.begin(), pointwise.end(), 0.0),
              posterior["leave_one_out"]["elpd"].get<double>(), 1e-9);
}

TEST(PosteriorFiles, HaveRanksAndPredictionsOfEachChain) {
  const nlohmann::json& posterior = good_run().result["posterior"];
  for (const nlohmann::json& name : posterior["ranks"]["counts"]) {
    ASSERT_EQ(name.size(), 8U);
    for (const nlohmann::json& chain : name) {
      EXPECT_EQ(chain.size(), posterior["ranks"]["bins"]);
      const std::vector<int> counts = chain;
      EXPECT_EQ(std::accumulate(counts.begin(), counts.end(), 0), 200);
    }
  }
  ASSERT_EQ(posterior["predictive"]["tests"].size(), 3U);
  for (const nlohmann::json& row : posterior["predictive"]["tests"]) EXPECT_EQ(row.size(), 5U);
}

TEST(PosteriorFiles, AreTheSameWithAnyNumberOfThreads) {
  StudyFolder folder;
  folder.write("study.toml", posterior_study());
  for (const int threads : {2, 8}) {
    const std::string out = fmt::format("t{}", threads);
    EXPECT_EQ(test::untimed(folder.update({.out = out, .threads = threads})), test::untimed(good_run().result));
    for (const std::string name : {"/posterior.csv", "/posterior.json", "/cloud-final.csv"}) {
      EXPECT_EQ(folder.text(out + name), good_run().folder.text("out" + name)) << threads << name;
    }
  }
}

TEST(PosteriorFiles, OfOneSpecimenSayWhyItIsNotLeftOut) {
  StudyFolder folder;
  folder.write("study.toml", posterior_study());
  const std::vector<std::string> lines = test::lines_of(test::k_three_masses_tests);
  folder.write("tests.csv", lines[0] + "\n" + lines[1] + "\n");
  const nlohmann::json posterior = folder.update()["posterior"];
  EXPECT_TRUE(posterior["leave_one_out"].is_null());
  EXPECT_THAT(posterior["not_left_out"].get<std::string>(), HasSubstr("two specimens"));
}

TEST(PosteriorFiles, OfAnEarlierRunDoNotStay) {
  StudyFolder folder;
  folder.write("study.toml", posterior_study());
  folder.update();
  EXPECT_TRUE(folder.has("out/posterior.csv"));
  const nlohmann::json result = folder.update_changed({});  // another method has none
  EXPECT_TRUE(result["evidence"].is_null());
  EXPECT_TRUE(result["posterior"].is_null());
  EXPECT_TRUE(result["modes"].empty());
  EXPECT_FALSE(folder.has("out/posterior.csv"));
  EXPECT_FALSE(folder.has("out/posterior.json"));
}

TEST(PosteriorNoise, IsSampledWhereItHasNoNumber) {
  StudyFolder folder;
  folder.write("study.toml", posterior_study("bayes", {{k_repeatability, ""}}));
  const nlohmann::json result = folder.update();
  EXPECT_EQ(result["posterior"]["names"], nlohmann::json({"k1", "k2", "noise:f", "log_likelihood"}));
  EXPECT_EQ(result["verdict"]["conclusion"], "undecided");
}

TEST(PosteriorNoise, LetsAnOutputOfOneSpecimenCount) {
  StudyFolder folder;
  std::string tests;
  const std::vector<std::string> lines = test::lines_of(test::k_three_masses_tests);
  for (std::size_t i = 0; i < lines.size(); ++i) {
    tests += (i < 2 ? lines[i] : lines[i].substr(0, lines[i].rfind(',') + 1)) + "\n";
  }
  folder.write("tests.csv", tests);
  for (const auto& [method, first_test] :
       {std::pair<std::string, std::string>{"bayes", "residuals"}, {"hierarchical", "mean-residuals"}}) {
    folder.write("study.toml", posterior_study(method));
    const nlohmann::json result = folder.update();
    EXPECT_EQ(result["status"], "converged") << method;
    EXPECT_EQ(result["verdict"]["tests"][0]["name"], first_test);
  }
  folder.write("study.toml", posterior_study("maximum-likelihood", {{"particles = 200", ""}}));
  EXPECT_THAT(folder.refusal(), HasSubstr("test: output 'f3' is measured once in 6 specimens"));
}

/// Why an update by `bayes` is refused.
std::string refusal_of(const std::vector<TextChange>& changes, const std::vector<std::string>& set = {}) {
  StudyFolder folder;
  folder.write("study.toml", posterior_study("bayes", changes));
  return folder.without_path(test::message_of<InvalidInput>([&] { folder.update({.set = set}); }));
}

TEST(PosteriorNoise, IsRefusedWhereItIsNeitherKnownNorSampled) {
  for (const TextChange& noise : {TextChange{k_repeatability, ""}, TextChange{"0.02 }", "0.0 }"}}) {
    test::expect_message(refusal_of({noise, {"particles = 200", "noise = \"given\""}}),
                         {"the noise of f1, f2, f3 is not known"});
  }
}

TEST(PosteriorNoise, IsRefusedWhereThePriorHasNoProbabilityAtTheTests) {
  EXPECT_THAT(refusal_of({{"0.02 }", "1e-170 }"}}), HasSubstr("below 1e-10 of them rounding decides"));
  EXPECT_THAT(refusal_of({{k_repeatability, ""}}, {"update.bayes.noise_scale=1e-320"}),
              HasSubstr("likelihood above zero"));
}

TEST(BayesOptions, GiveAPosteriorAtTheirEnds) {
  StudyFolder folder;
  for (const auto& [option, values] :
       std::vector<std::pair<std::string, std::vector<std::string>>>{{"effective_fraction", {"0.1", "0.99"}},
                                                                     {"decorrelation", {"0.02", "0.9"}},
                                                                     {"max_moves", {"1", "60000"}},
                                                                     {"islands", {"8"}},
                                                                     {"noise_scale", {"1e-9", "1e9"}},
                                                                     {"noise_degrees_of_freedom", {"1.0", "1e6"}}}) {
    for (const std::string& value : values) {
      SCOPED_TRACE(option + " = " + value);
      const std::string entries = fmt::format("particles = 100\nnoise = \"estimated\"\n{} = {}", option, value);
      folder.write("study.toml", posterior_study("bayes", {{"particles = 200", entries}}));
      EXPECT_THAT(folder.update({.set = {"update.samples=100"}})["status"].get<std::string>(),
                  testing::AnyOf("converged", "stalled"));
    }
  }
}

}  // namespace
}  // namespace mottle::study
