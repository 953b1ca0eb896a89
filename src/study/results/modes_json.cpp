#include "study/results/modes_json.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <numeric>
#include <span>

#include "mottle/core/base64.hpp"
#include "mottle/fem/drawing.hpp"
#include "mottle/model/structures/finite_element_structure.hpp"

namespace mottle::study {
namespace {

std::string floats(const Eigen::MatrixX3d& rows, const std::vector<int>& nodes, double scale) {
  std::vector<float> values;
  for (const int node : nodes) {
    for (Eigen::Index c = 0; c < 3; ++c) values.push_back(static_cast<float>(scale * rows(node, c)));
  }
  return base64_of(std::span<const float>(values));
}

/// The measured shape at those of its nodes that are drawn.
Json measured_json(const ShownMode& mode, const std::vector<int>& drawn, double scale) {
  std::vector<std::uint32_t> nodes;
  std::vector<float> values;
  for (std::size_t k = 0; k < mode.measured_nodes.size(); ++k) {
    const auto found = std::lower_bound(drawn.begin(), drawn.end(), mode.measured_nodes[k]);
    if (found == drawn.end() || *found != mode.measured_nodes[k]) continue;
    nodes.push_back(static_cast<std::uint32_t>(found - drawn.begin()));
    for (Eigen::Index c = 0; c < 3; ++c) {
      values.push_back(static_cast<float>(scale * mode.measured(static_cast<Eigen::Index>(k), c)));
    }
  }
  return {{"nodes", nodes}, {"shape", base64_of(std::span<const float>(values))}};
}

/// Groups of a part's nodes in the numbers of the whole drawing; those with a node that is not drawn are left out.
template <std::size_t Size>
std::vector<std::uint32_t> renumbered(const std::vector<std::array<std::uint32_t, Size>>& groups, const Drawing& part,
                                      const std::vector<int>& drawn) {
  std::vector<std::uint32_t> numbers;
  for (const auto& group : groups) {
    std::array<std::uint32_t, Size> own{};
    bool is_drawn = true;
    for (std::size_t k = 0; k < Size; ++k) {
      const auto found = std::lower_bound(drawn.begin(), drawn.end(), part.nodes[group[k]]);
      is_drawn = is_drawn && found != drawn.end() && *found == part.nodes[group[k]];
      own[k] = static_cast<std::uint32_t>(found - drawn.begin());
    }
    if (is_drawn) numbers.insert(numbers.end(), own.begin(), own.end());
  }
  return numbers;
}

std::vector<std::array<std::uint32_t, 1>> points_of(const Drawing& part) {
  std::vector<std::array<std::uint32_t, 1>> points;
  for (const std::uint32_t point : part.points) points.push_back({point});
  return points;
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
    if (!mode.measured_nodes.empty() && largest > 0.0) {
      list.back()["test"] = measured_json(mode, drawing.nodes, 1.0 / largest);
    }
  }
  return {{"frequency_unit", frequency_unit},
          {"positions", floats(positions, drawing.nodes, 1.0)},
          {"node_ids", ids},
          {"triangles", base64_of(std::span<const std::uint32_t>(triangles))},
          {"edges", base64_of(std::span<const std::uint32_t>(edges))},
          {"points", drawing.points},
          {"list", list}};
}

Json parameter_parts_json(const Structure& structure, const std::vector<std::string>& names) {
  const auto* const deck = dynamic_cast<const FiniteElementStructure*>(&structure);
  Json list = Json::array();
  if (deck == nullptr || deck->field_parameters().size() != names.size()) return list;
  std::vector<std::vector<FieldIndex>> groups;
  for (const FieldParameter& parameter : deck->field_parameters()) groups.push_back(parameter.fields);
  const std::vector<int> drawn = drawing_of(deck->model()).nodes;
  const std::vector<Drawing> parts = drawings_of_fields(deck->model(), groups);
  for (std::size_t i = 0; i < names.size(); ++i) {
    const Drawing& part = parts[i];
    list.push_back({{"name", names[i]},
                    {"triangles", base64_of(std::span<const std::uint32_t>(renumbered(part.triangles, part, drawn)))},
                    {"edges", base64_of(std::span<const std::uint32_t>(renumbered(part.edges, part, drawn)))},
                    {"points", renumbered(points_of(part), part, drawn)}});
  }
  return list;
}

}  // namespace mottle::study
