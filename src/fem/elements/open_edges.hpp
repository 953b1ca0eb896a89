// Mid-edge nodes that a card leaves out: each lies midway between the ends of its edge and moves as their mean.
#pragma once

#include <Eigen/Core>
#include <array>
#include <span>
#include <vector>

#include "mottle/fem/finite_element_model.hpp"
#include "mottle/layers.hpp"

namespace mottle::fem {

/// An edge whose middle node is left out; all count the element's nodes.
struct OpenEdge {
  int middle = 0;
  std::array<int, 2> ends = {};
};

/// @param nodes    corners, then the middles of the edges, -1 where they are left out
/// @param corners  how many
/// @param edges    ends of the edges in the order of their middles
std::vector<OpenEdge> open_edges(std::span<const int> nodes, int corners, std::span<const std::array<int, 2>> edges);

/// Basic coordinates of all nodes, [3 x node].
Eigen::Matrix3Xd positions(const FiniteElementModel& model, std::span<const int> nodes,
                           const std::vector<OpenEdge>& open);

/// The matrix of the nodes that are there. Of a mass without terms between nodes, the ends take half each.
/// @param width  degrees of freedom by node
Eigen::MatrixXd without_open_edges(const Eigen::MatrixXd& matrix, const std::vector<OpenEdge>& open, int width,
                                   bool is_lumped);

}  // namespace mottle::fem
