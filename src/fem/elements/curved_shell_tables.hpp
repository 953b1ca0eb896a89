// Shape functions, integration points and tying points of the curved shells, tabulated once.
#pragma once

#include <Eigen/Core>
#include <vector>

#include "mottle/layers.hpp"

namespace mottle::fem::curved_shell {

/// A place in parent coordinates with the shape functions there.
struct ParentPoint {
  double xi = 0.0, eta = 0.0, weight = 0.0;
  Eigen::Matrix<double, 1, Eigen::Dynamic, Eigen::RowMajor, 1, 8> values = {};
  Eigen::Matrix<double, 2, Eigen::Dynamic, Eigen::ColMajor, 2, 8> slopes = {};  ///< by xi, eta
  double bubble = 0.0;  ///< zero along the edges, one at the centre
  Eigen::Vector2d bubble_slopes = Eigen::Vector2d::Zero();
};

/// A point at which the strain along a parent direction is tied.
struct Tie {
  ParentPoint point;
  Eigen::Vector2d direction;
};

struct Tables {
  int node_count = 8;
  std::vector<ParentPoint> nodes, points;
  ParentPoint centre;
  std::vector<ParentPoint> reduced = {};  ///< of eight nodes 2 x 2: the membrane
  std::vector<Tie> membrane_ties = {};    ///< of six nodes: three along each edge's direction
  std::vector<Tie> shear_ties = {};       ///< two along each edge
  /// Coefficients of the shear's functions from the values at shear_ties and the two means.
  Eigen::MatrixXd shear_fit = {};
};

/// @param node_count  6 or 8
const Tables& tables(int node_count);

/// Functions of the covariant shear: [xi, eta x function].
Eigen::MatrixXd shear_functions(int node_count, double xi, double eta);

/// Of eight nodes, a bilinear function from its values at `reduced`. Of six, a linear one from those at three ties.
Eigen::RowVectorXd extrapolation(const Tables& tables, double xi, double eta);
Eigen::RowVector3d linear_fit(const Tables& tables, int direction, double xi, double eta);

}  // namespace mottle::fem::curved_shell
