#include "mottle/fem/elements/beam.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <Eigen/Dense>
#include <array>
#include <cmath>
#include <vector>

#include "mottle/core/error.hpp"

namespace mottle::fem {
namespace {

constexpr double k_young = 70.0, k_shear = 26.0;

const BeamSection k_section = {.area = 2.0, .inertia_1 = 0.5, .inertia_2 = 0.3, .torsion = 0.4};

double value_of(BeamCoefficient coefficient, const BeamSection& section) {
  using enum BeamCoefficient;
  switch (coefficient) {
    case EA:
      return k_young * section.area;
    case GJ:
      return k_shear * section.torsion;
    case EI1:
      return k_young * section.inertia_1;
    case EI2:
      return k_young * section.inertia_2;
    case EI12:
      return k_young * section.inertia_12;
    case E:
      return k_young;
    case G:
      return k_shear;
  }
  return 0.0;
}

BeamMatrix stiffness(const BeamGeometry& geometry, const BeamSection& section) {
  BeamMatrix K = BeamMatrix::Zero();
  for (const BeamPiece& piece : beam_stiffness(geometry, section, k_young / k_shear)) {
    K += value_of(piece.coefficient, section) * piece.matrix;
  }
  return K;
}

/// Along basic x, plane 1 is x-y.
BeamGeometry straight(double length) {
  BeamGeometry geometry;
  geometry.nodes[1] = {length, 0.0, 0.0};
  geometry.orientation = Eigen::Vector3d::UnitY();
  return geometry;
}

/// Somewhere in space, with offsets.
BeamGeometry slanted() {
  return {.nodes = {Eigen::Vector3d(1.0, 2.0, 3.0), Eigen::Vector3d(2.5, 1.0, 4.0)},
          .offsets = {Eigen::Vector3d(0.1, -0.2, 0.3), Eigen::Vector3d(-0.2, 0.1, 0.2)},
          .orientation = {0.3, 0.2, -1.0}};
}

/// Displacement of end B under forces there, end A clamped.
Eigen::Matrix<double, 6, 1> tip(const BeamMatrix& K, const Eigen::Matrix<double, 6, 1>& forces) {
  return K.bottomRightCorner<6, 6>().ldlt().solve(forces);
}

Eigen::Matrix<double, 6, 1> unit(int component) {
  return Eigen::Matrix<double, 6, 1>::Unit(component);
}

/// Six rigid motions of both nodes.
Eigen::Matrix<double, 12, 6> rigid_motions(const std::array<Eigen::Vector3d, 2>& nodes) {
  Eigen::Matrix<double, 12, 6> motions = Eigen::Matrix<double, 12, 6>::Zero();
  for (int node = 0; node < 2; ++node) {
    motions.block<6, 6>(6 * node, 0).setIdentity();
    for (int axis = 0; axis < 3; ++axis) {
      motions.block<3, 1>(6 * node, 3 + axis) = Eigen::Vector3d::Unit(axis).cross(nodes[node]);
    }
  }
  return motions;
}

// 1e-13, here and below where nothing else is said: a dozen roundings.
TEST(Beam, BendsStretchesAndTwistsAsTheClosedFormWithOneElement) {
  const double l = 3.0;
  const BeamMatrix K = stiffness(straight(l), k_section);
  EXPECT_NEAR(tip(K, unit(0))(0), l / (k_young * k_section.area), 1e-13);
  EXPECT_NEAR(tip(K, unit(1))(1), l * l * l / (3.0 * k_young * k_section.inertia_1), 1e-13);
  EXPECT_NEAR(tip(K, unit(1))(5), l * l / (2.0 * k_young * k_section.inertia_1), 1e-13);
  EXPECT_NEAR(tip(K, unit(2))(2), l * l * l / (3.0 * k_young * k_section.inertia_2), 1e-13);
  EXPECT_NEAR(tip(K, unit(2))(4), -l * l / (2.0 * k_young * k_section.inertia_2), 1e-13);
  EXPECT_NEAR(tip(K, unit(3))(3), l / (k_shear * k_section.torsion), 1e-13);
}

TEST(Beam, SoftInShearBendsAsTimoshenkoWithOneElement) {
  BeamSection section = k_section;
  section.shear_1 = 0.8;
  section.shear_2 = 0.5;
  const double l = 1.5;
  const BeamMatrix K = stiffness(straight(l), section);
  EXPECT_NEAR(tip(K, unit(1))(1), l * l * l / (3.0 * k_young * 0.5) + l / (0.8 * 2.0 * k_shear), 1e-13);
  EXPECT_NEAR(tip(K, unit(2))(2), l * l * l / (3.0 * k_young * 0.3) + l / (0.5 * 2.0 * k_shear), 1e-13);
  EXPECT_NEAR(tip(K, unit(5))(5), l / (k_young * 0.5), 1e-13);  // a pure moment makes no shear
}

// Unsymmetric bending: curvatures are the inverse of [[I1, I12], [I12, I2]] times the moments.
TEST(Beam, WithAProductOfInertiaBendsAcrossTheForce) {
  BeamSection section = k_section;
  section.inertia_12 = 0.2;
  const Eigen::Matrix2d inertia{{0.5, 0.2}, {0.2, 0.3}};
  const Eigen::Vector2d expected = 8.0 / (3.0 * k_young) * inertia.inverse().col(0);
  const auto moved = tip(stiffness(straight(2.0), section), unit(1));
  EXPECT_NEAR(moved(1), expected(0), 1e-13);
  EXPECT_NEAR(moved(2), expected(1), 1e-13);
  section.shear_1 = 1e9;  // as good as rigid, yet through the piece E
  EXPECT_NEAR(tip(stiffness(straight(2.0), section), unit(1))(2), expected(1), 1e-10);
}

TEST(Beam, OffersBendingByItsInertiasUnlessShearOrPinsMixThem) {
  using enum BeamCoefficient;
  const auto kinds = [](const BeamGeometry& geometry, const BeamSection& section) {
    std::vector<BeamCoefficient> result;
    for (const BeamPiece& piece : beam_stiffness(geometry, section, 2.6)) result.push_back(piece.coefficient);
    return result;
  };
  BeamGeometry pinned = straight(1.0);
  pinned.pins[0] = 0x20;
  BeamSection oblique = k_section, soft = k_section;
  oblique.inertia_12 = 0.1;
  soft.shear_2 = 0.8;
  EXPECT_THAT(kinds(straight(1.0), k_section), ::testing::ElementsAre(EA, GJ, EI1, EI2));
  EXPECT_THAT(kinds(pinned, k_section), ::testing::ElementsAre(EA, GJ, EI1, EI2));
  EXPECT_THAT(kinds(straight(1.0), oblique), ::testing::ElementsAre(EA, GJ, EI1, EI2, EI12));
  EXPECT_THAT(kinds(pinned, oblique), ::testing::ElementsAre(EA, GJ, E));
  EXPECT_THAT(kinds(straight(1.0), soft), ::testing::ElementsAre(EA, GJ, E));
}

TEST(Beam, ResistsNoRigidMotionAndEveryOther) {
  BeamSection section = k_section;
  section.shear_1 = 0.7;
  section.inertia_12 = 0.2;
  const BeamGeometry geometry = slanted();
  const BeamMatrix K = stiffness(geometry, section);
  EXPECT_LT((K * rigid_motions(geometry.nodes)).norm(), 1e-12 * K.norm());  // sums over coordinates near 5
  const Eigen::VectorXd values = Eigen::SelfAdjointEigenSolver<Eigen::MatrixXd>(K).eigenvalues();
  EXPECT_GT(values(6), 1e-3 * values(11));
}

TEST(Beam, PiecesAreSymmetricToTheLastBit) {
  BeamGeometry geometry = slanted();
  geometry.pins = {0x20, 0x18};
  for (const BeamPiece& piece : beam_stiffness(geometry, k_section, 2.6)) {
    EXPECT_EQ(piece.matrix, piece.matrix.transpose());
  }
  for (const MassKind kind : {MassKind::lumped, MassKind::consistent}) {
    const BeamMass mass = beam_mass(geometry, kind);
    EXPECT_EQ(mass.line, mass.line.transpose());
    EXPECT_EQ(mass.torsional, mass.torsional.transpose());
  }
}

/// Displacements of an end that a rigid link holds to its node.
BeamMatrix rigid_links(const std::array<Eigen::Vector3d, 2>& offsets) {
  BeamMatrix links = BeamMatrix::Identity();
  for (int end = 0; end < 2; ++end) {
    for (int axis = 0; axis < 3; ++axis) {
      links.block<3, 1>(6 * end, 6 * end + 3 + axis) = Eigen::Vector3d::Unit(axis).cross(offsets[end]);
    }
  }
  return links;
}

TEST(Beam, WithOffsetsIsTheBeamBetweenTheEndsBehindRigidLinks) {
  const BeamGeometry geometry = slanted();
  BeamGeometry moved = geometry;
  for (int end = 0; end < 2; ++end) moved.nodes[end] += geometry.offsets[end];
  moved.offsets = {Eigen::Vector3d::Zero(), Eigen::Vector3d::Zero()};
  const BeamMatrix links = rigid_links(geometry.offsets), plain = stiffness(moved, k_section);
  EXPECT_LT((stiffness(geometry, k_section) - links.transpose() * plain * links).norm(), 1e-13 * plain.norm());
  for (const MassKind kind : {MassKind::lumped, MassKind::consistent}) {
    const BeamMatrix mass = beam_mass(moved, kind).line;
    EXPECT_LT((beam_mass(geometry, kind).line - links.transpose() * mass * links).norm(), 1e-13 * mass.norm());
  }
}

// A beam with a hinge at A: 3 EI / L^3 at B; hinged at both ends it is a bar.
TEST(Beam, WithHingesHasTheClosedForms) {
  BeamGeometry geometry = straight(2.0);
  geometry.pins[0] = 0x20;  // rotation z
  const BeamMatrix hinged = stiffness(geometry, k_section);
  EXPECT_NEAR(hinged(7, 7), 3.0 * k_young * 0.5 / 8.0, 1e-12);
  EXPECT_NEAR(hinged(11, 11), 3.0 * k_young * 0.5 / 2.0, 1e-12);
  EXPECT_EQ(hinged.row(5).norm(), 0.0);
  geometry.pins[1] = 0x20;
  const BeamMatrix bar = stiffness(geometry, k_section);
  EXPECT_EQ(bar.row(11).norm(), 0.0);
  EXPECT_NEAR(bar(7, 7), 0.0, 1e-12);                         // what cancels in 12 - 9 - 3
  EXPECT_NEAR(bar(8, 8), 12.0 * k_young * 0.3 / 8.0, 1e-12);  // the other plane is untouched
}

// Timoshenko's beam with a hinge: 1 / (L^3 / 3 EI + L / KAG).
TEST(Beam, WithAHingeAndSoftInShearHasTheClosedForm) {
  BeamGeometry geometry = straight(2.0);
  geometry.pins[0] = 0x20;
  BeamSection section = k_section;
  section.shear_1 = 0.8;
  const double flexibility = 8.0 / (3.0 * k_young * 0.5) + 2.0 / (0.8 * 2.0 * k_shear);
  EXPECT_NEAR(stiffness(geometry, section)(7, 7), 1.0 / flexibility, 1e-12);
}

TEST(Beam, RefusesPinsThatMakeAMechanism) {
  const auto refused = [](Components a, Components b) {
    BeamGeometry geometry = straight(2.0);
    geometry.pins = {a, b};
    EXPECT_THROW(stiffness(geometry, k_section), InvalidInput) << int(a) << " " << int(b);
  };
  refused(0x01, 0x01);  // slides along itself
  refused(0x08, 0x08);  // spins
  refused(0x22, 0x20);
  refused(0x14, 0x04);
}

TEST(Beam, RefusesPinsWithoutStiffnessToRelease) {
  BeamGeometry geometry = straight(2.0);
  geometry.pins[0] = 0x08;
  BeamSection section = k_section;
  section.torsion = 0.0;
  EXPECT_THROW(stiffness(geometry, section), InvalidInput);
}

TEST(Beam, RefusesGeometryAndNumbersWithoutMeaning) {
  EXPECT_THROW(stiffness(straight(0.0), k_section), InvalidInput);
  BeamGeometry along = straight(1.0);
  along.orientation = {-2.0, 0.0, 0.0};
  EXPECT_THROW(stiffness(along, k_section), InvalidInput);
  BeamSection section = k_section;
  section.inertia_12 = 0.4;  // > sqrt(0.15)
  EXPECT_THROW(stiffness(straight(1.0), section), InvalidInput);
  section = {.area = -1.0};
  EXPECT_THROW(stiffness(straight(1.0), section), InvalidInput);
  section = {.inertia_1 = 1.0, .shear_1 = 1.0};
  EXPECT_THROW(stiffness(straight(1.0), section), InvalidInput);
  EXPECT_THROW(rod_stiffness({Eigen::Vector3d::Ones(), Eigen::Vector3d::Ones()}), InvalidInput);
}

TEST(BeamMassMatrix, HasTheInertiaOfALineWhetherPinnedOrNot) {
  const double l = 3.0;
  for (const Components pin : std::to_array<Components>({0x00, 0x20, 0x31})) {
    BeamGeometry geometry = straight(l);
    geometry.pins[0] = pin;
    const BeamMatrix mass = beam_mass(geometry, MassKind::consistent).line;
    const Eigen::Matrix<double, 6, 6> total =
        rigid_motions(geometry.nodes).transpose() * mass * rigid_motions(geometry.nodes);
    EXPECT_NEAR(total(0, 0), l, 1e-12) << int(pin);
    EXPECT_NEAR(total(1, 1), l, 1e-12) << int(pin);
    EXPECT_NEAR(total(1, 5), l * l / 2.0, 1e-12) << int(pin);
    EXPECT_NEAR(total(5, 5), l * l * l / 3.0, 1e-12) << int(pin);
    EXPECT_NEAR(total(4, 4), l * l * l / 3.0, 1e-12) << int(pin);
  }
}

TEST(BeamMassMatrix, LumpedIsHalfAtEachEnd) {
  const BeamMass mass = beam_mass(straight(3.0), MassKind::lumped);
  Eigen::Matrix<double, 6, 1> half;
  half << 1.5, 1.5, 1.5, 0.0, 0.0, 0.0;
  const Eigen::Matrix<double, 12, 1> expected = half.replicate<2, 1>();
  EXPECT_EQ(mass.line, BeamMatrix(expected.asDiagonal()));
  EXPECT_EQ(mass.torsional.diagonal().sum(), 3.0);
}

TEST(Rod, IsTheAxialAndTorsionalPartOfABeam) {
  BeamGeometry geometry = slanted();
  geometry.offsets = {Eigen::Vector3d::Zero(), Eigen::Vector3d::Zero()};
  const std::array<BeamPiece, 2> rod = rod_stiffness(geometry.nodes);
  const std::vector<BeamPiece> beam = beam_stiffness(geometry, k_section, 2.6);
  for (int i = 0; i < 2; ++i) {
    EXPECT_EQ(rod[i].coefficient, beam[i].coefficient);
    EXPECT_LT((rod[i].matrix - beam[i].matrix).norm(), 1e-14);
  }
  const Eigen::Vector3d axis = (geometry.nodes[1] - geometry.nodes[0]).normalized();
  Eigen::Matrix<double, 12, 1> along = Eigen::Matrix<double, 12, 1>::Zero();
  along.segment<3>(6) = axis;
  const double length = (geometry.nodes[1] - geometry.nodes[0]).norm();
  EXPECT_NEAR(along.dot(rod_mass(geometry.nodes, MassKind::consistent) * along), 5.0 / 12.0 * length, 1e-14);
  EXPECT_NEAR(along.dot(rod_mass(geometry.nodes, MassKind::lumped) * along), 0.5 * length, 1e-14);
}

}  // namespace
}  // namespace mottle::fem
