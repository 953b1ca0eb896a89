#include "mottle/fem/elements/solid.hpp"

#include <Eigen/Geometry>
#include <Eigen/LU>
#include <algorithm>
#include <cassert>
#include <cmath>
#include <limits>

#include "fem/elements/solid_quality.hpp"
#include "fem/elements/solid_shapes.hpp"
#include "mottle/core/error.hpp"
#include "mottle/linalg/dense/decompositions.hpp"

namespace mottle::fem {
namespace {

using solid_shapes::SolidPoint;
using solid_shapes::Table;
using Elasticity = Eigen::Matrix<double, 6, 6>;
using NodesRef = Eigen::Ref<const Eigen::Matrix3Xd>;
// Of any shape, and not on the heap. With each shape's own sizes the compiler takes five times as long for this file,
// for a tenth of the time to run in small elements and none in large ones.
constexpr int k_most = solid_shapes::k_most_nodes;
using Directions = Eigen::Matrix<double, 3, Eigen::Dynamic, Eigen::ColMajor, 3, k_most>;
using Column = Eigen::Matrix<double, Eigen::Dynamic, 1, Eigen::ColMajor, 3 * k_most, 1>;
using Square = Eigen::Matrix<double, Eigen::Dynamic, Eigen::Dynamic, Eigen::ColMajor, 3 * k_most, 3 * k_most>;

/// Node positions, from the first node, lest a far origin costs digits of the determinant.
struct Geometry {
  Directions nodes;

  Geometry([[maybe_unused]] const Table& table, const NodesRef& given)
      : nodes(given.colwise() - Eigen::Vector3d(given.col(0))) {
    assert(given.cols() == table.nodes());
  }

  /// [own coordinate x basic coordinate]
  Eigen::Matrix3d jacobian(const SolidPoint& point) const { return point.gradients.lazyProduct(nodes.transpose()); }

