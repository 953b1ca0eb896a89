#include "mottle/formats/vtu.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cstdint>
#include <cstring>
#include <span>

#include "mottle/core/base64.hpp"

namespace mottle::formats {
namespace {

/// Connectivity in VTK's form.
struct Cells {
  std::vector<std::int32_t> nodes, ends, ids;
  std::vector<std::uint8_t> types;

  void add(std::span<const int> of_nodes, const Topology& topology, int id) {
    for (const int k : topology.cell_nodes) nodes.push_back(of_nodes[static_cast<std::size_t>(k)]);
    ends.push_back(static_cast<std::int32_t>(nodes.size()));
    types.push_back(static_cast<std::uint8_t>(topology.cell));
    ids.push_back(id);
  }
};

/// Whether a cell lies between different grid points; ground and scalar points have no position.
bool has_positions(const FiniteElementModel& model, const Topology& topology, std::span<const int> nodes) {
  const auto is_placed = [&](int k) {
    const int node = nodes[static_cast<std::size_t>(k)];
    return node >= 0 && !model.nodes[static_cast<std::size_t>(node)].is_scalar;
  };
  return std::ranges::all_of(topology.cell_nodes, is_placed) && (nodes.size() != 2 || nodes[0] != nodes[1]);
}

Cells cells_of(const FiniteElementModel& model) {
  Cells cells;
  for_each_list(model.element_lists, [&](const auto& list) {
    const auto& traits = traits_of(list);
    for (const auto& element : list) {
      const Topology& topology = traits.topology(element);
      const std::span<const int> nodes = traits.nodes(element);
      if (topology.cell != VtkCell::none && has_positions(model, topology, nodes))
        cells.add(nodes, topology, element.id);
    }
  });
  return cells;
}

/// A text inside the quotes of an XML attribute.
std::string attribute(const std::string& text) {
  std::string result;
  for (const char letter : text) {
    switch (letter) {
      case '&':
        result += "&amp;";
        break;
      case '<':
        result += "&lt;";
        break;
      case '"':
        result += "&quot;";
        break;
      default:
        result += letter;
    }
  }
  return result;
}

/// An inline array: its length in bytes, then its bytes, in one base64 text.
template <typename Number>
std::string data_array(const char* type, const std::string& name, int components, const std::vector<Number>& values) {
  const auto bytes = static_cast<std::uint32_t>(values.size() * sizeof(Number));
  std::vector<std::byte> raw(sizeof bytes + bytes);
  std::memcpy(raw.data(), &bytes, sizeof bytes);
  if (bytes > 0) std::memcpy(raw.data() + sizeof bytes, values.data(), bytes);
  return fmt::format(
      "        <DataArray type=\"{}\" Name=\"{}\" NumberOfComponents=\"{}\" format=\"binary\">{}</DataArray>\n", type,
      attribute(name), components, base64(raw));
}

std::string vectors_array(const std::string& name, const Eigen::MatrixX3d& vectors) {
  std::vector<double> values;
  values.reserve(static_cast<std::size_t>(vectors.size()));
  for (Eigen::Index i = 0; i < vectors.rows(); ++i) {
    for (Eigen::Index c = 0; c < 3; ++c) values.push_back(vectors(i, c));
  }
  return data_array("Float64", name, 3, values);
}

}  // namespace

std::string format_vtu(const FiniteElementModel& model, const std::vector<VtuField>& fields) {
  const Cells cells = cells_of(model);
  Eigen::MatrixX3d positions(static_cast<Eigen::Index>(model.nodes.size()), 3);
  std::vector<std::int32_t> ids;
  for (std::size_t i = 0; i < model.nodes.size(); ++i) {
    positions.row(static_cast<Eigen::Index>(i)) = model.nodes[i].position.transpose();
    ids.push_back(model.nodes[i].id);
  }
  std::string text =
      "<?xml version=\"1.0\"?>\n<VTKFile type=\"UnstructuredGrid\" version=\"0.1\" byte_order=\"LittleEndian\" "
      "header_type=\"UInt32\">\n  <UnstructuredGrid>\n";
  text +=
      fmt::format("    <Piece NumberOfPoints=\"{}\" NumberOfCells=\"{}\">\n", model.nodes.size(), cells.types.size());
  text += "      <PointData>\n" + data_array("Int32", "grid", 1, ids);
  for (const VtuField& field : fields) text += vectors_array(field.name, field.vectors);
  text += "      </PointData>\n      <CellData>\n" + data_array("Int32", "element", 1, cells.ids);
  text += "      </CellData>\n      <Points>\n" + vectors_array("position", positions);
  text += "      </Points>\n      <Cells>\n" + data_array("Int32", "connectivity", 1, cells.nodes);
  text += data_array("Int32", "offsets", 1, cells.ends) + data_array("UInt8", "types", 1, cells.types);
  text += "      </Cells>\n    </Piece>\n  </UnstructuredGrid>\n</VTKFile>\n";
  return text;
}

}  // namespace mottle::formats
