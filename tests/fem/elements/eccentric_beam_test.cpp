// Beams whose neutral axis and mass lie beside the shear centre.
#include <gtest/gtest.h>

#include <Eigen/Dense>
#include <array>
#include <cmath>

#include "mottle/fem/elements/beam.hpp"

namespace mottle::fem {
namespace {

constexpr double k_young = 70.0, k_shear = 26.0, k_length = 3.0, k_n1 = 0.3, k_n2 = -0.2;

const BeamSection k_section = {.area = 2.0, .inertia_1 = 0.5, .inertia_2 = 0.3, .torsion = 0.4};

BeamSection eccentric_section() {
  BeamSection section = k_section;
  section.neutral_axis = {k_n1, k_n2};
  return section;
}

/// Along basic x, plane 1 is x-y; with offsets WA = WB if wanted.
BeamGeometry beam_along_x(const Eigen::Vector3d& offset = Eigen::Vector3d::Zero()) {
  return {.nodes = {Eigen::Vector3d::Zero(), Eigen::Vector3d(k_length, 0.0, 0.0)},
          .offsets = {offset, offset},
          .orientation = Eigen::Vector3d::UnitY()};
}

BeamMatrix stiffness(const BeamGeometry& geometry, const BeamSection& section) {
  const std::array<double, 7> numbers = {k_young * section.area,
                                         k_shear * section.torsion,
                                         k_young * section.inertia_1,
                                         k_young * section.inertia_2,
                                         k_young * section.inertia_12,
                                         k_young,
                                         k_shear};  // as BeamCoefficient
  BeamMatrix sum = BeamMatrix::Zero();
  for (const BeamPiece& piece : beam_stiffness(geometry, section, k_young / k_shear))
    sum += numbers[static_cast<std::size_t>(piece.coefficient)] * piece.matrix;
  return sum;
}

// A force through the shear centre bends about the neutral axis with the moment F n: slope F n L / EI, and the shear
// centre moves by F L / EA + n times that.
TEST(Beam, BesideItsNeutralAxisBendsUnderAnAxialForce) {
  const Eigen::Matrix<double, 6, 6> at_b = stiffness(beam_along_x(), eccentric_section()).bottomRightCorner<6, 6>();
  const Eigen::Matrix<double, 6, 1> u = at_b.ldlt().solve(Eigen::Matrix<double, 6, 1>::Unit(0));
  const double slope_1 = k_n1 * k_length / (k_young * k_section.inertia_1),
               slope_2 = k_n2 * k_length / (k_young * k_section.inertia_2);
  EXPECT_NEAR(u(0), k_length / (k_young * k_section.area) + k_n1 * slope_1 + k_n2 * slope_2, 1e-13);
  EXPECT_NEAR(u(5), slope_1, 1e-13);
  EXPECT_NEAR(u(4), -slope_2, 1e-13);
  EXPECT_NEAR(u(3), 0.0, 1e-15);
}

// As the same beam with WA = WB where nothing twists; twisting about the shear centre it has G J / L and no more.
TEST(Beam, BesideItsNeutralAxisIsTheBeamWithOffsetsUnlessItTwists) {
  const BeamGeometry shifted = beam_along_x({0.0, k_n1, k_n2});
  BeamSection soft = eccentric_section();
  soft.shear_1 = soft.shear_2 = 0.8;
  BeamSection soft_shifted = soft;
  soft_shifted.neutral_axis.setZero();
  BeamMatrix K = stiffness(beam_along_x(), soft), expected = stiffness(shifted, soft_shifted);
  const Eigen::Matrix<double, 12, 1> twist = K.col(9);
  EXPECT_NEAR(twist(9), k_shear * soft.torsion / k_length, 1e-13);
  EXPECT_NEAR(twist.norm(), std::sqrt(2.0) * twist(9), 1e-13);
  for (BeamMatrix* matrix : {&K, &expected}) {
    for (const Eigen::Index rotation : {3, 9}) matrix->row(rotation).setZero(), matrix->col(rotation).setZero();
  }
  EXPECT_LT((K - expected).cwiseAbs().maxCoeff(), 1e-13 * expected.maxCoeff());
}

// A pin along the axis leaves no force at the neutral axis: bending alone is left. A hinge at the free end changes
// nothing of how that end moves under a force.
TEST(Beam, BesideItsNeutralAxisMayHavePins) {
  BeamGeometry pinned = beam_along_x();
  pinned.pins = {Components{0}, Components{0x01}};
  BeamSection no_area = k_section;
  no_area.area = 0.0;
  EXPECT_LT((stiffness(pinned, eccentric_section()) - stiffness(beam_along_x(), no_area)).cwiseAbs().maxCoeff(), 1e-12);
  pinned.pins = {Components{0}, Components{0x20}};
  const BeamMatrix K = stiffness(pinned, eccentric_section());
  EXPECT_EQ(K.col(11).cwiseAbs().maxCoeff(), 0.0);
  Eigen::Matrix<double, 6, 6> block = K.bottomRightCorner<6, 6>();
  block(5, 5) = 1.0;
  const double slope_1 = k_n1 * k_length / (k_young * k_section.inertia_1),
               slope_2 = k_n2 * k_length / (k_young * k_section.inertia_2);
  EXPECT_NEAR(block.ldlt().solve(Eigen::Matrix<double, 6, 1>::Unit(0)).x(),
              k_length / (k_young * k_section.area) + k_n1 * slope_1 + k_n2 * slope_2, 1e-12);
}

TEST(BeamMassMatrix, BesideTheAxisIsThatOfTheBeamWithOffsets) {
  for (const MassKind kind : {MassKind::lumped, MassKind::consistent}) {
    const BeamGeometry shifted = beam_along_x({0.0, k_n1, k_n2});
    const BeamMatrix difference = beam_mass(beam_along_x(), kind, {k_n1, k_n2}).line - beam_mass(shifted, kind).line;
    EXPECT_LT(difference.cwiseAbs().maxCoeff(), 1e-15);
  }
}

}  // namespace
}  // namespace mottle::fem
