#include "study/results/modes_json.hpp"

#include <cmath>
#include <numeric>
#include <span>

#include "mottle/core/base64.hpp"
#include "mottle/fem/drawing.hpp"

namespace mottle::study {
namespace {

std::string floats(const Eigen::MatrixX3d& rows, const std::vector<int>& nodes, double scale) {
  std::vector<float> values;
  for (const int node : nodes) {
    for (Eigen::Index c = 0; c < 3; ++c) values.push_back(static_cast<float>(scale * rows(node, c)));
  }
  return base64_of(std::span<const float>(values));
}

}  // namespace

Eigen::MatrixX3d node_displacements(const Structure& structure, const Eigen::Ref<const Eigen::VectorXd>& shape) {
  const FiniteElementModel& model = *structure.mesh();
  std::vector<int> components(6 * model.nodes.size());
  std::iota(components.begin(), components.end(), 0);
  const Eigen::VectorXd all = structure.displacements(shape, components);
  Eigen::MatrixX3d result(static_cast<Eigen::Index>(model.nodes.size()), 3);
  for (Eigen::Index i = 0; i < result.rows(); ++i) {
    const Node& node = model.nodes[static_cast<std::size_t>(i)];
    Eigen::Vector3d local = all.segment<3>(6 * i);
    if (node.displacement_system >= 0) {
      local =
          model.coordinate_systems[static_cast<std::size_t>(node.displacement_system)].directions_at(node.position) *
          local;
    }
    result.row(i) = node.is_scalar ? Eigen::RowVector3d(0, 0, 0) : Eigen::RowVector3d(local.transpose());
  }
  return result;
}

Json drawing_json(const Structure& structure, const std::vector<ShownMode>& modes, const std::string& frequency_unit) {
  const FiniteElementModel& model = *structure.mesh();
  const Drawing drawing = drawing_of(model);
  Eigen::MatrixX3d positions(static_cast<Eigen::Index>(model.nodes.size()), 3);
  for (Eigen::Index i = 0; i < positions.rows(); ++i) {
    positions.row(i) = model.nodes[static_cast<std::size_t>(i)].position.transpose();
  }
  Json ids = Json::array();
  for (const int node : drawing.nodes) ids.push_back(model.nodes[static_cast<std::size_t>(node)].id);
  std::vector<std::uint32_t> triangles;
  for (const auto& triangle : drawing.triangles) triangles.insert(triangles.end(), triangle.begin(), triangle.end());
  std::vector<std::uint32_t> edges;
  for (const auto& edge : drawing.edges) edges.insert(edges.end(), edge.begin(), edge.end());
  Json list = Json::array();
  for (const ShownMode& mode : modes) {
    const Eigen::MatrixX3d shape = node_displacements(structure, mode.shape);
    const double largest = shape.rowwise().norm().maxCoeff();
    list.push_back({{"number", mode.number},
                    {"frequency", mode.frequency},
                    {"label", fmt::format("mode {}", mode.number)},
                    {"residual", std::isnan(mode.residual) ? Json(nullptr) : Json(mode.residual)},
                    {"note", mode.note},
                    {"shape", floats(shape, drawing.nodes, largest > 0.0 ? 1.0 / largest : 0.0)}});
  }
  return {{"frequency_unit", frequency_unit},
          {"positions", floats(positions, drawing.nodes, 1.0)},
          {"node_ids", ids},
          {"triangles", base64_of(std::span<const std::uint32_t>(triangles))},
          {"edges", base64_of(std::span<const std::uint32_t>(edges))},
          {"points", drawing.points},
          {"list", list}};
}

}  // namespace mottle::study
