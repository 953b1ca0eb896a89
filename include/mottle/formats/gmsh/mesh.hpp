// Meshes as Gmsh writes them: nodes, elements and the physical groups that they belong to.
#pragma once

#include <Eigen/Core>
#include <filesystem>
#include <span>
#include <string>
#include <string_view>
#include <vector>

#include "mottle/layers.hpp"

namespace mottle::formats {

/// A kind of element in Gmsh's numbering.
struct GmshElementKind {
  int type = 0;  ///< Gmsh's number
  int dimension = 0;
  int nodes = 0;
  std::string_view name;  ///< "6-node triangle"
};

/// The kinds that are known; null where there is none of that number.
const GmshElementKind* gmsh_element_kind(int type);

struct GmshMesh {
  struct Node {
    int tag = 0;
    Eigen::Vector3d position = Eigen::Vector3d::Zero();
  };
  struct Element {
    int tag = 0;
    const GmshElementKind* kind = nullptr;
    std::size_t first_node = 0;  ///< into element_nodes
  };
  /// A physical group.
  struct Group {
    int dimension = 0, tag = 0;
    std::string name;                   ///< empty: it has none
    std::vector<std::size_t> elements;  ///< indices, ascending, each once
  };

  std::vector<Node> nodes;                 ///< ascending in tag
  std::vector<Element> elements;           ///< those in physical groups; ascending in tag
  std::vector<std::size_t> element_nodes;  ///< indices into nodes, in Gmsh's order
  std::vector<Group> groups;               ///< by dimension, then by tag

  std::span<const std::size_t> nodes_of(const Element& element) const {
    return {element_nodes.data() + element.first_node, static_cast<std::size_t>(element.kind->nodes)};
  }
};

/// Reads MSH 4.1 and 2.2 as text. Elements outside of physical groups are left out; an element that stands in MSH 2.2
/// once for each of its groups is one element.
///
/// @throws FormatError  file and line: another version, binary, partitioned, without physical groups, an element of a
///                      kind that is not known, tags that repeat or are missing, numbers that are none
GmshMesh read_gmsh_mesh(const std::filesystem::path& file);

/// The same of a mesh in memory.
GmshMesh parse_gmsh_mesh(std::string_view bytes, const std::string& file);

}  // namespace mottle::formats
