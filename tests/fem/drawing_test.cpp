// Surfaces, lines and points of small models, counted by hand.
#include "mottle/fem/drawing.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "fem/models.hpp"

namespace mottle::fem {
namespace {

using Eigen::Vector3d;

/// Bricks of edge 1 in a row along x.
FiniteElementModel bricks(int count) {
  test::ModelMaker maker;
  for (int i = 0; i <= count; ++i) {
    for (int k = 0; k < 4; ++k) {
      maker.node(4 * i + k + 1, {1.0 * i, k == 1 || k == 2 ? 1.0 : 0.0, k > 1 ? 1.0 : 0.0});
    }
  }
  for (int i = 0; i < count; ++i) {
    const int n = 4 * i;
    maker.model.elements<SolidElement>().push_back(
        {.id = i + 1, .nodes = {n, n + 1, n + 2, n + 3, n + 4, n + 5, n + 6, n + 7}});
  }
  return maker.model;
}

/// Volume inside closed triangles by the divergence theorem; positive where they are seen counter-clockwise from
/// outside.
double volume(const FiniteElementModel& model, const Drawing& drawing) {
  double sum = 0.0;
  for (const auto& [a, b, c] : drawing.triangles) {
    const auto at = [&](std::uint32_t k) -> const Vector3d& {
      return model.nodes[static_cast<std::size_t>(drawing.nodes[k])].position;
    };
    sum += at(a).dot(at(b).cross(at(c))) / 6.0;
  }
  return sum;
}

TEST(Drawing, LeavesOutTheFacesBetweenSolids) {
  const FiniteElementModel model = bricks(2);
  const Drawing drawing = drawing_of(model);
  EXPECT_EQ(drawing.triangles.size(), 20U);  // 10 of 12 faces
  EXPECT_EQ(drawing.edges.size(), 20U);
  EXPECT_EQ(drawing.nodes.size(), 12U);
  EXPECT_NEAR(volume(model, drawing), 2.0, 1e-14) << "all faces look outwards";
}

TEST(Drawing, LeavesOutNodesThatNothingShows) {
  FiniteElementModel model = bricks(3);
  model.nodes.push_back({.id = 100, .position = {9, 9, 9}});
  const Drawing drawing = drawing_of(model);
  EXPECT_EQ(drawing.nodes.size(), 16U);
  EXPECT_EQ(drawing.nodes.back(), 15);
}

TEST(Drawing, LooksOutwardsForWedgeAndTetrahedra) {
  test::ModelMaker maker;
  const double points[7][3] = {{0, 0, 0}, {1, 0, 0}, {0, 1, 0}, {0, 0, 1}, {1, 0, 1}, {0, 1, 1}, {0.2, 0.2, 2}};
  for (int k = 0; k < 7; ++k) maker.node(k + 1, {points[k][0], points[k][1], points[k][2]});
  maker.model.elements<SolidElement>().push_back({.id = 1, .shape = SolidShape::wedge6, .nodes = {0, 1, 2, 3, 4, 5}});
  EXPECT_NEAR(volume(maker.model, drawing_of(maker.model)), 0.5, 1e-15);
  maker.model.elements<SolidElement>().push_back({.id = 2, .shape = SolidShape::tetrahedron4, .nodes = {3, 4, 5, 6}});
  EXPECT_NEAR(volume(maker.model, drawing_of(maker.model)), 0.5 + 0.5 / 3.0, 1e-15);
}

TEST(Drawing, LeavesOutMidEdgeNodes) {
  test::ModelMaker maker;
  for (int k = 0; k < 10; ++k) maker.node(k + 1, {k == 1 ? 1.0 : 0.1 * k, k == 2 ? 1.0 : 0.0, k == 3 ? 1.0 : 0.0});
  maker.model.elements<SolidElement>().push_back(
      {.id = 1, .shape = SolidShape::tetrahedron10, .nodes = {0, 1, 2, 3, 4, 5, 6, 7, 8, 9}});
  const Drawing drawing = drawing_of(maker.model);
  EXPECT_THAT(drawing.nodes, ::testing::ElementsAre(0, 1, 2, 3));
  EXPECT_EQ(drawing.edges.size(), 6U);
}

TEST(Drawing, SplitsQuadrilateralsAlongTheirShorterDiagonal) {
  test::ModelMaker maker;
  maker.node(1, {0, 0, 0});
  maker.node(2, {2, 0, 0});
  maker.node(3, {5, 2, 0});
  maker.node(4, {1, 1, 0});
  maker.model.elements<ShellElement>().push_back({.id = 1, .nodes = {0, 1, 2, 3}});
  const Drawing drawing = drawing_of(maker.model);
  using Triangle = std::array<std::uint32_t, 3>;
  EXPECT_THAT(drawing.triangles, ::testing::ElementsAre(Triangle{0, 1, 3}, Triangle{1, 2, 3}));
  EXPECT_EQ(drawing.edges.size(), 4U) << "the diagonal is no edge";
}

TEST(Drawing, ShowsLinesWhereTheirEndsLieApart) {
  test::ModelMaker maker;
  for (int k = 0; k < 3; ++k) maker.node(k + 1, {1.0 * k, 0, 0});
  const int twin = maker.node(4, {2, 0, 0});
  const int nowhere = maker.scalar_point(5);
  maker.beam(1, 0, 1, 0);
  maker.rod(2, 1, 0, 0, k_no_field);  // the same line once more
  maker.spring(3, 1, 0, 2, 0, 1.0);
  maker.spring(4, 2, 0, twin, 0, 1.0);     // no length
  maker.spring(5, 2, 0, nowhere, 0, 1.0);  // a scalar point has no place
  maker.spring(6, 0, 0, -1, 0, 1.0);
  const Drawing drawing = drawing_of(maker.model);
  using Edge = std::array<std::uint32_t, 2>;
  EXPECT_THAT(drawing.edges, ::testing::ElementsAre(Edge{0, 1}, Edge{1, 2}));
  EXPECT_THAT(drawing.nodes, ::testing::ElementsAre(0, 1, 2));
}

TEST(Drawing, ShowsAPointMassOnce) {
  test::ModelMaker maker;
  maker.node(1, {0, 0, 0});
  const int place = maker.node(2, {1, 0, 0});
  maker.point_mass(1, place, 1.0);
  maker.point_mass(2, place, 2.0);
  const Drawing drawing = drawing_of(maker.model);
  EXPECT_THAT(drawing.nodes, ::testing::ElementsAre(1));
  EXPECT_THAT(drawing.points, ::testing::ElementsAre(0U));
}

TEST(Drawing, HoldsTheElementsThatDependOnFieldsAndNoOther) {
  test::ModelMaker maker;
  for (int k = 0; k < 3; ++k) maker.node(k + 1, {1.0 * k, 0, 0});
  const int twin = maker.node(4, {2, 0, 0});
  const int soft = maker.material(1, 1.0, 0.3, 1.0);
  const int stiff = maker.material(2, 2.0, 0.3, 1.0);
  const FieldIndex area = maker.field("PROD", 1, "A", 1.0);
  maker.rod(1, 0, 1, soft, area);
  maker.rod(2, 1, 2, stiff, area);
  maker.spring(3, 2, 0, twin, 0, 1.0);  // no length
  const FieldIndex spring = static_cast<FieldIndex>(maker.model.fields.size()) - 1;
  const FieldIndex young = maker.model.materials[1].young;
  const std::vector<Drawing> parts = drawings_of_fields(maker.model, {{young}, {area}, {spring}, {}});
  ASSERT_EQ(parts.size(), 4U);
  EXPECT_THAT(parts[0].nodes, ::testing::ElementsAre(1, 2));
  EXPECT_EQ(parts[0].edges.size(), 1U);
  EXPECT_THAT(parts[1].nodes, ::testing::ElementsAre(0, 1, 2));
  EXPECT_THAT(parts[2].nodes, ::testing::ElementsAre(2, twin)) << "as points";
  EXPECT_EQ(parts[2].points.size(), 2U);
  EXPECT_TRUE(parts[3].nodes.empty());
}

}  // namespace
}  // namespace mottle::fem
