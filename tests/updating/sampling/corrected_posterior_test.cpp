#include "updating/sampling/corrected_posterior.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <limits>
#include <numbers>

#include "mottle/core/error.hpp"
#include "mottle/updating/estimate/posterior.hpp"

namespace mottle::updating {
namespace {

constexpr double k_errors = 4.0;  // standard errors: once in 16,000 cases of a normal error

/// u ~ N(0, 1) measured at 1 with noise 0.5, and four blocks of one variable with c_s = -(v_s - u - s)^2 / 2: all
/// normal.
SamplingTarget measured_once() {
  return {.dimension = 1, .log_likelihood = [](const Eigen::MatrixXd& points) -> Eigen::VectorXd {
            return -2.0 * (points.col(0).array() - 1.0).square();
          }};
}

Correction coupled_blocks() {
  return {.blocks = 4,
          .block_size = 1,
          .log_ratio = [](const Eigen::MatrixXd& points, const Eigen::MatrixXd& auxiliaries) -> Eigen::MatrixXd {
            Eigen::MatrixXd ratio(points.rows(), 4);
            for (Eigen::Index s = 0; s < 4; ++s) {
              ratio.col(s) = -0.5 * (auxiliaries.col(s) - points.col(0)).array().unaryExpr([s](double apart) {
                return (apart - static_cast<double>(s)) * (apart - static_cast<double>(s));
              });
            }
            return ratio;
          }};
}

TEST(CorrectedPosterior, HasTheEvidenceAndMomentsOfAClosedForm) {
  const std::vector<CorrectedIsland> found = sample_corrected(measured_once(), coupled_blocks(), {}, {.seed = 2});
  // Over v_s: exp(-(u + s)^2 / 4) / sqrt 2 each. Then u has precision 1 + 4 + 4 / 2 and is pulled by 4 - (0 + 1 + 2 +
  // 3) / 2.
  const double precision = 7.0;
  const double pull = 4.0 - 3.0;
  const double log_evidence =
      0.5 * pull * pull / precision - 0.5 * std::log(precision) - 2.0 - 14.0 / 4.0 - 2.0 * std::log(2.0);
  std::vector<SampledIsland> islands;
  double mean = 0.0;
  double square = 0.0;
  double last = 0.0;
  for (const CorrectedIsland& one : found) {
    islands.push_back(one.island);
    mean += one.island.points.mean() / 8.0;
    square += one.island.points.array().square().mean() / 8.0;
    last += one.auxiliaries.col(3).mean() / 8.0;
  }
  const Evidence evidence = combine_evidence(islands);
  EXPECT_NEAR(evidence.log_evidence, log_evidence, k_errors * evidence.standard_error);
  EXPECT_LT(evidence.standard_error, 0.05);
  const double error = k_errors / std::sqrt(precision * 2000.0);  // as if a quarter of the draws were independent
  EXPECT_NEAR(mean, pull / precision, error);
  EXPECT_NEAR(std::sqrt(square - mean * mean), 1.0 / std::sqrt(precision), error);
  EXPECT_NEAR(last, 0.5 * (pull / precision + 3.0), k_errors * std::sqrt(0.5 + 0.25 / precision) / std::sqrt(2000.0));
}

TEST(CorrectedPosterior, IsThatOfTheCheapLikelihoodWhereNothingIsToCorrect) {
  Correction none = coupled_blocks();
  none.log_ratio = [](const Eigen::MatrixXd& points, const Eigen::MatrixXd&) -> Eigen::MatrixXd {
    return Eigen::MatrixXd::Zero(points.rows(), 4);
  };
  const std::vector<CorrectedIsland> found = sample_corrected(measured_once(), none, {}, {});
  const std::vector<SampledIsland> plain = sample_posterior(measured_once(), {}, {});
  for (std::size_t i = 0; i < plain.size(); ++i) EXPECT_DOUBLE_EQ(found[i].island.log_evidence, plain[i].log_evidence);
}

/// Ten blocks that are possible above 0.5, once in three draws: all of a particle's are once in 128,000.
TEST(CorrectedPosterior, StartsWhereFewDrawsArePossible) {
  static constexpr double k_limit = 0.5;
  const Correction cut{
      .blocks = 10,
      .block_size = 1,
      .log_ratio = [](const Eigen::MatrixXd&, const Eigen::MatrixXd& auxiliaries) -> Eigen::MatrixXd {
        return auxiliaries.unaryExpr(
            [](double v) { return v > k_limit ? 0.0 : -std::numeric_limits<double>::infinity(); });
      },
      .is_possible = [](const Eigen::MatrixXd&, const Eigen::MatrixXd& auxiliaries) -> Correction::IsPossible {
        return auxiliaries.array() > k_limit;
      }};
  const std::vector<CorrectedIsland> found = sample_corrected(measured_once(), cut, {}, {.seed = 3});
  const std::vector<SampledIsland> plain = sample_posterior(measured_once(), {}, {.seed = 3});
  const double probability = 0.5 * std::erfc(k_limit / std::numbers::sqrt2);
  std::vector<SampledIsland> islands;
  double mean = 0.0;
  for (const CorrectedIsland& one : found) {
    islands.push_back(one.island);
    EXPECT_GT(one.auxiliaries.minCoeff(), k_limit);
    mean += one.auxiliaries.mean() / 8.0;
  }
  const Evidence evidence = combine_evidence(islands);
  EXPECT_NEAR(evidence.log_evidence, combine_evidence(plain).log_evidence + 10.0 * std::log(probability),
              k_errors * evidence.standard_error);
  EXPECT_LT(evidence.standard_error, 0.1);
  const double density = std::exp(-0.5 * k_limit * k_limit) / std::sqrt(2.0 * std::numbers::pi);
  EXPECT_NEAR(mean, density / probability, 0.02);  // of 80,000 numbers with standard deviation 0.5
}

TEST(CorrectedPosterior, DrawsTheSameNumbersAtAnyNumberOfThreads) {
  const SamplingSettings few{.particles = 100};
  const auto once = sample_corrected(measured_once(), coupled_blocks(), few, {.seed = 4, .threads = 1});
  const auto again = sample_corrected(measured_once(), coupled_blocks(), few, {.seed = 4, .threads = 3});
  for (std::size_t i = 0; i < once.size(); ++i) {
    EXPECT_EQ(once[i].island.points, again[i].island.points);
    EXPECT_EQ(once[i].auxiliaries, again[i].auxiliaries);
    EXPECT_EQ(once[i].island.log_evidence, again[i].island.log_evidence);
  }
}

TEST(CorrectedPosterior, RefusesACorrectionThatIsZeroEverywhere) {
  Correction impossible = coupled_blocks();
  impossible.log_ratio = [](const Eigen::MatrixXd& points, const Eigen::MatrixXd&) -> Eigen::MatrixXd {
    return Eigen::MatrixXd::Constant(points.rows(), 4, std::numeric_limits<double>::quiet_NaN());
  };
  EXPECT_THROW(sample_corrected(measured_once(), impossible, {.particles = 50}, {}), InvalidInput);
}

}  // namespace
}  // namespace mottle::updating
