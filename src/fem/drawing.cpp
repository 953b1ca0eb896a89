#include "mottle/fem/drawing.hpp"

#include <algorithm>
#include <map>
#include <set>
#include <span>

namespace mottle {
namespace {

using Face = std::vector<int>;  // nodes in order around it

const std::vector<std::vector<int>>& local_faces(SolidShape shape) {
  static const std::vector<std::vector<int>> k_hexahedron = {{0, 3, 2, 1}, {4, 5, 6, 7}, {0, 1, 5, 4},
                                                             {1, 2, 6, 5}, {2, 3, 7, 6}, {3, 0, 4, 7}};
  static const std::vector<std::vector<int>> k_wedge = {{0, 2, 1}, {3, 4, 5}, {0, 1, 4, 3}, {1, 2, 5, 4}, {2, 0, 3, 5}};
  static const std::vector<std::vector<int>> k_tetrahedron = {{0, 2, 1}, {0, 1, 3}, {1, 2, 3}, {2, 0, 3}};
  if (shape == SolidShape::hexahedron8) return k_hexahedron;
  return shape == SolidShape::wedge6 ? k_wedge : k_tetrahedron;
}

std::vector<Face> surface(const FiniteElementModel& model) {
  std::map<Face, std::pair<Face, int>> faces;  // sorted nodes -> (as seen, how often)
  for (const SolidElement& element : model.solids) {
    for (const std::vector<int>& local : local_faces(element.shape)) {
      Face face;
      for (const int k : local) face.push_back(element.nodes[static_cast<std::size_t>(k)]);
      Face key = face;
      std::sort(key.begin(), key.end());
      auto& entry = faces[key];
      entry.first = face;
      ++entry.second;
    }
  }
  std::vector<Face> outer;
  for (auto& [key, entry] : faces) {
    if (entry.second == 1) outer.push_back(std::move(entry.first));
  }
  for (const ShellElement& element : model.shells) {
    outer.emplace_back(element.nodes.begin(), element.nodes.begin() + element.node_count);
  }
  return outer;
}

/// Ends of everything that is drawn as a line, in nodes of the model.
std::set<std::pair<int, int>> lines(const FiniteElementModel& model, const std::vector<Face>& faces) {
  std::set<std::pair<int, int>> result;
  const auto add = [&](int a, int b) {
    if (a < 0 || b < 0 || a == b) return;
    const Node& first = model.nodes[static_cast<std::size_t>(a)];
    const Node& second = model.nodes[static_cast<std::size_t>(b)];
    if (first.is_scalar || second.is_scalar) return;  // lies nowhere
    if (first.position != second.position) result.insert(std::minmax(a, b));
  };
  for (const Face& face : faces) {
    for (std::size_t k = 0; k < face.size(); ++k) add(face[k], face[(k + 1) % face.size()]);
  }
  for (const BeamElement& element : model.beams) add(element.nodes[0], element.nodes[1]);
  for (const RodElement& element : model.rods) add(element.nodes[0], element.nodes[1]);
  for (const BushElement& element : model.bushes) add(element.nodes[0], element.nodes[1]);
  for (const ScalarElement& element : model.scalars) {
    if (element.kind == ScalarElement::Kind::spring) add(element.nodes[0], element.nodes[1]);
  }
  return result;
}

}  // namespace

Drawing drawing_of(const FiniteElementModel& model) {
  const std::vector<Face> faces = surface(model);
  const std::set<std::pair<int, int>> edges = lines(model, faces);
  std::set<int> used;
  for (const Face& face : faces) used.insert(face.begin(), face.end());
  for (const auto& [a, b] : edges) used.insert({a, b});
  std::set<int> masses;
  for (const PointMassElement& element : model.point_masses) masses.insert(element.node);
  used.insert(masses.begin(), masses.end());

  Drawing drawing;
  drawing.nodes.assign(used.begin(), used.end());
  const auto number = [&](int node) {
    const auto found = std::lower_bound(drawing.nodes.begin(), drawing.nodes.end(), node);
    return static_cast<std::uint32_t>(found - drawing.nodes.begin());
  };
  const auto position = [&](int node) { return model.nodes[static_cast<std::size_t>(node)].position; };
  for (const Face& face : faces) {
    const auto add = [&](int a, int b, int c) { drawing.triangles.push_back({number(a), number(b), number(c)}); };
    if (face.size() == 3) {
      add(face[0], face[1], face[2]);
    } else if ((position(face[0]) - position(face[2])).norm() <= (position(face[1]) - position(face[3])).norm()) {
      add(face[0], face[1], face[2]);
      add(face[0], face[2], face[3]);
    } else {
      add(face[0], face[1], face[3]);
      add(face[1], face[2], face[3]);
    }
  }
  for (const auto& [a, b] : edges) drawing.edges.push_back({number(a), number(b)});
  for (const int node : masses) drawing.points.push_back(number(node));
  return drawing;
}

}  // namespace mottle
