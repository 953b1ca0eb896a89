#include "mottle/dynamics/modes/damping.hpp"

#include <gtest/gtest.h>

#include <Eigen/Eigenvalues>
#include <cmath>
#include <limits>

#include "mottle/core/error.hpp"

namespace mottle::dynamics {
namespace {

struct Structure {
  Eigen::MatrixXd stiffness;
  Eigen::MatrixXd mass;

  ModeSet modes() const {
    const Eigen::GeneralizedSelfAdjointEigenSolver<Eigen::MatrixXd> solver(stiffness, mass);
    return {solver.eigenvalues(), solver.eigenvectors()};
  }
};

/// K = [3, -1; -1, 2], M = diag(1, 2).
Structure two_masses() {
  return {(Eigen::MatrixXd(2, 2) << 3.0, -1.0, -1.0, 2.0).finished(), Eigen::Vector2d(1.0, 2.0).asDiagonal()};
}

ModeSet one_mass() {
  return {Eigen::VectorXd::Ones(1), Eigen::MatrixXd::Ones(1, 1)};
}

// C = alpha M + beta K: zeta = alpha / (2 omega) + beta omega / 2.
TEST(ModalDamping, HasTheClosedFormOfProportionalDamping) {
  const Structure structure = two_masses();
  const ModeSet modes = structure.modes();
  const Eigen::VectorXd ratios = modal_damping_ratios(modes, 0.1 * structure.mass + 0.02 * structure.stiffness);
  for (Eigen::Index r = 0; r < 2; ++r) {
    const double omega = std::sqrt(modes.eigenvalues(r));
    EXPECT_NEAR(ratios(r), 0.1 / (2.0 * omega) + 0.02 * omega / 2.0, 1e-14);  // some roundings of numbers near one
  }
}

// Roots of (mu^2 + 0.3 mu + 3)(2 mu^2 + 0.05 mu + 2) - 1 by numpy.roots (1.24).
TEST(ModalDamping, AgreesWithTheCharacteristicPolynomialForNonProportionalDamping) {
  const Eigen::MatrixXd damping = Eigen::Vector2d(0.3, 0.05).asDiagonal();
  const Eigen::VectorXd ratios = modal_damping_ratios(two_masses().modes(), damping);
  EXPECT_NEAR(ratios(0), 0.028457507259201657, 1e-13);  // numpy.roots itself is good to some 1e-15
  EXPECT_NEAR(ratios(1), 0.07661848794529826, 1e-13);
}

// Roots of (mu^2 + 6 mu + 3)(2 mu^2 + 0.05 mu + 2) - 1 by numpy.roots: -5.4528, -0.4673 and one conjugate pair.
TEST(ModalDamping, IsNotANumberForTheOneModeThatIsOverdamped) {
  const Eigen::MatrixXd damping = Eigen::Vector2d(6.0, 0.05).asDiagonal();
  const Eigen::VectorXd ratios = modal_damping_ratios(two_masses().modes(), damping);
  EXPECT_NEAR(ratios(0), 0.052920566355895315, 1e-13);
  EXPECT_TRUE(std::isnan(ratios(1)));
}

// zeta = c / (2 sqrt(k m)) with k = m = 1.
TEST(ModalDamping, IsHalfTheDamperOfOneMass) {
  EXPECT_NEAR(modal_damping_ratios(one_mass(), Eigen::MatrixXd::Constant(1, 1, 0.5))(0), 0.25, 1e-15);
  EXPECT_NEAR(modal_damping_ratios(one_mass(), Eigen::MatrixXd::Constant(1, 1, 1.99))(0), 0.995, 1e-13);
}

TEST(ModalDamping, IsNotANumberForAnOverdampedMass) {
  EXPECT_TRUE(std::isnan(modal_damping_ratios(one_mass(), Eigen::MatrixXd::Constant(1, 1, 2.01))(0)));
}

TEST(ModalDamping, WithoutDampersIsZero) {
  // The real part of an undamped root is rounding alone.
  EXPECT_LT(modal_damping_ratios(two_masses().modes(), Eigen::MatrixXd::Zero(2, 2)).cwiseAbs().maxCoeff(), 1e-15);
}

// Uncoupled masses: zeta = c / (2 omega), whatever the order of the damped frequencies omega sqrt(1 - zeta^2).
TEST(ModalDamping, BelongsToTheModeWhoseShapeItHas) {
  const Structure structure{Eigen::Vector3d(1.0, 4.0, 9.0).asDiagonal(), Eigen::Matrix3d::Identity()};
  const Eigen::MatrixXd damping = Eigen::Vector3d(0.02, 0.4, 5.9).asDiagonal();
  const Eigen::VectorXd ratios = modal_damping_ratios(structure.modes(), damping);
  EXPECT_NEAR(ratios(0), 0.01, 1e-13);
  EXPECT_NEAR(ratios(1), 0.1, 1e-13);
  EXPECT_NEAR(ratios(2), 5.9 / 6.0, 1e-13);  // its damped frequency is the lowest of the three
}

TEST(ModalDamping, IsNotANumberWhereTheDampingIsNone) {
  const Eigen::MatrixXd damping = Eigen::MatrixXd::Constant(2, 2, std::numeric_limits<double>::quiet_NaN());
  EXPECT_TRUE(modal_damping_ratios(two_masses().modes(), damping).array().isNaN().all());
}

TEST(ModalDamping, NeedsAllModes) {
  const ModeSet modes{Eigen::VectorXd::Ones(1), Eigen::MatrixXd::Ones(2, 1)};
  EXPECT_THROW(modal_damping_ratios(modes, Eigen::MatrixXd::Zero(2, 2)), InvalidInput);
}

}  // namespace
}  // namespace mottle::dynamics
