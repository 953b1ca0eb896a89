// Errors of fixed numbers that could hide behind a verdict, in the result of an update.
#include <gtest/gtest.h>

#include <set>

#include "support/study_folder.hpp"

namespace mottle::study {
namespace {

using test::StudyFolder;
using test::TextChange;

const TextChange k_maximum_likelihood{"method = \"mares\"", "method = \"maximum-likelihood\""};
const std::string k_noise = "[test]\nrepeatability = { \"f*\" = 0.001 }";

const nlohmann::json& error_of(const nlohmann::json& result, const std::string& name) {
  for (const nlohmann::json& error : result["verdict"]["could_hide"]) {
    if (error["name"] == name) return error;
  }
  throw std::logic_error("nothing is said of " + name);
}

bool is_any(const nlohmann::json& result, const char* key) {
  bool any = false;
  for (const nlohmann::json& error : result["verdict"]["could_hide"]) any = any || error[key] == true;
  return any;
}

TEST(CouldHide, ListsEverySpringAndMassThatNoParameterMovesTheMostHarmfulFirst) {
  const nlohmann::json result = StudyFolder().update();
  std::set<std::string> names;
  double last = std::numeric_limits<double>::infinity();
  for (const nlohmann::json& error : result["verdict"]["could_hide"]) {
    names.insert(error["name"]);
    EXPECT_EQ(error["nominal"], error["name"] == "k6" ? 3.0 : 1.0);
    EXPECT_GT(error["relative_change"].get<double>(), 0.0);
    EXPECT_LE(error["relative_change"].get<double>(), 1.0);
    EXPECT_TRUE(error["is_detected"].is_boolean());
    ASSERT_EQ(error["would_move"].size(), 2U);
    EXPECT_EQ(error["would_move"][0]["parameter"], "k1");
    EXPECT_EQ(error["would_move"][1]["parameter"], "k2");
    double harm = 0.0;
    for (const nlohmann::json& move : error["would_move"])
      harm = std::max(harm, std::abs(move["half_widths"].get<double>()));
    EXPECT_LE(harm, last);
    last = harm;
  }
  EXPECT_EQ(names, (std::set<std::string>{"k3", "k4", "k5", "k6", "m1", "m2", "m3"}));
}

/// As many frequencies as parameters: k6 off by 10 % moves the estimate by what was said of it.
TEST(CouldHide, SaysHowFarAnErrorThatNoTestSeesMovesTheMeans) {
  StudyFolder folder;
  const TextChange k5{"[outputs]",
                      "[[parameter]]\nname = \"k5\"\ntarget = \"spring:k5\"\n"
                      "distribution = { kind = \"normal\", mean = 2.0, std = 0.3 }\n\n[outputs]"};
  const nlohmann::json right = folder.update_changed({k5, k_maximum_likelihood});
  const nlohmann::json& error = error_of(right, "k6");
  EXPECT_EQ(error["is_detected"], false);
  EXPECT_EQ(error["relative_change"], 0.1);
  // The model off by 1 % downwards, against the same tests, errs as tests off by 1 % upwards do.
  constexpr double k_small = 0.01;
  const nlohmann::json wrong =
      folder.update_changed({k5, k_maximum_likelihood, {"stiffness = 3.0", "stiffness = 2.97"}});
  for (std::size_t i = 0; i < 3; ++i) {
    const std::vector<double> ends = test::doubles(right["parameters"]["mean_ci95"][i]);
    const double said = error["would_move"][i]["half_widths"].get<double>() * 0.5 * (ends[1] - ends[0]) * k_small / 0.1;
    const double found = wrong["parameters"]["mean"][i].get<double>() - right["parameters"]["mean"][i].get<double>();
    // First order at the mean; specimens scatter by a fifth about it, so that their mean differs by some per cent.
    EXPECT_NEAR(found, said, 0.1 * std::abs(said));
  }
}

/// A spring of stiffness 0: its error is absolute, at a tenth of the other springs' median where no test sees it.
TEST(CouldHide, NamesANumberThatIsZeroInTheModel) {
  const nlohmann::json result = StudyFolder().update_changed(
      {{"stiffness = 3.0 },",
        "stiffness = 3.0 },\n  { name = \"k7\", between = [\"m1\", \"m3\"], stiffness = 0.0 },"}});
  const nlohmann::json& error = error_of(result, "k7");
  EXPECT_EQ(error["nominal"], 0.0);
  EXPECT_TRUE(error["relative_change"].is_null());
  EXPECT_GT(error["change"].get<double>(), 0.0);
  EXPECT_LE(error["change"].get<double>(), 1.0);
}

/// A model error that is estimated from the means leaves no test of them: no size may be said to be refused.
TEST(CouldHide, RefusesNoErrorWhereTheMeansAreNotTested) {
  const nlohmann::json verdict = StudyFolder().update_changed(
      {k_maximum_likelihood, {"[test]", k_noise + "\nmodel_error = \"estimated\""}})["verdict"];
  for (const nlohmann::json& hypothesis : verdict["tests"]) EXPECT_NE(hypothesis["name"], "mean-residuals");
  for (const nlohmann::json& error : verdict["could_hide"]) EXPECT_EQ(error["is_detected"], false) << error["name"];
  EXPECT_THAT(test::sentences(verdict["not_tested"]), testing::Not(testing::HasSubstr("80 % of cases")));
}

/// The level of the noise comes from the same tests, where an error of the model counts as noise too.
TEST(CouldHide, SaysThatAnEstimatedNoiseRefusesFewer) {
  StudyFolder folder;
  const nlohmann::json estimated = folder.update_changed({k_maximum_likelihood});
  for (const nlohmann::json& error : estimated["verdict"]["could_hide"]) {
    EXPECT_EQ(error["assumes_estimated_noise"], error["is_detected"]) << error["name"];
  }
  EXPECT_FALSE(is_any(folder.update_changed({k_maximum_likelihood, {"[test]", k_noise}}), "assumes_estimated_noise"));
}

}  // namespace
}  // namespace mottle::study
