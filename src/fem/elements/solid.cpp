#include "mottle/fem/elements/solid.hpp"

#include <Eigen/Cholesky>
#include <Eigen/Geometry>
#include <Eigen/LU>
#include <algorithm>
#include <cassert>
#include <cmath>
#include <limits>

#include "fem/elements/solid_quality.hpp"
#include "fem/elements/solid_shapes.hpp"
#include "mottle/core/error.hpp"

namespace mottle::fem {
namespace {

using solid_shapes::SolidPoint;
using solid_shapes::Table;
using Elasticity = Eigen::Matrix<double, 6, 6>;
using NodesRef = Eigen::Ref<const Eigen::Matrix3Xd>;

/// Node positions of fixed size. From the first node, lest a far origin costs digits of the determinant.
template <int count>
struct Geometry {
  Eigen::Matrix<double, 3, count> nodes;

  explicit Geometry(const NodesRef& given) {
    assert(given.cols() == count);
    nodes = given.colwise() - Eigen::Vector3d(given.col(0));
  }

  /// [own coordinate x basic coordinate]
  template <int modes>
  Eigen::Matrix3d jacobian(const SolidPoint<count, modes>& point) const {
    return point.gradients * nodes.transpose();
  }

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

template <int size>
void mirror_upper(Eigen::Matrix<double, size, size>& matrix) {
  for (int row = 1; row < size; ++row) {
    for (int column = 0; column < row; ++column) matrix(row, column) = matrix(column, row);
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
template <int count, int modes>
const typename Table<count, modes>::Points& stiffness_points(const Table<count, modes>& table,
                                                             const Geometry<count>& geometry) {
  if constexpr (count == 10) {
    // The Jacobian of a straight element is the same everywhere. What four points miss is of second order in the
    // difference, so that 1e-3 leaves 1e-6 and lets mid-edge nodes be rounded to the digits of a card.
    const Eigen::Matrix3d centre = geometry.jacobian(table.centre);
    for (const SolidPoint<count, modes>& corner : table.corners) {
      if ((geometry.jacobian(corner) - centre).norm() > 1e-3 * centre.norm()) return table.mass;
    }
  }
  return table.stiffness;
}

/// Integrals of every product of two basic derivatives of shape functions and modes: [3 function x 3 function].
template <int count, int modes>
auto gradient_products(const Table<count, modes>& table, const Geometry<count>& geometry) {
  constexpr int k_functions = count + modes;
  const double negligible = geometry.negligible_determinant();
  Eigen::Matrix3d mode_operator = Eigen::Matrix3d::Zero();
  if constexpr (modes > 0) {
    const Eigen::Matrix3d centre = geometry.jacobian(table.centre);
    mode_operator = centre.inverse() * centre.determinant();
  }
  using Column = Eigen::Matrix<double, 3 * k_functions, 1>;
  Eigen::Matrix<double, 3 * k_functions, 3 * k_functions> products;
  products.setZero();
  for (const SolidPoint<count, modes>& point : stiffness_points(table, geometry)) {
    const Eigen::Matrix3d jacobian = geometry.jacobian(point);
    const double determinant = require_positive(jacobian.determinant(), negligible);
    Eigen::Matrix<double, 3, k_functions> gradients;
    gradients.template leftCols<count>().noalias() = jacobian.inverse() * point.gradients;
    if constexpr (modes > 0) {
      gradients.template rightCols<modes>().noalias() = (mode_operator / determinant) * point.mode_gradients;
    }
    const Column column = gradients.reshaped();
    const Column weighted = (point.weight * determinant) * column;
    for (int j = 0; j < 3 * k_functions; ++j) products.col(j) += weighted(j) * column;
  }
  return products;
}

/// Removes the modes, which come after the nodes.
template <int kept, int size>
Eigen::Matrix<double, kept, kept> condense(const Eigen::Matrix<double, size, size>& K) {
  constexpr int k_removed = size - kept;
  if constexpr (k_removed == 0) {
    return K;
  } else {
    const Eigen::Matrix<double, k_removed, k_removed> mode_K = K.template bottomRightCorner<k_removed, k_removed>();
    const Eigen::LLT<Eigen::Matrix<double, k_removed, k_removed>, Eigen::Upper> factor(mode_K);
    require(factor.info() == Eigen::Success, "the elasticity matrix is not positive definite");
    Eigen::Matrix<double, k_removed, kept> half = K.template topRightCorner<kept, k_removed>().transpose();
    factor.matrixL().solveInPlace(half);
    return K.template topLeftCorner<kept, kept>() - half.transpose().lazyProduct(half);
  }
}

template <int count, int modes>
Eigen::MatrixXd stiffness(const Table<count, modes>& table, const NodesRef& nodes, const Elasticity& elasticity) {
  constexpr int k_functions = count + modes;
  const auto products = gradient_products(table, Geometry<count>(nodes));
  const Eigen::Matrix<double, 9, 9> moduli = moduli_by_direction(elasticity);
  Eigen::Matrix<double, 3 * k_functions, 3 * k_functions> K;
  for (int j = 0; j < k_functions; ++j) {
    for (int i = 0; i <= j; ++i) {
      const Eigen::Matrix3d product = products.template block<3, 3>(3 * i, 3 * j);
      const Eigen::Matrix<double, 9, 1> block = moduli * product.reshaped();
      K.template block<3, 3>(3 * i, 3 * j) = block.reshaped(3, 3);
    }
  }
  Eigen::Matrix<double, 3 * count, 3 * count> condensed = condense<3 * count>(K);
  mirror_upper(condensed);
  return condensed;
}

template <int count, int modes>
Eigen::Matrix<double, count, count> scalar_mass(const Table<count, modes>& table, const NodesRef& nodes) {
  const Geometry<count> geometry(nodes);
  const double negligible = geometry.negligible_determinant();
  Eigen::Matrix<double, count, count> mass = Eigen::Matrix<double, count, count>::Zero();
  for (const SolidPoint<count, modes>& point : table.mass) {
    const double determinant = require_positive(geometry.jacobian(point).determinant(), negligible);
    const Eigen::Matrix<double, count, 1> weighted = (point.weight * determinant) * point.values;
    for (int j = 0; j < count; ++j) mass.col(j) += weighted(j) * point.values;
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

template <int count, int modes>
double ratio_of(const Table<count, modes>& table, const NodesRef& nodes) {
  const Geometry<count> geometry(nodes);
  double smallest = std::numeric_limits<double>::infinity(), sum = 0.0, weights = 0.0;
  for (const auto* points : {&table.corners, &table.mass}) {
    for (const SolidPoint<count, modes>& point : *points) {
      const double determinant = geometry.jacobian(point).determinant();
      smallest = std::min(smallest, determinant);
      sum += point.weight * determinant;
      weights += point.weight;
    }
  }
  return smallest == 0.0 ? 0.0 : smallest / std::abs(sum / weights);
}

}  // namespace

double jacobian_ratio(SolidShape shape, const NodesRef& nodes) {
  return solid_shapes::with_table(shape, [&](const auto& table) { return ratio_of(table, nodes); });
}

int node_count(SolidShape shape) {
  return solid_shapes::with_table(shape,
                                  [](const auto& table) { return static_cast<int>(table.centre.values.size()); });
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
  return solid_shapes::with_table(shape, [&](const auto& table) { return stiffness(table, nodes, elasticity); });
}

Eigen::MatrixXd solid_mass(SolidShape shape, const NodesRef& nodes, MassKind kind) {
  return solid_shapes::with_table(shape, [&](const auto& table) {
    auto mass = scalar_mass(table, nodes);
    if (kind == MassKind::lumped && shape == SolidShape::pyramid5) {
      mass = Eigen::VectorXd(mass.rowwise().sum()).asDiagonal();
    } else if (kind == MassKind::lumped && shape == SolidShape::pyramid13) {
      mass = Eigen::VectorXd(balanced_pyramid(mass)).asDiagonal();
    } else if (kind == MassKind::lumped) {
      mass = Eigen::VectorXd(mass.diagonal() * (mass.sum() / mass.trace())).asDiagonal();
    }
    const Eigen::Index count = mass.cols();
    Eigen::MatrixXd M = Eigen::MatrixXd::Zero(3 * count, 3 * count);
    for (Eigen::Index j = 0; j < count; ++j) {
      for (Eigen::Index i = 0; i < count; ++i) M.block<3, 3>(3 * i, 3 * j).diagonal().setConstant(mass(i, j));
    }
    return M;
  });
}

double solid_volume(SolidShape shape, const NodesRef& nodes) {
  return solid_shapes::with_table(shape, [&](const auto& table) { return scalar_mass(table, nodes).sum(); });
}

}  // namespace mottle::fem