  /// A determinant below this is zero but for rounding.
  double negligible_determinant() const { return 1e-12 * std::pow(nodes.colwise().norm().maxCoeff(), 3); }
};

double require_positive(double determinant, double negligible) {
  // Written so that a NaN is refused too.
  if (determinant > negligible) return determinant;
  throw InvalidInput(
      fmt::format("the Jacobian determinant is {:.4g} <= 0: the nodes are in the wrong order, or the element is turned "
                  "inside out or flat",
                  std::abs(determinant) <= negligible ? 0.0 : determinant));
}

void mirror_upper(Eigen::MatrixXd& matrix) {
  for (Eigen::Index row = 1; row < matrix.rows(); ++row) {
    for (Eigen::Index column = 0; column < row; ++column) matrix(row, column) = matrix(column, row);
  }
}

/// Moduli of the products of gradients: row p + 3 q, column a + 3 b holds the force in p from displacement in q, where
/// the virtual displacement is differentiated by a, the other by b.
Eigen::Matrix<double, 9, 9> moduli_by_direction(const Elasticity& elasticity) {
  constexpr int k_strain[3][3] = {{0, 3, 5}, {3, 1, 4}, {5, 4, 2}};
  Eigen::Matrix<double, 9, 9> moduli;
  for (int q = 0; q < 3; ++q) {
    for (int p = 0; p < 3; ++p) {
      for (int b = 0; b < 3; ++b) {
        for (int a = 0; a < 3; ++a) moduli(p + 3 * q, a + 3 * b) = elasticity(k_strain[p][a], k_strain[q][b]);
      }
    }
  }
  return moduli;
}

/// Quadratic tetrahedra with curved edges need more points than straight ones, lest they fail the patch test.
const std::vector<SolidPoint>& stiffness_points(const Table& table, const Geometry& geometry) {
  if (&table == &solid_shapes::quadratic_tetrahedron()) {
    // The Jacobian of a straight element is the same everywhere. What four points miss is of second order in the
    // difference, so that 1e-3 leaves 1e-6 and lets mid-edge nodes be rounded to the digits of a card.
    const Eigen::Matrix3d centre = geometry.jacobian(table.centre);
    for (const SolidPoint& corner : table.corners) {
      if ((geometry.jacobian(corner) - centre).norm() > 1e-3 * centre.norm()) return table.mass;
    }
  }
  return table.stiffness;
}

/// Integrals of every product of two basic derivatives of shape functions and modes: [3 function x 3 function], of
/// which the blocks above the diagonal and on it are computed.
Square gradient_products(const Table& table, const Geometry& geometry) {
  const Eigen::Index functions = table.nodes() + table.modes();
  const double negligible = geometry.negligible_determinant();
  const Eigen::Matrix3d centre = geometry.jacobian(table.centre);
  const Eigen::Matrix3d mode_operator = centre.inverse() * centre.determinant();  // used where there are modes
  Square products = Square::Zero(3 * functions, 3 * functions);
  Directions gradients(3, functions);
  for (const SolidPoint& point : stiffness_points(table, geometry)) {
    const Eigen::Matrix3d jacobian = geometry.jacobian(point);
    const double determinant = require_positive(jacobian.determinant(), negligible);
    gradients.leftCols(table.nodes()) = jacobian.inverse().lazyProduct(point.gradients);
    if (table.modes() > 0) {
      gradients.rightCols(table.modes()) = (mode_operator / determinant).lazyProduct(point.mode_gradients);
    }
    const Column column = gradients.reshaped();
    const Column weighted = (point.weight * determinant) * column;
    for (Eigen::Index j = 0; j < column.size(); ++j) {
      const Eigen::Index rows = j - j % 3 + 3;
      products.col(j).head(rows) += weighted(j) * column.head(rows);
    }
  }
  return products;
}

/// Removes the modes, which come after the nodes; of K only the upper triangle is read, and is right in what is left.
Eigen::MatrixXd condense(const Square& K, Eigen::Index kept) {
  const Eigen::Index removed = K.cols() - kept;
  if (removed == 0) return K;
  const linalg::CholeskyFactor factor(K.bottomRightCorner(removed, removed).transpose());
  require(factor.is_positive_definite(), "the elasticity matrix is not positive definite");
  const Eigen::MatrixXd half = factor.solve_lower(K.topRightCorner(kept, removed).transpose());
  return K.topLeftCorner(kept, kept) - half.transpose().lazyProduct(half);
}

Eigen::MatrixXd stiffness(const Table& table, const NodesRef& nodes, const Elasticity& elasticity) {
  const Square products = gradient_products(table, Geometry(table, nodes));
  const Eigen::Matrix<double, 9, 9> moduli = moduli_by_direction(elasticity);
  Square K(products.rows(), products.cols());
  for (Eigen::Index j = 0; j < K.cols(); j += 3) {
    for (Eigen::Index i = 0; i <= j; i += 3) {
      const Eigen::Matrix3d product = products.block<3, 3>(i, j);
      const Eigen::Matrix<double, 9, 1> block = moduli * product.reshaped();
      K.block<3, 3>(i, j) = block.reshaped(3, 3);
    }
  }
  Eigen::MatrixXd condensed = condense(K, 3 * table.nodes());
  mirror_upper(condensed);
  return condensed;
}

Eigen::MatrixXd scalar_mass(const Table& table, const NodesRef& nodes) {
  const Geometry geometry(table, nodes);
  const double negligible = geometry.negligible_determinant();
  Eigen::MatrixXd mass = Eigen::MatrixXd::Zero(nodes.cols(), nodes.cols());
  for (const SolidPoint& point : table.mass) {
    const double determinant = require_positive(geometry.jacobian(point).determinant(), negligible);
    const Column weighted = (point.weight * determinant) * point.values;
    for (Eigen::Index j = 0; j < mass.cols(); ++j) mass.col(j) += weighted(j) * point.values;
  }
  mirror_upper(mass);
  return mass;
}

/// Masses d_i (p + q zeta_i), d the diagonal, zeta the height in own coordinates, with the total and the first moment
/// of `mass`: scaled by the total alone, a pyramid's centre of gravity would move along its height.
Eigen::VectorXd balanced_pyramid(const Eigen::Ref<const Eigen::MatrixXd>& mass) {
  Eigen::VectorXd zeta = Eigen::VectorXd::Zero(mass.cols());
  zeta(4) = 1.0;
  zeta.tail<4>().setConstant(0.5);
  const Eigen::VectorXd d = mass.diagonal(), sums = mass.rowwise().sum();
  const double first = d.dot(zeta), second = d.cwiseProduct(zeta).dot(zeta);
  const Eigen::Matrix2d moments{{d.sum(), first}, {first, second}};
  const Eigen::Vector2d factors = moments.inverse() * Eigen::Vector2d(sums.sum(), sums.dot(zeta));
  return d.cwiseProduct((factors(0) + factors(1) * zeta.array()).matrix());
}

}  // namespace

double jacobian_ratio(SolidShape shape, const NodesRef& nodes) {
  const Table& table = solid_shapes::table_of(shape);
  const Geometry geometry(table, nodes);
  double smallest = std::numeric_limits<double>::infinity(), sum = 0.0, weights = 0.0;
  for (const auto* points : {&table.corners, &table.mass}) {
    for (const SolidPoint& point : *points) {
      const double determinant = geometry.jacobian(point).determinant();
      smallest = std::min(smallest, determinant);
      sum += point.weight * determinant;
      weights += point.weight;
    }
  }
  return smallest == 0.0 ? 0.0 : smallest / std::abs(sum / weights);
}

int node_count(SolidShape shape) {
  return static_cast<int>(solid_shapes::table_of(shape).nodes());
}

Elasticity isotropic_elasticity(double young, double poisson) {
  require(young > 0.0 && std::isfinite(young), "Young's modulus is {}, a value > 0 is needed", young);
  require(-1.0 < poisson && poisson < 0.5, "Poisson's ratio is {}, it must lie in (-1, 0.5)", poisson);
  const double shear = young / (2.0 * (1.0 + poisson));
  const double lambda = 2.0 * shear * poisson / (1.0 - 2.0 * poisson);
  Elasticity elasticity = Elasticity::Zero();
  elasticity.topLeftCorner<3, 3>().setConstant(lambda);
  elasticity.diagonal().head<3>().array() += 2.0 * shear;
  elasticity.diagonal().tail<3>().setConstant(shear);
  return elasticity;
}

Elasticity turned_elasticity(const Elasticity& elasticity, const Eigen::Matrix3d& axes) {
  // A strain in basic axes is seen from the material as axes' strain axes; engineering shears are twice the tensor's.
  constexpr int k_pairs[6][2] = {{0, 0}, {1, 1}, {2, 2}, {0, 1}, {1, 2}, {2, 0}};
  Elasticity seen;
  for (int basic = 0; basic < 6; ++basic) {
    const auto [k, l] = k_pairs[basic];
    for (int own = 0; own < 6; ++own) {
      const auto [i, j] = k_pairs[own];
      const double both = axes(k, i) * axes(l, j) + axes(l, i) * axes(k, j);
      seen(own, basic) = (own < 3 ? 0.5 : 1.0) * both;
    }
  }
  return seen.transpose() * elasticity * seen;
}

Eigen::MatrixXd solid_stiffness(SolidShape shape, const NodesRef& nodes, const Elasticity& elasticity) {
  return stiffness(solid_shapes::table_of(shape), nodes, elasticity);
}

Eigen::MatrixXd solid_mass(SolidShape shape, const NodesRef& nodes, MassKind kind) {
  Eigen::MatrixXd mass = scalar_mass(solid_shapes::table_of(shape), nodes);
  if (kind == MassKind::lumped && shape == SolidShape::pyramid5) {
    mass = Eigen::VectorXd(mass.rowwise().sum()).asDiagonal();
  } else if (kind == MassKind::lumped && shape == SolidShape::pyramid13) {
    mass = balanced_pyramid(mass).asDiagonal();
  } else if (kind == MassKind::lumped) {
    mass = Eigen::VectorXd(mass.diagonal() * (mass.sum() / mass.trace())).asDiagonal();
  }
  const Eigen::Index count = mass.cols();
  Eigen::MatrixXd M = Eigen::MatrixXd::Zero(3 * count, 3 * count);
  for (Eigen::Index j = 0; j < count; ++j) {
    for (Eigen::Index i = 0; i < count; ++i) M.block<3, 3>(3 * i, 3 * j).diagonal().setConstant(mass(i, j));
  }
  return M;
}

double solid_volume(SolidShape shape, const NodesRef& nodes) {
  return scalar_mass(solid_shapes::table_of(shape), nodes).sum();
}

}  // namespace mottle::fem
