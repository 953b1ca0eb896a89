#include "updating/population/mean_residuals.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <limits>

#include "mottle/core/random.hpp"
#include "mottle/stats/distributions/standard_normal.hpp"
#include "updating/estimate/normal_draws.hpp"
#include "updating/fits/measured_outputs.hpp"

namespace mottle::updating {
namespace {

struct Sums {
  double mean = 0.0;
  double square = 0.0;
  void add(double value) {
    mean += value;
    square += value * value;
  }
};

/// Linear outputs of one parameter, half of the entries of the later specimens missing; `shift` of the first output.
MeanResiduals draw(std::uint32_t replication, double shift) {
  constexpr Eigen::Index k_specimens = 8;
  const Eigen::VectorXd slope = Eigen::Vector4d(1.0, 2.0, -1.0, 0.5);
  const Eigen::VectorXd noise = Eigen::Vector4d(1.0, 0.25, 0.04, 4.0);
  Eigen::MatrixXd values = Eigen::MatrixXd::Zero(k_specimens, 4);
  std::vector<RandomEffectsUnit> units;
  for (Eigen::Index s = 0; s < k_specimens; ++s) {
    RandomStream stream({.seed = 7, .purpose = StreamPurpose::truth, .iteration = replication},
                        static_cast<std::uint32_t>(s));
    const auto normal = [&] { return standard_normal_quantile(stream.uniform()); };
    const double effect = 3.0 * normal();
    if (s >= 3) values(s, s % 4) = values(s, (s + 1) % 4) = std::numeric_limits<double>::quiet_NaN();
    Eigen::VectorXd response = slope * effect;
    for (Eigen::Index k = 0; k < 4; ++k) response(k) += std::sqrt(noise(k)) * normal();
    response(0) += shift;
    const std::vector<Eigen::Index> rows = measured_outputs(values, s);
    units.push_back({slope(rows), response(rows), noise(rows)});
  }
  return mean_residuals(values, units, noise);
}

/// Mean d and variance 2 d of chi-squared, each to four standard errors of 4000 replications; the plain sum of squares
/// has a smaller mean where entries are missing.
TEST(MeanResiduals, AreChiSquaredWhereEntriesAreMissing) {
  constexpr int k_replications = 4000;
  Sums means;
  Sums rest;
  double product = 0.0;
  for (std::uint32_t i = 0; i < k_replications; ++i) {
    const MeanResiduals found = draw(i, 0.0);
    EXPECT_EQ(found.mean_degrees_of_freedom, 3.0);
    EXPECT_EQ(found.degrees_of_freedom, 3.0 * 3.0 + 5.0 * 1.0 - 3.0);
    means.add(found.mean_squares);
    rest.add(found.squares);
    product += found.mean_squares * found.squares;
  }
  const double n = k_replications;
  EXPECT_NEAR(means.mean / n, 3.0, 4.0 * std::sqrt(6.0 / n));
  EXPECT_NEAR(rest.mean / n, 11.0, 4.0 * std::sqrt(22.0 / n));
  const double variance = means.square / n - std::pow(means.mean / n, 2);
  EXPECT_NEAR(variance, 6.0, 4.0 * std::sqrt((48.0 * 3.0 + 8.0 * 9.0) / n));  // fourth moment of chi-squared
  const double correlation = (product / n - means.mean * rest.mean / n / n) / std::sqrt(6.0 * 22.0);
  EXPECT_NEAR(correlation, 0.0, 4.0 / std::sqrt(n));
}

/// A shift adds its noncentrality: the sum over specimens of what their own parameter does not imitate of it.
TEST(MeanResiduals, ShowAShiftByTheNoncentralityOfLeastSquares) {
  const Eigen::Array4d slope(1.0, 2.0, -1.0, 0.5);
  const Eigen::Array4d noise(1.0, 0.25, 0.04, 4.0);
  double noncentrality = 0.0;
  for (int s = 0; s < 8; ++s) {
    Eigen::Array4d is_there = Eigen::Array4d::Ones();
    if (s >= 3) is_there(s % 4) = is_there((s + 1) % 4) = 0.0;
    const double total = (is_there * slope.square() / noise).sum();
    noncentrality += is_there(0) * (1.0 / noise(0) - std::pow(slope(0) / noise(0), 2) / total);
  }
  constexpr int k_replications = 4000;
  constexpr double k_shift = 1.5;
  double mean = 0.0;
  for (std::uint32_t i = 0; i < k_replications; ++i) mean += draw(i, k_shift).mean_squares / k_replications;
  const double expected = noncentrality * k_shift * k_shift;
  EXPECT_NEAR(mean, 3.0 + expected, 4.0 * std::sqrt((6.0 + 4.0 * expected) / k_replications));
}

/// Slopes that differ from specimen to specimen, and an error of the model, ten times the noise, that all share.
MeanResiduals draw_with_model_error(std::uint32_t replication) {
  constexpr Eigen::Index k_specimens = 8;
  constexpr Eigen::Index k_outputs = 4;
  const Eigen::VectorXd noise = Eigen::Vector4d(1.0, 0.25, 0.04, 4.0);
  const Eigen::VectorXd error = 10.0 * noise.cwiseSqrt();
  const auto stream_of = [&](Eigen::Index s) {
    return RandomStream({.seed = 8, .purpose = StreamPurpose::truth, .iteration = replication},
                        static_cast<std::uint32_t>(s));
  };
  RandomStream shared = stream_of(k_specimens);
  const Eigen::VectorXd shift = error.cwiseProduct(standard_normals(shared, k_outputs));
  std::vector<RandomEffectsUnit> units;
  for (Eigen::Index s = 0; s < k_specimens; ++s) {
    RandomStream stream = stream_of(s);
    const Eigen::VectorXd slope = Eigen::Vector4d(1.0, 2.0, -1.0, 0.5) + 0.3 * standard_normals(stream, k_outputs);
    const double effect = 3.0 * standard_normal_quantile(stream.uniform());
    const Eigen::VectorXd own = noise.cwiseSqrt().cwiseProduct(standard_normals(stream, k_outputs));
    units.push_back({slope, slope * effect + shift + own, noise});
  }
  return mean_residuals(Eigen::MatrixXd::Zero(k_specimens, k_outputs), units, noise, error);
}

/// Mean and variance as in the first test; plain squares about the mean are four times as large.
TEST(MeanResiduals, AreChiSquaredWhereTheModelsErrorIsSharedByDifferentDesigns) {
  constexpr int k_replications = 4000;
  constexpr double k_freedom = 8.0 * 3.0 - 3.0;
  Sums means;
  Sums rest;
  for (std::uint32_t i = 0; i < k_replications; ++i) {
    const MeanResiduals found = draw_with_model_error(i);
    EXPECT_EQ(found.degrees_of_freedom, k_freedom);
    means.add(found.mean_squares);
    rest.add(found.squares);
  }
  const double n = k_replications;
  EXPECT_NEAR(means.mean / n, 3.0, 4.0 * std::sqrt(6.0 / n));
  EXPECT_NEAR(rest.mean / n, k_freedom, 4.0 * std::sqrt(2.0 * k_freedom / n));
  const double variance = rest.square / n - std::pow(rest.mean / n, 2);
  const double fourth = 48.0 * k_freedom + 8.0 * k_freedom * k_freedom;  // of chi-squared, less the squared variance
  EXPECT_NEAR(variance, 2.0 * k_freedom, 4.0 * std::sqrt(fourth / n));
}

TEST(MeanResiduals, HaveNoFreedomWhereParametersMoveEveryOutput) {
  const Eigen::MatrixXd values = Eigen::MatrixXd::Zero(3, 1);
  const Eigen::VectorXd one = Eigen::VectorXd::Ones(1);
  const MeanResiduals found = mean_residuals(values, {{one, one, one}, {one, one, one}, {one, one, one}}, one);
  EXPECT_EQ(found.mean_degrees_of_freedom, 0.0);
  EXPECT_EQ(found.degrees_of_freedom, 0.0);
}

/// A modulus in Pa beside a thickness in m: a hertz of 7e10 Pa is 1e-10, one of 0.01 m is 1e4.
TEST(MeanResiduals, DoNotDependOnTheUnitsOfParameters) {
  Eigen::MatrixXd design(4, 2);
  design << 1.0, 2.0, -1.0, 0.5, 0.3, 0.7, 2.0, 1.0;
  const Eigen::VectorXd noise = Eigen::Vector4d(1.0, 0.25, 0.04, 4.0);
  Eigen::MatrixXd values(3, 4);
  values << 1.0, 0.4, 0.2, 2.0, -0.5, 0.1, 0.3, 1.0, 0.2, -0.6, 0.5, -1.0;
  const auto found_in = [&](const Eigen::Vector2d& units) {
    std::vector<RandomEffectsUnit> specimens;
    for (Eigen::Index s = 0; s < 3; ++s) {
      specimens.push_back({design * units.asDiagonal(), values.row(s).transpose(), noise});
    }
    return mean_residuals(values, specimens, noise);
  };
  const MeanResiduals one = found_in({1.0, 1.0});
  const MeanResiduals other = found_in({1e-11, 1e5});
  EXPECT_EQ(one.mean_degrees_of_freedom, 2.0);
  EXPECT_EQ(other.mean_degrees_of_freedom, 2.0);
  EXPECT_EQ(other.degrees_of_freedom, one.degrees_of_freedom);
  EXPECT_NEAR(other.squares, one.squares, 1e-9 * one.squares);
  EXPECT_NEAR(other.mean_squares, one.mean_squares, 1e-9 * one.mean_squares);
}

}  // namespace
}  // namespace mottle::updating
