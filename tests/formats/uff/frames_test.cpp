#include "mottle/formats/uff/frames.hpp"

#include <gtest/gtest.h>

#include <cmath>

#include "formats/uff/datasets.hpp"

namespace mottle::formats {
namespace {

using test::dataset;

TEST(UffFrames, TurnsByTheSystemOfTheNodeAndItsReference) {
  // System 2 is turned by 90 degrees about z within system 4, which is turned by 90 degrees about x.
  const UffFile file = parse_uff(dataset("18",
                                         "4 0 0 8 1\nA\n1. 1. 1. 2. 1. 1.\n1. 0. 1.\n"
                                         "2 0 4 8 1\nB\n0. 0. 0. 0. 1. 0.\n0. 0. 1.\n") +
                                     dataset("15", "1 0 2 8 9. 9. 9.\n2 0 0 8 0. 0. 0.\n"),
                                 "t.uff");
  // A: x, z = -y, y = z. B: x = A's y = z, z = A's z = -y, y = -A's x = -x.
  const UffFrames frames(file);
  const Eigen::Matrix3d expected = (Eigen::Matrix3d() << 0, -1, 0, 0, 0, -1, 1, 0, 0).finished();
  EXPECT_TRUE(frames.directions_at(1).isApprox(expected, 1e-12)) << frames.directions_at(1);
  EXPECT_TRUE(frames.directions_at(2).isIdentity(0.0));
  EXPECT_TRUE(frames.directions_at(77).isIdentity(0.0));
}

TEST(UffFrames, GivesRadialTangentialAndAxialDirectionsOfACylindricalSystem) {
  const UffFile file = parse_uff(dataset("2420", "1\npart\n5 1 8\nC\n1. 0. 0.\n0. 1. 0.\n0. 0. 1.\n1. 0. 0.\n") +
                                     dataset("2411", "7 0 5 11\n1. 2. 3.\n"),
                                 "t.uff");
  // The node lies at 90 degrees about the system's axis: radial is y, tangential -x.
  const Eigen::Matrix3d expected = (Eigen::Matrix3d() << 0, -1, 0, 1, 0, 0, 0, 0, 1).finished();
  EXPECT_TRUE(UffFrames(file).directions_at(7).isApprox(expected, 1e-12));
}

TEST(UffFrames, GivesTheDirectionsOfASphericalSystem) {
  const UffFile file = parse_uff(dataset("2420", "1\npart\n5 2 8\nS\n1. 0. 0.\n0. 1. 0.\n0. 0. 1.\n0. 0. 0.\n") +
                                     dataset("2411", "7 0 5 11\n3. 0. 0.\n"),
                                 "t.uff");
  // On the x axis: radius along x, polar angle along -z, azimuth along y.
  const Eigen::Matrix3d expected = (Eigen::Matrix3d() << 1, 0, 0, 0, 0, 1, 0, -1, 0).finished();
  EXPECT_TRUE(UffFrames(file).directions_at(7).isApprox(expected, 1e-12));
}

TEST(UffFrames, TakesSystemOneForGlobalWhereTheFileHasNone) {
  const UffFile file = parse_uff(dataset("2411", "7 1 1 11\n3. 0. 0.\n"), "gmsh.unv");
  EXPECT_TRUE(UffFrames(file).directions_at(7).isIdentity(0.0));
}

// mm and mN: a length is divided by 1000, a force by 1000, a mass (force s^2 / length) by 1.
TEST(ConvertToSi, DividesByTheFactors) {
  UffFile file = parse_uff(
      dataset("164", "5mm (milli-newton)\n1.D3 1.D3 1.\n2.7315D2\n") + dataset("2411", "1 0 0 11\n500. 0. -1000.\n") +
          dataset("55", test::k_uff_titles + "1 2 3 8 2 6\n2 4 1 3\n12.5 2. 0. 0.\n1\n1. 2. 3. 4. 5. 6.\n") +
          dataset("58", test::function_head("2 2 1 0. 1. 0.\n") + "1. 2.\n"),
      "t.uff");
  EXPECT_EQ(convert_to_si(file), "converted to SI: lengths divided by 1000, forces by 1000");
  EXPECT_EQ(file.nodes[0].position, Eigen::Vector3d(0.5, 0.0, -1.0));
  EXPECT_EQ(file.shapes[0].frequency, 12.5);
  EXPECT_EQ(file.shapes[0].modal_mass, 2.0);
  EXPECT_EQ(file.shapes[0].values(0, 2).real(), 3.0);     // a ratio
  EXPECT_EQ(file.shapes[0].values(0, 3).real(), 4000.0);  // radians per mm are a thousand per m
  EXPECT_EQ(file.functions[0].values(1).real(), 2.0);     // mm/s^2 per mN
  EXPECT_EQ(convert_to_si(file), "");
}

}  // namespace
}  // namespace mottle::formats
