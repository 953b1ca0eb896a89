#include "mottle/formats/gmsh/mesh.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <map>
#include <numeric>
#include <unordered_map>
#include <utility>

#include "formats/gmsh/words.hpp"
#include "mottle/core/files.hpp"

namespace mottle::formats {
namespace gmsh {
namespace {

constexpr int k_most_dimensions = 3;

/// Source: Gmsh's reference manual, "MSH file format".
constexpr GmshElementKind k_kinds[] = {
    {1, 1, 2, "2-node line"},        {2, 2, 3, "3-node triangle"},       {3, 2, 4, "4-node quadrangle"},
    {4, 3, 4, "4-node tetrahedron"}, {5, 3, 8, "8-node hexahedron"},     {6, 3, 6, "6-node prism"},
    {7, 3, 5, "5-node pyramid"},     {8, 1, 3, "3-node line"},           {9, 2, 6, "6-node triangle"},
    {10, 2, 9, "9-node quadrangle"}, {11, 3, 10, "10-node tetrahedron"}, {12, 3, 27, "27-node hexahedron"},
    {13, 3, 18, "18-node prism"},    {14, 3, 14, "14-node pyramid"},     {15, 0, 1, "1-node point"},
    {16, 2, 8, "8-node quadrangle"}, {17, 3, 20, "20-node hexahedron"},  {18, 3, 15, "15-node prism"},
    {19, 3, 13, "13-node pyramid"},
};

/// Groups of an entity of the geometry, by dimension and tag.
using Entity = std::pair<int, int>;

class MeshReader {
 public:
  MeshReader(std::string_view bytes, const std::string& file) : words_(bytes, file) {}

  GmshMesh read() {
    read_format();
    for (std::string_view section = words_.next(); !section.empty(); section = words_.next()) {
      if (!section.starts_with('$')) words_.fail(fmt::format("expected a section, like $Nodes"));
      read_section(section.substr(1));
    }
    if (!has_nodes_ || !has_elements_) words_.fail(fmt::format("there is no ${}", has_nodes_ ? "Elements" : "Nodes"));
    finish();
    return std::move(mesh_);
  }

 private:
  void read_format() {
    if (words_.next() != "$MeshFormat") words_.fail("this is no mesh of Gmsh: it does not begin with $MeshFormat");
    const std::string_view version = words_.need("the version");
    is_version_4_ = version == "4.1";
    if (!is_version_4_ && version != "2.2") {
      words_.fail(fmt::format("version {} of MSH is not read; save it as 4.1 or 2.2 (gmsh -save -format msh41)",
                              version.substr(0, 8)));
    }
    if (words_.whole("the kind of file", 0, 1) == 1) {
      words_.fail("the mesh is binary; save it as text (gmsh -save -format msh41, Mesh.Binary = 0)");
    }
    words_.skip(1, "the size of a number");
    words_.end_section("MeshFormat");
  }

  void read_section(std::string_view name) {
    if (name == "PartitionedEntities") words_.fail("the mesh is partitioned; save it as a whole");
    if (name == "PhysicalNames") return read_names();
    if (name == "Entities" && is_version_4_) return read_entities();
    if (name == "Nodes") return read_nodes();
    if (name == "Elements") return read_elements();
    words_.skip_section(name);
  }

  void read_names() {
    for (std::size_t left = words_.count("the number of physical names"); left > 0; --left) {
      const int dimension = words_.whole("a dimension", 0, k_most_dimensions);
      const int tag = words_.tag("a physical group");
      group(dimension, tag).name = words_.quoted("a name");
    }
    words_.end_section("PhysicalNames");
  }

  void read_entities() {
    std::array<std::size_t, k_most_dimensions + 1> counts = {};
    for (std::size_t& count : counts) count = words_.count("a number of entities");
    for (int dimension = 0; dimension <= k_most_dimensions; ++dimension) {
      for (std::size_t left = counts[static_cast<std::size_t>(dimension)]; left > 0; --left) {
        const int tag = words_.tag("an entity");
        words_.skip(dimension == 0 ? 3 : 6, "coordinates");
        std::vector<int>& groups = groups_of_[{dimension, tag}];
        for (std::size_t more = words_.count("a number of physical groups"); more > 0; --more) {
          groups.push_back(physical_tag());
        }
        if (dimension > 0) words_.skip(words_.count("a number of boundaries"), "a boundary");
      }
    }
    words_.end_section("Entities");
    has_entities_ = true;
  }

