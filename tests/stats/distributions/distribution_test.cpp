#include "mottle/stats/distributions/distribution.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <functional>
#include <limits>

#include "mottle/core/error.hpp"
#include "stats/relative_error.hpp"

namespace mottle::stats {
namespace {

using Kind = DistributionKind;

const DistributionSpec k_normal{.kind = Kind::normal, .mean = 2.0, .std = 0.3};
const DistributionSpec k_lognormal{.kind = Kind::lognormal, .mean = 2.0, .std = 0.3};
const DistributionSpec k_uniform{.kind = Kind::uniform, .lower = 0.5, .upper = 3.0};
const DistributionSpec k_truncated{.kind = Kind::truncated_normal, .mean = 2.0, .std = 0.3, .lower = 1.5, .upper = 2.2};
const DistributionSpec k_beta{.kind = Kind::beta, .mean = 2.0, .std = 0.3, .lower = 0.5, .upper = 3.0};
const DistributionSpec k_gamma{.kind = Kind::gamma, .mean = 2.0, .std = 0.3};

struct Reference {
  DistributionSpec spec;
  double mean;
  double standard_deviation;
  std::array<double, 5> quantiles;        // at 1e-12, 1e-3, 0.3, 0.5, 0.9
  std::array<double, 2> upper_quantiles;  // at 1e-3, 1e-12
  std::array<double, 3> cdf;              // at 1.6, 1.9, 2.1
  std::array<double, 3> pdf;
};

// SciPy 1.10, d.mean(), d.std(), d.ppf(p), d.isf(p), d.cdf(x), d.pdf(x) of
//   v = log1p(.15**2)
//   norm(2, .3); lognorm(sqrt(v), scale=exp(log(2) - v / 2)); uniform(.5, 2.5);
//   truncnorm(-.5 / .3, .2 / .3, 2, .3); gamma((2 / .3)**2, scale=.045);
//   (the lognormal at 1e-12 of its upper tail is exp(.. + sqrt(v) norm.isf(1e-12)): SciPy's own forms 1 - 1e-12)
//   beta(.6 * nu, .4 * nu, .5, 2.5) with nu = .24 / .12**2 - 1
const std::array<Reference, 6> k_references = {{
    {k_normal,
     2.0,
     0.3,
     {-0.1103451475903392, 1.072930308149656, 1.8426798461875877, 2.0, 2.3844654696633802},
     {2.927069691850344, 4.110345147590339},
     {0.09121121972586793, 0.3694413401817635, 0.6305586598182364},
     {0.546700248919979, 1.2579440923099772, 1.2579440923099772}},
    {k_lognormal,
     2.0,
     0.3,
     {0.692611106222687, 1.2474021509970932, 1.8290541035548298, 1.977872705736595, 2.3945283586178796},
     {3.1361020477404282, 5.6481630238831695},
     {0.07760692061278586, 0.3938559060427884, 0.6560360752762431},
     {0.6087345655419024, 1.3574987196163923, 1.1748590629878226}},
    {k_uniform,
     1.75,
     0.7216878364870322,
     {0.5000000000025, 0.5025, 1.25, 1.75, 2.75},
     {2.9975, 2.9999999999975},
     {0.44, 0.56, 0.64},
     {0.4, 0.4, 0.4}},
    {k_truncated,
     1.9056886575177785,
     0.17996637244351252,
     {1.5000000000021103, 1.502097928436461, 1.804869358430244, 1.9221687949650053, 2.138245688234938},
     {2.1993433604835313, 2.199999999999343},
     {0.06205488878479329, 0.45968718390505614, 0.8328627370499596},
     {0.7813161075611499, 1.79778952666443, 1.79778952666443}},
    {k_beta,
     2.0,
     0.3,
     {0.556940940955374, 1.0820269012449426, 1.843957919588913, 2.0108960112971284, 2.384101511452064},
     {2.7572249798108275, 2.992055336831058},
     {0.09946987744343785, 0.36328171805724674, 0.6131206052049596},
     {0.5510400047752549, 1.1731509433409228, 1.251685794248761}},
    {k_gamma,
     2.0,
     0.3,
     {0.5505287448645639, 1.1992543372216984, 1.8324842023072498, 1.9850201646058405, 2.392809218511609},
     {3.056416496321497, 4.8850202273665975},
     {0.0832740230135629, 0.3863599908632984, 0.6471942615812044},
     {0.5931550621505589, 1.3191305516520926, 1.1979343005298007}},
}};

class DistributionAgainstScipy : public ::testing::TestWithParam<Reference> {
 protected:
  Distribution distribution_{GetParam().spec};
};

TEST_P(DistributionAgainstScipy, HasItsMeanAndStandardDeviation) {
  EXPECT_TRUE(is_relatively_near(distribution_.mean(), GetParam().mean, 1e-12));
  EXPECT_TRUE(is_relatively_near(distribution_.standard_deviation(), GetParam().standard_deviation, 1e-11));
}

TEST_P(DistributionAgainstScipy, HasItsQuantilesInBothTails) {
  constexpr std::array<double, 5> k_probabilities = {1e-12, 1e-3, 0.3, 0.5, 0.9};
  for (std::size_t i = 0; i < k_probabilities.size(); ++i) {
    EXPECT_TRUE(is_relatively_near(distribution_.quantile(k_probabilities[i]), GetParam().quantiles[i], 1e-10));
  }
  constexpr std::array<double, 2> k_upper = {1e-3, 1e-12};
  for (std::size_t i = 0; i < k_upper.size(); ++i) {
    EXPECT_TRUE(is_relatively_near(distribution_.upper_quantile(k_upper[i]), GetParam().upper_quantiles[i], 1e-10));
  }
}

TEST_P(DistributionAgainstScipy, HasItsCdfAndPdf) {
  constexpr std::array<double, 3> k_values = {1.6, 1.9, 2.1};
  for (std::size_t i = 0; i < k_values.size(); ++i) {
    EXPECT_TRUE(is_relatively_near(distribution_.cdf(k_values[i]), GetParam().cdf[i], 1e-10));
    EXPECT_TRUE(is_relatively_near(distribution_.pdf(k_values[i]), GetParam().pdf[i], 1e-10));
  }
}

TEST_P(DistributionAgainstScipy, QuantileOfTheStandardNormalProbabilityIsTheTransformOfTheScore) {
  for (const double z : {-6.0, -1.5, 0.0, 0.7}) {
    const double probability = 0.5 * std::erfc(-z / std::sqrt(2.0));
    EXPECT_TRUE(is_relatively_near(distribution_.from_standard_normal(z), distribution_.quantile(probability), 1e-12));
    EXPECT_TRUE(
        is_relatively_near(distribution_.from_standard_normal(-z), distribution_.upper_quantile(probability), 1e-12));
  }
}

TEST_P(DistributionAgainstScipy, EndsOfTheSupportAreTheQuantilesOfZeroAndOne) {
  EXPECT_EQ(distribution_.quantile(0.0), distribution_.lower());
  EXPECT_EQ(distribution_.quantile(1.0), distribution_.upper());
  EXPECT_EQ(distribution_.upper_quantile(0.0), distribution_.upper());
  EXPECT_LE(distribution_.lower(), distribution_.quantile(1e-300));
  EXPECT_LE(distribution_.upper_quantile(1e-300), distribution_.upper());
}

INSTANTIATE_TEST_SUITE_P(EveryKind, DistributionAgainstScipy, ::testing::ValuesIn(k_references), [](const auto& test) {
  std::string name = distribution_kind_info(test.param.spec.kind).name;
  std::replace(name.begin(), name.end(), '-', '_');
  return name;
});

TEST(Distribution, SupportsAreThoseOfTheFamilies) {
  constexpr double k_infinity = std::numeric_limits<double>::infinity();
  EXPECT_EQ(Distribution(k_normal).lower(), -k_infinity);
  EXPECT_EQ(Distribution(k_normal).upper(), k_infinity);
  for (const DistributionSpec& spec : {k_lognormal, k_gamma}) {
    EXPECT_EQ(Distribution(spec).lower(), 0.0);
    EXPECT_EQ(Distribution(spec).upper(), k_infinity);
  }
  for (const DistributionSpec& spec : {k_uniform, k_truncated, k_beta}) {
    EXPECT_EQ(Distribution(spec).lower(), spec.lower);
    EXPECT_EQ(Distribution(spec).upper(), spec.upper);
  }
}

// A normal that is nearly flat between close bounds is a uniform: deviation (upper - lower) / sqrt 12 up to a relative
// (width / std)^2 / 60 = 2e-9. The closed form has lost all but four digits here.
TEST(Distribution, TruncatedNormalBetweenCloseBoundsHasTheDeviationOfAUniform) {
  const Distribution narrow({.kind = Kind::truncated_normal, .mean = 2.0, .std = 0.3, .lower = 2.0, .upper = 2.0001});
  EXPECT_TRUE(is_relatively_near(narrow.standard_deviation(), 1e-4 / std::sqrt(12.0), 1e-8));
}

// SciPy 1.10: truncnorm(6, 2.9 / .3, 2, .3).mean(), .std(). (2 + 6 * .3 = 3.8.)
TEST(Distribution, TruncatedNormalFarInTheTailOfItsParentKeepsItsMoments) {
  const Distribution tail({.kind = Kind::truncated_normal, .mean = 2.0, .std = 0.3, .lower = 3.8, .upper = 4.9});
  EXPECT_TRUE(is_relatively_near(tail.mean(), 3.847544781363159, 1e-12));
  EXPECT_TRUE(is_relatively_near(tail.standard_deviation(), 0.04646382798220897, 1e-10));
}

TEST(Distribution, CopiesShareOneImplementation) {
  const Distribution original(k_beta);
  const Distribution copy = original;  // NOLINT: the copy is the point
  EXPECT_EQ(copy.quantile(0.3), original.quantile(0.3));
  EXPECT_EQ(copy.spec().upper, 3.0);
}

std::string message_of(const DistributionSpec& spec) {
  try {
    const Distribution distribution(spec);
  } catch (const InvalidInput& error) {
    return error.what();
  }
  return "accepted";
}

TEST(Distribution, SaysWhichValueIsWrong) {
  using ::testing::HasSubstr;
  using ::testing::StartsWith;
  EXPECT_THAT(message_of({.kind = Kind::normal, .mean = 1.0, .std = 0.0}), StartsWith("std: 0"));
  EXPECT_THAT(message_of({.kind = Kind::normal, .mean = 1.0}), StartsWith("std: missing"));
  EXPECT_THAT(message_of({.kind = Kind::normal, .mean = INFINITY, .std = 1.0}), StartsWith("mean: inf"));
  EXPECT_THAT(message_of({.kind = Kind::normal, .mean = 1.0, .std = 1.0, .lower = 0.0}), StartsWith("lower: 0"));
  EXPECT_THAT(message_of({.kind = Kind::uniform, .lower = 2.0, .upper = 2.0}), StartsWith("lower: 2"));
  EXPECT_THAT(message_of({.kind = Kind::lognormal, .mean = -1.0, .std = 1.0}), StartsWith("mean: -1"));
  EXPECT_THAT(message_of({.kind = Kind::lognormal, .mean = 1e308, .std = 1e307}), StartsWith("mean: 1e+308"));
  EXPECT_THAT(message_of({.kind = Kind::lognormal, .mean = 1e-308, .std = 1e-308}), StartsWith("mean: 1e-308"));
  EXPECT_THAT(message_of({.kind = Kind::lognormal, .mean = 1.0, .std = 1e4}), StartsWith("std: 10000"));
  EXPECT_THAT(message_of({.kind = Kind::normal, .mean = 1.0, .std = 1e200}), StartsWith("std: 1e+200"));
  EXPECT_THAT(message_of({.kind = Kind::uniform, .lower = -1.7e308, .upper = 1.7e308}), StartsWith("lower: -1.7e+308"));
  EXPECT_THAT(message_of({.kind = Kind::gamma, .mean = 0.0, .std = 1.0}), StartsWith("mean: 0"));
  EXPECT_THAT(message_of({.kind = Kind::beta, .mean = 3.0, .std = 0.1, .lower = 0.0, .upper = 3.0}),
              StartsWith("mean: 3"));
  EXPECT_THAT(message_of({.kind = Kind::beta, .mean = 0.5, .std = 0.5, .lower = 0.0, .upper = 1.0}),
              StartsWith("std: 0.5 is too large"));
  EXPECT_THAT(message_of({.kind = Kind::truncated_normal, .mean = 0.0, .std = 1.0, .lower = 9.0, .upper = 10.0}),
              HasSubstr("of the normal"));
}

// Shapes from 1e-6 to 1e8 stay within what the incomplete gamma and beta functions can do; beyond lies an error.
TEST(Distribution, ExtremeShapesGiveFiniteRisingQuantilesOrAMessage) {
  for (const double std : {1e-7, 1e-4, 1e-3, 1.0, 30.0, 1e3, 1e5}) {
    for (const DistributionSpec& spec :
         {DistributionSpec{.kind = Kind::gamma, .mean = 1.0, .std = std},
          DistributionSpec{.kind = Kind::beta, .mean = 1.0, .std = std, .lower = 0.0, .upper = 1e3},
          DistributionSpec{.kind = Kind::beta, .mean = 500.0, .std = std, .lower = 0.0, .upper = 1e3}}) {
      if (message_of(spec) != "accepted") {
        EXPECT_THAT(message_of(spec), ::testing::StartsWith("std: "));
        continue;
      }
      const Distribution distribution(spec);
      EXPECT_LE(distribution.lower(), distribution.quantile(1e-6));
      EXPECT_LE(distribution.quantile(1e-6), distribution.quantile(0.5));
      EXPECT_LE(distribution.quantile(0.5), distribution.upper_quantile(1e-6));
      EXPECT_LE(distribution.upper_quantile(1e-6), distribution.upper());
    }
  }
}

// A gamma or beta of many standard deviations from its ends is a normal up to a skewness of 2 std / mean.
TEST(Distribution, NarrowGammaAndBetaAreNearlyNormal) {
  const Distribution gamma({.kind = Kind::gamma, .mean = 1.0, .std = 2e-4});
  const Distribution beta({.kind = Kind::beta, .mean = 0.5, .std = 2e-4, .lower = 0.0, .upper = 1.0});
  EXPECT_NEAR((gamma.quantile(0.975) - 1.0) / 2e-4, 1.959964, 4e-4);
  EXPECT_NEAR((beta.quantile(0.975) - 0.5) / 2e-4, 1.959964, 1e-6);
}

TEST(Distribution, RefusesAProbabilityOutsideZeroToOne) {
  const Distribution distribution(k_normal);
  EXPECT_THROW(static_cast<void>(distribution.quantile(-0.1)), InvalidInput);
  EXPECT_THROW(static_cast<void>(distribution.quantile(1.1)), InvalidInput);
  EXPECT_THROW(static_cast<void>(distribution.upper_quantile(NAN)), InvalidInput);
}

TEST(Distribution, TableNamesEveryKindOnceAsAStudyWritesIt) {
  std::vector<std::string> names;
  for (const DistributionKindInfo& info : distribution_kinds()) names.push_back(info.name);
  EXPECT_THAT(names, ::testing::ElementsAre("normal", "lognormal", "uniform", "truncated-normal", "beta", "gamma"));
}

}  // namespace
}  // namespace mottle::stats
