#include "updating/population/linear_specimens.hpp"

#include <gtest/gtest.h>

#include <Eigen/Cholesky>
#include <Eigen/LU>
#include <Eigen/QR>
#include <cmath>
#include <limits>
#include <numbers>
#include <utility>

namespace mottle::updating {
namespace {

const double k_log_two_pi = std::log(2.0 * std::numbers::pi);

/// Three outputs of two parameters, of which the second output was not measured.
struct Measured {
  Measured() {
    specimen.outputs = {0, 2};
    specimen.point = Eigen::Vector2d(1.0, -0.5);
    specimen.design.resize(2, 2);
    specimen.design << 1.0, 0.4, -0.3, 2.0;
    specimen.residual = Eigen::Vector2d(0.2, -0.7);
    population.mean = Eigen::Vector2d(0.8, 0.1);
    population.factor.resize(2, 2);
    population.factor << 0.5, 0.0, -0.2, 0.3;
    population.noise = Eigen::Vector3d(0.04, 7.0, 0.09);
    population.model_error = Eigen::Vector3d(0.05, 9.0, -0.1);
  }
  LinearSpecimen specimen;
  PopulationAt population;
};

TEST(LinearSpecimens, HaveTheDensityAndTheParametersOfANormalLaw) {
  const Measured measured;
  const LinearSpecimen& specimen = measured.specimen;
  const PopulationAt& population = measured.population;
  const Eigen::MatrixXd& g = specimen.design;
  const Eigen::Matrix2d scatter = population.factor * population.factor.transpose();
  Eigen::Matrix2d total = g * scatter * g.transpose();
  total.diagonal() += Eigen::Vector2d(0.04, 0.09);
  const Eigen::Vector2d apart =
      specimen.residual - Eigen::Vector2d(0.05, -0.1) - g * (population.mean - specimen.point);
  SpecimenAlgebra algebra;
  const double log_density = algebra.condition(specimen, population);
  EXPECT_NEAR(log_density,
              -0.5 * (2.0 * k_log_two_pi + std::log(total.determinant()) + apart.dot(total.inverse() * apart)), 1e-12);
  const Eigen::Vector2d mean = population.mean + scatter * g.transpose() * total.inverse() * apart;
  const auto parameters = [&](const Eigen::Vector2d& normals) -> Eigen::Vector2d {
    return population.mean + population.factor * algebra.scores(normals);
  };
  EXPECT_LT((parameters(Eigen::Vector2d::Zero()) - mean).norm(), 1e-12);
  Eigen::Matrix2d root;
  for (Eigen::Index i = 0; i < 2; ++i) root.col(i) = parameters(Eigen::Vector2d::Unit(i)) - mean;
  const Eigen::Matrix2d covariance = scatter - scatter * g.transpose() * total.inverse() * g * scatter;
  EXPECT_LT((root * root.transpose() - covariance).norm(), 1e-12);
}

/// In turned axes of the outputs the test is two outputs of one parameter each, with scatters s, and one of none:
/// ln N = -1/2 (3 ln 2 pi + sum ln(1 + s^2) + sum r^2 / (1 + s^2) + r_3^2). s^2 has no digits of 1.
TEST(LinearSpecimens, KeepTheirDigitsWhereTheScatterIsAMillionTimesTheNoise) {
  const Eigen::Matrix3d turned = Eigen::HouseholderQR<Eigen::Matrix3d>(
                                     (Eigen::Matrix3d() << 1.0, 2.0, -1.0, 0.5, -1.0, 3.0, 2.0, 0.3, 0.7).finished())
                                     .householderQ();
  const Eigen::Vector3d residual(3000.0, -500.0, 20.0);
  for (const double large : {1e6, 1e9, 1e11}) {
    const Eigen::Vector2d scatter(large, 0.01 * large);
    const LinearSpecimen specimen{{0, 1, 2}, Eigen::Vector2d::Zero(), turned.leftCols(2), turned * residual};
    const PopulationAt population{Eigen::Vector2d::Zero(),
                                  Eigen::Matrix2d(scatter.asDiagonal()),
                                  {},
                                  Eigen::Vector3d::Ones(),
                                  Eigen::Vector3d::Zero()};
    double sum = 3.0 * k_log_two_pi + residual(2) * residual(2);
    for (Eigen::Index i = 0; i < 2; ++i) {
      const double variance = 1.0 + scatter(i) * scatter(i);
      sum += std::log(variance) + residual(i) * residual(i) / variance;
    }
    EXPECT_NEAR(SpecimenAlgebra().condition(specimen, population), -0.5 * sum, 1e-9 * sum) << large;
  }
}

TEST(LinearSpecimens, AreImpossibleUnderAScatterOfWhichNoDigitsAreLeft) {
  Measured measured;
  measured.population.factor *= 1e13;
  EXPECT_EQ(SpecimenAlgebra().condition(measured.specimen, measured.population),
            -std::numeric_limits<double>::infinity());
}

/// Density of a component of the mixture, by the normal law of specimens under noise R / power.
double component_density(const Measured& measured, double power, const Eigen::Vector2d& parameters) {
  const Eigen::Matrix2d& g = measured.specimen.design;
  const Eigen::Matrix2d scatter = measured.population.factor * measured.population.factor.transpose();
  const Eigen::Vector2d information = power * Eigen::Vector2d(0.04, 0.09).cwiseInverse();
  const Eigen::Vector2d residual = measured.specimen.residual - Eigen::Vector2d(0.05, -0.1);
  const Eigen::Matrix2d precision = scatter.inverse() + g.transpose() * information.asDiagonal() * g;
  const Eigen::Vector2d pull = scatter.inverse() * measured.population.mean +
                               g.transpose() * information.asDiagonal() * (residual + g * measured.specimen.point);
  const Eigen::Vector2d apart = parameters - precision.inverse() * pull;
  return std::sqrt(precision.determinant()) / (2.0 * std::numbers::pi) * std::exp(-0.5 * apart.dot(precision * apart));
}

TEST(DefensiveDraws, KnowTheDensityThatTheyCameFrom) {
  const Measured measured;
  DefensiveDraws draws;
  for (const double which : {-2.0, 0.8, 0.9, 1.2, 1.3, 3.0}) {  // shares end at the scores 0.84 and 1.28
    for (const double far : {0.0, 1.0, -6.0}) {
      const Eigen::Vector3d scores(far, 0.5, which);
      const SpecimenDraw drawn = draws.draw(measured.specimen, measured.population, scores);
      const double linear = component_density(measured, 1.0, drawn.parameters);
      const double mixture = 0.8 * linear + 0.1 * component_density(measured, 0.25, drawn.parameters) +
                             0.1 * component_density(measured, 0.0, drawn.parameters);
      EXPECT_NEAR(drawn.log_ratio, std::log(linear / mixture), 1e-9) << which << " " << far;
    }
  }
}

TEST(DefensiveDraws, TakeTheComponentThatTheLastScoreNames) {
  const Measured measured;
  const Eigen::Vector2d normals(-1.5, 0.7);
  DefensiveDraws draws;
  const auto drawn = [&](double which) -> Eigen::Vector2d {
    return draws.draw(measured.specimen, measured.population, Eigen::Vector3d(normals(0), normals(1), which))
        .parameters;
  };
  for (const auto& [which, power] : {std::pair{0.84, 1.0}, {0.85, 0.25}, {1.28, 0.25}, {1.29, 0.0}}) {
    SpecimenAlgebra algebra;
    algebra.condition(measured.specimen, measured.population, power);
    const Eigen::Vector2d expected = measured.population.mean + measured.population.factor * algebra.scores(normals);
    EXPECT_LT((drawn(which) - expected).norm(), 1e-14) << which;
  }
  EXPECT_LT((drawn(2.0) - measured.population.mean - measured.population.factor * normals).norm(), 1e-14);
}

}  // namespace
}  // namespace mottle::updating
