// Parameters that explain the tests as well as those that the deterministic method found.
#include <gtest/gtest.h>

#include "support/study_folder.hpp"

namespace mottle::study {
namespace {

using test::edited;
using test::StudyFolder;
using testing::HasSubstr;

/// Masses 1 and 3 hang alike: their springs, which are the parameters, exchanged give the same frequencies.
const std::vector<test::TextChange> k_exchangeable{{"target = \"spring:k2\"", "target = \"spring:k3\""}};

/// One specimen, whose springs are 1.2 and 2.2.
void measure(StudyFolder& folder) {
  folder.change(k_exchangeable);
  const test::WrittenTable cloud = folder.propagate("k1,k2\n1.2,2.2\n", {.out = "cloud"});
  folder.write("tests.csv",
               fmt::format("f1,f2,f3\n{},{},{}\n", cloud.texts("f1")[0], cloud.texts("f2")[0], cloud.texts("f3")[0]));
}

nlohmann::json solved(StudyFolder& folder, std::vector<std::string> set = {}) {
  set.insert(set.end(),
             {"update.method=\"deterministic\"", "update.deterministic.regularisation=\"none\"", "update.samples=50"});
  return folder.update({.set = std::move(set)});
}

TEST(DeterministicMethod, NamesOtherSolutions) {
  StudyFolder folder;
  measure(folder);
  const nlohmann::json result = solved(folder, {"parameter.k2.distribution.mean=1.6"});
  EXPECT_EQ(result["options"]["starts"], 64);
  const std::vector<double> mean = test::doubles(result["parameters"]["mean"]);
  // Iterations end at steps of 0.001 of 0.3.
  EXPECT_NEAR(mean[0] + mean[1], 3.4, 0.003);
  ASSERT_EQ(result["other_solutions"].size(), 1U);
  const std::vector<double> other = test::doubles(result["other_solutions"][0]["mean"]);
  EXPECT_NEAR(other[0], mean[1], 0.003);
  EXPECT_NEAR(other[1], mean[0], 0.003);
  EXPECT_THAT(test::sentences(result["verdict"]["reasons"]),
              HasSubstr("Other parameters explain the tests as well, with a probability of "));
}

TEST(DeterministicMethod, SaysThatASolutionIsOutsideAPriorsRange) {
  StudyFolder folder;
  measure(folder);
  const std::string normal = R"(distribution = { kind = "normal", mean = 2.0, std = 0.3 })";
  std::string text = test::three_masses(k_exchangeable);
  for (const std::string range : {"lower = 0.5, upper = 1.8", "lower = 1.4, upper = 2.8"}) {
    text.replace(text.find(normal), normal.size(), R"(distribution = { kind = "uniform", )" + range + " }");
  }
  folder.write("study.toml", text);
  EXPECT_THAT(test::sentences(solved(folder)["verdict"]["reasons"]),
              HasSubstr("k1 lies outside the range of its prior, [0.5, 1.8]"));
}

}  // namespace
}  // namespace mottle::study
