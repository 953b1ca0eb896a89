// What a verdict comes from, of whole studies whose fault is known.
#include <gtest/gtest.h>

#include "mottle/core/files.hpp"
#include "support/study_folder.hpp"

namespace mottle::study {
namespace {

using test::StudyFolder;
using testing::ElementsAre;
using testing::HasSubstr;

std::string example(const std::string& name) {
  return read_file(std::filesystem::path(MOTTLE_SOURCE_DIR) / "examples/01-three-masses" / name);
}

/// The example whose model is right, with its tests as `change` leaves them.
nlohmann::json shapes_with(const std::function<void(std::vector<std::vector<double>>&)>& change,
                           const std::vector<std::string>& set = {}) {
  StudyFolder folder;
  const std::string tests = example("specimens-shapes.csv");
  std::vector<std::vector<double>> rows = test::numbers_of(tests);
  change(rows);
  folder.write("study.toml", example("shapes.toml"));
  folder.write("specimens-shapes.csv", test::csv_text(test::lines_of(tests).front(), rows));
  return folder.update({.set = set})["verdict"];
}

std::vector<std::string> kinds_of(const nlohmann::json& verdict) {
  std::vector<std::string> kinds;
  for (const nlohmann::json& cause : verdict["causes"]) kinds.push_back(cause["kind"]);
  return kinds;
}

void shift_frequencies(std::vector<double>& row, double factor) {
  for (std::size_t k = 0; k < 3; ++k) row[k] *= factor;
}

TEST(VerdictCauses, AreNoneOfARightModel) {
  const nlohmann::json verdict = shapes_with([](auto&) {});
  EXPECT_EQ(verdict["conclusion"], "adequate");
  EXPECT_TRUE(verdict["causes"].empty()) << verdict["causes"].dump();
}

TEST(VerdictCauses, BeginWithTheSpecimenWhoseParametersLieFarFromTheOthers) {
  StudyFolder folder;
  folder.write("study.toml", example("shapes.toml"));
  const std::string tests = example("specimens-shapes.csv");
  folder.write("specimens-shapes.csv", tests);
  const test::WrittenTable loose = folder.propagate("k1,k2,k5\n2.8,0.55,2.9\n");
  std::vector<std::vector<double>> rows = test::numbers_of(tests);
  const std::vector<std::string> header = test::split(test::lines_of(tests).front(), ',');
  for (std::size_t k = 0; k < header.size(); ++k) rows[2][k] = loose.numbers(header[k]).front();
  folder.write("specimens-shapes.csv", test::csv_text(test::lines_of(tests).front(), rows));
  const nlohmann::json verdict = folder.update()["verdict"];
  ASSERT_FALSE(verdict["causes"].empty());
  EXPECT_EQ(verdict["causes"][0]["kind"], "outlier");
  EXPECT_EQ(verdict["causes"][0]["specimens"], nlohmann::json::array({3}));
  EXPECT_FALSE(verdict["is_reassuring"]);
}

TEST(VerdictCauses, BeginWithTheSpecimenThatNoParametersReproduce) {
  const auto loosen = [](auto& rows) { shift_frequencies(rows[6], 0.6); };
  const nlohmann::json verdict = shapes_with(loosen);
  ASSERT_FALSE(verdict["causes"].empty());
  const nlohmann::json& first = verdict["causes"][0];
  EXPECT_EQ(first["kind"], "outlier");
  EXPECT_EQ(first["specimens"], nlohmann::json::array({7}));
  EXPECT_THAT(first["sentence"].get<std::string>(), HasSubstr("the test of specimen 7 (f"));
  EXPECT_EQ(verdict["next"][0]["command"], "mottle update study.toml --set 'test.leave_out=[7]'");
  EXPECT_FALSE(verdict["is_reassuring"]);
  // The step mends it.
  const nlohmann::json without = shapes_with(loosen, {"test.leave_out=[7]"});
  EXPECT_EQ(without["conclusion"], "adequate");
  EXPECT_THAT(kinds_of(without), testing::Not(testing::Contains("outlier")));
}

TEST(VerdictCauses, BeginWithColumnsThatAreExchanged) {
  const auto exchange = [](auto& rows) {
    for (auto& row : rows) std::swap(row[0], row[1]);
  };
  const nlohmann::json verdict = shapes_with(exchange);
  EXPECT_NE(verdict["conclusion"], "adequate");
  EXPECT_EQ(kinds_of(verdict).front(), "mode-order");
  EXPECT_THAT(verdict["next"][0]["command"].get<std::string>(), HasSubstr("test.pairing=\"frequency\""));
}

TEST(VerdictCauses, NameTheBoundsThatTheTestsAskToLeave) {
  StudyFolder folder;
  folder.write("study.toml", example("case3.toml"));
  folder.write("specimens-case3.csv", example("specimens-case3.csv"));
  const nlohmann::json verdict = folder.update()["verdict"];
  EXPECT_EQ(verdict["conclusion"], "inadequate");
  EXPECT_THAT(kinds_of(verdict), ElementsAre("bounds"));
  EXPECT_EQ(verdict["causes"][0]["sentence"], "The tests ask for values beyond the bounds of k2, k5.");
}

TEST(VerdictCauses, OfAnUndecidedOneSayWhatWouldDecide) {
  StudyFolder folder;
  folder.write("study.toml", example("case1.toml"));
  folder.write("specimens-case1.csv", example("specimens-case1.csv"));
  const nlohmann::json verdict = folder.update()["verdict"];
  EXPECT_THAT(kinds_of(verdict), ElementsAre("scatter-not-estimated", "too-few-outputs", "unknown-noise"));
  for (const nlohmann::json& cause : verdict["causes"])
    EXPECT_FALSE(cause["next"]["reason"].get<std::string>().empty());
}

TEST(VerdictCauses, NameTheOutputsWhoseMeansAModelWithAWrongMassMisses) {
  StudyFolder folder;
  folder.write("study.toml", test::edited(example("shapes.toml"), {{"m1 = 1.0", "m1 = 1.2"}}));
  folder.write("specimens-shapes.csv", example("specimens-shapes.csv"));
  const nlohmann::json verdict = folder.update()["verdict"];
  EXPECT_EQ(verdict["conclusion"], "inadequate");
  EXPECT_THAT(kinds_of(verdict), testing::Contains("means"));
  EXPECT_EQ(verdict["next"][0]["command"], "mottle diagnose study.toml");
}

TEST(LeaveOut, IsAsIfTheRowWereNotInTheFile) {
  StudyFolder with;
  const nlohmann::json left_out = with.update({.set = {"test.leave_out=[2]"}});
  StudyFolder without;
  std::vector<std::vector<double>> rows = test::numbers_of(test::k_three_masses_tests);
  rows.erase(rows.begin() + 1);
  without.write("tests.csv", test::csv_text("f1,f2,f3", rows));
  const nlohmann::json removed = without.update();
  EXPECT_EQ(left_out["parameters"]["mean"], removed["parameters"]["mean"]);
  EXPECT_EQ(left_out["outputs"]["test_mean"], removed["outputs"]["test_mean"]);
  EXPECT_THAT(left_out["notes"].dump(), HasSubstr("specimen 2 is left out"));
}

TEST(LeaveOut, RefusesASpecimenThatIsNotThereAndAll) {
  StudyFolder folder;
  EXPECT_THAT(folder.refusal({.set = {"test.leave_out=[99]"}}),
              HasSubstr("there is no specimen 99; the tests have 1, 2"));
  std::string all;
  for (std::size_t i = 1; i <= test::numbers_of(test::k_three_masses_tests).size(); ++i) all += fmt::format("{},", i);
  EXPECT_THAT(folder.refusal({.set = {fmt::format("test.leave_out=[{}]", all)}}), HasSubstr("leaves no specimen"));
  EXPECT_THAT(folder.refusal({.set = {"test.leave_out=[0]"}}), HasSubstr("a list of specimen numbers >= 1"));
}

}  // namespace
}  // namespace mottle::study
