// [test] model_error: an error of the model that all specimens share, from the study to results and predictions.
#include <gtest/gtest.h>

#include "support/study_refusals.hpp"

namespace mottle::study {
namespace {

using test::StudyFolder;
using test::TextChange;

const TextChange k_maximum_likelihood{"method = \"mares\"", "method = \"maximum-likelihood\""};
const std::string k_file = "file = \"tests.csv\"";
const std::string k_noise = k_file + "\nrepeatability = { \"f*\" = \"0.05 %\" }\n";

nlohmann::json updated(const std::string& test_section) {
  return StudyFolder().update_changed({k_maximum_likelihood, {k_file, test_section}});
}

double width(const nlohmann::json& interval) {
  return interval[1].get<double>() - interval[0].get<double>();
}

bool has_note(const nlohmann::json& result, const std::string& part) {
  return test::sentences(result["notes"]).find(part) != std::string::npos;
}

TEST(ModelError, WidensTheMeansAndIsInTheResult) {
  const nlohmann::json without = updated(k_noise);
  EXPECT_TRUE(without["outputs"]["model_error_std"].is_null());
  EXPECT_TRUE(without["outputs"]["model_error"].is_null());
  const nlohmann::json result = updated(k_noise + "model_error = { \"f*\" = \"0.3 %\", f3 = 0.01 }");
  const std::vector<double> std = test::doubles(result["outputs"]["model_error_std"]);
  EXPECT_NEAR(std[0], 0.003 * result["outputs"]["test_mean"][0].get<double>(), 5e-13);
  EXPECT_EQ(std[2], 0.01);
  for (std::size_t k = 0; k < 3; ++k) {
    const nlohmann::json& error = result["outputs"]["model_error"][k];
    EXPECT_LE(error["standard_error"].get<double>(), std[k] * (1.0 + 1e-9));
    EXPECT_LT(std::abs(error["shift"].get<double>()), 5.0 * std[k]);
  }
  EXPECT_GT(width(result["parameters"]["mean_ci95"][0]), width(without["parameters"]["mean_ci95"][0]));
  EXPECT_TRUE(has_note(result, "Model error f* = 0.3 %: applies to f1, f2")) << result["notes"];
}

TEST(ModelError, CanBeEstimated) {
  const nlohmann::json result = updated(k_noise + "model_error = \"estimated\"");
  EXPECT_EQ(result["outputs"]["model_error_std"].size(), 3U);
  EXPECT_TRUE(has_note(result, "This estimate has only")) << result["notes"];
}

/// The error moves the tested frequencies and the mean together: their sum is what the tests have measured.
TEST(ModelError, MakesAPredictionOfWhatWasTestedNoLessSure) {
  StudyFolder folder;
  std::string truth = "\n[truth]\nspecimens = 12\n";
  for (const char* name : {"k1", "k2"}) {
    truth += fmt::format(
        "\n[[truth.parameter]]\nname = \"{0}\"\ntarget = \"spring:{0}\"\n"
        "distribution = {{ kind = \"normal\", mean = 2.0, std = 0.2 }}\n",
        name);
  }
  folder.write("study.toml", test::three_masses() + truth);
  folder.simulate();
  const auto widths = [&](const std::string& error, const std::string& model = "") {
    const nlohmann::json result = folder.update_changed(
        {k_maximum_likelihood,
         {k_file, "file = \"drawn/specimens.csv\"\n" + error},
         {"frequencies = [1, 2, 3]", "frequencies = [1, 2]"},
         {"weighting = \"mahalanobis\"\n",
          "weighting = \"mahalanobis\"\n\n[predict]\nfrequencies = [1, 2]\ndraws = 4000\n" + model}});
    return std::vector{width(result["prediction"]["interval95"][0]), width(result["prediction"]["interval95"][1])};
  };
  const std::vector<double> without = widths("");
  const std::vector<double> with = widths("model_error = { \"f*\" = \"0.5 %\" }");
  for (std::size_t k = 0; k < 2; ++k) EXPECT_NEAR(with[k] / without[k], 1.0, 0.1);
  // Of another structure the error is a new one: 3 % of f1 and what the mean carries.
  const std::string changed = "model = { \"mass:m1\" = 1.5 }\n";
  EXPECT_GT(widths("model_error = { \"f*\" = \"3 %\" }", changed)[0], 1.1 * widths("", changed)[0]);
}

TEST(ModelError, IsRefusedWhereItIsNone) {
  const auto wrong = [](const std::string& entry, const std::string& says) {
    return test::WrongStudy{.what = entry,
                            .changes = {k_maximum_likelihood, {k_file, k_noise + entry}},
                            .says = {"test.model_error", says}};
  };
  test::expect_refused({
      wrong("model_error = \"guess\"", "\"estimated\", or a table"),
      wrong("model_error = { g1 = 0.1 }", "output 'g1'"),
      wrong("model_error = { \"f*\" = \"-1 %\" }", "a number >= 0"),
  });
}

// Eight specimens of the study's own population and noise; standard deviations had come out half as large as without
// the error.
TEST(ModelError, MakesARightModelNotInadequateByDistances) {
  StudyFolder folder;
  folder.write("tests.csv",
               "f1,f2,f3\n0.209488,0.355357,0.46863\n0.188222,0.341468,0.456915\n0.207764,0.352537,0.467762\n"
               "0.20649,0.353103,0.466936\n0.2026,0.347843,0.466301\n0.195871,0.33948,0.465722\n"
               "0.197441,0.345765,0.462437\n0.201111,0.35116,0.4634\n");
  folder.write("study.toml", test::three_masses({{"method = \"mares\"", "method = \"abc\""},
                                                 {k_file, k_file + "\nrepeatability = { \"f*\" = \"0.1 %\" }\n"
                                                                   "model_error = { \"f*\" = \"0.3 %\" }\n"}}) +
                                 "[update.abc]\nsimulations = 2000\ncalibration_sets = 100\n");
  EXPECT_EQ(folder.update()["verdict"]["conclusion"], "adequate");
}

}  // namespace
}  // namespace mottle::study
