// Points and truths that the model cannot be run for.
#include <gtest/gtest.h>

#include "support/study_refusals.hpp"

namespace mottle::study {
namespace {

using test::StudyFolder;
using test::three_masses;

TEST(Propagate, RefusesPointsThatAreNone) {
  struct WrongPoints {
    std::string what, points;
    std::vector<std::string> says;
  };
  StudyFolder folder;
  for (const WrongPoints& wrong : std::vector<WrongPoints>{
           {"of an unknown parameter", "k1,k3\n1,2\n", {"points.csv:1: ", "'k3'", "k1, k2"}},
           {"without a parameter", "k1\n1\n", {"points.csv:1: ", "'k2'", "no column"}},
           {"without a row", "k1,k2\n", {"points.csv", "no point"}},
           {"without a value", "k1,k2\n1,2\n1,\n", {"points.csv:3: ", "no value"}},
           {"that are impossible", "k1,k2\n1,2\n\n1,-2\n", {"points.csv:4: ", "<= 0", "impossible"}},
           {"with a text", "k1,k2\n1,two\n", {"points.csv:2: ", "column 'k2'", "'two'"}},
           {"in an empty file", "", {"points.csv", "is empty"}},
       }) {
    SCOPED_TRACE(wrong.what);
    const auto run = [&] { folder.propagate(wrong.points); };
    test::expect_message(folder.without_path(test::message_of<InvalidInput>(run)), wrong.says);
    EXPECT_FALSE(folder.has("out/cloud.csv"));
  }
  const auto without_file = [&] { (void)propagate(folder.study(), folder / "none.csv", {}); };
  test::expect_message(test::message_of<InvalidInput>(without_file), {"none.csv", "no such file"});
}

TEST(Simulate, RefusesTruthsThatAreNone) {
  struct WrongTruth {
    std::string truth;
    std::vector<std::string> says;
    std::string at;
  };
  const std::string unknown_spring =
      "[truth]\n[[truth.parameter]]\nname = \"k9\"\ntarget = \"spring:k9\"\n"
      "distribution = { kind = \"normal\", mean = 1.0, std = 0.2 }\n";
  StudyFolder folder;
  for (const WrongTruth& wrong : std::vector<WrongTruth>{
           {"", {"study.toml", "truth", "missing", "[truth]"}, ""},
           {"[truth]\nspecimens = 0\n", {"truth.specimens", "found 0", ">= 1"}, "specimens = 0"},
           {"[truth]\nnoise = { f9 = 0.1 }\n", {"truth.noise", "'f9'", "f1, f2, f3"}, ""},
           {"[truth]\nnoise = { f1 = -0.1 }\n", {"truth.noise.f1", "-0.1", ">= 0"}, "noise"},
           {"[truth]\nnoise = { \"g*\" = 0.001 }\n", {"truth.noise", "'g*' fits no output"}, ""},
           {unknown_spring, {"parameter 'k9'", "spring:k9"}, ""},
       }) {
    SCOPED_TRACE(wrong.truth);
    const std::string text = three_masses() + "\n" + wrong.truth;
    folder.write("study.toml", text);
    const std::string message = test::message_of<InvalidInput>([&] { folder.simulate(); });
    test::expect_message(folder.without_path(message), wrong.says);
    if (!wrong.at.empty()) {
      EXPECT_THAT(folder.without_path(message),
                  testing::StartsWith(fmt::format("study.toml:{}: ", test::line_of(text, wrong.at))));
    }
    EXPECT_FALSE(folder.has("drawn/specimens.csv"));
  }
}

}  // namespace
}  // namespace mottle::study
