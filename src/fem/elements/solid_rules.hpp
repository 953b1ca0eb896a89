// Integration rules of the solids in natural coordinates, and tables of shape functions at their points.
#pragma once

#include <Eigen/Core>
#include <vector>

#include "fem/elements/solid_shapes.hpp"
#include "mottle/layers.hpp"

namespace mottle::fem::solid_shapes {

struct Abscissa {
  double weight;
  Eigen::Vector3d position;
};
using Rule = std::vector<Abscissa>;

/// Gauss' points on [-1, 1], along x. @param count  2, 3 or 4: exact to degree 3, 5 or 7
Rule gauss(int count);
/// The points of a line in three directions.
Rule cube(const Rule& line);
Rule triangle_of_degree_2();  ///< 3 points
Rule triangle_of_degree_4();  ///< 6 points [Dunavant1985]
Rule triangle_of_degree_5();  ///< 7 points [Dunavant1985]
/// The points of a triangle in x and y at those of a line in z.
Rule prism(const Rule& triangle, const Rule& line);
Rule tetrahedron_of_degree_2();  ///< 4 points
Rule tetrahedron_of_degree_5();  ///< 14 points, all weights positive [Walkington2000]
/// Points of a pyramid as (a, b, zeta), a and b from -1 to 1 at every height: xi = a (1 - zeta), eta = b (1 - zeta).
/// The weights contain the section's area that this leaves.
Rule collapsed(const Rule& line, const Rule& height);

/// The corners, of weight 0.
Rule hexahedron_corners();
Rule wedge_corners();
Rule pyramid_corners();
Rule tetrahedron_corners();

/// Barycentric coordinates of a triangle or tetrahedron whose first corner is the origin of the own coordinates.
Eigen::Vector4d barycentric(const Eigen::Vector3d& position);
Eigen::Matrix<double, 3, 4> barycentric_gradients();

/// Shape functions at the points of rules. @param evaluate  fills everything but the weight
Table make_table(int nodes, int modes, const Rule& stiffness, const Rule& mass, const Rule& corners,
                 const Eigen::Vector3d& centre, void (*evaluate)(const Eigen::Vector3d& position, SolidPoint& point));

}  // namespace mottle::fem::solid_shapes
