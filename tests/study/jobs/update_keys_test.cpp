// What a study may say besides the usual: samples, designs, outputs, parameters, methods.
#include <gtest/gtest.h>

#include <cmath>
#include <numeric>

#include "mottle/updating/methods/updater.hpp"
#include "support/study_folder.hpp"

namespace mottle::study {
namespace {

using test::k_three_masses_tests;
using test::StudyFolder;
using test::WrittenTable;

const std::string k_k1 = R"({ kind = "normal", mean = 2.0, std = 0.3 })"
                         "\nbounds = [0.5, 3.0]";
const std::string k_target_k2 = "target = \"spring:k2\"";

double mean_of(const std::vector<double>& values) {
  return std::accumulate(values.begin(), values.end(), 0.0) / static_cast<double>(values.size());
}

TEST(StudyKeys, LetTheNumberOfSamplesBeChosen) {
  StudyFolder folder;
  const nlohmann::json result = folder.update_changed({{"samples = 200", "samples = \"auto\""}});
  const std::size_t samples = result["sample_size"]["n_model"];
  EXPECT_GE(samples, 100U);
  EXPECT_EQ(folder.table("out/cloud-final.csv").rows.size(), samples);
  EXPECT_EQ(result["options"]["samples_rule"], "auto");
}

TEST(StudyKeys, TakeEveryDistribution) {
  StudyFolder folder;
  for (const std::string kind :
       {R"(kind = "lognormal", mean = 2.0, std = 0.3)", R"(kind = "uniform", lower = 1.0, upper = 3.0)",
        R"(kind = "truncated-normal", mean = 2.0, std = 0.5, lower = 1.0, upper = 3.0)",
        R"(kind = "beta", mean = 2.0, std = 0.3, lower = 1.0, upper = 3.0)",
        R"(kind = "gamma", mean = 2.0, std = 0.3)"}) {
    SCOPED_TRACE(kind);
    const nlohmann::json result = folder.update_changed({{k_k1, "{ " + kind + " }"}});
    // All are symmetric or given by their mean.
    EXPECT_NEAR(result["parameters"]["prior_mean"][0].get<double>(), 2.0, 1e-9);
    const std::vector<double> drawn = folder.table("out/cloud-initial.csv").numbers("k1");
    const bool is_bounded = kind.find("lower") != std::string::npos;
    EXPECT_GT(*std::min_element(drawn.begin(), drawn.end()), is_bounded ? 1.0 : 0.0);
    EXPECT_LT(*std::max_element(drawn.begin(), drawn.end()), is_bounded ? 3.0 : 10.0);
  }
}

TEST(StudyKeys, TakeACorrelationByPairsAndByMatrixAlike) {
  StudyFolder folder;
  const auto correlated = [&](const std::string& entry) {
    return folder.update_changed({{"[outputs]", "[correlation]\n" + entry + "\n\n[outputs]"}})["outputs"];
  };
  EXPECT_EQ(correlated(R"(pairs = [{ between = ["k1", "k2"], value = 0.9 }])"),
            correlated("matrix = [[1, 0.9], [0.9, 1]]"));
  const WrittenTable cloud = folder.table("out/cloud-initial.csv");
  const std::vector<double> x = cloud.numbers("k1");
  const std::vector<double> y = cloud.numbers("k2");
  double xy = 0.0;
  double xx = 0.0;
  double yy = 0.0;
  for (std::size_t i = 0; i < x.size(); ++i) {
    xy += (x[i] - mean_of(x)) * (y[i] - mean_of(y));
    xx += std::pow(x[i] - mean_of(x), 2);
    yy += std::pow(y[i] - mean_of(y), 2);
  }
  EXPECT_NEAR(xy / std::sqrt(xx * yy), 0.9, 0.06);  // 4 standard errors (1 - r^2) / sqrt(200)
}

TEST(StudyKeys, TakeEverySampling) {
  StudyFolder folder;
  for (const std::string sampling : {"monte-carlo", "latin-hypercube", "sobol"}) {
    SCOPED_TRACE(sampling);
    folder.update_changed({{"samples = 200", "samples = 256\nsampling = \"" + sampling + "\""}});
    // 5 standard errors of plain sampling; stratified designs are far closer.
    EXPECT_NEAR(mean_of(folder.table("out/cloud-initial.csv").numbers("k1")), 2.0,
                sampling == "monte-carlo" ? 5 * 0.3 / 16 : 0.01);
  }
}

TEST(StudyKeys, TakeDampingRatiosAsOutputs) {
  StudyFolder folder;
  std::string tests;
  int row = 0;
  for (const std::string& line : test::lines_of(k_three_masses_tests)) {
    tests += line + (row == 0 ? ",zeta1\n" : fmt::format(",0.00{}\n", 50 + row));
    ++row;
  }
  folder.write("tests.csv", tests);
  const nlohmann::json result = folder.update_changed(
      {{"springs = [", R"(dampers = [{ name = "c1", between = ["ground", "m1"], damping = 0.05 }])"
                       "\nsprings = ["},
       {"[1, 2, 3]", "[1, 2, 3]\ndamping = [1]"},
       {k_target_k2 + "\n"
                      R"(distribution = { kind = "normal", mean = 2.0, std = 0.3 })",
        "target = \"damper:c1\"\n"
        R"(distribution = { kind = "gamma", mean = 0.05, std = 0.01 })"}});
  EXPECT_EQ(result["outputs"]["names"], nlohmann::json({"f1", "f2", "f3", "zeta1"}));
  EXPECT_EQ(result["outputs"]["units"][3], "-");
  EXPECT_EQ(result["parameters"]["units"][1], "N s/m");
}

TEST(StudyKeys, TakeShapesAsOutputs) {
  StudyFolder folder;
  folder.change({{"[1, 2, 3]", "[1, 2]\nshapes = { modes = [1], dofs = [\"m1\", \"m3\"] }"},
                 {"[outputs]", "[truth]\nspecimens = 12\n\n[outputs]"},
                 {"\"tests.csv\"", "\"drawn/specimens.csv\""}});
  folder.simulate();
  EXPECT_EQ(folder.update()["outputs"]["names"], nlohmann::json({"f1", "f2", "phi1:m1", "phi1:m3"}));
}

TEST(StudyKeys, TrackModesByShape) {
  StudyFolder folder;
  const nlohmann::json by_order = folder.update_changed({})["parameters"]["mean"];
  const nlohmann::json by_mac =
      folder.update_changed({{"[1, 2, 3]", "[1, 2, 3]\ntracking = \"mac\""}})["parameters"]["mean"];
  // No mode crosses another in this study, so both say the same up to the kernels' rounding.
  for (std::size_t i = 0; i < 2; ++i) EXPECT_NEAR(by_order[i].get<double>(), by_mac[i].get<double>(), 1e-9);
}

TEST(LostModes, AreCountedAndLeftOut) {
  StudyFolder folder;
  const nlohmann::json result =
      folder.update_changed({{"[1, 2, 3]", "[1, 2, 3]\ntracking = \"mac\"\nminimum_mac = 0.98"},
                             {"samples = 200", "samples = 200\nmax_failed = 1.0"}});
  const nlohmann::json& failed = result["failed_evaluations"];
  ASSERT_FALSE(failed.empty());
  std::size_t of_first_cloud = 0;
  for (const nlohmann::json& entry : failed) {
    EXPECT_THAT(entry["reason"].get<std::string>(), testing::HasSubstr("lost"));
    EXPECT_GE(entry["sample"], 0);
    EXPECT_LT(entry["sample"], 200);
    of_first_cloud += entry["iteration"] == 0 ? 1 : 0;
  }
  std::size_t lost = 0;
  for (const auto& row : folder.table("out/cloud-initial.csv").rows) {
    if (row.back().find("ok") != std::string::npos) continue;
    ++lost;
    EXPECT_EQ(row[2] + row[3] + row[4], "");
  }
  EXPECT_EQ(lost, of_first_cloud);
  const std::vector<double> states = folder.table("out/clouds.csv").numbers("iteration");
  for (const nlohmann::json& state : result["iterations"]) {
    const auto drawn = std::count(states.begin(), states.end(), state["index"].get<double>());
    EXPECT_EQ(drawn, 200 - state["failed"].get<int>()) << state["index"];
  }
}

TEST(LostModes, EndTheUpdateWhereTheyAreTooMany) {
  StudyFolder folder;
  folder.change({{"[1, 2, 3]", "[1, 2, 3]\ntracking = \"mac\"\nminimum_mac = 1.0"}});
  EXPECT_THAT(test::message_of<SystemFailure>([&] { folder.update(); }),
              testing::HasSubstr("of 200 model runs failed"));
  EXPECT_FALSE(folder.has("out/result.json"));
}

TEST(StudyKeys, LetAParameterBeAFactor) {
  StudyFolder folder;
  const test::TextChange softer{R"(name = "k6", between = ["m1", "m3"], stiffness = 3.0)",
                                R"(name = "k6", between = ["m1", "m3"], stiffness = 2.0)"};
  const nlohmann::json values = folder.update_changed({softer, {k_target_k2, "target = \"spring:k6\""}});
  const nlohmann::json factors =
      folder.update_changed({softer,
                             {k_target_k2 + "\n"
                                            R"(distribution = { kind = "normal", mean = 2.0, std = 0.3 })",
                              "target = \"spring:k6\"\nrelative = true\n"
                              R"(distribution = { kind = "normal", mean = 1.0, std = 0.15 })"}});
  EXPECT_EQ(factors["parameters"]["units"][1], "-");
  // A factor on 2 is half the value. The clouds differ: the root of a covariance depends on the parameters' scale, so
  // this agrees to the Monte-Carlo error of 200 samples only, a third of it here.
  EXPECT_NEAR(2.0 * factors["parameters"]["mean"][1].get<double>(), values["parameters"]["mean"][1].get<double>(),
              0.3 * 0.3 / std::sqrt(200.0));
}

TEST(StudyKeys, LetParametersActOnSeveralElementsAndOnMasses) {
  StudyFolder folder;
  const nlohmann::json tied = folder.update_changed({{k_target_k2, "target = [\"spring:k2\", \"spring:k5\"]"}});
  EXPECT_EQ(tied["parameters"]["names"], nlohmann::json({"k1", "k2"}));
  EXPECT_EQ(folder.update_changed({{k_target_k2, "target = \"mass:m2\""}})["parameters"]["units"],
            nlohmann::json({"N/m", "kg"}));
}

TEST(StudyKeys, LetTheDeterministicMethodRegularise) {
  StudyFolder folder;
  for (const std::string regularisation : {"none", "tikhonov", "bayesian"}) {
    SCOPED_TRACE(regularisation);
    const nlohmann::json result =
        folder.update_changed({{"method = \"mares\"", "method = \"deterministic\""},
                               {"[update.mares]", "[update.deterministic]\nspecimen = 2\nregularisation = \"" +
                                                      regularisation + "\"\n\n[update.mares]"}});
    EXPECT_EQ(result["method"], "deterministic");
    EXPECT_EQ(result["status"], "converged");
    EXPECT_EQ(result["options"]["specimen"], 2);
  }
}

TEST(StudyKeys, LetTheDeterministicMethodTakeOneSpecimen) {
  StudyFolder folder;
  const std::vector<std::string> lines = test::lines_of(k_three_masses_tests);
  folder.write("tests.csv", lines[0] + "\n" + lines[1] + "\n");
  const nlohmann::json result = folder.update_changed({{"method = \"mares\"", "method = \"deterministic\""}});
  EXPECT_EQ(result["status"], "converged");
  EXPECT_EQ(result["outputs"]["test_count"], nlohmann::json({1, 1, 1}));
}

TEST(ImpossibleDraws, AreReplacedAndCounted) {
  StudyFolder folder;
  const nlohmann::json result = folder.update_changed({{k_k1, R"({ kind = "normal", mean = 0.5, std = 0.4 })"}});
  const int first = result["iterations"][0]["rejected_draws"];
  // Of 200 draws a share of Phi(-1.25) = 0.106 is impossible, each redraw again: 23.6 expected, deviation 5.1.
  EXPECT_GE(first, 3);
  EXPECT_LE(first, 45);
  EXPECT_GE(result["rejected_draws"]["count"], first);
  EXPECT_THAT(result["rejected_draws"]["rule"].get<std::string>(), testing::HasSubstr("rejected"));
  const std::vector<double> drawn = folder.table("out/cloud-initial.csv").numbers("k1");
  EXPECT_GT(*std::min_element(drawn.begin(), drawn.end()), 0.0);
}

TEST(StudyKeys, MayEndTheIterationEarlyWhichIsNoEvidence) {
  const nlohmann::json result = StudyFolder().update_changed({{"iterations = 30", "iterations = 1"}});
  EXPECT_EQ(result["status"], "max-iterations");
  EXPECT_EQ(result["verdict"]["conclusion"], "undecided");
}

TEST(StudyKeys, GiveTheResultItsUnits) {
  EXPECT_EQ(StudyFolder().update_changed({{"units = \"SI\"", "units = \"mm-kg-ms\""}})["outputs"]["units"],
            nlohmann::json({"kHz", "kHz", "kHz"}));
}

TEST(StudyKeys, TakeTheDefaultOfEveryOptionOfEveryMethod) {
  const StudyFolder folder;
  for (const MethodEntry& method : updating_methods()) {
    for (const OptionDescription& option : method.options) {
      const std::string assignment = fmt::format("update.{}.{}={}", method.name, option.name, option.default_value);
      EXPECT_NO_THROW((void)folder.study({.set = {assignment}})) << assignment;
    }
  }
}

}  // namespace
}  // namespace mottle::study
