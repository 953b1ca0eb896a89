#include "mottle/fem/drawing.hpp"

#include <algorithm>
#include <iterator>
#include <map>
#include <set>
#include <span>

#include "fem/elements/element_pieces.hpp"

namespace mottle::fem {
namespace {

using Face = std::vector<int>;  // nodes in order around it

/// What is drawn of a model's elements, in nodes of the model.
struct Shapes {
  std::vector<Face> faces;
  std::set<std::pair<int, int>> lines;
  std::set<int> points;
};

/// Adds the face of a solid; a face that two solids have in common lies inside.
void add_face_of_solid(const Face& face, std::map<Face, std::pair<Face, int>>& faces) {
  Face key = face;
  std::sort(key.begin(), key.end());
  auto& entry = faces[key];  // as seen, how often
  entry.first = face;
  ++entry.second;
}

/// Adds a line between two grid points that lie apart.
void add_line(const FiniteElementModel& model, int a, int b, std::set<std::pair<int, int>>& lines) {
  if (a < 0 || b < 0 || a == b) return;
  const Node& first = model.nodes[static_cast<std::size_t>(a)];
  const Node& second = model.nodes[static_cast<std::size_t>(b)];
  if (first.is_scalar || second.is_scalar) return;  // lies nowhere
  if (first.position != second.position) lines.insert(std::minmax(a, b));
}

/// Whether an element, counted through all lists, is wanted; empty: all are.
using Wanted = std::vector<bool>;

/// Nodes of an element that is drawn neither by faces nor by lines.
void add_nodes(const FiniteElementModel& model, std::span<const int> nodes, std::set<int>& points) {
  for (const int node : nodes) {
    if (node >= 0 && !model.nodes[static_cast<std::size_t>(node)].is_scalar) points.insert(node);
  }
}

Shapes shapes_of(const FiniteElementModel& model, const Wanted& wanted = {}) {
  Shapes shapes;
  std::size_t next = 0;
  std::vector<Face> faces_of_shells;
  std::map<Face, std::pair<Face, int>> faces_of_solids;  // by their nodes in ascending order
  for_each_list(model.element_lists, [&](const auto& list) {
    const auto& traits = traits_of(list);
    for (const auto& element : list) {
      if (!wanted.empty() && !wanted[next++]) continue;
      const Topology& topology = traits.topology(element);
      const std::span<const int> nodes = traits.nodes(element);
      const auto node = [&](int k) { return nodes[static_cast<std::size_t>(k)]; };
      for (const std::vector<int>& local : topology.faces) {
        Face face(local.size());
        std::transform(local.begin(), local.end(), face.begin(), node);
        if (topology.is_solid) {
          add_face_of_solid(face, faces_of_solids);
        } else {
          faces_of_shells.push_back(std::move(face));
        }
      }
      const std::size_t lines = shapes.lines.size();
      for (const std::array<int, 2>& line : topology.lines) add_line(model, node(line[0]), node(line[1]), shapes.lines);
      const bool is_drawn = !topology.faces.empty() || shapes.lines.size() > lines;
      if (!wanted.empty() && !is_drawn) add_nodes(model, nodes, shapes.points);
      for (const int point : topology.points) shapes.points.insert(node(point));
    }
  });
  for (auto& [key, entry] : faces_of_solids) {
    if (entry.second == 1) shapes.faces.push_back(std::move(entry.first));
  }
  std::move(faces_of_shells.begin(), faces_of_shells.end(), std::back_inserter(shapes.faces));
  for (const Face& face : shapes.faces) {
    for (std::size_t k = 0; k < face.size(); ++k) add_line(model, face[k], face[(k + 1) % face.size()], shapes.lines);
  }
  return shapes;
}

Drawing drawing_of_shapes(const FiniteElementModel& model, const Shapes& shapes) {
  const auto& [faces, lines, points] = shapes;
  std::set<int> used;
  for (const Face& face : faces) used.insert(face.begin(), face.end());
  for (const auto& [a, b] : lines) used.insert({a, b});
  used.insert(points.begin(), points.end());

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
  for (const auto& [a, b] : lines) drawing.edges.push_back({number(a), number(b)});
  for (const int node : points) drawing.points.push_back(number(node));
  return drawing;
}

/// Fields on which an element's matrices depend.
std::set<FieldIndex> fields_of(const ElementPieces& element) {
  std::set<FieldIndex> fields;
  for (const ElementPiece& piece : element.pieces) {
    for (const FieldPower& factor : piece.coefficient) fields.insert(factor.field);
    fields.insert(piece.matrix_fields.begin(), piece.matrix_fields.end());
  }
  return fields;
}

}  // namespace

Drawing drawing_of(const FiniteElementModel& model) {
  return drawing_of_shapes(model, shapes_of(model));
}

std::vector<Drawing> drawings_of_fields(const FiniteElementModel& model,
                                        const std::vector<std::vector<FieldIndex>>& groups) {
  std::vector<Wanted> wanted(groups.size());
  visit_elements(model, PieceSelection::all, [&](const ElementPieces& element) {
    const std::set<FieldIndex> fields = fields_of(element);
    for (std::size_t g = 0; g < groups.size(); ++g) {
      wanted[g].push_back(std::any_of(groups[g].begin(), groups[g].end(),
                                      [&](const FieldIndex field) { return fields.contains(field); }));
    }
  });
  std::vector<Drawing> drawings;
  for (const Wanted& each : wanted) {
    drawings.push_back(each.empty() ? Drawing{} : drawing_of_shapes(model, shapes_of(model, each)));
  }
  return drawings;
}

}  // namespace mottle::fem
