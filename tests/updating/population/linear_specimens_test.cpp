#include "updating/population/linear_specimens.hpp"

#include <gtest/gtest.h>

#include <Eigen/Cholesky>
#include <Eigen/LU>
#include <Eigen/QR>
#include <cmath>
#include <limits>
#include <numbers>

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
  EXPECT_LT((algebra.parameters(Eigen::Vector2d::Zero()) - mean).norm(), 1e-12);
  Eigen::Matrix2d root;
  for (Eigen::Index i = 0; i < 2; ++i) root.col(i) = algebra.parameters(Eigen::Vector2d::Unit(i)) - mean;
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

}  // namespace
}  // namespace mottle::updating
