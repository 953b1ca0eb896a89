#include "fem/elements/curved_shell_strains.hpp"

#include <Eigen/Geometry>
#include <Eigen/LU>
#include <cmath>

#include "mottle/core/error.hpp"

namespace mottle::fem::curved_shell {
namespace {

constexpr int k_pairs[3][2] = {{0, 0}, {1, 1}, {0, 1}};

/// v . (a x b) = a . (b x v): the row by a of a vector product's component.
Eigen::RowVector3d turned_by(const Eigen::Vector3d& b, const Eigen::Vector3d& v) {
  return b.cross(v).transpose();
}

}  // namespace

Surface::Surface(const CurvedShellInput& input) : tables_(&curved_shell::tables(input.node_count)) {
  const Eigen::Index count = tables_->node_count;
  nodes_ = input.nodes.leftCols(count).colwise() - Eigen::Vector3d(input.nodes.col(0));
  normals_ = Eigen::Matrix3Xd::Zero(3, count);
  const double span = nodes_.norm();
  const auto across = [&](const ParentPoint& point) {
    const Eigen::Matrix<double, 3, 2> tangents = nodes_ * point.slopes.transpose();
    const Eigen::Vector3d normal = tangents.col(0).cross(tangents.col(1));
    require(normal.norm() > 1e-12 * span * span && std::isfinite(span),
            "shell: the nodes enclose no area, points around an area are needed");
    return normal.normalized().eval();
  };
  const Eigen::Vector3d middle = across(tables_->centre);
  for (Eigen::Index n = 0; n < count; ++n) {
    normals_.col(n) = across(tables_->nodes[static_cast<std::size_t>(n)]);
    require(normals_.col(n).dot(middle) > 0.0,
            "shell: the element turns over or inwards: its normal at node {} lies across that of its centre; a finer "
            "mesh, or mid-edge nodes nearer to the middle, are needed",
            n + 1);
  }
  nodes_ += input.offset * normals_;
  centre_ = place_unchecked(tables_->centre);
}

Place Surface::place_unchecked(const ParentPoint& point) const {
  Place place;
  place.tangents = nodes_ * point.slopes.transpose();
  place.director = normals_ * point.values.transpose();
  place.director_slopes = normals_ * point.slopes.transpose();
  const Eigen::Vector3d across = place.tangents.col(0).cross(place.tangents.col(1));
  place.area = across.norm();
  place.axes.row(2) = across.normalized();
  return place;
}

Place Surface::place(const ParentPoint& point) const {
  Place place = place_unchecked(point);
  const Eigen::Vector3d normal = place.axes.row(2);
  require(normal.dot(centre_.axes.row(2)) > 0.0,
          "shell: the element turns over or inwards, or its offset is larger than its radius of curvature");
  // One direction for all points, so that a constant strain of a flat element has constant components.
  const Eigen::Vector3d along = centre_.tangents.col(0);
  const Eigen::Vector3d x = (along - normal * normal.dot(along)).normalized();
  place.axes.row(0) = x;
  place.axes.row(1) = normal.cross(x);
  place.inverse = (place.axes.topRows<2>() * place.tangents).inverse();
  return place;
}

double Surface::area() const {
  double area = 0.0;
  for (const ParentPoint& point : tables_->points) area += point.weight * place(point).area;
  return area;
}

Strain Surface::membrane(const ParentPoint& point) const {
  const Place at = place_unchecked(point);
  Strain strain = Strain::Zero(3, size() + inside());
  for (Eigen::Index row = 0; row < 3; ++row) {
    const int a = k_pairs[row][0], b = k_pairs[row][1];
    const double factor = a == b ? 0.5 : 1.0;
    const auto of = [&](const Eigen::Vector2d& slopes) {
      return (factor * (at.tangents.col(a) * slopes(b) + at.tangents.col(b) * slopes(a))).transpose().eval();
    };
    for (Eigen::Index n = 0; n < tables_->node_count; ++n) strain.block<1, 3>(row, 6 * n) = of(point.slopes.col(n));
    if (inside() == 4) {
      strain.block<1, 2>(row, size() + 2) = of(point.bubble_slopes) * centre_.tangents;
    }
  }
  return strain;
}

Strain Surface::curvature(const ParentPoint& point) const {
  const Place at = place_unchecked(point);
  Strain strain = Strain::Zero(3, size() + inside());
  for (Eigen::Index row = 0; row < 3; ++row) {
    const int a = k_pairs[row][0], b = k_pairs[row][1];
    const double factor = a == b ? 0.5 : 1.0;
    const auto by_displacement = [&](const Eigen::Vector2d& slopes) {
      return (factor * (at.director_slopes.col(a) * slopes(b) + at.director_slopes.col(b) * slopes(a)))
          .transpose()
          .eval();
    };
    const auto by_director = [&](const Eigen::Vector2d& slopes) {
      return (factor * (at.tangents.col(a) * slopes(b) + at.tangents.col(b) * slopes(a))).eval();
    };
    for (Eigen::Index n = 0; n < tables_->node_count; ++n) {
      strain.block<1, 3>(row, 6 * n) = by_displacement(point.slopes.col(n));
      strain.block<1, 3>(row, 6 * n + 3) = turned_by(normals_.col(n), by_director(point.slopes.col(n)));
    }
    strain.block<1, 2>(row, size()) = by_director(point.bubble_slopes).transpose() * centre_.tangents;
    if (inside() == 4) strain.block<1, 2>(row, size() + 2) = by_displacement(point.bubble_slopes) * centre_.tangents;
  }
  return strain;
}

Shear Surface::shear(const ParentPoint& point) const {
  const Place at = place_unchecked(point);
  Shear shear = Shear::Zero(2, size() + inside());
  for (Eigen::Index a = 0; a < 2; ++a) {
    const Eigen::Vector3d tangent = at.tangents.col(a);
    for (Eigen::Index n = 0; n < tables_->node_count; ++n) {
      shear.block<1, 3>(a, 6 * n) = point.slopes(a, n) * at.director.transpose();
      shear.block<1, 3>(a, 6 * n + 3) = point.values(n) * turned_by(normals_.col(n), tangent);
    }
    shear.block<1, 2>(a, size()) = point.bubble * tangent.transpose() * centre_.tangents;
  }
  return shear;
}

Eigen::RowVectorXd Surface::drilling(const ParentPoint& point) const {
  const Place at = place(point);
  Eigen::RowVectorXd lag = Eigen::RowVectorXd::Zero(size());
  const Eigen::Matrix<double, 2, Eigen::Dynamic, Eigen::ColMajor, 2, 8> slopes = at.inverse.transpose() * point.slopes;
  for (Eigen::Index n = 0; n < tables_->node_count; ++n) {
    lag.segment<3>(6 * n) = 0.5 * (slopes(1, n) * at.axes.row(0) - slopes(0, n) * at.axes.row(1));
    lag.segment<3>(6 * n + 3) = point.values(n) * at.axes.row(2);
  }
  return lag;
}

Eigen::MatrixXd Surface::to_offset_nodes(double offset) const {
  Eigen::MatrixXd motion = Eigen::MatrixXd::Identity(size(), size());
  for (Eigen::Index n = 0; n < tables_->node_count; ++n) {
    const Eigen::Vector3d arm = offset * normals_.col(n);  // rotation x arm
    motion.block<3, 3>(6 * n, 6 * n + 3) << 0.0, arm.z(), -arm.y(), -arm.z(), 0.0, arm.x(), arm.y(), -arm.x(), 0.0;
  }
  return motion;
}

Eigen::Matrix3d to_axes(const Place& place) {
  const double a = place.inverse(0, 0), b = place.inverse(1, 0), c = place.inverse(0, 1), d = place.inverse(1, 1);
  Eigen::Matrix3d turned;
  turned << a * a, b * b, a * b, c * c, d * d, c * d, 2.0 * a * c, 2.0 * b * d, a * d + b * c;
  return turned;
}

}  // namespace mottle::fem::curved_shell
