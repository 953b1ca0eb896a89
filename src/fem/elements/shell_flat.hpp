// The flat element behind a shell: its plane, its nodes in that plane, shape functions and integration points.
#pragma once

#include <Eigen/Core>
#include <array>

#include "mottle/fem/elements/shell.hpp"
#include "mottle/layers.hpp"

namespace mottle::fem::shell {

/// An integration point of the flat element.
struct Point {
  Eigen::Vector4d shape = Eigen::Vector4d::Zero();
  Eigen::Matrix<double, 2, 4> gradient = Eigen::Matrix<double, 2, 4>::Zero();  ///< d shape / d (x, y)
  Eigen::Matrix2d inverse = Eigen::Matrix2d::Zero();                           ///< d (xi, eta) / d (x, y), rows x, y
  double xi = 0.0, eta = 0.0;
  double area = 0.0;  ///< weight times Jacobian determinant
};

/// Edge from node `first` to `second` of the flat element.
struct Edge {
  Eigen::Index first = 0, second = 1;
  double length = 0.0;
  Eigen::Vector2d tangent = Eigen::Vector2d::Zero();
};

/// The plane of an element and its nodes seen from there.
struct Plane {
  Eigen::Matrix3d axes = Eigen::Matrix3d::Identity();  ///< rows: x, y, normal, in basic coordinates
  Eigen::Matrix<double, 3, 4> nodes =
      Eigen::Matrix<double, 3, 4>::Zero();  ///< in these axes, from the mean of the nodes
};

/// @throws InvalidInput  nodes that enclose no area
Plane plane_of(const ShellInput& input);

struct Flat {
  int node_count = 4;
  Eigen::Matrix3d axes = Eigen::Matrix3d::Identity();
  Eigen::Matrix<double, 2, 4> nodes = Eigen::Matrix<double, 2, 4>::Zero();  ///< in the plane
  Eigen::Vector4d heights = Eigen::Vector4d::Zero();                        ///< of the nodes above the plane
  bool is_warped = false;
  std::array<Edge, 4> edges = {};    ///< node i to node i + 1
  std::array<Point, 4> points = {};  ///< 2 x 2, or the three mid-edges
  Point centre = {};
  int point_count = 4;
  double area = 0.0;
};

/// @throws InvalidInput  as shell_stiffness
Flat flatten(const ShellInput& input);

/// Plane stress of unit Young's modulus: xx, yy, engineering xy.
Eigen::Matrix3d plane_stress(double poisson);

using PlaneMatrix = Eigen::Matrix<double, 12, 12>;  ///< in plane by node u, v, rotation about the normal; or
                                                    ///< across it by node w, rotations about x and y

/// Strains xx, yy, engineering xy at the integration points.
struct MembraneStrains {
  std::array<Eigen::Matrix<double, 3, 8>, 4> nodes;  ///< by node u, v
  std::array<Eigen::Matrix<double, 3, 4>, 4> modes;  ///< of the incompatible modes of a quadrilateral
};

MembraneStrains membrane_strains(const Flat& flat);

/// Curvatures xx, yy, engineering xy and transverse shears xz, yz at the integration points, by node w, rotations about
/// x and y.
struct PlateStrains {
  std::array<Eigen::Matrix<double, 3, 12>, 4> curvature;
  std::array<Eigen::Matrix<double, 2, 12>, 4> shear;
};

/// @param fractions  of each edge's shear that becomes bending, in [0, 1]
PlateStrains plate_strains(const Flat& flat, const std::array<double, 4>& fractions);

/// The section in the axes of the flat element.
/// @throws InvalidInput  a material direction across the element
ShellSection in_element_axes(const Flat& flat, const ShellInput& input, const ShellSection& section);

struct SectionStiffness {
  PlaneMatrix membrane = PlaneMatrix::Zero();
  PlaneMatrix coupling = PlaneMatrix::Zero();  ///< forces in plane by deformations across it
  PlaneMatrix bending = PlaneMatrix::Zero();
  PlaneMatrix shear = PlaneMatrix::Zero();
};

/// @param section  in element axes
SectionStiffness section_stiffness(const Flat& flat, const ShellSection& section);

/// Resistance of the rotation about the normal against the plane's own, per G t K6ROT.
PlaneMatrix drilling(const Flat& flat);

}  // namespace mottle::fem::shell