  /// An entity turned round in its group has a negative one.
  int physical_tag() {
    constexpr int k_most = 2'000'000'000;
    const int tag = std::abs(words_.whole("a physical group", -k_most, k_most));
    if (tag == 0) words_.fail("a physical group is 0");
    return tag;
  }

  void add_node(int tag) {
    GmshMesh::Node& node = mesh_.nodes.emplace_back();
    node.tag = tag;
  }

  void read_position(GmshMesh::Node& node) {
    for (double& coordinate : node.position) coordinate = words_.real("a coordinate");
  }

  void read_nodes() {
    if (has_nodes_) words_.fail("a second $Nodes");
    has_nodes_ = true;
    if (!is_version_4_) {
      for (std::size_t left = words_.count("the number of nodes"); left > 0; --left) {
        add_node(words_.tag("a node"));
        read_position(mesh_.nodes.back());
      }
    } else {
      std::size_t blocks = words_.count("the number of blocks");
      words_.skip(3, "numbers of nodes");
      for (; blocks > 0; --blocks) read_node_block();
    }
    words_.end_section("Nodes");
    std::ranges::sort(mesh_.nodes, {}, &GmshMesh::Node::tag);
    for (std::size_t k = 0; k < mesh_.nodes.size(); ++k) {
      if (!index_of_.emplace(mesh_.nodes[k].tag, k).second) {
        words_.fail(fmt::format("node {} stands twice", mesh_.nodes[k].tag));
      }
    }
  }

  void read_node_block() {
    const int dimension = words_.whole("a dimension", 0, k_most_dimensions);
    words_.skip(1, "an entity");
    const bool is_parametric = words_.whole("whether nodes are parametric", 0, 1) == 1;
    const std::size_t count = words_.count("a number of nodes");
    const std::size_t first = mesh_.nodes.size();
    for (std::size_t k = 0; k < count; ++k) add_node(words_.tag("a node"));
    for (std::size_t k = first; k < mesh_.nodes.size(); ++k) {
      read_position(mesh_.nodes[k]);
      if (is_parametric) words_.skip(static_cast<std::size_t>(dimension), "a parameter");
    }
  }

  void read_elements() {
    if (!has_nodes_ || has_elements_) words_.fail(has_nodes_ ? "a second $Elements" : "$Elements before $Nodes");
    if (is_version_4_ && !has_entities_)
      words_.fail("$Elements without $Entities: nothing says which group they are in");
    has_elements_ = true;
    if (is_version_4_) {
      std::size_t blocks = words_.count("the number of blocks");
      words_.skip(3, "numbers of elements");
      for (; blocks > 0; --blocks) read_element_block();
    } else {
      for (std::size_t left = words_.count("the number of elements"); left > 0; --left) read_old_element();
    }
    words_.end_section("Elements");
  }

  const GmshElementKind& read_kind() {
    const int type = words_.tag("a kind of element");
    const GmshElementKind* kind = gmsh_element_kind(type);
    if (kind == nullptr) words_.fail(fmt::format("elements of Gmsh's type {} are not known here", type));
    return *kind;
  }

  void read_element_block() {
    const int dimension = words_.whole("a dimension", 0, k_most_dimensions);
    const int entity = words_.tag("an entity");
    const GmshElementKind& kind = read_kind();
    if (kind.dimension != dimension)
      words_.fail(fmt::format("a {} on an entity of dimension {}", kind.name, dimension));
    const auto groups = groups_of_.find({dimension, entity});
    for (std::size_t left = words_.count("a number of elements"); left > 0; --left) {
      read_element(words_.tag("an element"), kind, groups == groups_of_.end() ? std::vector<int>{} : groups->second);
    }
  }

