#include "mottle/stats/sampling/sampling.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>
#include <openturns/SobolSequence.hxx>
#include <set>

#include "mottle/core/error.hpp"
#include "mottle/stats/moments/descriptive.hpp"

namespace mottle::stats {
namespace {

constexpr StreamKey k_key{.seed = 42, .purpose = StreamPurpose::parameter_cloud, .iteration = 3};

constexpr SamplingDesign k_every_design[] = {SamplingDesign::monte_carlo, SamplingDesign::latin_hypercube,
                                             SamplingDesign::sobol};

/// L2 star discrepancy by the formula of [Warnock1972].
double discrepancy(const Eigen::MatrixXd& points) {
  const auto count = static_cast<double>(points.rows());
  const auto dimension = static_cast<double>(points.cols());
  const double single = (1.0 - points.array().square()).rowwise().prod().sum();
  double pairs = 0.0;
  for (Eigen::Index i = 0; i < points.rows(); ++i) {
    for (Eigen::Index j = 0; j < points.rows(); ++j) {
      pairs += (1.0 - points.row(i).cwiseMax(points.row(j)).array()).prod();
    }
  }
  return std::sqrt(std::pow(3.0, -dimension) - std::pow(2.0, 1.0 - dimension) / count * single + pairs / count / count);
}

TEST(UniformDesign, MonteCarloRowsAreTheSamplesStreams) {
  const Eigen::MatrixXd design = uniform_design(SamplingDesign::monte_carlo, 7, 3, k_key);
  RandomStream stream(k_key, 6);
  for (Eigen::Index j = 0; j < 3; ++j) EXPECT_EQ(design(6, j), stream.uniform());
}

TEST(UniformDesign, MonteCarloOfFewerRowsIsTheBeginningOfALargerOne) {
  const Eigen::MatrixXd large = uniform_design(SamplingDesign::monte_carlo, 50, 4, k_key);
  EXPECT_EQ(uniform_design(SamplingDesign::monte_carlo, 20, 4, k_key), large.topRows(20));
}

TEST(UniformDesign, SobolOfFewerRowsIsTheBeginningOfALargerOne) {
  const Eigen::MatrixXd large = uniform_design(SamplingDesign::sobol, 50, 4, k_key);
  EXPECT_EQ(uniform_design(SamplingDesign::sobol, 20, 4, k_key), large.topRows(20));
}

TEST(UniformDesign, LatinHypercubeHasOneValueInEveryStratumOfEveryColumn) {
  constexpr Eigen::Index k_samples = 1000;
  const Eigen::MatrixXd design = uniform_design(SamplingDesign::latin_hypercube, k_samples, 5, k_key);
  for (Eigen::Index j = 0; j < design.cols(); ++j) {
    std::set<int> strata;
    for (Eigen::Index s = 0; s < k_samples; ++s) strata.insert(static_cast<int>(design(s, j) * k_samples));
    EXPECT_EQ(strata.size(), static_cast<std::size_t>(k_samples));
    EXPECT_EQ(*strata.rbegin(), k_samples - 1);
  }
}

TEST(UniformDesign, LatinHypercubeColumnsAreUncorrelated) {
  constexpr Eigen::Index k_samples = 10000;
  const Eigen::MatrixXd design = uniform_design(SamplingDesign::latin_hypercube, k_samples, 4, k_key);
  Eigen::MatrixXd correlation = correlation_from_covariance(sample_covariance(design));
  correlation.diagonal().setZero();
  // Correlation of two random permutations: standard error 1 / sqrt(n - 1); six pairs, hence 4.5 instead of 4.
  EXPECT_LT(correlation.cwiseAbs().maxCoeff(), 4.5 / std::sqrt(k_samples - 1.0));
}

// With the shift (row 0) taken off again, the points are OpenTURNS' own.
TEST(UniformDesign, SobolIsTheShiftedSequenceOfOpenTurns) {
  const Eigen::MatrixXd design = uniform_design(SamplingDesign::sobol, 64, 3, k_key);
  const OT::SobolSequence sequence(3);
  for (Eigen::Index s = 1; s < design.rows(); ++s) {
    const OT::Point point = sequence.generate();
    for (Eigen::Index j = 0; j < 3; ++j) {
      const double unshifted = design(s, j) - design(0, j) + (design(s, j) < design(0, j) ? 1.0 : 0.0);
      EXPECT_NEAR(unshifted, point[static_cast<OT::UnsignedInteger>(j)], 1e-15);
    }
  }
}

TEST(UniformDesign, SobolOfAPowerOfTwoIsSpreadEvenlyInEveryColumn) {
  const Eigen::MatrixXd design = uniform_design(SamplingDesign::sobol, 256, 10, k_key);
  for (Eigen::Index j = 0; j < design.cols(); ++j) {
    // The shift moves every point by one amount: in the frame of row 0 each interval of 1/256 holds one point.
    std::set<int> cells;
    for (Eigen::Index s = 0; s < design.rows(); ++s) {
      const double moved = design(s, j) - design(0, j) + 1.0 + 1e-12;
      cells.insert(static_cast<int>((moved - std::floor(moved)) * 256.0));
    }
    EXPECT_EQ(cells.size(), 256U);
  }
}

// E[discrepancy^2] of independent points is (2^-d - 3^-d) / n; each better design must lie well below its root.
TEST(UniformDesign, DiscrepancyFallsFromMonteCarloOverLatinHypercubeToSobol) {
  const double monte_carlo = discrepancy(uniform_design(SamplingDesign::monte_carlo, 512, 3, k_key));
  const double latin = discrepancy(uniform_design(SamplingDesign::latin_hypercube, 512, 3, k_key));
  const double sobol = discrepancy(uniform_design(SamplingDesign::sobol, 512, 3, k_key));
  const double expected = std::sqrt((1.0 / 8.0 - 1.0 / 27.0) / 512.0);
  EXPECT_LT(monte_carlo, 3.0 * expected);
  EXPECT_GT(monte_carlo, 0.3 * expected);
  EXPECT_LT(latin, monte_carlo);
  EXPECT_LT(sobol, 0.3 * expected);
}

TEST(UniformDesign, EveryDesignLiesInTheOpenUnitCubeAndRepeats) {
  for (const SamplingDesign design : k_every_design) {
    const Eigen::MatrixXd uniforms = uniform_design(design, 1000, 6, k_key);
    EXPECT_GT(uniforms.minCoeff(), 0.0);
    EXPECT_LT(uniforms.maxCoeff(), 1.0);
    EXPECT_EQ(uniforms, uniform_design(design, 1000, 6, k_key));
    EXPECT_NEAR(uniforms.mean(), 0.5, 4.0 * std::sqrt(1.0 / 12.0 / 6000.0));
  }
}

TEST(UniformDesign, DrawsOfAnotherSeedPurposeOrIterationAreUncorrelated) {
  for (const SamplingDesign design : k_every_design) {
    const Eigen::MatrixXd reference = uniform_design(design, 4000, 1, k_key);
    for (const StreamKey& other : {StreamKey{.seed = 43, .purpose = k_key.purpose, .iteration = 3},
                                   StreamKey{.seed = 42, .purpose = StreamPurpose::truth, .iteration = 3},
                                   StreamKey{.seed = 42, .purpose = k_key.purpose, .iteration = 4}}) {
      const Eigen::MatrixXd uniforms = uniform_design(design, 4000, 1, other);
      EXPECT_NE(reference, uniforms);
      if (design == SamplingDesign::sobol) continue;  // one sequence under another shift: correlated by construction
      Eigen::MatrixXd both(4000, 2);
      both << reference, uniforms;
      EXPECT_LT(std::abs(correlation_from_covariance(sample_covariance(both))(0, 1)), 4.0 / std::sqrt(4000.0));
    }
  }
}

TEST(UniformDesign, OneSampleIsAllowed) {
  for (const SamplingDesign design : k_every_design) EXPECT_EQ(uniform_design(design, 1, 2, k_key).rows(), 1);
}

TEST(UniformDesign, SobolReachesItsLimitOfDimensionsAndSaysItBeyond) {
  EXPECT_EQ(uniform_design(SamplingDesign::sobol, 4, 1111, k_key).cols(), 1111);
  try {
    static_cast<void>(uniform_design(SamplingDesign::sobol, 4, 1112, k_key));
    FAIL() << "accepted";
  } catch (const InvalidInput& error) {
    EXPECT_THAT(error.what(), ::testing::HasSubstr("at most 1111"));
  }
}

TEST(UniformDesign, RefusesSizesOutsideItsRange) {
  for (const SamplingDesign design : k_every_design) {
    EXPECT_THROW(static_cast<void>(uniform_design(design, 0, 1, k_key)), InvalidInput);
    EXPECT_THROW(static_cast<void>(uniform_design(design, Eigen::Index{1} << 32, 1, k_key)), InvalidInput);
    EXPECT_THROW(static_cast<void>(uniform_design(design, 1, 0, k_key)), InvalidInput);
    EXPECT_THROW(static_cast<void>(uniform_design(design, 1, 65536, k_key)), InvalidInput);
  }
}

}  // namespace
}  // namespace mottle::stats
