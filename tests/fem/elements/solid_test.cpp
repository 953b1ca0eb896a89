#include "mottle/fem/elements/solid.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <Eigen/Dense>
#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <map>
#include <numbers>
#include <random>
#include <string>
#include <vector>

#include "mottle/core/error.hpp"

namespace mottle::fem {
namespace {

using Eigen::Matrix3d;
using Eigen::Matrix3Xd;
using Eigen::MatrixXd;
using Eigen::Vector3d;
using Eigen::VectorXd;
using Elasticity = Eigen::Matrix<double, 6, 6>;

// ---------------------------------------------------------------------------------------------------------- meshes

struct Mesh {
  SolidShape shape = SolidShape::hexahedron8;
  Matrix3Xd nodes = {};
  std::vector<std::vector<int>> elements = {};

  int count() const { return static_cast<int>(nodes.cols()); }
  Matrix3Xd of(const std::vector<int>& element) const { return nodes(Eigen::all, element); }
};

bool is_quadratic(SolidShape shape) {
  return shape == SolidShape::tetrahedron10 || shape == SolidShape::hexahedron20 || shape == SolidShape::wedge15 ||
         shape == SolidShape::pyramid13;
}

SolidShape linear_of(SolidShape shape) {
  if (shape == SolidShape::hexahedron20) return SolidShape::hexahedron8;
  if (shape == SolidShape::wedge15) return SolidShape::wedge6;
  if (shape == SolidShape::pyramid13) return SolidShape::pyramid5;
  return shape == SolidShape::tetrahedron10 ? SolidShape::tetrahedron4 : shape;
}

int corner_count(SolidShape shape) {
  return node_count(linear_of(shape));
}

/// Corners of the shapes that fill a hexahedron; the same pattern in every cell conforms.
std::vector<std::vector<int>> split(SolidShape shape) {
  if (shape == SolidShape::hexahedron8) return {{0, 1, 2, 3, 4, 5, 6, 7}};
  if (shape == SolidShape::wedge6) return {{0, 1, 2, 4, 5, 6}, {0, 2, 3, 4, 6, 7}};
  if (shape == SolidShape::pyramid5) {  // 8: the middle of the cell
    return {{0, 1, 2, 3, 8}, {4, 7, 6, 5, 8}, {0, 4, 5, 1, 8}, {1, 5, 6, 2, 8}, {2, 6, 7, 3, 8}, {3, 7, 4, 0, 8}};
  }
  return {{0, 1, 2, 6}, {0, 2, 3, 6}, {0, 3, 7, 6}, {0, 7, 4, 6}, {0, 4, 5, 6}, {0, 5, 1, 6}};
}

using Edges = std::vector<std::array<int, 2>>;

/// Edges in the order of the mid-edge nodes on CHEXA, CPENTA, CPYRAM and CTETRA, from Nastran's figures.
Edges edges_of_card(SolidShape shape) {
  const auto ring = [](Edges& edges, int first, int count) {
    for (int i = 0; i < count; ++i) edges.push_back({first + i, first + (i + 1) % count});
  };
  Edges edges;
  switch (corner_count(shape)) {
    case 8:
      ring(edges, 0, 4);
      edges.insert(edges.end(), {{0, 4}, {1, 5}, {2, 6}, {3, 7}});
      ring(edges, 4, 4);
      return edges;
    case 6:
      ring(edges, 0, 3);
      edges.insert(edges.end(), {{0, 3}, {1, 4}, {2, 5}});
      ring(edges, 3, 3);
      return edges;
    case 5:
      ring(edges, 0, 4);
      edges.insert(edges.end(), {{0, 4}, {1, 4}, {2, 4}, {3, 4}});
      return edges;
    default:
      return {{0, 1}, {1, 2}, {0, 2}, {0, 3}, {1, 3}, {2, 3}};
  }
}

/// Adds a node in the middle of every edge.
void make_quadratic(Mesh& mesh) {
  std::map<std::pair<int, int>, int> middle;
  std::vector<Vector3d> added;
  for (std::vector<int>& element : mesh.elements) {
    const std::vector<int> corners = element;
    for (const auto& [i, j] : edges_of_card(mesh.shape)) {
      const auto edge = std::minmax(corners[i], corners[j]);
      const auto [place, is_new] = middle.try_emplace({edge.first, edge.second}, mesh.count() + int(added.size()));
      if (is_new) added.emplace_back(0.5 * (mesh.nodes.col(edge.first) + mesh.nodes.col(edge.second)));
      element.push_back(place->second);
    }
  }
  const Eigen::Index old = mesh.nodes.cols();
  mesh.nodes.conservativeResize(3, old + Eigen::Index(added.size()));
  for (std::size_t i = 0; i < added.size(); ++i) mesh.nodes.col(old + Eigen::Index(i)) = added[i];
}

using Cells = std::array<int, 3>;

/// A box with a corner at the origin. `shift` moves the corners before mid-edge nodes are set.
template <typename Shift>
Mesh box(SolidShape shape, const Cells& cells, const Vector3d& size, const Shift& shift) {
  Mesh mesh{.shape = shape};
  const int nx = cells[0], ny = cells[1], nz = cells[2];
  const auto index = [&](int i, int j, int k) { return i + (nx + 1) * (j + (ny + 1) * k); };
  mesh.nodes.resize(3, index(nx, ny, nz) + 1);
  for (int k = 0; k <= nz; ++k) {
    for (int j = 0; j <= ny; ++j) {
      for (int i = 0; i <= nx; ++i) {
        const Vector3d place = Vector3d(double(i) / nx, double(j) / ny, double(k) / nz).cwiseProduct(size);
        mesh.nodes.col(index(i, j, k)) = place + shift(place);
      }
    }
  }
  for (int k = 0; k < nz; ++k) {
    for (int j = 0; j < ny; ++j) {
      for (int i = 0; i < nx; ++i) {
        std::array<int, 9> cell = {index(i, j, k),
                                   index(i + 1, j, k),
                                   index(i + 1, j + 1, k),
                                   index(i, j + 1, k),
                                   index(i, j, k + 1),
                                   index(i + 1, j, k + 1),
                                   index(i + 1, j + 1, k + 1),
                                   index(i, j + 1, k + 1),
                                   -1};
        if (corner_count(shape) == 5) {
          cell[8] = mesh.count();
          const Vector3d middle =
              mesh.nodes(Eigen::all, std::vector<int>(cell.begin(), cell.end() - 1)).rowwise().mean();
          mesh.nodes.conservativeResize(3, cell[8] + 1);
          mesh.nodes.col(cell[8]) = middle;
        }
        for (std::vector<int> corners : split(linear_of(shape))) {
          for (int& corner : corners) corner = cell[std::size_t(corner)];
          mesh.elements.push_back(corners);
        }
      }
    }
  }
  if (is_quadratic(shape)) make_quadratic(mesh);
  return mesh;
}

Mesh box(SolidShape shape, const Cells& cells, const Vector3d& size) {
  return box(shape, cells, size, [](const Vector3d&) { return Vector3d::Zero().eval(); });
}

/// A box of 3 x 3 x 3 cells with every node moved; mid-edge nodes too, so that edges are curved.
Mesh distorted_box(SolidShape shape) {
  std::mt19937_64 random(7);
  std::uniform_real_distribution<double> uniform(-1.0, 1.0);
  const auto any = [&] { return Vector3d(uniform(random), uniform(random), uniform(random)); };
  Mesh mesh = box(shape, {3, 3, 3}, Vector3d(3.0, 2.4, 3.6), [&](const Vector3d&) { return (0.17 * any()).eval(); });
  const int corners = 64;
  for (int node = corners; node < mesh.count(); ++node) mesh.nodes.col(node) += 0.03 * any();
  return mesh;
}

/// The cube of [MacNeal1985], fig. 2: seven hexahedra, one of them inside with the given nodes.
Mesh cube_of_macneal_and_harder() {
  Mesh mesh{.shape = SolidShape::hexahedron8, .nodes = Matrix3Xd(3, 16)};
  mesh.nodes.leftCols(8) << 0, 1, 1, 0, 0, 1, 1, 0, 0, 0, 1, 1, 0, 0, 1, 1, 0, 0, 0, 0, 1, 1, 1, 1;
  mesh.nodes.rightCols(8).transpose() << .249, .342, .192, .826, .288, .288, .850, .649, .263, .273, .750, .230,  //
      .320, .186, .643, .677, .305, .683, .788, .693, .644, .165, .745, .702;
  mesh.elements = {{8, 9, 10, 11, 12, 13, 14, 15}, {0, 1, 2, 3, 8, 9, 10, 11},  {12, 13, 14, 15, 4, 5, 6, 7},
                   {0, 1, 9, 8, 4, 5, 13, 12},     {1, 2, 10, 9, 5, 6, 14, 13}, {2, 3, 11, 10, 6, 7, 15, 14},
                   {3, 0, 8, 11, 7, 4, 12, 15}};
  return mesh;
}

/// Degrees of freedom of nodes, in their order.
std::vector<int> freedoms_of(const std::vector<int>& nodes) {
  std::vector<int> freedoms;
  for (const int node : nodes) freedoms.insert(freedoms.end(), {3 * node, 3 * node + 1, 3 * node + 2});
  return freedoms;
}

MatrixXd assemble(const Mesh& mesh, const auto& matrix_of) {
  const Eigen::Index size = mesh.nodes.size();
  MatrixXd sum = MatrixXd::Zero(size, size);
  for (const std::vector<int>& element : mesh.elements) {
    const std::vector<int> freedoms = freedoms_of(element);
    sum(freedoms, freedoms) += matrix_of(mesh.of(element));
  }
  return sum;
}

MatrixXd stiffness(const Mesh& mesh, const Elasticity& elasticity) {
  return assemble(mesh, [&](const Matrix3Xd& nodes) { return solid_stiffness(mesh.shape, nodes, elasticity); });
}

MatrixXd mass(const Mesh& mesh, MassKind kind) {
  return assemble(mesh, [&](const Matrix3Xd& nodes) { return solid_mass(mesh.shape, nodes, kind); });
}

/// Degrees of freedom of the nodes, or of one component, where the claim holds.
std::vector<int> freedoms(const Mesh& mesh, const auto& claim) {
  std::vector<int> chosen;
  for (int node = 0; node < mesh.count(); ++node) {
    for (int component = 0; component < 3; ++component) {
      if (claim(node, component)) chosen.push_back(3 * node + component);
    }
  }
  return chosen;
}

// ---------------------------------------------------------------------------------------------- each of the shapes

class Solid : public ::testing::TestWithParam<SolidShape> {
 protected:
  SolidShape shape() const { return GetParam(); }
  bool is_linear() const { return !is_quadratic(shape()); }
  /// An element without symmetry, of size one; the quadratic ones have curved edges.
  Matrix3Xd element() const {
    const Mesh mesh = distorted_box(shape());
    return mesh.of(mesh.elements.front());
  }
  /// A sheared and stretched element with straight, parallel edges.
  Matrix3Xd parallel_element(const Matrix3d& axes) const {
    const Mesh mesh = box(shape(), {1, 1, 1}, Vector3d::Ones());
    return axes * mesh.of(mesh.elements.front());
  }
};

const Matrix3d k_axes = (Matrix3d() << 2.0, 0.3, -0.4, 0.1, 1.5, 0.2, -0.3, 0.5, 1.1).finished();

std::string name_of(const ::testing::TestParamInfo<SolidShape>& info) {
  return std::array{"Hexahedron8", "Wedge6",       "Tetrahedron4", "Tetrahedron10",
                    "Pyramid5",    "Hexahedron20", "Wedge15",      "Pyramid13"}[std::size_t(info.param)];
}

INSTANTIATE_TEST_SUITE_P(Shapes, Solid,
                         ::testing::Values(SolidShape::hexahedron8, SolidShape::wedge6, SolidShape::tetrahedron4,
                                           SolidShape::tetrahedron10, SolidShape::pyramid5, SolidShape::hexahedron20,
                                           SolidShape::wedge15, SolidShape::pyramid13),
                         name_of);

/// Prescribes a linear displacement field on the faces and compares the inside and the energy with it.
void expect_patch_test(const Mesh& mesh, const auto& is_outside) {
  const Elasticity elasticity = isotropic_elasticity(1e6, 0.25);
  const MatrixXd K = stiffness(mesh, elasticity);
  const Matrix3d gradient = (Matrix3d() << 1.0, 0.5, -0.3, 0.7, -0.4, 0.2, 0.1, 0.6, 0.8).finished();
  const VectorXd exact = (gradient * mesh.nodes).reshaped();
  const std::vector<int> inside = freedoms(mesh, [&](int node, int) { return !is_outside(node); });
  const std::vector<int> outside = freedoms(mesh, [&](int node, int) { return is_outside(node); });
  ASSERT_FALSE(inside.empty());
  const VectorXd solved = K(inside, inside).llt().solve(-MatrixXd(K(inside, outside)) * exact(outside));
  // 1e-10 of displacements near one: rounding of the solution; a failed patch test shows 1e-2.
  EXPECT_LT((solved - exact(inside)).cwiseAbs().maxCoeff(), 1e-10);

  Eigen::Vector<double, 6> strain;
  strain << gradient(0, 0), gradient(1, 1), gradient(2, 2), gradient(0, 1) + gradient(1, 0),
      gradient(1, 2) + gradient(2, 1), gradient(0, 2) + gradient(2, 0);
  double volume = 0.0;
  for (const std::vector<int>& element : mesh.elements) volume += solid_volume(mesh.shape, mesh.of(element));
  const double energy = volume * strain.dot(elasticity * strain);
  EXPECT_NEAR(exact.dot(K * exact), energy, 1e-12 * energy);  // a thousand roundings, mostly of one sign
}

TEST_P(Solid, PassesThePatchTestOnADistortedMesh) {
  const Mesh mesh = distorted_box(shape());
  // Each node of the faces belongs to a straight 3 x 3 x 3 grid whose numbers tell where it lies.
  const Mesh straight = box(shape(), {3, 3, 3}, Vector3d::Constant(3.0));
  expect_patch_test(mesh, [&](int node) {
    return straight.nodes.col(node).minCoeff() < 1e-9 || straight.nodes.col(node).maxCoeff() > 3.0 - 1e-9;
  });
}

TEST(SolidHexahedron, PassesThePatchTestOfMacNealAndHarder) {
  expect_patch_test(cube_of_macneal_and_harder(), [](int node) { return node < 8; });
}

TEST_P(Solid, HasSixRigidBodyModesAndNoOtherMotionWithoutEnergy) {
  const MatrixXd K = solid_stiffness(shape(), element(), isotropic_elasticity(1.0, 0.3));
  const VectorXd values = Eigen::SelfAdjointEigenSolver<MatrixXd>(K, Eigen::EigenvaluesOnly).eigenvalues();
  // 1e-14: rounding of entries near one; the softest strain of an element of size one stands far above.
  EXPECT_LT(values.head(6).cwiseAbs().maxCoeff(), 1e-14 * values.maxCoeff());
  EXPECT_GT(values(6), 1e-3 * values.maxCoeff());
}

TEST_P(Solid, DoesNotResistRigidMotionFarFromTheOrigin) {
  const Matrix3Xd nodes = element().colwise() + Vector3d(100.0, -200.0, 50.0);
  const MatrixXd K = solid_stiffness(shape(), nodes, isotropic_elasticity(1.0, 0.3));
  const Matrix3d spin = (Matrix3d() << 0, -1, 2, 1, 0, -3, -2, 3, 0).finished();
  const VectorXd rotation = (spin * nodes).reshaped();
  const VectorXd translation = Vector3d(1, 2, 3).replicate(nodes.cols(), 1);
  // 1e-13: rounding of coordinates, digits lost to a distance of 230 sizes included by the norms.
  EXPECT_LT((K * rotation).norm(), 1e-13 * K.norm() * rotation.norm());
  EXPECT_LT((K * translation).norm(), 1e-13 * K.norm() * translation.norm());
}

TEST_P(Solid, TurnsItsStiffnessWithTheElement) {
  const Elasticity elasticity = isotropic_elasticity(1.0, 0.3);
  const Matrix3d turn = Eigen::AngleAxisd(0.7, Vector3d(1.0, -2.0, 0.5).normalized()).toRotationMatrix();
  const Matrix3Xd nodes = element();
  const MatrixXd K = solid_stiffness(shape(), nodes, elasticity);
  const MatrixXd turned = solid_stiffness(shape(), (turn * nodes).colwise() + Vector3d(3.0, 1.0, 2.0), elasticity);
  MatrixXd expected = K;
  for (Eigen::Index j = 0; j < nodes.cols(); ++j) {
    for (Eigen::Index i = 0; i < nodes.cols(); ++i) {
      expected.block<3, 3>(3 * i, 3 * j) = turn * K.block<3, 3>(3 * i, 3 * j) * turn.transpose();
    }
  }
  EXPECT_LT((turned - expected).norm(), 1e-13 * K.norm());  // rounding of turned coordinates
}

/// A numbering of the same element that begins at another corner.
std::vector<int> other_numbering(SolidShape shape) {
  std::vector<int> order = {1, 2, 0, 3};
  if (corner_count(shape) == 8) order = {1, 5, 6, 2, 0, 4, 7, 3};
  if (corner_count(shape) == 6) order = {5, 4, 3, 2, 1, 0};
  if (corner_count(shape) == 5) order = {1, 2, 3, 0, 4};
  if (!is_quadratic(shape)) return order;
  const Edges edges = edges_of_card(shape);
  for (const auto& [i, j] : edges) {
    const int a = order[std::size_t(i)], b = order[std::size_t(j)];
    const auto same = [&](const auto& edge) { return std::minmax(edge[0], edge[1]) == std::minmax(a, b); };
    order.push_back(corner_count(shape) + int(std::ranges::find_if(edges, same) - edges.begin()));
  }
  return order;
}

TEST_P(Solid, DoesNotDependOnTheCornerWhereItsNumberingBegins) {
  const std::vector<int> order = other_numbering(shape());
  const Matrix3Xd nodes = element();
  const Elasticity elasticity = isotropic_elasticity(1.0, 0.3);
  const MatrixXd K = solid_stiffness(shape(), nodes, elasticity);
  const MatrixXd reordered = solid_stiffness(shape(), nodes(Eigen::all, order), elasticity);
  const std::vector<int> degrees_of_freedom = freedoms_of(order);
  EXPECT_LT((reordered - K(degrees_of_freedom, degrees_of_freedom)).norm(), 1e-13 * K.norm());  // sums in another order
}

TEST_P(Solid, IsSymmetricToTheLastBit) {
  const MatrixXd K = solid_stiffness(shape(), element(), isotropic_elasticity(2.1e11, 0.3));
  const MatrixXd M = solid_mass(shape(), element(), MassKind::consistent);
  EXPECT_EQ(K, K.transpose());
  EXPECT_EQ(M, M.transpose());
}

TEST_P(Solid, ScalesWithYoungsModulusAndSize) {
  const MatrixXd K = solid_stiffness(shape(), element(), isotropic_elasticity(1.0, 0.3));
  const MatrixXd scaled = solid_stiffness(shape(), 1e-3 * element(), isotropic_elasticity(2.1e11, 0.3));
  EXPECT_LT((scaled - 2.1e8 * K).norm(), 1e-13 * scaled.norm());  // rounding
}

TEST_P(Solid, HasItsVolumeAsMassInEachDirectionAndItsCentreOfGravity) {
  const Matrix3Xd nodes = parallel_element(k_axes);
  const double volume = solid_volume(shape(), nodes);
  const VectorXd ones = VectorXd::Ones(nodes.cols());
  Vector3d centre = nodes.leftCols(corner_count(shape())).rowwise().mean();
  if (corner_count(shape()) == 5) centre = 0.75 * nodes.leftCols<4>().rowwise().mean() + 0.25 * nodes.col(4);
  for (const MassKind kind : {MassKind::lumped, MassKind::consistent}) {
    const MatrixXd M = solid_mass(shape(), nodes, kind);
    for (int component = 0; component < 3; ++component) {
      const auto pick = Eigen::seqN(component, nodes.cols(), 3);
      const VectorXd row = MatrixXd(M(pick, pick)) * ones;
      EXPECT_NEAR(row.sum(), volume, 1e-13 * volume);  // ten roundings
      EXPECT_LT((nodes * row / volume - centre).norm(), 1e-14);
    }
    EXPECT_NEAR(M.sum(), 3.0 * volume, 1e-13 * volume);  // nothing couples directions
  }
}

TEST_P(Solid, HasPositiveDiagonalLumpedMass) {
  const MatrixXd M = solid_mass(shape(), element(), MassKind::lumped);
  EXPECT_TRUE(M.isDiagonal(0.0));
  EXPECT_GT(M.diagonal().minCoeff(), 0.0);
  const double volume = solid_volume(shape(), element());
  EXPECT_NEAR(M.trace(), 3.0 * volume, 1e-13 * volume);  // thirty roundings
}

/// x^i y^j z^k.
using Monomial = std::array<int, 3>;

/// Monomials that a quadratic shape spans; of a pyramid with its height 1 - zeta instead of z.
std::vector<Monomial> monomials_of(SolidShape shape) {
  std::vector<Monomial> monomials;
  if (shape == SolidShape::pyramid13) {
    return {{0, 0, 0}, {1, 0, 0}, {0, 1, 0}, {0, 0, 1},  {2, 0, 0},  {0, 2, 0}, {0, 0, 2},
            {1, 1, 0}, {1, 0, 1}, {0, 1, 1}, {1, 1, -1}, {2, 1, -1}, {1, 2, -1}};
  }
  for (int i = 0; i < 3; ++i) {
    for (int j = 0; j < 3; ++j) {
      for (int k = 0; k < 3; ++k) {
        const bool is_of_hexahedron = (i == 2) + (j == 2) + (k == 2) <= 1;
        const bool is_of_wedge = i + j <= (k == 2 ? 1 : 2);
        if (shape == SolidShape::hexahedron20 ? is_of_hexahedron : is_of_wedge) monomials.push_back({i, j, k});
      }
    }
  }
  return monomials;
}

double integral(SolidShape shape, const Monomial& of) {
  const auto [i, j, k] = of;
  const auto over_line = [](int power) { return power % 2 == 0 ? 2.0 / (power + 1) : 0.0; };  // -1 to 1
  if (shape == SolidShape::hexahedron20) return over_line(i) * over_line(j) * over_line(k);
  if (shape == SolidShape::wedge15)
    return std::tgamma(i + 1) * std::tgamma(j + 1) / std::tgamma(i + j + 3) * over_line(k);
  return over_line(i) * over_line(j) / (i + j + k + 3);  // with x = a h, y = b h
}

/// Nodes in own coordinates.
Matrix3Xd own_nodes(SolidShape shape) {
  Mesh mesh{.shape = shape, .elements = {std::vector<int>(std::size_t(corner_count(shape)))}};
  for (int i = 0; i < corner_count(shape); ++i) mesh.elements[0][std::size_t(i)] = i;
  mesh.nodes.resize(3, corner_count(shape));
  if (shape == SolidShape::hexahedron20)
    mesh.nodes << -1, 1, 1, -1, -1, 1, 1, -1, -1, -1, 1, 1, -1, -1, 1, 1, -1, -1, -1, -1, 1, 1, 1, 1;
  if (shape == SolidShape::wedge15) mesh.nodes << 0, 1, 0, 0, 1, 0, 0, 0, 1, 0, 0, 1, -1, -1, -1, 1, 1, 1;
  if (shape == SolidShape::pyramid13) mesh.nodes << -1, 1, 1, -1, 0, -1, -1, 1, 1, 0, 0, 0, 0, 0, 1;
  make_quadratic(mesh);
  if (shape == SolidShape::pyramid13) mesh.nodes.row(2) = 1.0 - mesh.nodes.row(2).array();
  return mesh.nodes;
}

/// Integrals of N_i N_j over volume one of the functions that span the monomials and are one at a node each.
MatrixXd mass_by_monomials(SolidShape shape) {
  const std::vector<Monomial> monomials = monomials_of(shape);
  const Matrix3Xd nodes = own_nodes(shape);
  const auto size = nodes.cols();
  MatrixXd at_nodes(size, size), moments(size, size);
  for (Eigen::Index m = 0; m < size; ++m) {
    const Monomial& one = monomials[std::size_t(m)];
    for (Eigen::Index n = 0; n < size; ++n) {
      const bool is_apex = shape == SolidShape::pyramid13 && nodes(2, n) == 0.0 && one[2] < 0;  // x y / h is zero there
      at_nodes(n, m) =
          is_apex ? 0.0 : std::pow(nodes(0, n), one[0]) * std::pow(nodes(1, n), one[1]) * std::pow(nodes(2, n), one[2]);
      const Monomial& other = monomials[std::size_t(n)];
      moments(n, m) = integral(shape, {one[0] + other[0], one[1] + other[1], one[2] + other[2]});
    }
  }
  const MatrixXd functions = at_nodes.fullPivLu().inverse();
  return functions.transpose() * moments * functions / integral(shape, {0, 0, 0});
}

/// Integrals of N_i N_j over volume one, from the closed form for products of barycentric coordinates.
MatrixXd exact_mass(SolidShape shape) {
  const auto simplex = [](int corners) {
    return ((MatrixXd::Ones(corners, corners) + MatrixXd::Identity(corners, corners)) / (corners * (corners + 1)))
        .eval();
  };
  if (shape == SolidShape::tetrahedron4) return simplex(4);
  if (is_quadratic(shape) && shape != SolidShape::tetrahedron10) return mass_by_monomials(shape);
  const MatrixXd line = simplex(2);
  if (shape == SolidShape::wedge6) {
    const MatrixXd triangle = simplex(3);
    return (MatrixXd(6, 6) << line(0, 0) * triangle, line(0, 1) * triangle, line(1, 0) * triangle,
            line(1, 1) * triangle)
        .finished();
  }
  MatrixXd mass;
  if (shape == SolidShape::hexahedron8) {
    constexpr int k_bits[8] = {0b000, 0b001, 0b011, 0b010, 0b100, 0b101, 0b111, 0b110};
    mass.resize(8, 8);
    for (int i = 0; i < 8; ++i) {
      for (int j = 0; j < 8; ++j) {
        mass(i, j) = 1.0;
        for (const int bit : {1, 2, 4}) mass(i, j) *= (k_bits[i] & bit) == (k_bits[j] & bit) ? line(0, 0) : line(0, 1);
      }
    }
    return mass;
  }
  // [Zienkiewicz2013]: 1/420 of 6 and 1 between corners, -4 and -6 corner to middle, 32, 16 and 8 between middles.
  if (shape == SolidShape::pyramid5) {
    // With xi = a (1 - zeta): N_i N_j (1 - zeta)^2 integrated over a, b and zeta, over the volume 4/3.
    constexpr int k_signs[4][2] = {{-1, -1}, {1, -1}, {1, 1}, {-1, 1}};
    mass = MatrixXd::Constant(5, 5, 3.0 / 80.0);
    for (int i = 0; i < 4; ++i) {
      for (int j = 0; j < 4; ++j)
        for (int axis = 0; axis < 2; ++axis) mass(i, j) *= 1.0 + k_signs[i][axis] * k_signs[j][axis] / 3.0;
    }
    mass(4, 4) = 0.1;
    return mass;
  }
  constexpr int k_ends[6] = {0b0011, 0b0110, 0b0101, 0b1001, 0b1010, 0b1100};
  mass.resize(10, 10);
  for (int i = 0; i < 4; ++i) {
    for (int j = 0; j < 4; ++j) mass(i, j) = i == j ? 6 : 1;
    for (int edge = 0; edge < 6; ++edge) mass(i, 4 + edge) = mass(4 + edge, i) = (k_ends[edge] >> i) & 1 ? -4 : -6;
  }
  for (int i = 0; i < 6; ++i) {
    for (int j = 0; j < 6; ++j) mass(4 + i, 4 + j) = i == j ? 32 : ((k_ends[i] & k_ends[j]) != 0 ? 16 : 8);
  }
  return mass / 420.0;
}

TEST_P(Solid, HasTheExactConsistentMassWhereEdgesAreParallel) {
  const Matrix3Xd nodes = parallel_element(k_axes);
  const MatrixXd M = solid_mass(shape(), nodes, MassKind::consistent);
  const auto pick = Eigen::seqN(1, nodes.cols(), 3);
  // 1e-14: a dozen roundings of entries below one tenth.
  EXPECT_LT((M(pick, pick) / solid_volume(shape(), nodes) - exact_mass(shape())).cwiseAbs().maxCoeff(), 1e-14);
}

TEST_P(Solid, HasTheVolumeOfItsParallelepiped) {
  const int corners = corner_count(shape());
  const double parts = corners == 8 ? 1.0 : corners == 6 ? 2.0 : 6.0;
  EXPECT_NEAR(solid_volume(shape(), parallel_element(k_axes)), k_axes.determinant() / parts, 1e-14);
}

TEST_P(Solid, RefusesNodesInTheOtherOrder) {
  const Matrix3Xd mirrored = Vector3d(1, 1, -1).asDiagonal() * element();
  const auto refusal = ::testing::ThrowsMessage<InvalidInput>(
      ::testing::AllOf(::testing::HasSubstr("Jacobian determinant is -"), ::testing::HasSubstr("wrong order")));
  EXPECT_THAT([&] { solid_stiffness(shape(), mirrored, isotropic_elasticity(1.0, 0.3)); }, refusal);
  EXPECT_THAT([&] { solid_mass(shape(), mirrored, MassKind::lumped); }, refusal);
  EXPECT_THAT([&] { solid_volume(shape(), mirrored); }, refusal);
  EXPECT_LT(solid_quality(shape(), mirrored).jacobian_ratio, 0.0);
}

TEST_P(Solid, RefusesAFlatElement) {
  Matrix3Xd flat = element().colwise() + Vector3d(1e3, 1e3, 1e3);
  flat.row(2) = flat.row(0) + flat.row(1);
  const auto refusal = ::testing::ThrowsMessage<InvalidInput>(::testing::HasSubstr("determinant is 0 <= 0"));
  EXPECT_THAT([&] { solid_stiffness(shape(), flat, isotropic_elasticity(1.0, 0.3)); }, refusal);
}

TEST_P(Solid, HasAJacobianRatioOfOneWhereEdgesAreParallel) {
  EXPECT_NEAR(solid_quality(shape(), parallel_element(k_axes)).jacobian_ratio, 1.0, 1e-14);
}

TEST_P(Solid, RefusesAPositionThatIsNotANumber) {
  Matrix3Xd nodes = element();
  nodes(1, 2) = std::numeric_limits<double>::quiet_NaN();
  EXPECT_THROW(solid_volume(shape(), nodes), InvalidInput);
}

// ------------------------------------------------------------------------------------------- volumes and qualities

// Corners of the section at height t are linear in t, so its area is |1 - t + t e^(i angle)|^2: 2/3 + cos(angle)/3.
TEST(SolidVolume, FollowsTheRuledFacesOfATwistedHexahedron) {
  const Mesh unit = box(SolidShape::hexahedron8, {1, 1, 1}, Vector3d::Ones());
  Matrix3Xd nodes = unit.of(unit.elements.front()).colwise() - Vector3d(0.5, 0.5, 0.0);
  nodes.rightCols(4) = Eigen::AngleAxisd(0.6, Vector3d::UnitZ()).toRotationMatrix() * nodes.rightCols(4).eval();
  EXPECT_NEAR(solid_volume(SolidShape::hexahedron8, nodes), (2.0 + std::cos(0.6)) / 3.0, 1e-14);
}

// Frustum: height / 3 times the areas below, above and their geometric mean: 1/3 (1/2 + 1/8 + 1/4).
TEST(SolidVolume, IsTheFrustumsForATaperedWedge) {
  Matrix3Xd nodes(3, 6);
  nodes << 0, 1, 0, 0, 0.5, 0, 0, 0, 1, 0, 0, 0.5, 0, 0, 0, 1, 1, 1;
  EXPECT_NEAR(solid_volume(SolidShape::wedge6, nodes), 0.875 / 3.0, 1e-14);
}

// The middle of edge 2-3 moved by d along x gives x = xi + 4 d xi eta: determinant 1 + 4 d eta, volume (1 + d) / 6.
TEST(SolidVolume, CountsTheBulgeOfACurvedTetrahedron) {
  Mesh mesh{.shape = SolidShape::tetrahedron10, .nodes = Matrix3Xd(3, 4), .elements = {{0, 1, 2, 3}}};
  mesh.nodes << 0, 1, 0, 0, 0, 0, 1, 0, 0, 0, 0, 1;
  make_quadratic(mesh);
  mesh.nodes(0, 5) += 0.1;
  EXPECT_NEAR(solid_volume(mesh.shape, mesh.nodes), 1.1 / 6.0, 1e-14);
}

// With a corner at (s, s, s) its three edges span 3 s - 2, which is zero where the corner lies between its neighbours.
TEST(SolidQuality, IsZeroWhereAHexahedronsCornerBecomesFlat) {
  const Mesh unit = box(SolidShape::hexahedron8, {1, 1, 1}, Vector3d::Ones());
  Matrix3Xd nodes = unit.of(unit.elements.front());
  nodes.col(6).setConstant(2.0 / 3.0);
  EXPECT_NEAR(solid_quality(SolidShape::hexahedron8, nodes).jacobian_ratio, 0.0, 1e-14);
}

TEST(SolidQuality, HasTheRatioOfEdgesAsAspectRatio) {
  const Mesh slab = box(SolidShape::hexahedron8, {1, 1, 1}, Vector3d(10.0, 3.0, 2.0));
  EXPECT_DOUBLE_EQ(solid_quality(slab.shape, slab.of(slab.elements.front())).aspect_ratio, 5.0);
}

TEST(SolidQuality, IsOneForTheRegularTetrahedron) {
  Matrix3Xd nodes(3, 4);
  nodes << 1, -1, -1, 1, 1, -1, 1, -1, 1, 1, -1, -1;
  EXPECT_NEAR(solid_quality(SolidShape::tetrahedron4, nodes).aspect_ratio, 1.0, 1e-14);
}

TEST(SolidQuality, ShowsTheSliverWhoseEdgesAreAllLong) {
  Matrix3Xd nodes(3, 4);
  nodes << 1, 0, -1, 0, 0, 1, 0, -1, 0, 0.01, 0, 0.01;
  EXPECT_GT(solid_quality(SolidShape::tetrahedron4, nodes).aspect_ratio, 50.0);
  Matrix3Xd wedge(3, 6);
  wedge << 0, 2, 1, 0, 2, 1, 0, 0, 0.01, 0, 0, 0.01, 0, 0, 0, 1, 1, 1;
  EXPECT_GT(solid_quality(SolidShape::wedge6, wedge).aspect_ratio, 50.0);
}

TEST(SolidQuality, IsOneForThePyramidOfEqualEdges) {
  Matrix3Xd nodes(3, 5);
  nodes << 1, -1, -1, 1, 0, 1, 1, -1, -1, 0, 0, 0, 0, 0, std::numbers::sqrt2;
  EXPECT_NEAR(solid_quality(SolidShape::pyramid5, nodes).aspect_ratio, 1.0, 1e-14);
  nodes(2, 4) = 0.01;
  EXPECT_GT(solid_quality(SolidShape::pyramid5, nodes).aspect_ratio, 50.0);
}

// Energy of a strain does not depend on the axes in which both are seen; an isotropic material looks the same from all.
TEST(TurnedElasticity, KeepsTheEnergyOfAStrain) {
  const Matrix3d axes = Eigen::AngleAxisd(0.7, Vector3d(1.0, -2.0, 0.5).normalized()).toRotationMatrix();
  const auto vector_of = [](const Matrix3d& e) {
    return (VectorXd(6) << e(0, 0), e(1, 1), e(2, 2), 2.0 * e(0, 1), 2.0 * e(1, 2), 2.0 * e(2, 0)).finished();
  };
  Elasticity own = Elasticity::Zero();
  for (int i = 0; i < 6; ++i) {
    for (int j = 0; j < 6; ++j) own(i, j) = std::cos(i * j) + (i == j ? 8.0 + i : 0.0);
  }
  const Matrix3d strain = (Matrix3d() << 1.0, 0.2, -0.4, 0.2, -0.7, 0.3, -0.4, 0.3, 0.5).finished();
  const VectorXd basic = vector_of(strain), seen = vector_of(axes.transpose() * strain * axes);
  const double energy = seen.dot(own * seen);
  EXPECT_NEAR(basic.dot(turned_elasticity(own, axes) * basic), energy, 1e-13 * energy);
  const Elasticity isotropic = isotropic_elasticity(1.0, 0.3);
  EXPECT_TRUE(turned_elasticity(isotropic, axes).isApprox(isotropic, 1e-14));
}

TEST(IsotropicElasticity, IsTheInverseOfHookesCompliance) {
  const double young = 7e10, poisson = 0.33;
  Elasticity compliance = Elasticity::Zero();
  compliance.topLeftCorner<3, 3>().setConstant(-poisson / young);
  compliance.diagonal().head<3>().setConstant(1.0 / young);
  compliance.diagonal().tail<3>().setConstant(2.0 * (1.0 + poisson) / young);
  EXPECT_TRUE((isotropic_elasticity(young, poisson) * compliance).isIdentity(1e-14));
}

TEST(IsotropicElasticity, RefusesWhatNoMaterialHas) {
  EXPECT_THROW(isotropic_elasticity(0.0, 0.3), InvalidInput);
  EXPECT_THROW(isotropic_elasticity(1.0, 0.5), InvalidInput);
  EXPECT_THROW(isotropic_elasticity(1.0, -1.0), InvalidInput);
}

// --------------------------------------------------------------------------------------------------- bending beams

/// Mean displacement of the end x = length under a unit force in `direction`, clamped at x = 0.
double tip_deflection(const Mesh& mesh, const Elasticity& elasticity, int direction) {
  const double length = mesh.nodes.row(0).maxCoeff(), close = 1e-9 * length;
  const MatrixXd K = stiffness(mesh, elasticity);
  const std::vector<int> free = freedoms(mesh, [&](int node, int) { return mesh.nodes(0, node) > close; });
  VectorXd end = VectorXd::Zero(K.rows());
  for (const int i : freedoms(mesh, [&](int node, int component) {
         return mesh.nodes(0, node) > length - close && component == direction;
       })) {
    end(i) = 1.0;
  }
  end /= end.sum();
  return end(free).dot(K(free, free).llt().solve(end(free)));
}

/// Timoshenko's cantilever of breadth 1 and height 1 with shear factor 5/6.
double timoshenko_tip(double length, double young, double poisson) {
  const double shear = young / (2.0 * (1.0 + poisson));
  return std::pow(length, 3) / (3.0 * young / 12.0) + length / (5.0 / 6.0 * shear);
}

struct Layer {
  std::string name;
  SolidShape shape;
  int direction;
  double tolerance;
};

/// Ten cells, each ten times as long as high, extruded along the beam: wedges have their triangles across it.
class CantileverOfOneLayer : public ::testing::TestWithParam<Layer> {};

// Without incompatible modes a trilinear element of this length reaches 3 % of the deflection. Elements of constant
// curvature miss 1/400; the clamped end hinders lateral contraction over the first element; and a section of two
// triangles cannot take the anticlastic form, which costs it a part of nu^2.
TEST_P(CantileverOfOneLayer, BendsAsTimoshenkosBeam) {
  const auto& [name, shape, direction, tolerance] = GetParam();
  Mesh mesh = box(shape, {1, 1, 10}, Vector3d(1.0, 1.0, 100.0));
  mesh.nodes = Matrix3Xd(mesh.nodes({2, 0, 1}, Eigen::all));
  const double tip = tip_deflection(mesh, isotropic_elasticity(1e4, 0.3), direction);
  EXPECT_NEAR(tip / timoshenko_tip(100.0, 1e4, 0.3), 1.0, tolerance);
}

INSTANTIATE_TEST_SUITE_P(Bending, CantileverOfOneLayer,
                         ::testing::Values(Layer{"Hexahedron8AlongY", SolidShape::hexahedron8, 1, 0.015},
                                           Layer{"Hexahedron8AlongZ", SolidShape::hexahedron8, 2, 0.015},
                                           Layer{"Wedge6AlongY", SolidShape::wedge6, 1, 0.04},
                                           Layer{"Wedge6AlongZ", SolidShape::wedge6, 2, 0.04},
                                           Layer{"Tetrahedron10AlongY", SolidShape::tetrahedron10, 1, 0.025},
                                           Layer{"Tetrahedron10AlongZ", SolidShape::tetrahedron10, 2, 0.025},
                                           Layer{"Hexahedron20AlongY", SolidShape::hexahedron20, 1, 0.025},
                                           Layer{"Wedge15AlongY", SolidShape::wedge15, 1, 0.025},
                                           Layer{"Wedge15AlongZ", SolidShape::wedge15, 2, 0.025},
                                           Layer{"Pyramid13AlongY", SolidShape::pyramid13, 1, 0.025}),
                         [](const auto& layer) { return layer.param.name; });

/// Published tip displacements over theory, in-plane and out-of-plane: of a trilinear brick with incompatible modes,
/// and of the serendipity brick with 3 x 3 x 3 points.
struct SlenderBeam {
  std::string name;
  SolidShape shape;
  double slant_even, slant_odd;  ///< how the planes between elements lean: offset in x at the upper edge
  double in_plane, out_of_plane;
};

class SlenderBeamOfMacNealAndHarder : public ::testing::TestWithParam<SlenderBeam> {};

// [MacNeal1985], table 3: 6 x 0.2 x 0.1, six elements, E = 1e7, nu = 0.3; HEX20; HEX8 as [OptiStruct] publishes it.
TEST_P(SlenderBeamOfMacNealAndHarder, DeflectsAsThePublishedBrick) {
  const SlenderBeam& beam = GetParam();
  const Mesh mesh = box(beam.shape, {6, 1, 1}, Vector3d(6.0, 0.2, 0.1), [&](const Vector3d& place) {
    const bool is_end = place.x() < 1e-9 || place.x() > 6.0 - 1e-9;
    const double slant = std::lround(place.x()) % 2 == 0 ? beam.slant_even : beam.slant_odd;
    return Vector3d(is_end ? 0.0 : slant * (place.y() > 0.1 ? 1.0 : -1.0), 0.0, 0.0);
  });
  const Elasticity elasticity = isotropic_elasticity(1e7, 0.3);
  // 0.001: the publication has three digits.
  EXPECT_NEAR(tip_deflection(mesh, elasticity, 1) / 0.1081, beam.in_plane, 0.001);
  EXPECT_NEAR(tip_deflection(mesh, elasticity, 2) / 0.4321, beam.out_of_plane, 0.001);
}

INSTANTIATE_TEST_SUITE_P(
    Bending, SlenderBeamOfMacNealAndHarder,
    ::testing::Values(SlenderBeam{"Regular", SolidShape::hexahedron8, 0.0, 0.0, 0.978, 0.973},
                      SlenderBeam{"Parallelogram", SolidShape::hexahedron8, 0.1, 0.1, 0.624, 0.529},
                      SlenderBeam{"Trapezoidal", SolidShape::hexahedron8, 0.1, -0.1, 0.047, 0.030},
                      SlenderBeam{"Regular20", SolidShape::hexahedron20, 0.0, 0.0, 0.970, 0.961},
                      SlenderBeam{"Parallelogram20", SolidShape::hexahedron20, 0.1, 0.1, 0.967, 0.941},
                      SlenderBeam{"Trapezoidal20", SolidShape::hexahedron20, 0.1, -0.1, 0.886, 0.920}),
    [](const auto& beam) { return beam.param.name; });

// ----------------------------------------------------------------------------------------------------- convergence

/// Lowest eigenvalue of K x = lambda M x by inverse iteration; the next one must be several times as large.
double lowest_eigenvalue(const MatrixXd& K, const MatrixXd& M) {
  const Eigen::LLT<MatrixXd> factor(K);
  VectorXd x = VectorXd::LinSpaced(K.rows(), 1.0, 2.0);
  for (int iteration = 0; iteration < 40; ++iteration) x = factor.solve(M * x).normalized();
  return x.dot(K * x) / x.dot(M * x);
}

/// A bar of length one along x, nu = 0 and E = 1, with the freedoms where the claim holds.
double lowest_eigenvalue_of_bar(SolidShape shape, const Cells& cells, double height, MassKind kind,
                                const auto& is_free) {
  const Mesh mesh = box(shape, cells, Vector3d(1.0, height, height));
  const auto free =
      freedoms(mesh, [&](int node, int component) { return is_free(Vector3d(mesh.nodes.col(node)), component); });
  return lowest_eigenvalue(stiffness(mesh, isotropic_elasticity(1.0, 0.0))(free, free), mass(mesh, kind)(free, free));
}

/// One row of cubes: they must shrink in all directions, lest lumped mass moves within the section.
double axial_eigenvalue(SolidShape shape, int cells, MassKind kind) {
  return lowest_eigenvalue_of_bar(shape, {cells, 1, 1}, 1.0 / cells, kind, [](const Vector3d& place, int component) {
    return component == 0 && place.x() > 1e-9;
  });
}

double observed_order(double coarse_error, double fine_error) {
  return std::log2(std::abs(coarse_error / fine_error));
}

// The mass and stiffness of linear rods give lambda = 6 / h^2 (1 - cos kh) / (2 + cos kh); lumped 2 / h^2 (1 - cos kh).
TEST(SolidHexahedron, VibratesAxiallyAsAChainOfLinearRods) {
  const double h = 1.0 / 8.0, cosine = std::cos(0.5 * std::numbers::pi * h);
  const double consistent = 6.0 / (h * h) * (1.0 - cosine) / (2.0 + cosine), lumped = 2.0 / (h * h) * (1.0 - cosine);
  // 1e-12: rounding, amplified by the condition of K.
  EXPECT_NEAR(axial_eigenvalue(SolidShape::hexahedron8, 8, MassKind::consistent), consistent, 1e-12);
  EXPECT_NEAR(axial_eigenvalue(SolidShape::hexahedron8, 8, MassKind::lumped), lumped, 1e-12);
}

double axial_order(SolidShape shape, MassKind kind) {
  const double exact = std::pow(0.5 * std::numbers::pi, 2);
  return observed_order(axial_eigenvalue(shape, 6, kind) - exact, axial_eigenvalue(shape, 12, kind) - exact);
}

// 0.1: what the next term of the error adds on meshes this coarse.
TEST_P(Solid, ConvergesToTheAxialModeOfABarWithItsOrder) {
  EXPECT_NEAR(axial_order(shape(), MassKind::consistent), is_linear() ? 2.0 : 4.0, 0.1);
}

// Lumping integrates linear functions exactly, so that the quadratic shape too is left with order two.
TEST_P(Solid, ConvergesToTheAxialModeWithLumpedMassWithOrderTwo) {
  EXPECT_NEAR(axial_order(shape(), MassKind::lumped), 2.0, 0.1);
}

/// Of a Timoshenko beam of length one, pinned at one end and guided at the other: a quarter wave, nu = 0, E = 1.
double timoshenko_eigenvalue(double height, double shear_factor) {
  const double k2 = std::pow(0.5 * std::numbers::pi, 2), r2 = height * height / 12.0, g = 0.5 * shear_factor;
  // With g = shear factor G: (r2 k2 + g - r2 l) (g k2 - l) = g^2 k2, the lesser root in l.
  const double b = r2 * g * k2 + r2 * k2 + g, c = r2 * k2 * g * k2;
  return 2.0 * c / (b + std::sqrt(b * b - 4.0 * r2 * c));
}

double bending_eigenvalue(SolidShape shape, int cells) {
  return lowest_eigenvalue_of_bar(
      shape, {cells, 1, 1}, 0.1, MassKind::consistent, [](const Vector3d& place, int component) {
        return (component == 0 && place.x() < 1.0 - 1e-9) || (component == 2 && place.x() > 1e-9);
      });
}

// One layer has a straight section and so a shear factor of one, which makes Timoshenko's beam its exact limit.
TEST(SolidHexahedron, ConvergesToTheBendingModeOfABarWithOrderTwo) {
  const double exact = timoshenko_eigenvalue(0.1, 1.0);
  const double coarse = bending_eigenvalue(SolidShape::hexahedron8, 4) - exact;
  const double fine = bending_eigenvalue(SolidShape::hexahedron8, 8) - exact;
  EXPECT_NEAR(observed_order(coarse, fine), 2.0, 0.1);
  EXPECT_LT(std::abs(fine), 0.01 * exact);
}

}  // namespace
}  // namespace mottle::fem
