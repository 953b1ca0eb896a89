// Clouds and specimens that the model gives without an update.
#include <gtest/gtest.h>

#include <numbers>

#include "mottle/study/jobs/study_objects.hpp"
#include "support/study_folder.hpp"

namespace mottle::study {
namespace {

using test::StudyFolder;
using test::three_masses;
using test::WrittenTable;
using testing::HasSubstr;

TEST(Propagate, IsTheFirstCloudOfAnUpdate) {
  StudyFolder folder;
  folder.update();
  folder.propagate(std::nullopt, {.out = "cloud"});
  EXPECT_EQ(folder.text("cloud/cloud.csv"), folder.text("out/cloud-initial.csv"));
}

TEST(Propagate, NeedsNoTests) {
  StudyFolder folder;
  folder.change({{"[test]\nfile = \"tests.csv\"", ""}});
  EXPECT_EQ(folder.propagate().rows.size(), 200U);
}

TEST(Propagate, EvaluatesGivenPoints) {
  StudyFolder folder;
  const WrittenTable cloud = folder.propagate("k2,k1\n1,1\n2.5,1.5\n1,1\n");
  EXPECT_EQ(cloud.header, (std::vector<std::string>{"k1", "k2", "f1", "f2", "f3", "status"}));
  EXPECT_EQ(cloud.texts("k1"), (std::vector<std::string>{"1", "1.5", "1"}));
  EXPECT_EQ(cloud.texts("k2"), (std::vector<std::string>{"1", "2.5", "1"}));
  EXPECT_EQ(cloud.rows[0], cloud.rows[2]);
  // K = [[5,-1,-3],[-1,3,-1],[-3,-1,5]], M = I: lambda = 1, 4, 8, f = sqrt(lambda) / 2 pi
  for (const auto& [name, eigenvalue] : {std::pair{"f1", 1.0}, {"f2", 4.0}, {"f3", 8.0}}) {
    EXPECT_NEAR(cloud.numbers(name)[0], std::sqrt(eigenvalue) / (2.0 * std::numbers::pi), 1e-14);
  }
  EXPECT_EQ(folder.propagate("k1,k2\n1,1\n", {.out = "one"}).rows.size(), 1U);
}

TEST(Propagate, GivesTiedElementsOneParameter) {
  StudyFolder folder;
  folder.change({{"target = \"spring:k2\"", "target = [\"spring:k2\", \"spring:k5\"]"}});
  const WrittenTable tied = folder.propagate("k1,k2\n1,1.5\n");
  folder.change({{R"(name = "k5", between = ["m2", "m3"], stiffness = 1.0)",
                  R"(name = "k5", between = ["m2", "m3"], stiffness = 1.5)"}});
  const WrittenTable plain = folder.propagate("k1,k2\n1,1.5\n", {.out = "plain"});
  for (const char* name : {"f1", "f2", "f3"}) EXPECT_NEAR(tied.numbers(name)[0], plain.numbers(name)[0], 1e-15);
}

TEST(Simulate, MakesTheSpecimensOfTheExamples) {
  const std::filesystem::path example = std::filesystem::path(MOTTLE_SOURCE_DIR) / "examples/01-three-masses";
  StudyFolder folder;
  for (int number = 1; number <= 4; ++number) {
    const std::string name = fmt::format("truth-case{}.toml", number);
    folder.write(name, read_file(example / name));
    const std::string out = fmt::format("out{}", number);
    folder.simulate({.study = name, .out = out});
    EXPECT_EQ(folder.text(out + "/specimens.csv"), read_file(example / fmt::format("specimens-case{}.csv", number)))
        << number;
  }
}

TEST(Simulate, MakesSpecimensThatAreTests) {
  StudyFolder folder;
  folder.change({{"\"tests.csv\"", "\"drawn/specimens.csv\""},
                 {"[outputs]", "[truth]\nspecimens = 20\nnoise = { f1 = 1e-4 }\n\n[outputs]"}});
  const WrittenTable specimens = folder.simulate();
  const WrittenTable truth = folder.table("drawn/specimens-truth.csv");
  EXPECT_EQ(specimens.header, (std::vector<std::string>{"f1", "f2", "f3"}));
  EXPECT_EQ(specimens.rows.size(), 20U);
  EXPECT_EQ(truth.rows.size(), 20U);
  EXPECT_NE(specimens.texts("f1")[0], truth.texts("f1")[0]);  // noise on f1 alone
  EXPECT_EQ(specimens.texts("f2"), truth.texts("f2"));
  EXPECT_EQ(specimens.texts("f3"), truth.texts("f3"));
  EXPECT_NO_THROW(folder.update());
}

TEST(Simulate, LeavesOutFrequenciesThatNoiseMakesImpossible) {
  StudyFolder folder;
  folder.write("study.toml", three_masses() + "\n[truth]\nspecimens = 50\nnoise = { f1 = 0.9 }\n");
  const SimulateOutcome outcome = simulate(folder.study(), {});
  write_results(outcome, folder / "noisy");
  const WrittenTable specimens = folder.table("noisy/specimens.csv");
  int left_out = 0;
  for (const std::string& cell : specimens.texts("f1")) {
    if (cell.empty() || cell == "nan") {
      ++left_out;
    } else {
      EXPECT_GT(std::strtod(cell.c_str(), nullptr), 0.0);
    }
  }
  EXPECT_GT(left_out, 0);
  folder.simulate({.out = "told"});
  const std::string said = folder.told() + fmt::format("{}", fmt::join(summarise(outcome, "noisy").lines, "\n"));
  EXPECT_THAT(said, HasSubstr("of 150 frequencies 0 or less: left out"));
  folder.change({{"\"tests.csv\"", "\"noisy/specimens.csv\""}});
  EXPECT_NO_THROW(folder.check());
}

TEST(Propagate, IsDoneInTheStudysUnits) {
  const StudyFolder folder;
  folder.change({{"units = \"SI\"", "units = \"mm-kg-ms\""}});
  const StudyModel made = make_model(folder.study(), folder.study().parameters);
  for (const Quantity& output : made.model->outputs()) EXPECT_EQ(output.unit, "kHz");
  EXPECT_THAT(folder.check(), HasSubstr("kHz"));
}

}  // namespace
}  // namespace mottle::study
