#include "fem/elements/open_edges.hpp"

namespace mottle::fem {

std::vector<OpenEdge> open_edges(std::span<const int> nodes, int corners, std::span<const std::array<int, 2>> edges) {
  std::vector<OpenEdge> open;
  for (int n = corners; n < std::ssize(nodes); ++n) {
    if (nodes[static_cast<std::size_t>(n)] < 0) open.push_back({n, edges[static_cast<std::size_t>(n - corners)]});
  }
  return open;
}

Eigen::Matrix3Xd positions(const FiniteElementModel& model, std::span<const int> nodes,
                           const std::vector<OpenEdge>& open) {
  Eigen::Matrix3Xd result(3, std::ssize(nodes));
  for (Eigen::Index n = 0; n < result.cols(); ++n) {
    const int node = nodes[static_cast<std::size_t>(n)];
    if (node >= 0) result.col(n) = model.nodes[static_cast<std::size_t>(node)].position;
  }
  for (const auto& [middle, ends] : open) result.col(middle) = 0.5 * (result.col(ends[0]) + result.col(ends[1]));
  return result;
}

Eigen::MatrixXd without_open_edges(const Eigen::MatrixXd& matrix, const std::vector<OpenEdge>& open, int width,
                                   bool is_lumped) {
  if (open.empty()) return matrix;
  Eigen::MatrixXd sum = matrix;
  std::vector<bool> is_open(static_cast<std::size_t>(matrix.cols() / width), false);
  for (const auto& [middle, ends] : open) {
    is_open[static_cast<std::size_t>(middle)] = true;
    const Eigen::Index from = width * middle;
    for (const int end : ends) {
      if (is_lumped) {
        sum.block(width * end, width * end, width, width) += 0.5 * sum.block(from, from, width, width);
      } else {
        sum.middleRows(width * end, width) += 0.5 * sum.middleRows(from, width);
      }
    }
    for (const int end : ends) {
      if (!is_lumped) sum.middleCols(width * end, width) += 0.5 * sum.middleCols(from, width);
    }
  }
  std::vector<int> kept;
  for (int row = 0; row < matrix.cols(); ++row) {
    if (!is_open[static_cast<std::size_t>(row / width)]) kept.push_back(row);
  }
  Eigen::MatrixXd rest = sum(kept, kept);
  rest.triangularView<Eigen::StrictlyUpper>() = rest.transpose();
  return rest;
}

}  // namespace mottle::fem
