// The tables that an update writes, and the study as it was run.
#include <gtest/gtest.h>

#include <numeric>

#include "support/study_folder.hpp"

namespace mottle::study {
namespace {

using test::StudyCall;
using test::StudyFolder;
using test::untimed;
using test::WrittenTable;

TEST(UpdateFiles, HaveARowAStateInTheHistory) {
  StudyFolder folder;
  const nlohmann::json result = folder.update();
  const WrittenTable history = folder.table("out/history.csv");
  EXPECT_EQ(history.header, (std::vector<std::string>{"iteration", "distance_euclidean", "distance_mahalanobis",
                                                      "k1_mean", "k2_mean", "k1_std", "k2_std", "f1_mean", "f2_mean",
                                                      "f3_mean", "f1_std", "f2_std", "f3_std"}));
  EXPECT_EQ(history.rows.size(), result["iterations"].size());
  EXPECT_EQ(history.numbers("k1_mean").back(), result["parameters"]["mean"][0]);
  EXPECT_EQ(history.numbers("k2_mean").back(), result["parameters"]["mean"][1]);
}

TEST(UpdateFiles, HaveARowASampleInTheClouds) {
  StudyFolder folder;
  const nlohmann::json result = folder.update();
  for (const auto& [name, key] :
       {std::pair{"out/cloud-initial.csv", "initial_mean"}, std::pair{"out/cloud-final.csv", "final_mean"}}) {
    const WrittenTable cloud = folder.table(name);
    EXPECT_EQ(cloud.header, (std::vector<std::string>{"k1", "k2", "f1", "f2", "f3", "status"}));
    EXPECT_THAT(cloud.texts("status"), testing::AllOf(testing::SizeIs(200), testing::Each("ok")));
    const std::vector<double> f1 = cloud.numbers("f1");
    const double mean = std::accumulate(f1.begin(), f1.end(), 0.0) / 200.0;
    EXPECT_NEAR(mean, result["outputs"][key][0].get<double>(), 1e-12);  // summed in another order
  }
}

TEST(UpdateFiles, LeaveNoJournal) {
  StudyFolder folder;
  folder.update();
  EXPECT_FALSE(folder.has("out/resume.journal"));
  for (const std::string& name : folder.files()) EXPECT_FALSE(name.ends_with(".partial")) << name;
}

TEST(StudyAsRun, GivesTheSameNumbers) {
  StudyFolder folder;
  folder.change({{"bounds = [0.5, 3.0]", "bounds = [0.1, 3.0]"}});
  const nlohmann::json first = folder.update({.set = {"update.samples=300"}, .seed = 11});
  EXPECT_EQ(untimed(folder.update({.study = "out/study.toml", .out = "again"})), untimed(first));
  EXPECT_EQ(folder.text("again/cloud-final.csv"), folder.text("out/cloud-final.csv"));
}

TEST(StudyAsRun, KeepsTheOrderOfMasses) {
  StudyFolder folder;
  const nlohmann::json first =
      folder.update_changed({{"m1 = 1.0, m2 = 1.0, m3 = 1.0", "m3 = 1.1, m1 = 1.3, m2 = 0.7"}});
  EXPECT_EQ(untimed(folder.update({.study = "out/study.toml", .out = "again"})), untimed(first));
}

TEST(StudyAsRun, HoldsOverriddenValues) {
  StudyFolder folder;
  const nlohmann::json first = folder.update(
      {.set = {"parameter.k2.distribution.mean=1.7", "model.springs.k6.stiffness=2.9", "model.masses.m2=1.1",
               R"(title="Ü \"quoted\" # title")", "update.deterministic.specimen=2"}});
  EXPECT_EQ(first["title"], "Ü \"quoted\" # title");
  EXPECT_EQ(untimed(folder.update({.study = "out/study.toml", .out = "again"})), untimed(first));
}

TEST(StudyAsRun, FindsItsTestsFromALinkedFolder) {
  StudyFolder folder;
  std::filesystem::create_directories(folder / "far/away");
  std::filesystem::create_directory_symlink(folder / "far/away", folder / "link");
  folder.update({.out = "link/out"});
  EXPECT_NO_THROW(folder.check({.study = "link/out/study.toml"}));
}

TEST(Seed, ChangesTheDrawAndNothingElse) {
  StudyFolder folder;
  const nlohmann::json first = folder.update({.seed = 1});
  const nlohmann::json second = folder.update({.seed = 2});
  EXPECT_EQ(first["seed"], 1);
  EXPECT_EQ(second["seed"], 2);
  EXPECT_EQ(first["outputs"]["test_mean"], second["outputs"]["test_mean"]);
  EXPECT_NE(first["outputs"]["initial_mean"], second["outputs"]["initial_mean"]);
}

TEST(Seed, MayBeTheLargest) {
  EXPECT_EQ(StudyFolder().update({.seed = 9223372036854775807U})["seed"], 9223372036854775807U);
}

}  // namespace
}  // namespace mottle::study
