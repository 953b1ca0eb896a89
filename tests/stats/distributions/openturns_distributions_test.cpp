// The families against OpenTURNS' own, over wide ranges of their parameters, and against closed forms where OpenTURNS
// stops or loses digits.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <exception>
#include <functional>
#include <numbers>
#include <openturns/Beta.hxx>
#include <openturns/DistFunc.hxx>
#include <openturns/Distribution.hxx>
#include <openturns/Gamma.hxx>
#include <openturns/LogNormal.hxx>
#include <openturns/Normal.hxx>
#include <openturns/TruncatedNormal.hxx>
#include <openturns/Uniform.hxx>
#include <random>

#include "mottle/stats/distributions/distribution.hpp"
#include "stats/distributions/incomplete_functions.hpp"
#include "stats/distributions/truncated_moments.hpp"
#include "stats/relative_error.hpp"

namespace mottle::stats {
namespace {

using Kind = DistributionKind;

constexpr int k_specs = 400;

/// Sizes over many decades.
class Draws {
 public:
  double between(double low, double high) { return low + (high - low) * uniform_(engine_); }
  double of_sizes(double low, double high) { return std::exp(between(std::log(low), std::log(high))); }

 private:
  std::mt19937_64 engine_{37};
  std::uniform_real_distribution<double> uniform_;
};

struct Pair {
  Distribution own;
  OT::Distribution peer;
};

Pair normal(Draws& draws) {
  const double mean = draws.between(-1.0, 1.0) * draws.of_sizes(1e-6, 1e12);
  const double std = draws.of_sizes(1e-9, 1e9);
  return {Distribution({.kind = Kind::normal, .mean = mean, .std = std}), OT::Normal(mean, std)};
}

Pair lognormal(Draws& draws) {
  const double mean = draws.of_sizes(0.1, 10.0);  // whose logarithm has many digits beside its deviation
  const double std = mean * draws.of_sizes(1e-3, 1e2);
  const double variance = std::log1p(std / mean * (std / mean));
  return {Distribution({.kind = Kind::lognormal, .mean = mean, .std = std}),
          OT::LogNormal(std::log(mean) - 0.5 * variance, std::sqrt(variance))};
}

Pair uniform(Draws& draws) {
  const double lower = draws.between(-1e3, 1e3);
  const double upper = lower + draws.of_sizes(1e-3, 1e6);
  return {Distribution({.kind = Kind::uniform, .lower = lower, .upper = upper}), OT::Uniform(lower, upper)};
}

Pair truncated_normal(Draws& draws) {
  const double mean = draws.between(-10.0, 10.0);
  const double std = draws.of_sizes(1e-3, 1e3);
  // Bounds within three standard deviations and at least a tenth of one apart: there OpenTURNS' forms cancel little.
  const double from = draws.between(-3.0, 2.9);
  const double to = from + draws.between(0.1, 4.0);
  const double lower = mean + std * from;
  const double upper = mean + std * to;
  return {Distribution({.kind = Kind::truncated_normal, .mean = mean, .std = std, .lower = lower, .upper = upper}),
          OT::TruncatedNormal(mean, std, lower, upper)};
}

/// Shapes from 1e-3 to 1e5. The peer's are those that mean and standard deviation give, with their rounding.
Pair beta(Draws& draws) {
  const double first = draws.of_sizes(1e-3, 1e5);
  const double second = draws.of_sizes(1e-3, 1e5);
  const double lower = draws.between(-2.0, 2.0);
  const double width = draws.of_sizes(1e-2, 1e4);
  const double fraction = first / (first + second);
  DistributionSpec spec{.kind = Kind::beta, .lower = lower, .upper = lower + width};
  spec.mean = lower + width * fraction;
  spec.std = width * std::sqrt(fraction * (1.0 - fraction) / (first + second + 1.0));
  const double concentration = (spec.mean - spec.lower) / spec.std * ((spec.upper - spec.mean) / spec.std) - 1.0;
  return {Distribution(spec),
          OT::Beta(concentration * (spec.mean - spec.lower) / (spec.upper - spec.lower),
                   concentration * (spec.upper - spec.mean) / (spec.upper - spec.lower), spec.lower, spec.upper)};
}

Pair gamma(Draws& draws) {
  const double mean = draws.of_sizes(1e-9, 1e12);
  const double std = mean * draws.of_sizes(1e-3, 30.0);
  return {Distribution({.kind = Kind::gamma, .mean = mean, .std = std}),
          OT::Gamma(mean / std * (mean / std), mean / std / std)};
}

struct Family {
  const char* name;
  std::function<Pair(Draws&)> draw;
  // What OpenTURNS' own numbers are good for.
  double probability_tolerance;  ///< relative
  double probability_slack;      ///< absolute
  double density_tolerance;      ///< relative
  double smallest;               ///< probability or density
};

void PrintTo(const Family& family, std::ostream* out) {
  *out << family.name;
}

class FamilyAgainstOpenTurns : public ::testing::TestWithParam<Family> {
 protected:
  /// Calls `check` with many members of the family.
  void for_each(const std::function<void(const Pair&)>& check) {
    Draws draws;
    for (int i = 0; i < k_specs; ++i) check(GetParam().draw(draws));
  }

