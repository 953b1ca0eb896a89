// Priors and their correlation that cannot be.
#include <gtest/gtest.h>

#include "support/study_refusals.hpp"

namespace mottle::study {
namespace {

using test::expect_refused;
using test::WrongStudy;

/// Another prior of k1.
WrongStudy wrong_prior(const std::string& what, const std::string& distribution, std::vector<std::string> says) {
  const std::string good = R"({ kind = "normal", mean = 2.0, std = 0.3 })"
                           "\nbounds = [0.5, 3.0]";
  says.emplace_back("parameter.1.distribution");
  return {
      .what = what, .changes = {{good, distribution}}, .says = std::move(says), .at = "distribution = " + distribution};
}

WrongStudy wrong_correlation(const std::string& what, const std::string& section, std::vector<std::string> says,
                             const std::string& at = "") {
  says.emplace_back("correlation");
  return {.what = what,
          .changes = {{"[outputs]", "[correlation]\n" + section + "\n\n[outputs]"}},
          .says = std::move(says),
          .at = at};
}

TEST(ReadDistribution, SaysWhichNumberIsWrongAndWhatIsAllowed) {
  expect_refused({
      wrong_prior("an unknown distribution", R"({ kind = "gaussian", mean = 2.0, std = 0.3 })",
                  {"gaussian", "normal", "truncated-normal"}),
      wrong_prior("a nearly right distribution", R"({ kind = "log-normal", mean = 2.0, std = 0.3 })",
                  {"log-normal", R"(did you mean "lognormal")"}),
      wrong_prior("a distribution without kind", "{ mean = 2.0, std = 0.3 }", {"kind", "missing"}),
      wrong_prior("a distribution without std", R"({ kind = "normal", mean = 2.0 })", {"std", "missing"}),
      wrong_prior("a negative deviation", R"({ kind = "normal", mean = 2.0, std = -0.3 })",
                  {"std", "-0.3", "positive"}),
      wrong_prior("a deviation of zero", R"({ kind = "normal", mean = 2.0, std = 0.0 })", {"std", "0", "positive"}),
      wrong_prior("a mean that is not a number", R"({ kind = "normal", mean = nan, std = 0.3 })", {"mean", "nan"}),
      wrong_prior("an infinite deviation", R"({ kind = "normal", mean = 2.0, std = inf })", {"std", "inf", "finite"}),
      wrong_prior("a value that the distribution does not take",
                  R"({ kind = "uniform", lower = 1, upper = 3, mean = 2 })", {"mean", "not known here"}),
      wrong_prior("lognormal with mean 0", R"({ kind = "lognormal", mean = 0.0, std = 0.3 })",
                  {"mean", "0", "positive"}),
      wrong_prior("uniform turned round", R"({ kind = "uniform", lower = 3.0, upper = 1.0 })",
                  {"lower", "3", "below", "1"}),
      wrong_prior("truncated where nothing is left",
                  R"({ kind = "truncated-normal", mean = 2.0, std = 0.1, lower = 90.0, upper = 91.0 })",
                  {"lower", "[90, 91]"}),
      wrong_prior("beta with its mean outside", R"({ kind = "beta", mean = 4.0, std = 0.1, lower = 1.0, upper = 3.0 })",
                  {"mean", "4", "(1, 3)"}),
      wrong_prior("beta too wide", R"({ kind = "beta", mean = 2.0, std = 5.0, lower = 1.0, upper = 3.0 })",
                  {"std", "5", "too large", "below 1"}),
      wrong_prior("gamma with a negative mean", R"({ kind = "gamma", mean = -2.0, std = 0.3 })",
                  {"mean", "-2", "positive"}),
  });
}

TEST(ReadDistribution, RefusesDrawsThatAreAlmostAllImpossible) {
  expect_refused({
      {"a distribution that is almost wholly impossible",
       {{R"({ kind = "normal", mean = 2.0, std = 0.3 }
bounds = [0.5, 3.0])",
         R"({ kind = "normal", mean = 1e-9, std = 1.0 })"},
        {R"({ kind = "normal", mean = 2.0, std = 0.3 }

[outputs])",
         R"({ kind = "normal", mean = 1e-9, std = 1.0 }

[correlation]
pairs = [{ between = ["k1", "k2"], value = -0.999999999 }]

[outputs])"}},
       {"impossible", "<= 0", "mean"}},
  });
}

TEST(ReadCorrelation, RefusesWhatIsNoCorrelationMatrix) {
  expect_refused({
      wrong_correlation("a correlation that is not positive definite", "matrix = [[1.0, 1.0], [1.0, 1.0]]",
                        {"not positive definite"}, "[correlation]"),
      wrong_correlation("a correlation that is not symmetric", "matrix = [[1.0, 0.5], [0.4, 1.0]]",
                        {"not symmetric", "0.5", "0.4"}, "[correlation]"),
      wrong_correlation("a correlation above 1", R"(pairs = [{ between = ["k1", "k2"], value = 1.5 }])",
                        {"correlation.pairs.1.value", "1.5", "<= 1"}, "1.5"),
      wrong_correlation("a correlation of an unknown parameter", R"(pairs = [{ between = ["k1", "k5"], value = 0.5 }])",
                        {"'k5'", "Known: k1, k2"}, "pairs = "),
      wrong_correlation("a correlation matrix of the wrong size", "matrix = [[1.0]]", {"2 rows of 2 numbers"},
                        "matrix"),
      wrong_correlation("a correlation matrix with a text", R"(matrix = [[1.0, "a"], [0.4, 1.0]])",
                        {"2 rows of 2 numbers"}, "matrix"),
      wrong_correlation("a correlation both ways", "matrix = [[1, 0], [0, 1]]\npairs = []", {"matrix", "pairs"}),
      wrong_correlation("a pair given twice", R"(pairs = [{ between = ["k1", "k2"], value = 0.5 },
  { between = ["k2", "k1"], value = 0.1 }])",
                        {"correlation.pairs.2", "twice"}, R"(["k2", "k1"])"),
  });
}

}  // namespace
}  // namespace mottle::study
