// The grid point weight table against sums by hand.
#include "mottle/fem/assembly/mass_properties.hpp"

#include <gtest/gtest.h>

#include "fem/models.hpp"

namespace mottle::fem {
namespace {

using Eigen::Matrix3d;
using Eigen::Vector3d;

constexpr double k_rounding = 1e-13;  // sums of a few products of order ten

/// m (|r|^2 I - r r'): inertia of a point mass about a point from which it lies at r.
Matrix3d of_point(double mass, const Vector3d& r) {
  return mass * (r.squaredNorm() * Matrix3d::Identity() - r * r.transpose());
}

// Two masses a and b at distance d: inertia about the common centre is the reduced mass a b / (a + b) times d^2.
TEST(MassProperties, AreTheReducedMassForTwoPointMasses) {
  test::ModelMaker maker;
  const Vector3d first(1, 2, 3), second(4, -2, 3.5);
  maker.point_mass(1, maker.node(1, first), 2.0);
  maker.point_mass(2, maker.node(2, second), 6.0);
  const MassProperties properties = mass_properties(maker.model);
  EXPECT_LT((properties.mass - Vector3d::Constant(8.0)).norm(), k_rounding);
  EXPECT_LT((properties.center - (0.25 * first + 0.75 * second)).norm(), k_rounding);
  EXPECT_LT((properties.inertia - of_point(1.5, second - first)).norm(), 10 * k_rounding);
}

/// A mass of 3 at an offset in turned axes, with inertia of its own there.
test::ModelMaker offset_mass(const Matrix3d& axes) {
  test::ModelMaker maker;
  PointMassElement& mass = maker.point_mass(1, maker.node(1, {1, 1, 1}), 3.0);
  mass.axes = axes;
  mass.offset = {0.5, -0.2, 0.1};
  const double inertia[6] = {2.0, 0.3, 3.0, -0.2, 0.1, 4.0};  // I11 I21 I22 I31 I32 I33
  for (std::size_t k = 0; k < 6; ++k) mass.inertia[k] = maker.field("CONM2", 1, "I", inertia[k]);
  return maker;
}

// The products on the card are the integrals of x y: the tensor has them with a minus sign.
TEST(MassProperties, KeepTheOwnInertiaOfAnOffsetMass) {
  const Matrix3d axes = Eigen::AngleAxisd(0.8, Vector3d(1, -1, 2).normalized()).toRotationMatrix();
  const MassProperties properties = mass_properties(offset_mass(axes).model);
  const Matrix3d own{{2.0, -0.3, 0.2}, {-0.3, 3.0, -0.1}, {0.2, -0.1, 4.0}};
  const Vector3d center = Vector3d(1, 1, 1) + axes * Vector3d(0.5, -0.2, 0.1);
  EXPECT_LT((properties.center - center).norm(), k_rounding);
  EXPECT_LT((properties.inertia - axes * own * axes.transpose()).norm(), 10 * k_rounding);
  EXPECT_LT(
      (properties.rigid_body.bottomRightCorner<3, 3>() - axes * own * axes.transpose() - of_point(3.0, center)).norm(),
      10 * k_rounding)
      << "about the basic origin by the parallel axis theorem";
}

TEST(MassProperties, AreTakenAboutTheReferencePoint) {
  test::ModelMaker maker = offset_mass(Matrix3d::Identity());
  const MassProperties about_origin = mass_properties(maker.model);
  maker.model.settings.reference_node = maker.node(2, {2, 0, 5});
  const MassProperties about_node = mass_properties(maker.model);
  EXPECT_LT((about_node.center - about_origin.center).norm(), k_rounding) << "in basic coordinates";
  EXPECT_LT((about_node.inertia - about_origin.inertia).norm(), 100 * k_rounding);
  const Vector3d arm = about_origin.center - Vector3d(2, 0, 5);
  EXPECT_LT((about_node.rigid_body.bottomRightCorner<3, 3>() - about_node.inertia - of_point(3.0, arm)).norm(),
            100 * k_rounding);
}

TEST(MassProperties, AreInTheUnitsOfTheDeckWhateverWtmass) {
  test::ModelMaker maker = offset_mass(Matrix3d::Identity());
  const MassProperties plain = mass_properties(maker.model);
  maker.model.settings.mass_factor = 0.00259;
  EXPECT_LT((mass_properties(maker.model).rigid_body - plain.rigid_body).norm(), k_rounding * plain.rigid_body.norm());
}

// CONM1 with M11 = M22 = M33 = m and M51 = m a, M42 = -m a is a mass at (0, 0, a): u = u0 + a theta_y, v = v0 - a
// theta_x.
TEST(MassProperties, AreTheDescribedMassForAWholeMatrix) {
  test::ModelMaker maker;
  PointMassElement mass{.card = "CONM1", .id = 1, .node = maker.node(1, {1, 0, 0})};
  mass.axes = Eigen::AngleAxisd(std::acos(-1.0) / 2, Vector3d::UnitX()).toRotationMatrix();  // z points along -y
  const double m = 2.0, a = 0.3;
  const double rows[21] = {m,             // 1
                           0, m,          // 2
                           0, 0,      m,  // 3
                           0, -m * a, 0, m * a * a, m * a, 0, 0, 0, m * a * a, 0, 0, 0, 0, 0, 0};
  for (const double value : rows) {
    mass.matrix.push_back(value == 0.0 ? k_no_field : maker.field("CONM1", 1, "M", value));
  }
  maker.model.elements<PointMassElement>().push_back(mass);
  const MassProperties properties = mass_properties(maker.model);
  EXPECT_LT((properties.center - Vector3d(1, -0.3, 0)).norm(), k_rounding);
  EXPECT_LT(properties.inertia.norm(), k_rounding);
}

// 5 along x at y = 2 and 3 along z at y = 4: each direction has its mass, and the centre is where the moments of both
// together say, y = (5 * 2 + 3 * 4) / 8.
TEST(MassProperties, StandByDirectionForMassesInOneDirection) {
  test::ModelMaker maker;
  maker.mass(1, maker.node(1, {0, 2, 0}), 0, 5.0);
  maker.mass(2, maker.node(2, {0, 4, 0}), 2, 3.0);
  const MassProperties properties = mass_properties(maker.model);
  EXPECT_LT((properties.mass - Vector3d(5, 0, 3)).norm(), k_rounding);
  EXPECT_LT((properties.center - Vector3d(0, 2.75, 0)).norm(), k_rounding);
  // About z only the first resists, about x only the second: 5 * 0.75^2 and 3 * 1.25^2.
  EXPECT_LT((properties.inertia.diagonal() - Vector3d(3 * 1.5625, 0, 5 * 0.5625)).norm(), 10 * k_rounding);
}

// A scalar mass acts along its component of the displacement system: here radially, at 45 degrees between x and y.
TEST(MassProperties, FollowTheDisplacementSystemOfAScalarMass) {
  test::ModelMaker maker;
  maker.model.coordinate_systems.push_back({.id = 1, .kind = CoordinateSystem::Kind::cylindrical});
  maker.mass(1, maker.node(1, {1, 1, 0}, 0), 0, 4.0);
  const MassProperties properties = mass_properties(maker.model);
  EXPECT_LT((properties.rigid_body.topLeftCorner<3, 3>() - Matrix3d{{2, 2, 0}, {2, 2, 0}, {0, 0, 0}}).norm(),
            k_rounding);
  EXPECT_LT((properties.rigid_body.bottomRightCorner<3, 3>().norm()), k_rounding) << "it points at the origin";
}

// Displacement systems do not move a mass with six components.
TEST(MassProperties, DoNotDependOnDisplacementSystems) {
  test::ModelMaker maker = offset_mass(Matrix3d::Identity());
  const MassProperties plain = mass_properties(maker.model);
  maker.model.coordinate_systems.push_back({.id = 1, .kind = CoordinateSystem::Kind::spherical, .origin = {3, 1, 2}});
  maker.model.nodes[0].displacement_system = 0;
  EXPECT_EQ((mass_properties(maker.model).rigid_body - plain.rigid_body).norm(), 0.0);
}

// A brick of 1 x 2 x 3 and density 2 in one element: lumped at its corners it weighs 12, with corner masses' inertia.
TEST(MassProperties, AreTheCornersForABrick) {
  test::ModelMaker maker;
  maker.material(1, 1.0, 0.3, 2.0);
  for (int k = 0; k < 8; ++k) {
    const bool is_right = k % 4 == 1 || k % 4 == 2;
    maker.node(k + 1, {is_right ? 1.0 : 0.0, k % 4 > 1 ? 2.0 : 0.0, k > 3 ? 3.0 : 0.0});
  }
  maker.model.elements<SolidElement>().push_back({.id = 1, .nodes = {0, 1, 2, 3, 4, 5, 6, 7}, .material = 0});
  const MassProperties properties = mass_properties(maker.model);
  EXPECT_LT((properties.mass - Vector3d::Constant(12.0)).norm(), 10 * k_rounding);
  EXPECT_LT((properties.center - Vector3d(0.5, 1.0, 1.5)).norm(), k_rounding);
  const Vector3d expected = 12.0 * Vector3d(1.0 + 2.25, 0.25 + 2.25, 0.25 + 1.0);
  EXPECT_LT((properties.inertia - Matrix3d(expected.asDiagonal())).norm(), 1e-12);
}

TEST(MassProperties, AreZeroWithoutMass) {
  test::ModelMaker maker;
  maker.node(1, {1, 2, 3});
  const MassProperties properties = mass_properties(maker.model);
  EXPECT_EQ(properties.mass.norm() + properties.center.norm() + properties.inertia.norm(), 0.0);
}

}  // namespace
}  // namespace mottle::fem