  void read_old_element() {
    const int tag = words_.tag("an element");
    const GmshElementKind& kind = read_kind();
    const std::size_t tags = words_.count("a number of tags");
    if (tags == 0) return words_.skip(static_cast<std::size_t>(kind.nodes), "a node");
    constexpr int k_most = 2'000'000'000;
    const int physical = std::abs(words_.whole("a physical group", -k_most, k_most));
    words_.skip(tags - 1, "a tag");
    read_element(tag, kind, physical == 0 ? std::vector<int>{} : std::vector<int>{physical});
  }

  void read_element(int tag, const GmshElementKind& kind, const std::vector<int>& groups) {
    if (groups.empty()) return words_.skip(static_cast<std::size_t>(kind.nodes), "a node");
    std::vector<std::size_t> nodes;
    for (int k = 0; k < kind.nodes; ++k) {
      const int node = words_.tag("a node");
      const auto found = index_of_.find(node);
      if (found == index_of_.end())
        words_.fail(fmt::format("element {} names node {}, which there is none", tag, node));
      nodes.push_back(found->second);
    }
    std::vector<std::size_t> sorted = nodes;
    std::ranges::sort(sorted);
    if (std::ranges::adjacent_find(sorted) != sorted.end())
      words_.fail(fmt::format("element {} has a node twice", tag));
    // MSH 2.2 repeats an element for each of its groups, with another tag.
    const auto [place, is_new] = known_.emplace(std::pair{kind.type, nodes}, mesh_.elements.size());
    if (is_new) {
      mesh_.elements.push_back({tag, &kind, mesh_.element_nodes.size()});
      mesh_.element_nodes.insert(mesh_.element_nodes.end(), nodes.begin(), nodes.end());
    }
    for (const int physical : groups) group(kind.dimension, physical).elements.push_back(place->second);
  }

  GmshMesh::Group& group(int dimension, int tag) {
    GmshMesh::Group& found = groups_[{dimension, tag}];
    found.dimension = dimension;
    found.tag = tag;
    return found;
  }

  /// Elements by tag, groups by dimension and tag.
  void finish() {
    std::vector<std::size_t> order(mesh_.elements.size());
    std::iota(order.begin(), order.end(), std::size_t{0});
    std::ranges::stable_sort(order, {}, [&](std::size_t k) { return mesh_.elements[k].tag; });
    std::vector<std::size_t> place(order.size());
    std::vector<GmshMesh::Element> sorted;
    for (std::size_t k = 0; k < order.size(); ++k) {
      place[order[k]] = k;
      sorted.push_back(mesh_.elements[order[k]]);
      if (k > 0 && sorted[k - 1].tag == sorted[k].tag)
        words_.fail(fmt::format("element {} stands twice", sorted[k].tag));
    }
    mesh_.elements = std::move(sorted);
    for (auto& [key, group] : groups_) {
      for (std::size_t& element : group.elements) element = place[element];
      std::ranges::sort(group.elements);
      group.elements.erase(std::unique(group.elements.begin(), group.elements.end()), group.elements.end());
      if (!group.elements.empty()) mesh_.groups.push_back(std::move(group));
    }
    if (mesh_.groups.empty()) {
      words_.fail(
          "no element is in a physical group; give the parts of the geometry physical groups and mesh it again");
    }
  }

  Words words_;
  GmshMesh mesh_;
  bool is_version_4_ = false, has_entities_ = false, has_nodes_ = false, has_elements_ = false;
  std::unordered_map<int, std::size_t> index_of_;  // of a node's tag
  std::map<Entity, std::vector<int>> groups_of_;
  std::map<std::pair<int, int>, GmshMesh::Group> groups_;
  std::map<std::pair<int, std::vector<std::size_t>>, std::size_t> known_;  // elements by kind and nodes
};

}  // namespace
}  // namespace gmsh

const GmshElementKind* gmsh_element_kind(int type) {
  const auto found = std::ranges::find(gmsh::k_kinds, type, &GmshElementKind::type);
  return found == std::end(gmsh::k_kinds) ? nullptr : &*found;
}

GmshMesh parse_gmsh_mesh(std::string_view bytes, const std::string& file) {
  return gmsh::MeshReader(bytes, file).read();
}

GmshMesh read_gmsh_mesh(const std::filesystem::path& file) {
  return parse_gmsh_mesh(read_file(file), file.string());
}

}  // namespace mottle::formats
