// A box of parameters in the result of an update, with the bounds and images of the outputs.
#include <gtest/gtest.h>

#include <cmath>

#include "support/study_refusals.hpp"

namespace mottle::study {
namespace {

using test::StudyCall;
using test::StudyFolder;
using testing::HasSubstr;

StudyFolder& use_interval(StudyFolder& folder) {
  folder.change({{"method = \"mares\"", "method = \"interval\""},
                 {"[update.mares]\nweighting = \"mahalanobis\"\n", "[update.interval]\nbounds = \"observed\"\n"}});
  return folder;
}

TEST(IntervalJson, HoldsBoxBoundsAndImage) {
  StudyFolder folder;
  const nlohmann::json result = use_interval(folder).update();
  EXPECT_EQ(result["parameters"]["estimate"]["kind"], "box");
  for (std::size_t k = 0; k < 2; ++k) {
    const std::vector<double> ends = test::doubles(result["parameters"]["box"][k]);
    EXPECT_NEAR(0.5 * (ends[0] + ends[1]), result["parameters"]["mean"][k].get<double>(), 1e-12);
    EXPECT_NEAR((ends[1] - ends[0]) / std::sqrt(12.0), result["parameters"]["std"][k].get<double>(), 1e-12);
  }
  const nlohmann::json& interval = result["interval"];
  EXPECT_EQ(interval["certified"], true);
  EXPECT_EQ(interval["covered"], true);
  EXPECT_EQ(interval["trends"], nlohmann::json({"rising", "rising"}));
  for (const nlohmann::json& output : interval["image"]) {
    EXPECT_EQ(output["bounds"], output["observed"]);
    EXPECT_LE(output["image"][0], output["bounds"][0]);
    EXPECT_GE(output["image"][1], output["bounds"][1]);
    EXPECT_LE(output["proven"][0], output["image"][0]);
    EXPECT_GE(output["proven"][1], output["image"][1]);
  }
  EXPECT_THAT(test::sentences(result["notes"]), HasSubstr("observed bounds alone"));
  EXPECT_NE(result["verdict"]["conclusion"], "adequate");
}

TEST(IntervalJson, IsTheSameWithAnyNumberOfThreadsAndResumed) {
  StudyFolder folder;
  const nlohmann::json one = use_interval(folder).update({.out = "one"});
  const nlohmann::json three = folder.update({.out = "three", .threads = 3});
  const nlohmann::json again = folder.update({.out = "one", .resume = true});
  for (const char* key : {"parameters", "interval", "outputs", "verdict"}) {
    EXPECT_EQ(one[key].dump(), three[key].dump()) << key;
    EXPECT_EQ(one[key].dump(), again[key].dump()) << key;
  }
}

TEST(IntervalJson, IsNullOfOtherMethods) {
  const nlohmann::json result = StudyFolder().update();
  EXPECT_TRUE(result["interval"].is_null());
  EXPECT_TRUE(result["parameters"]["box"].is_null());
}

TEST(IntervalMethod, NamesTheSpecimensThatDistributionFreeLimitsNeed) {
  StudyFolder folder;
  use_interval(folder);
  const auto run = [&] { folder.update({.set = {"update.interval.bounds=\"distribution-free\""}}); };
  test::expect_message(folder.without_path(test::message_of<InvalidInput>(run)),
                       {"need 93 specimens", "normal-tolerance"});
}

}  // namespace
}  // namespace mottle::study
