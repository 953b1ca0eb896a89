#include "mottle/stats/chains/evidence_comparison.hpp"

#include <gtest/gtest.h>

#include <boost/math/distributions/students_t.hpp>
#include <cmath>
#include <string>

#include "mottle/core/error.hpp"
#include "mottle/core/random.hpp"
#include "mottle/stats/distributions/standard_normal.hpp"

namespace mottle::stats {
namespace {

/// The three masses of validation/bayes, by quadrature.
const std::vector<EstimatedEvidence> k_three_masses{
    {8.6435911, 0.03, 7.0}, {-5.3808755, 0.04, 7.0}, {-4.6166521, 0.05, 7.0}};

TEST(EvidenceComparison, GivesTheBayesFactorsOfThreeMasses) {
  const std::vector<ModelProbability> found = compare_evidences(k_three_masses);
  EXPECT_EQ(found[0].log_bayes_factor, 0.0);
  EXPECT_EQ(found[0].standard_error, 0.0);
  EXPECT_NEAR(found[1].log_bayes_factor, 14.0244666, 1e-7);
  EXPECT_NEAR(found[2].log_bayes_factor, 13.2602432, 1e-7);
  EXPECT_NEAR(found[1].standard_error, 0.05, 1e-15);
  EXPECT_NEAR(found[0].probability, 1.0 - std::exp(-14.0244666) - std::exp(-13.2602432), 1e-10);
}

TEST(EvidenceComparison, HasProbabilitiesOfSumOne) {
  const std::vector<ModelProbability> found = compare_evidences({{-700.0, 0.1, 7.0}, {-701.0, 0.2, 7.0}, {-705.0}});
  double sum = 0.0;
  for (const ModelProbability& one : found) {
    sum += one.probability;
    EXPECT_LE(one.lower, one.probability);
    EXPECT_GE(one.upper, one.probability);
  }
  EXPECT_NEAR(sum, 1.0, 1e-14);
  EXPECT_NEAR(found[1].probability, std::exp(-1.0) / (1.0 + std::exp(-1.0) + std::exp(-5.0)), 1e-14);
}

TEST(EvidenceComparison, KeepsWhatIsLeftToAProbabilityThatRoundsToOne) {
  const std::vector<ModelProbability> found = compare_evidences({{0.0, 0.1, 7.0}, {-200.0, 0.1, 7.0}});
  EXPECT_EQ(found[0].probability, 1.0);
  EXPECT_NEAR(std::log(found[0].rest), -200.0, 1e-9);
  EXPECT_GT(found[0].rest_of_lower, found[0].rest);
  EXPECT_LT(found[0].rest_of_upper, found[0].rest);
  EXPECT_GT(found[0].rest_of_upper, 0.0);
}

/// Of two models logit P is a difference of two t-variables.
TEST(EvidenceComparison, GivesTheIntervalOfTwoModelsDifference) {
  const std::vector<ModelProbability> found = compare_evidences({{1.0, 0.3, 7.0}, {0.0, 0.3, 7.0}});
  const boost::math::students_t t(14.0);  // Welch and Satterthwaite's, of two equal errors
  const double reach = quantile(complement(t, 0.025)) * std::sqrt(0.18);
  EXPECT_NEAR(found[0].lower, 1.0 / (1.0 + std::exp(reach - 1.0)), 1e-12);
  EXPECT_NEAR(found[0].upper, 1.0 / (1.0 + std::exp(-reach - 1.0)), 1e-12);
}

/// Evidences of three models with true ln Z, each by eight runs whose ln Z has a normal error of its own size, put
/// together as islands are: the logarithm of the mean of their evidences.
TEST(EvidenceComparison, HasIntervalsThatHoldTheProbability) {
  const std::vector<double> truth{0.0, -0.5, -1.5};
  const std::vector<double> spread{0.1, 0.2, 0.3};  // at 0.2, 0.4, 0.6 the intervals hold it in 92.6 % only
  const double sum = 1.0 + std::exp(-0.5) + std::exp(-1.5);
  constexpr std::uint32_t k_replications = 4000;
  std::vector<int> covered(3, 0);
  for (std::uint32_t r = 0; r < k_replications; ++r) {
    RandomStream stream({.seed = 7, .purpose = StreamPurpose::test_noise}, r);
    std::vector<EstimatedEvidence> evidences;
    for (std::size_t m = 0; m < 3; ++m) {
      double first = 0.0, second = 0.0;
      for (int run = 0; run < 8; ++run) {
        const double error = spread[m] * standard_normal_quantile(stream.uniform());
        const double evidence = std::exp(error - 0.5 * spread[m] * spread[m]);  // without bias, as each island's is
        first += evidence / 8.0;
        second += evidence * evidence;
      }
      const double variance = (second - 8.0 * first * first) / 7.0;
      evidences.push_back({truth[m] + std::log(first), std::sqrt(variance / 8.0) / first, 7.0});
    }
    const std::vector<ModelProbability> found = compare_evidences(evidences);
    for (std::size_t m = 0; m < 3; ++m) {
      const double exact = std::exp(truth[m]) / sum;
      covered[m] += found[m].lower <= exact && exact <= found[m].upper ? 1 : 0;
    }
  }
  for (const int count : covered) {
    EXPECT_NEAR(count / double{k_replications}, 0.95, 0.0138);  // four standard errors of 4,000 replications
  }
}

TEST(EvidenceComparison, NamesStrengthByTheScaleOfKassAndRaftery) {
  EXPECT_EQ(std::string(evidence_strength(0.9)), "not worth more than a bare mention");
  EXPECT_EQ(std::string(evidence_strength(1.1)), "positive");
  EXPECT_EQ(std::string(evidence_strength(3.1)), "strong");
  EXPECT_EQ(std::string(evidence_strength(5.1)), "very strong");
}

TEST(EvidenceComparison, RefusesOneModelAndUnknownEvidences) {
  EXPECT_THROW(compare_evidences({{1.0, 0.1, 7.0}}), InvalidInput);
  EXPECT_THROW(compare_evidences({{1.0, 0.1, 7.0}, {std::nan(""), 0.1, 7.0}}), InvalidInput);
  EXPECT_THROW(compare_evidences({{1.0, 0.1, 7.0}, {0.0, std::nan(""), 7.0}}), InvalidInput);
}

}  // namespace
}  // namespace mottle::stats
