// Solids as elements of a model: mid-edge nodes that are left out, and how cells with mid-edge nodes are numbered.
#include "mottle/fem/elements/solid_element.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <array>
#include <map>
#include <string>
#include <vector>

#include "fem/models.hpp"
#include "mottle/fem/assembly/assembly.hpp"
#include "mottle/fem/drawing.hpp"

namespace mottle::fem {
namespace {

using Eigen::Vector3d;
using test::dense;

const Eigen::VectorXd k_none;  // no parameters

/// Corners of a slanted element of each kind, in Nastran's order.
std::vector<Vector3d> corners_of(SolidShape shape) {
  switch (shape) {
    case SolidShape::hexahedron20:
      return {{0, 0, 0}, {1, 0, 0}, {1.1, 1, 0}, {0, 1, 0.1}, {0, 0, 1}, {1, 0.2, 1}, {1, 1, 1.2}, {0, 1, 1}};
    case SolidShape::wedge15:
      return {{0, 0, 0}, {1, 0, 0}, {0, 1, 0.1}, {0, 0, 1}, {1, 0.2, 1}, {0.1, 1, 1}};
    case SolidShape::pyramid13:
      return {{0, 0, 0}, {1, 0, 0}, {1.1, 1, 0}, {0, 1, 0}, {0.4, 0.5, 0.8}};
    default:
      return {{0, 0, 0}, {1, 0, 0}, {0.1, 1, 0}, {0.2, 0.3, 1}};
  }
}

/// One element with all of its mid-edge nodes, in the middle of the edges.
test::ModelMaker one(SolidShape shape) {
  test::ModelMaker maker;
  const int metal = maker.material(1, 2e11, 0.3, 7800.0);
  const std::vector<Vector3d> corners = corners_of(shape);
  SolidElement element{.id = 1, .shape = shape, .material = metal};
  std::size_t next = 0;
  const auto add = [&](const Vector3d& place) {
    element.nodes[next] = maker.node(static_cast<int>(next) + 1, place);
    ++next;
  };
  for (const Vector3d& corner : corners) add(corner);
  for (const auto& [i, j] : solid_edges(shape)) {
    add(0.5 * (corners[static_cast<std::size_t>(i)] + corners[static_cast<std::size_t>(j)]));
  }
  maker.model.elements<SolidElement>().push_back(element);
  return maker;
}

class QuadraticSolid : public ::testing::TestWithParam<SolidShape> {
 protected:
  std::size_t corners() const { return corners_of(GetParam()).size(); }
};

INSTANTIATE_TEST_SUITE_P(Shapes, QuadraticSolid,
                         ::testing::Values(SolidShape::hexahedron20, SolidShape::wedge15, SolidShape::pyramid13,
                                           SolidShape::tetrahedron10),
                         [](const auto& shape) { return "Shape" + std::to_string(static_cast<int>(shape.param)); });

// The constraint is eliminated by the assembly, which knows nothing of elements.
TEST_P(QuadraticSolid, WithoutAMiddleNodeIsOneWhoseNodeIsHeldMidway) {
  for (const bool coupled : {true, false}) {
    FiniteElementModel left_out = one(GetParam()).model, held = left_out;
    left_out.settings.coupled_mass = held.settings.coupled_mass = coupled;
    for (const std::size_t edge : {1U, 4U}) {
      const int middle = held.elements<SolidElement>()[0].nodes[corners() + edge];
      const auto [i, j] = solid_edges(GetParam())[edge];
      for (int c = 0; c < 3; ++c) held.multipoint_equations.push_back({{{middle, c, -2.0}, {i, c, 1.0}, {j, c, 1.0}}});
      left_out.elements<SolidElement>()[0].nodes[corners() + edge] = -1;
    }
    const AssembledModel one_way = assemble(left_out, {}), other_way = assemble(held, {});
    ASSERT_EQ(one_way.equations.size(), other_way.equations.size());
    const Eigen::MatrixXd K = dense(one_way.stiffness.at(k_none)), expected = dense(other_way.stiffness.at(k_none));
    EXPECT_LT((K - expected).norm(), 1e-13 * K.norm());  // rounding
    const Eigen::MatrixXd M = dense(one_way.mass.at(k_none)), expected_mass = dense(other_way.mass.at(k_none));
    EXPECT_NEAR(M.sum(), expected_mass.sum(), 1e-13 * M.sum());
    if (coupled) {
      EXPECT_LT((M - expected_mass).norm(), 1e-13 * M.norm());
    } else {
      EXPECT_TRUE(M.isDiagonal(0.0)) << "half of the node's mass goes to either end";
    }
  }
}

TEST_P(QuadraticSolid, IsDrawnByItsCornersWithFacesThatLookOutwards) {
  const FiniteElementModel model = one(GetParam()).model;
  const Drawing drawing = drawing_of(model);
  EXPECT_EQ(drawing.nodes.size(), corners());
  const Vector3d centre = [&] {
    Vector3d sum = Vector3d::Zero();
    for (const Vector3d& corner : corners_of(GetParam())) sum += corner / static_cast<double>(corners());
    return sum;
  }();
  for (const auto& [a, b, c] : drawing.triangles) {
    const auto at = [&](std::uint32_t k) -> Vector3d {
      return model.nodes[static_cast<std::size_t>(drawing.nodes[k])].position - centre;
    };
    EXPECT_GT(at(a).dot(at(b).cross(at(c))), 0.0);
  }
}

// VTK's figures: corners, then the ring around the base, that around the top, then the upright edges.
TEST_P(QuadraticSolid, HasMiddleNodesBetweenTheCornersThatVtkMeans) {
  static const std::map<SolidShape, std::vector<std::array<int, 2>>> k_edges = {
      {SolidShape::hexahedron20,
       {{0, 1}, {1, 2}, {2, 3}, {3, 0}, {4, 5}, {5, 6}, {6, 7}, {7, 4}, {0, 4}, {1, 5}, {2, 6}, {3, 7}}},
      {SolidShape::wedge15, {{0, 1}, {1, 2}, {2, 0}, {3, 4}, {4, 5}, {5, 3}, {0, 3}, {1, 4}, {2, 5}}},
      {SolidShape::pyramid13, {{0, 1}, {1, 2}, {2, 3}, {3, 0}, {0, 4}, {1, 4}, {2, 4}, {3, 4}}},
      {SolidShape::tetrahedron10, {{0, 1}, {1, 2}, {2, 0}, {0, 3}, {1, 3}, {2, 3}}}};
  const FiniteElementModel model = one(GetParam()).model;
  const SolidElement& element = model.elements<SolidElement>()[0];
  const Topology& topology = SolidElement::k_traits.topology(element);
  const auto at = [&](std::size_t k) {
    const int node = element.nodes[static_cast<std::size_t>(topology.cell_nodes[k])];
    return model.nodes[static_cast<std::size_t>(node)].position;
  };
  const auto& edges = k_edges.at(GetParam());
  ASSERT_EQ(topology.cell_nodes.size(), corners() + edges.size());
  for (std::size_t e = 0; e < edges.size(); ++e) {
    const auto [i, j] = edges[e];
    const Vector3d middle = 0.5 * (at(static_cast<std::size_t>(i)) + at(static_cast<std::size_t>(j)));
    EXPECT_LT((at(corners() + e) - middle).norm(), 1e-15) << "edge " << e;
  }
}

TEST_P(QuadraticSolid, IsALinearCellWhereAMiddleNodeIsLeftOut) {
  FiniteElementModel model = one(GetParam()).model;
  SolidElement& element = model.elements<SolidElement>()[0];
  element.nodes[corners()] = -1;
  EXPECT_EQ(SolidElement::k_traits.topology(element).cell_nodes.size(), corners());
}

}  // namespace
}  // namespace mottle::fem
