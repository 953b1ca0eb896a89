// The sections [predict], [surrogate] and [diagnose] of a study, where they are wrong.
#include <gtest/gtest.h>

#include "support/study_refusals.hpp"

namespace mottle::study {
namespace {

using test::expect_unread;
using test::WrongStudy;

/// An entry of a section behind the good study, and what is said of it.
WrongStudy wrong_entry(const std::string& section, const std::string& entry, std::vector<std::string> says) {
  return {.what = entry,
          .changes = {{"weighting = \"mahalanobis\"\n",
                       "weighting = \"mahalanobis\"\n\n[" + section + "]\n" + entry + "\n"}},
          .says = std::move(says),
          .at = entry};
}

TEST(ReadPredict, RefusesWhatIsNoPrediction) {
  const std::string& good = test::k_three_masses_study;
  expect_unread(
      good, {
                wrong_entry("predict", "draws = 99", {"predict.draws", "found 99", ">= 100"}),
                wrong_entry("predict", "draws = 2.5", {"predict.draws", "2.5", "whole number"}),
                wrong_entry("predict", "model = { \"mass:m1\" = -1.0 }", {"predict.model.mass:m1", "-1", ">= 0"}),
                wrong_entry("predict", "repeatability = { f1 = -0.1 }", {"predict.repeatability.f1", "-0.1", ">= 0"}),
                wrong_entry("predict", "held_out = 3", {"predict.held_out", "found 3", "text"}),
                wrong_entry("predict", "frequencies = [0]", {"predict.frequencies", ">= 1"}),
                wrong_entry("predict", "drawn = 500", {"predict.drawn", "did you mean 'draws'"}),
            });
}

TEST(ReadSurrogate, RefusesWhatIsNoSurrogate) {
  expect_unread(
      test::k_three_masses_study,
      {
          wrong_entry("surrogate", "kind = \"krigging\"", {"surrogate.kind", "krigging", "did you mean \"kriging\""}),
          wrong_entry("surrogate", "runs = 9", {"surrogate.runs", "found 9", ">= 10"}),
          wrong_entry("surrogate", "spread = 0.1", {"surrogate.spread", "0.1", ">= 0.5"}),
          wrong_entry("surrogate", "rounds = -1", {"surrogate.rounds", "-1", ">= 0"}),
          wrong_entry("surrogate", "tolerance = 2.0", {"surrogate.tolerance", "2.0", "<= 1"}),
          wrong_entry("surrogate", "run = 20", {"surrogate.run", "did you mean 'runs'"}),
      });
}

TEST(ReadDiagnose, RefusesWhatIsNoDiagnosis) {
  const std::string allowed = "a list of targets, like [\"spring:k3\"]";
  expect_unread(
      test::k_three_masses_study,
      {
          wrong_entry("diagnose", "candidates = []", {"diagnose.candidates", allowed}),
          wrong_entry("diagnose", "candidates = \"spring:k3\"", {"diagnose.candidates", allowed}),
          wrong_entry("diagnose", "candidates = [3]", {"diagnose.candidates", allowed}),
          wrong_entry("diagnose", "candidates = [{ name = \"k3\" }]", {"diagnose.candidates.1.target", "missing"}),
          wrong_entry("diagnose", "spread = 0", {"diagnose.spread", "found 0", ">= 1e-06"}),
          wrong_entry("diagnose", "screened = 0", {"diagnose.screened", "found 0", ">= 1"}),
          wrong_entry("diagnose", "like_evidence = -1", {"diagnose.like_evidence", "-1", ">= 0"}),
          wrong_entry("diagnose", "evidence = -1", {"diagnose.evidence", "-1", ">= 0"}),
          wrong_entry("diagnose", "candidate = [\"spring:k3\"]", {"diagnose.candidate", "did you mean 'candidates'"}),
      });
}

}  // namespace
}  // namespace mottle::study
