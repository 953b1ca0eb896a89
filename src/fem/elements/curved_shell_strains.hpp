// Kinematics of the curved shells: strains by the displacements of nodes and bubbles.
#pragma once

#include <Eigen/Core>

#include "fem/elements/curved_shell_tables.hpp"
#include "mottle/fem/elements/curved_shell.hpp"
#include "mottle/layers.hpp"

namespace mottle::fem::curved_shell {

/// Degrees of freedom inside: two rotations of the director; of eight nodes two tangential displacements as well.
inline constexpr int k_max_inside = 4;
using Strain = Eigen::Matrix<double, 3, Eigen::Dynamic, Eigen::ColMajor, 3, 6 * 8 + k_max_inside>;
using Shear = Eigen::Matrix<double, 2, Eigen::Dynamic, Eigen::ColMajor, 2, 6 * 8 + k_max_inside>;

/// The surface at a point.
struct Place {
  Eigen::Matrix<double, 3, 2> tangents = {};         ///< x,a
  Eigen::Vector3d director = {};                     ///< interpolated
  Eigen::Matrix<double, 3, 2> director_slopes = {};  ///< n,a
  Eigen::Matrix3d axes = {};                         ///< rows: x, y, normal; x is the centre's, projected
  Eigen::Matrix2d inverse = {};                      ///< d (xi, eta) / d (x, y)
  double area = 0.0;                                 ///< per parent area
};

/// The element's surface through the offset nodes.
class Surface {
 public:
  /// @throws InvalidInput  nodes that enclose no area or turn over
  explicit Surface(const CurvedShellInput& input);

  const Tables& tables() const { return *tables_; }
  int size() const { return 6 * tables_->node_count; }
  int inside() const { return tables_->node_count == 8 ? 4 : 2; }
  Place place(const ParentPoint& point) const;
  double area() const;

  /// Covariant strains xx, yy, twice xy of the middle surface, their change with the height, shears xz, yz.
  Strain membrane(const ParentPoint& point) const;
  Strain curvature(const ParentPoint& point) const;
  Shear shear(const ParentPoint& point) const;
  /// Rotation about the normal less that of the surface.
  Eigen::RowVectorXd drilling(const ParentPoint& point) const;

  /// Rotations and displacements of the nodes to those of the offset nodes, [size x size].
  Eigen::MatrixXd to_offset_nodes(double offset) const;

 private:
  Place place_unchecked(const ParentPoint& point) const;

  const Tables* tables_;
  Eigen::Matrix<double, 3, Eigen::Dynamic, Eigen::ColMajor, 3, 8> nodes_, normals_;
  Place centre_;
};

/// Covariant strains xx, yy, twice xy to engineering strains in the place's axes.
Eigen::Matrix3d to_axes(const Place& place);

}  // namespace mottle::fem::curved_shell
