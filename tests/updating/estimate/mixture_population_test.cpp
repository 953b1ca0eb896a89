// A population of two batches against its definition.
#include "mottle/updating/estimate/mixture_population.hpp"

#include <gtest/gtest.h>

#include <cmath>

#include "mottle/stats/sampling/sampling.hpp"

namespace mottle::updating {
namespace {

/// The first on its own axis, the second on the logarithm's.
MixturePopulation two_batches() {
  Eigen::Matrix2d narrow;
  narrow << 0.04, 0.006, 0.006, 0.01;
  Eigen::Matrix2d wide;
  wide << 0.25, -0.02, -0.02, 0.04;
  return {{{}, {ParameterTransform::Kind::log}},
          {{0.7, Eigen::Vector2d(1.0, 0.0), narrow}, {0.3, Eigen::Vector2d(4.0, 1.0), wide}}};
}

TEST(MixturePopulation, HasTheMomentsOfItsBatches) {
  const MixturePopulation population = two_batches();
  EXPECT_NEAR(population.mean()(0), 0.7 * 1.0 + 0.3 * 4.0, 1e-14);
  // E x = exp(m + s^2 / 2), E x^2 = exp(2 m + 2 s^2).
  const double mean = 0.7 * std::exp(0.005) + 0.3 * std::exp(1.02);
  EXPECT_NEAR(population.mean()(1), mean, 1e-12);
  EXPECT_NEAR(population.covariance()(1, 1), 0.7 * std::exp(0.02) + 0.3 * std::exp(2.08) - mean * mean, 1e-12);
  EXPECT_NEAR(population.covariance()(0, 0), 0.7 * 0.04 + 0.3 * 0.25 + 0.21 * 9.0, 1e-12);
}

TEST(MixturePopulation, HasADensityOfAreaOneWithTwoPeaks) {
  const MixturePopulation population = two_batches();
  for (Eigen::Index i = 0; i < 2; ++i) {
    const Eigen::VectorXd x = population.density_points(i, 1601);
    ASSERT_EQ(x.size(), 1601);
    const Eigen::VectorXd y = population.density(i, x);
    double area = 0.0;
    for (Eigen::Index k = 1; k < x.size(); ++k) area += 0.5 * (y(k) + y(k - 1)) * (x(k) - x(k - 1));
    EXPECT_NEAR(area, 1.0, 1e-3);
  }
  const Eigen::VectorXd y = population.density(0, Eigen::Vector3d(1.0, 2.2, 4.0));
  EXPECT_GT(y(0), 10.0 * y(1));
  EXPECT_GT(y(2), 10.0 * y(1));
}

TEST(MixturePopulation, DrawsWhatItsQuantilesAndRegionsSay) {
  const MixturePopulation population = two_batches();
  const Eigen::MatrixXd drawn =
      population.from_uniform(uniform_design(SamplingDesign::latin_hypercube, 20000, 2, {.seed = 3}));
  for (Eigen::Index i = 0; i < 2; ++i) {
    for (const double probability : {0.025, 0.5, 0.7, 0.975}) {
      const double end = population.quantile(i, probability);
      EXPECT_NEAR(static_cast<double>((drawn.col(i).array() < end).count()) / 20000.0, probability, 0.01);
    }
  }
  const auto outlines = population.region(0, 1, 0.86, 257);
  ASSERT_EQ(outlines.size(), 2U);
  int inside = 0;
  for (const auto& point : drawn.rowwise()) {
    bool is_in = false;
    for (const Eigen::MatrixXd& outline : outlines) {
      bool odd = false;
      for (Eigen::Index k = 1; k < outline.rows(); ++k) {
        const bool above = outline(k, 1) > point(1);
        if (above == (outline(k - 1, 1) > point(1))) continue;
        const double x = outline(k, 0) + (outline(k - 1, 0) - outline(k, 0)) * (point(1) - outline(k, 1)) /
                                             (outline(k - 1, 1) - outline(k, 1));
        odd = odd != (point(0) < x);
      }
      is_in = is_in || odd;
    }
    inside += is_in ? 1 : 0;
  }
  EXPECT_NEAR(inside / 20000.0, 0.86, 0.012);  // three standard errors, and the polygon's 0.1 %
}

}  // namespace
}  // namespace mottle::updating
