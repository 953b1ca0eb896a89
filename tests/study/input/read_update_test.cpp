// The sections [test] and [update] of a study.
#include <gtest/gtest.h>

#include "support/study_refusals.hpp"

namespace mottle::study {
namespace {

using test::expect_refused;

TEST(ReadTest, RefusesFilesAndNoiseThatAreNone) {
  expect_refused({
      {"no test file",
       {{R"("tests.csv")", R"("missing.csv")"}},
       {"test.file", "missing.csv", "no such file"},
       "missing.csv"},
      {"a folder in place of the test file", {{R"("tests.csv")", R"(".")"}}, {"test.file", "folder"}, R"(file = ".")"},
      {"the model's error to be estimated from as many outputs as parameters",
       {{R"(method = "mares")", R"(method = "maximum-likelihood")"},
        {"[test]\n", R"([test]
model_error = "estimated"
)"},
        {"[1, 2, 3]", "[1, 2]"}},
       {"test.model_error", "cannot be estimated"},
       "model_error"},
      {"repeatability by a pattern that fits nothing",
       {{R"("tests.csv")", R"("tests.csv"
repeatability = { "g*" = 0.001 })"}},
       {"test.repeatability", "'g*' fits no output", "f1, f2, f3"},
       "repeatability"},
      {"repeatability in something other than per cent",
       {{R"("tests.csv")", R"("tests.csv"
repeatability = { f1 = "1 Hz" })"}},
       {"test.repeatability.f1", "1 Hz", R"("1 %")"},
       "repeatability"},
      {"repeatability from a file that is not there",
       {{R"("tests.csv")", R"("tests.csv"
repeatability = "repeats.csv")"}},
       {"test.repeatability", "repeats.csv"},
       "repeatability"},
      {"repeatability of an unknown output",
       {{R"("tests.csv")", R"("tests.csv"
repeatability = { f9 = 0.001 })"}},
       {"test.repeatability", "'f9'", "f1, f2, f3"},
       "repeatability"},
      {"a negative repeatability",
       {{R"("tests.csv")", R"("tests.csv"
repeatability = { f1 = -0.001 })"}},
       {"test.repeatability.f1", "-0.001", ">= 0"},
       "repeatability"},
      {"a test file below a regular file", {{R"("tests.csv")", R"("study.toml/x.csv")"}}, {"study.toml/x.csv"}},
  });
}

TEST(ReadUpdate, RefusesMethodsAndOptionsThatAreNone) {
  expect_refused({
      {"an unknown method",
       {{R"(method = "mares")", R"(method = "marres")"}},
       {"update.method", "marres", "mares", "deterministic", R"(did you mean "mares")"},
       "marres"},
      {"an unknown value of an option",
       {{R"("mahalanobis")", R"("mahalonobis")"}},
       {"update.mares", "weighting", "mahalonobis", R"("mahalanobis" | "euclidean")"},
       "mahalonobis"},
      {"an option out of range",
       {{R"(weighting = "mahalanobis")", "model_error = -0.1"}},
       {"update.mares", "model_error", "-0.1", ">= 0"},
       "model_error"},
      {"one sample", {{"samples = 200", "samples = 1"}}, {"update.samples", "found 1", ">= 2"}, "samples = 1"},
      {"a huge number of samples",
       {{"samples = 200", "samples = 1000000000000"}},
       {"update.samples", "1000000000000", "<= "},
       "samples = "},
      {"no iterations",
       {{"iterations = 30", "iterations = 0"}},
       {"update.iterations", "found 0", ">= 1"},
       "iterations = 0"},
      {"a number beyond 64 bits", {{"samples = 200", "samples = 99999999999999999999"}}, {"TOML"}, "samples = "},
      {"an unknown sampling",
       {{"samples = 200", R"(samples = 200
sampling = "lhs")"}},
       {"update.sampling", "lhs", "latin-hypercube"},
       "sampling = "},
      {"a level above a half",
       {{"samples = 200", "samples = 200\nlevel = 0.9"}},
       {"update.level", "0.9", "<= 0.5"},
       "level"},
      {"a tolerance of zero",
       {{"samples = 200", "samples = 200\ntolerance = 0"}},
       {"update.tolerance", "found 0", "> 0"},
       "tolerance"},
      {"a negative seed", {{"seed = 7", "seed = -7"}}, {"seed", "-7", ">= 0"}, "seed = -7"},
      {"a specimen that is not there",
       {{R"(method = "mares")", R"(method = "deterministic")"},
        {"[update.mares]", "[update.deterministic]\nspecimen = 7\n[update.mares]"}},
       {"update.deterministic.specimen", "7", "1 to 6"},
       "specimen = 7"},
      {"more unknowns than data without regularisation",
       {{R"(method = "mares")", R"(method = "deterministic")"},
        {"[1, 2, 3]", "[1]"},
        {"[update.mares]", R"([update.deterministic]
regularisation = "none"
[update.mares])"}},
       {"2 parameters", "more unknowns", "bayesian"}},
      {"more unknowns than data",
       {{"[1, 2, 3]", "[1]"}},
       {"2 parameters", "more unknowns", "1 measured output"},
       "method = "},
      {"too few samples for the regression",
       {{"samples = 200", "samples = 3"}},
       {"update.samples", "3", "at least 4"},
       "samples = 3"},
      {"a covariance that is none",
       {{"samples = 200", R"(samples = 200
covariance = "diag")"}},
       {"update.covariance", "diag", R"("diagonal")", R"([["k1", "k2"], ["k5"]])"},
       R"(covariance = "diag")"},
      {"covariance groups of unknown parameters",
       {{"samples = 200", R"(samples = 200
covariance = [["k1", "k9"]])"}},
       {"update.covariance", "'k9'", "k1, k2"},
       "covariance = "},
      {"a parameter in two covariance groups",
       {{"samples = 200", R"(samples = 200
covariance = [["k1"], ["k1", "k2"]])"}},
       {"update.covariance", "'k1' is given twice"},
       "covariance = "},
  });
}

}  // namespace
}  // namespace mottle::study
