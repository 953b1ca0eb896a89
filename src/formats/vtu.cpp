#include "mottle/formats/vtu.hpp"

#include <fmt/format.h>

#include <cstdint>
#include <cstring>
#include <span>

#include "mottle/core/base64.hpp"

namespace mottle {
namespace {

/// Connectivity in VTK's form.
struct Cells {
  std::vector<std::int32_t> nodes, ends, ids;
  std::vector<std::uint8_t> types;

  void add(std::span<const int> of_nodes, std::uint8_t type, int id) {
    nodes.insert(nodes.end(), of_nodes.begin(), of_nodes.end());
    ends.push_back(static_cast<std::int32_t>(nodes.size()));
    types.push_back(type);
    ids.push_back(id);
  }
};

enum VtkCell : std::uint8_t {
  k_line = 3,
  k_triangle = 5,
  k_quad = 9,
  k_tetra = 10,
  k_hexahedron = 12,
  k_wedge = 13,
  k_quadratic_tetra = 24,
};

void add_solid(const SolidElement& element, Cells& cells) {
  const std::array<int, 10>& n = element.nodes;
  switch (element.shape) {
    case SolidShape::hexahedron8:
      return cells.add(std::span(n).first(8), k_hexahedron, element.id);
    case SolidShape::wedge6:
      // VTK's base is seen from outside, Nastran's from inside.
      return cells.add(std::array{n[0], n[2], n[1], n[3], n[5], n[4]}, k_wedge, element.id);
    case SolidShape::tetrahedron4:
      return cells.add(std::span(n).first(4), k_tetra, element.id);
    case SolidShape::tetrahedron10:
      return cells.add(n, k_quadratic_tetra, element.id);
  }
}

/// Whether an element lies between two grid points; a scalar point lies nowhere.
bool has_two_places(const FiniteElementModel& model, const ScalarElement& element) {
  const auto is_placed = [&](int node) { return node >= 0 && !model.nodes[static_cast<std::size_t>(node)].is_scalar; };
  return is_placed(element.nodes[0]) && is_placed(element.nodes[1]) && element.nodes[0] != element.nodes[1];
}

Cells cells_of(const FiniteElementModel& model) {
  Cells cells;
  for (const SolidElement& element : model.solids) add_solid(element, cells);
  for (const ShellElement& element : model.shells) {
    cells.add(std::span(element.nodes).first(static_cast<std::size_t>(element.node_count)),
              element.node_count == 3 ? k_triangle : k_quad, element.id);
  }
  for (const BeamElement& element : model.beams) cells.add(element.nodes, k_line, element.id);
  for (const RodElement& element : model.rods) cells.add(element.nodes, k_line, element.id);
  for (const BushElement& element : model.bushes) {
    if (element.nodes[1] >= 0) cells.add(element.nodes, k_line, element.id);
  }
  for (const ScalarElement& element : model.scalars) {
    if (has_two_places(model, element)) cells.add(element.nodes, k_line, element.id);
  }
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

}  // namespace mottle
