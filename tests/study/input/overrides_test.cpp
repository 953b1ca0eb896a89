// Values of a study that the command line replaces, and the study as it was run.
#include <gtest/gtest.h>

#include "support/study_refusals.hpp"

namespace mottle::study {
namespace {

using test::StudyFolder;

TEST(Overrides, AreRefusedByTheirOwnWords) {
  struct Wrong {
    std::string assignment;
    std::vector<std::string> says;
  };
  const StudyFolder folder;
  for (const auto& [assignment, says] : std::vector<Wrong>{
           {"seed", {"--set seed", "dotted.key=value"}},
           {"=3", {"--set =3", "dotted.key=value"}},
           {"update..samples=3", {"--set update..samples=3", "empty step"}},
           {"seed=", {"--set seed=", "TOML value"}},
           {"title=[1", {"--set title=[1", "not a TOML value"}},
           {"parameter.k9.bounds=[1, 2]", {"'parameter'", "no entry", "'k9'", "k1, k2"}},
           {"seed.x=3", {"--set seed.x=3", "not a table"}},
           {"update.sampels=3", {"update.sampels", "did you mean 'samples'", "--set"}},
           {"update.samples=many", {"update.samples", "many", "whole number", "--set"}},
           {"seed=3\nunits='SI'", {"--set seed=3", "one TOML value"}},
           {"update.interval.content=1.0", {"content", ">= 0.5 and <= 0.999"}},
       }) {
    SCOPED_TRACE(assignment);
    const std::string message =
        test::message_of<InvalidInput>([&, word = assignment] { (void)folder.study({.set = {word}}); });
    test::expect_message(printable(message), says);
  }
}

TEST(Overrides, TakeEffect) {
  const StudyFolder folder;
  const Study study =
      folder.study({.set = {"update.samples=150", "update.mares.weighting=euclidean", "parameter.k1.bounds=[0.6, 2.9]",
                            "title=other", "parameter.k2.distribution.mean=1.7", "model.springs.k6.stiffness=2.9"},
                    .seed = 9223372036854775807U});
  EXPECT_EQ(study.update.samples, 150);
  EXPECT_EQ(std::get<std::string>(study.update.method_options.at("mares").at("weighting")), "euclidean");
  EXPECT_EQ(study.parameters.list[0].lower_bound, 0.6);
  EXPECT_EQ(study.parameters.list[0].upper_bound, 2.9);
  EXPECT_EQ(study.parameters.list[1].distribution.mean, 1.7);
  EXPECT_EQ(study.title, "other");
  EXPECT_EQ(study.seed, 9223372036854775807U);
  EXPECT_THAT(study.text, testing::HasSubstr("stiffness = 2.9"));
}

TEST(StudyAsRun, HoldsOverriddenValuesAsAPersonWouldWriteThem) {
  const StudyFolder folder;
  const std::string text = folder
                               .study({.set = {"parameter.k2.distribution.mean=1.7", "model.masses.m2=1.1",
                                               R"(title="Ü \"quoted\" # title")", "update.deterministic.specimen=2"}})
                               .text;
  EXPECT_THAT(text, testing::HasSubstr("mean = 1.7,"));
  EXPECT_THAT(text, testing::HasSubstr("std = 0.3 "));
  folder.write("again.toml", text);
  const Study again = folder.study({.study = "again.toml"});
  EXPECT_EQ(again.title, "Ü \"quoted\" # title");
  EXPECT_EQ(again.text, text);
}

}  // namespace
}  // namespace mottle::study