  /// What two roundings of a value do to its probability: much where a bound has an infinite density, or the mean is
  /// far from 0.
  static double rounding(const Pair& pair, double value) {
    double size = std::abs(value);
    for (const double end : {pair.own.lower(), pair.own.upper()})
      size = std::max(size, std::isfinite(end) ? std::abs(end) : 0.0);
    const double spacing = std::nextafter(size, INFINITY) - size;
    return pair.peer.computeCDF(value + 2.0 * spacing) - pair.peer.computeCDF(value - 2.0 * spacing);
  }
};

TEST_P(FamilyAgainstOpenTurns, HasItsMomentsAndSupport) {
  for_each([](const Pair& pair) {
    const double std = pair.peer.getStandardDeviation()[0];
    EXPECT_NEAR(pair.own.mean(), pair.peer.getMean()[0], 1e-10 * std + 1e-14 * std::abs(pair.own.mean()));
    // OpenTURNS has exp(log_std^2) - 1, of which half the digits are left at std = 1e-4 mean.
    EXPECT_TRUE(is_relatively_near(pair.own.standard_deviation(), std, 1e-8));
    const OT::Interval range = pair.peer.getRange();
    if (range.getFiniteLowerBound()[0] != 0) {
      EXPECT_EQ(pair.own.lower(), range.getLowerBound()[0]);
    }
    if (range.getFiniteUpperBound()[0] != 0) {
      EXPECT_EQ(pair.own.upper(), range.getUpperBound()[0]);
    }
    EXPECT_EQ(std::isfinite(pair.own.lower()), range.getFiniteLowerBound()[0] != 0);
    EXPECT_EQ(std::isfinite(pair.own.upper()), range.getFiniteUpperBound()[0] != 0);
  });
}

TEST_P(FamilyAgainstOpenTurns, HasItsProbabilitiesAndDensities) {
  for_each([&](const Pair& pair) {
    for (const double score : {-35.0, -12.0, -5.0, -2.0, -0.5, 0.0, 0.3, 1.0, 4.0, 8.0}) {
      const double value = pair.own.from_standard_normal(score);
      if (!(pair.own.lower() < value && value < pair.own.upper()) || !std::isfinite(value)) continue;
      const double probability = pair.peer.computeCDF(value);
      if (probability > GetParam().smallest) {
        EXPECT_NEAR(
            pair.own.cdf(value), probability,
            GetParam().probability_tolerance * probability + GetParam().probability_slack + rounding(pair, value))
            << pair.peer.__str__() << value;
      }
      const double density = pair.peer.computePDF(value);
      if (density > GetParam().smallest && std::isfinite(density)) {
        EXPECT_TRUE(is_relatively_near(pair.own.pdf(value), density, GetParam().density_tolerance))
            << pair.peer.__str__() << value;
      }
    }
  });
}

TEST_P(FamilyAgainstOpenTurns, QuantilesAreWhereItsProbabilitiesAre) {
  for_each([&](const Pair& pair) {
    for (const double probability : {1e-12, 1e-3, 0.2, 0.5, 0.8, 0.999}) {
      const double value = pair.own.quantile(probability);
      if (value == pair.own.lower() || value == pair.own.upper()) continue;  // no double lies between
      EXPECT_NEAR(pair.peer.computeCDF(value), probability,
                  GetParam().probability_tolerance * probability + GetParam().probability_slack + rounding(pair, value))
          << pair.peer.__str__();
    }
  });
}

// A double rounds z^2 / 2 = 612 at a score of -35, and the logarithm of a value near 1 by 1e-16 / 1e-3 of a score; a
// truncated normal's probabilities are differences; those of beta and gamma have powers of the order of the shapes, and
// their densities logarithms of that size.
INSTANTIATE_TEST_SUITE_P(Every, FamilyAgainstOpenTurns,
                         ::testing::Values(Family{"normal", normal, 3e-13, 0.0, 3e-13, 1e-290},
                                           Family{"lognormal", lognormal, 1e-11, 0.0, 1e-11, 1e-290},
                                           Family{"uniform", uniform, 1e-15, 0.0, 1e-15, 0.0},
                                           Family{"truncated_normal", truncated_normal, 3e-13, 1e-12, 1e-12, 1e-290},
                                           Family{"beta", beta, 3e-10, 0.0, 1e-8, 1e-100},
                                           Family{"gamma", gamma, 3e-10, 0.0, 1e-8, 1e-290}),
                         [](const auto& test) { return test.param.name; });

// The same library inverts the same functions: samples of a beta keep their bits. Those of a gamma depend on which
// other program's copy of the library's templates OpenTURNS is linked to.
TEST(IncompleteFunctions, QuantilesAreThoseOfOpenTurns) {
  Draws draws;
  for (int i = 0; i < 20000; ++i) {
    const double first = draws.of_sizes(1e-3, 1e6);
    const double second = draws.of_sizes(1e-3, 1e6);
    const double probability = i % 2 == 0 ? draws.between(0.0, 0.5) : draws.of_sizes(1e-29, 0.5);
    const double t = standard_beta_quantile(first, second, probability);
    try {
      EXPECT_EQ(t, OT::DistFunc::qBeta(first, second, probability));
    } catch (const std::exception&) {  // iterations that do not end
      EXPECT_TRUE(is_relatively_near(standard_beta_cdf(first, second, t, 1.0 - t), probability, 1e-9));
    }
    EXPECT_TRUE(is_relatively_near(standard_gamma_quantile(first, probability),
                                   OT::DistFunc::qGamma(first, probability), 2e-12));
    EXPECT_TRUE(is_relatively_near(standard_gamma_upper_quantile(first, probability),
                                   OT::DistFunc::qGamma(first, probability, true), 2e-12));
  }
}

// F(t) = 1 - (1 - t)^b with a first shape of 1, t^a with a second one of 1.
TEST(IncompleteFunctions, BetaWithAShapeOfOneHasItsClosedFormDownToTheSmallestProbabilities) {
  for (const double shape : {0.01, 0.5, 1.0, 3.0, 200.0, 1e4}) {
    for (const double probability : {1e-300, 1e-200, 1e-100, 1e-40, 1e-20, 1e-3, 0.4}) {
      const double power = std::exp(std::log(probability) / shape);
      // The logarithm's rounding (691 ulp at the most), divided by the shape.
      if (power > 1e-290) {
        EXPECT_TRUE(is_relatively_near(standard_beta_quantile(shape, 1.0, probability), power, 2e-13 / shape + 2e-13));
        EXPECT_TRUE(
            is_relatively_near(standard_beta_cdf(shape, 1.0, power, 1.0 - power), probability, 2e-13 + 1e-15 * shape));
      }
      const double complement = -std::expm1(std::log1p(-probability) / shape);
      EXPECT_TRUE(is_relatively_near(standard_beta_quantile(1.0, shape, probability), complement, 2e-13));
    }
  }
}

// F(t) = t^2 (3 - 2 t) ~ 3 t^2 in the lower tail. OpenTURNS is 5 % off at 1e-308 and gives up below.
TEST(IncompleteFunctions, BetaQuantilesGoOnWhereBoostGivesUp) {
  for (const double probability : {1e-40, 1e-120, 1e-307}) {
    EXPECT_TRUE(is_relatively_near(standard_beta_quantile(2.0, 2.0, probability), std::sqrt(probability / 3.0), 3e-13));
  }
  // Boost throws here. F(t) ~ t^a / (a B(a, b)) (1 + O(b t)), b t = 1e-15.
  constexpr double k_first = 5.0;
  constexpr double k_second = 1e6;
  constexpr double k_probability = 1e-80;
  const double log_beta = std::lgamma(k_first) + std::lgamma(k_second) - std::lgamma(k_first + k_second);
  const double expected = std::exp((std::log(k_probability) + std::log(k_first) + log_beta) / k_first);
  // lgamma(1e6) = 1.3e7 has 2e-9 of an ulp's error, a fifth of which comes through.
  EXPECT_TRUE(is_relatively_near(standard_beta_quantile(k_first, k_second, k_probability), expected, 2e-9));
  EXPECT_TRUE(is_relatively_near(
      standard_beta_cdf(k_first, k_second, standard_beta_quantile(k_first, k_second, k_probability), 1.0),
      k_probability, 1e-12));
}

// With a shape of 1 the gamma is exponential; with 1/2 it is half a squared normal.
TEST(IncompleteFunctions, GammaHasItsClosedFormsDownToTheSmallestProbabilities) {
  for (const double probability : {1e-300, 1e-200, 1e-100, 1e-20, 1e-3, 0.4}) {
    EXPECT_TRUE(is_relatively_near(standard_gamma_quantile(1.0, probability), -std::log1p(-probability), 1e-13));
    EXPECT_TRUE(is_relatively_near(standard_gamma_upper_quantile(1.0, probability), -std::log(probability), 1e-13));
    EXPECT_TRUE(is_relatively_near(standard_gamma_cdf(1.0, probability), -std::expm1(-probability), 1e-13));
  }
  for (const double x : {1e-200, 1e-20, 0.01, 1.0, 20.0}) {
    EXPECT_TRUE(is_relatively_near(standard_gamma_cdf(0.5, x), std::erf(std::sqrt(x)), 1e-13));
    EXPECT_TRUE(is_relatively_near(standard_gamma_pdf(0.5, x), std::exp(-x) / std::sqrt(std::numbers::pi * x), 1e-13));
  }
  // x^(a - 1) e^-x / Gamma(a): in double, Boost's factors underflow before their product, which was 9 % off.
  constexpr double k_shape = 6.9;
  constexpr double k_x = 6.8e-47;
  const double expected = std::exp((k_shape - 1.0) * std::log(k_x) - std::lgamma(k_shape));
  EXPECT_TRUE(is_relatively_near(standard_gamma_pdf(k_shape, k_x), expected, 1e-12));
}

TEST(IncompleteFunctions, NothingThrowsInRange) {
  Draws draws;
  for (int i = 0; i < 20000; ++i) {
    const double first = draws.of_sizes(1e-6, 1e8);
    const double second = draws.of_sizes(1e-6, 1e8);
    const double probability = i % 2 == 0 ? draws.between(0.0, 0.5) : draws.of_sizes(1e-307, 0.5);
    const double t = standard_beta_quantile(first, second, probability);
    EXPECT_TRUE(0.0 <= t && t <= 1.0) << first << " " << second << " " << probability;
    const double x = standard_gamma_quantile(first, probability);
    const double y = standard_gamma_upper_quantile(first, probability);
    EXPECT_TRUE(0.0 <= x && std::isfinite(x) && 0.0 <= y && std::isfinite(y)) << first << " " << probability;
    const double z = draws.of_sizes(1e-300, 1e10);
    const double below = draws.of_sizes(1e-300, 1.0);
    for (const double result : {standard_beta_cdf(first, second, below, 1.0 - below), standard_gamma_cdf(first, z)}) {
      EXPECT_TRUE(0.0 <= result && result <= 1.0) << first << " " << second << " " << below << " " << z;
    }
    EXPECT_GE(standard_beta_pdf(first, second, below, 1.0 - below), 0.0);
    EXPECT_GE(standard_gamma_pdf(first, z), 0.0);
  }
  EXPECT_EQ(standard_beta_quantile(2.0, 3.0, 0.0), 0.0);
  EXPECT_EQ(standard_gamma_quantile(2.0, 0.0), 0.0);
}

// In long double, the closed form has 2^-64 where a double has 2^-53:
//   mean = (phi(a) - phi(b)) / P,   variance = 1 + (a phi(a) - b phi(b)) / P - mean^2
TEST(TruncatedMoments, AreThoseOfTheClosedForm) {
  const auto density = [](long double z) {
    return std::exp(-0.5L * z * z) / std::sqrt(2.0L * std::numbers::pi_v<long double>);
  };
  const auto tail = [](long double z) { return 0.5L * std::erfc(z / std::numbers::sqrt2_v<long double>); };
  for (const double from : {-40.0, -8.0, -2.0, -0.5, 0.0, 1.0, 4.0, 6.0}) {
    for (const double width : {2.0, 2.5, 5.0, 60.0}) {
      const double to = from + width;
      const long double mass = from > 0.0 ? tail(from) - tail(to) : tail(-to) - tail(-from);
      if (mass < 1e-10L) continue;
      const long double mean = (density(from) - density(to)) / mass;
      const long double variance = 1.0L + (from * density(from) - to * density(to)) / mass - mean * mean;
      const TruncatedMoments moments = truncated_moments(0.0, 1.0, from, to);
      const auto expected = static_cast<double>(std::sqrt(variance));
      EXPECT_NEAR(moments.mean, static_cast<double>(mean), 1e-14 * std::max(1.0, std::abs(from)));
      // The closed form in long double loses a^4 / variance of its 5e-20.
      EXPECT_TRUE(is_relatively_near(moments.standard_deviation, expected, 1e-14)) << from << " " << to;
    }
  }
}

}  // namespace
}  // namespace mottle::stats
