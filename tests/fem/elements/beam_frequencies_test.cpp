#include <gtest/gtest.h>

#include <Eigen/Dense>
#include <array>
#include <cmath>
#include <numbers>
#include <vector>

#include "mottle/fem/elements/beam.hpp"

namespace mottle::fem {
namespace {

constexpr double k_pi = std::numbers::pi;

/// Along basic x, plane 1 is x-y.
BeamGeometry element(int count) {
  BeamGeometry geometry;
  geometry.nodes[1] = {1.0 / count, 0.0, 0.0};
  geometry.orientation = Eigen::Vector3d::UnitY();
  return geometry;
}

/// Circular frequencies of a unit beam (length, EI1, GJ, EA and masses of one) along x, cut into `count` elements.
/// @param component  the only ones free: bits of 0..5; `clamped`: the first node is held
Eigen::VectorXd frequencies(int count, Components components, bool is_clamped, MassKind kind, bool is_torsional) {
  const BeamSection section = {.area = 1.0, .inertia_1 = 1.0, .inertia_2 = 1.0, .torsion = 1.0};
  const int size = 6 * (count + 1);
  Eigen::MatrixXd K = Eigen::MatrixXd::Zero(size, size), M = K;
  for (int e = 0; e < count; ++e) {
    const BeamGeometry geometry = element(count);
    for (const BeamPiece& piece : beam_stiffness(geometry, section, 2.6)) K.block<12, 12>(6 * e, 6 * e) += piece.matrix;
    const BeamMass mass = beam_mass(geometry, kind);
    M.block<12, 12>(6 * e, 6 * e) += is_torsional ? mass.torsional : mass.line;
  }
  std::vector<int> free;
  for (int i = is_clamped ? 6 : 0; i < size; ++i) {
    if ((components >> (i % 6) & 1) != 0) free.push_back(i);
  }
  // K x = lambda M x with M singular where lumped: the inverse problem, its largest values first.
  const Eigen::MatrixXd shifted = Eigen::MatrixXd(K(free, free)) + Eigen::MatrixXd(M(free, free));
  const Eigen::VectorXd inverse =
      Eigen::GeneralizedSelfAdjointEigenSolver<Eigen::MatrixXd>(M(free, free), shifted, Eigen::EigenvaluesOnly)
          .eigenvalues();
  return (inverse.reverse().array().inverse() - 1.0).max(0.0).sqrt();
}

// Roots of cos x cosh x = -1 (clamped) and 1 (free), squared. The error of n cubic elements is x^4 / (1440 n^4), plus
// higher terms, here of the other sign.
TEST(BeamFrequencies, AreThoseOfEulerAndBernoulli) {
  const std::array<double, 3> clamped = {3.51601527, 22.0344916, 61.6972144};
  const std::array<double, 3> free = {22.3732854, 61.6728229, 120.903392};
  const Eigen::VectorXd cantilever = frequencies(8, 0x22, true, MassKind::consistent, false);
  const Eigen::VectorXd floating = frequencies(8, 0x22, false, MassKind::consistent, false);
  const auto expect = [](double found, double exact) {
    EXPECT_GT(found / exact - 1.0, 0.0) << exact;
    EXPECT_LT(found / exact - 1.0, exact * exact / (1440.0 * 4096.0)) << exact;
  };
  for (int i = 0; i < 3; ++i) {
    expect(cantilever(i), clamped[i]);
    expect(floating(i + 2), free[i]);
  }
}

/// Order of convergence of the second frequency from 8 to 16 elements.
double order(double exact, Components components, MassKind kind, bool is_torsional) {
  const double coarse = frequencies(8, components, true, kind, is_torsional)(1) / exact - 1.0;
  const double fine = frequencies(16, components, true, kind, is_torsional)(1) / exact - 1.0;
  return std::log2(coarse / fine);
}

// 0.1 of the order: higher terms of the error at eight elements.
TEST(BeamFrequencies, ConvergeWithTheFourthPowerOrLumpedWithTheSecond) {
  EXPECT_NEAR(order(22.0344916, 0x22, MassKind::consistent, false), 4.0, 0.1);
  EXPECT_NEAR(order(22.0344916, 0x22, MassKind::lumped, false), 2.0, 0.1);
}

// (2 n - 1) pi / 2 for a rod clamped at one end, along and about its axis.
TEST(BeamFrequencies, ConvergeForARodWithTheFourthPowerOrLumpedWithTheSecond) {
  EXPECT_NEAR(order(1.5 * k_pi, 0x01, MassKind::consistent, false), 4.0, 0.1);
  EXPECT_NEAR(order(1.5 * k_pi, 0x08, MassKind::consistent, true), 4.0, 0.1);
  EXPECT_NEAR(order(1.5 * k_pi, 0x08, MassKind::lumped, true), 2.0, 0.1);
  EXPECT_NEAR(frequencies(8, 0x08, true, MassKind::consistent, true)(0), 0.5 * k_pi, 1e-4);
}

}  // namespace
}  // namespace mottle::fem
