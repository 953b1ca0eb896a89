// Jobs of a study called as functions, without the command.
#include "mottle/study/jobs/update.hpp"

#include <gtest/gtest.h>

#include <nlohmann/json.hpp>

#include "core/temporary_folder.hpp"
#include "mottle/core/files.hpp"
#include "mottle/study/jobs/forward.hpp"
#include "mottle/study/results/run_folder.hpp"

namespace mottle::study {
namespace {

using test::TemporaryFolder;

Study first_case() {
  return read_study(std::filesystem::path(MOTTLE_SOURCE_DIR) / "examples/01-three-masses/case1.toml");
}

/// result.json without its timings.
nlohmann::json numbers_in(const std::filesystem::path& folder) {
  nlohmann::json json = nlohmann::json::parse(read_file(folder / "result.json"));
  json.erase("timings_s");
  return json;
}

TEST(UpdateJob, FindsTheSameWithAFolderAndWithout) {
  const Study study = first_case();
  const TemporaryFolder with;
  const TemporaryFolder without;
  write_results(update(study, {.folder = with.path()}), with.path());
  write_results(update(study, {}), without.path());
  EXPECT_EQ(numbers_in(with.path()), numbers_in(without.path()));
  EXPECT_TRUE(std::filesystem::exists(with.path() / k_log));
  EXPECT_TRUE(std::filesystem::exists(with.path() / k_journal));
  EXPECT_FALSE(std::filesystem::exists(without.path() / k_log));
  EXPECT_FALSE(std::filesystem::exists(without.path() / k_journal));
}

TEST(UpdateJob, AnOutcomeThatWasMovedSaysWhatItSaid) {
  UpdateOutcome first = update(first_case(), {});
  const RunSummary before = summarise(first, "folder");
  const UpdateOutcome second = std::move(first);
  const RunSummary after = summarise(second, "folder");
  EXPECT_EQ(before.lines, after.lines);
  EXPECT_EQ(before.json, after.json);
  EXPECT_EQ(second.problem().space.names(), (std::vector<std::string>{"k1", "k2", "k5"}));
}

TEST(UpdateJob, ItsFilesTakeThePlaceOfEarlierOnes) {
  const TemporaryFolder folder;
  for (const char* name : {"result.json", "report.html", "cloud.csv"}) RunFolder(folder.path()).write(name, "old");
  write_results(update(first_case(), {}), folder.path());
  EXPECT_NE(read_file(folder.path() / "result.json"), "old");
  EXPECT_FALSE(std::filesystem::exists(folder.path() / "report.html"));
  EXPECT_EQ(read_file(folder.path() / k_previous / "cloud.csv"), "old");
  RunFolder(folder.path()).finish();
  EXPECT_FALSE(std::filesystem::exists(folder.path() / k_previous));
}

TEST(UpdateJob, ItsFilesTakeThePlaceOfNobodyElses) {
  const TemporaryFolder folder;
  for (const char* name : {"result.json", "prediction.csv"}) write_file_atomically(folder.path() / name, "mine");
  EXPECT_THROW(write_results(update(first_case(), {}), folder.path()), InvalidInput);
  for (const char* name : {"result.json", "prediction.csv"}) EXPECT_EQ(read_file(folder.path() / name), "mine");
  EXPECT_FALSE(std::filesystem::exists(folder.path() / k_previous));
}

TEST(PropagateJob, GivesTheCloudThatItsFilesHold) {
  const TemporaryFolder folder;
  const PropagateOutcome outcome = propagate(first_case(), std::nullopt, {});
  EXPECT_EQ(outcome.cloud.outputs.cols(), 3);
  write_results(outcome, folder.path());
  EXPECT_EQ(numbers_in(folder.path())["model_evaluations"], outcome.cloud.samples.rows());
}

}  // namespace
}  // namespace mottle::study
