#include "study/models/mesh/mesh_groups.hpp"

#include <fmt/format.h>

#include "mottle/core/text.hpp"
#include "study/input/key_error.hpp"

namespace mottle::study {

std::string name_of(const GmshMesh::Group& group) {
  return group.name.empty() ? fmt::format("{}:{}", group.dimension, group.tag) : group.name;
}

const GmshMesh::Group& MeshGroups::find(const std::string& name, const std::string& key) {
  const GmshMesh::Group* found = nullptr;
  std::vector<std::string> known;
  for (const GmshMesh::Group& each : mesh_.groups) {
    known.push_back(name_of(each));
    if (known.back() != name && fmt::format("{}:{}", each.dimension, each.tag) != name) continue;
    require_key(found == nullptr, key, "'{}' is the name of two groups; write \"{}:{}\" or \"{}:{}\" (dimension:tag)",
                name, found == nullptr ? 0 : found->dimension, found == nullptr ? 0 : found->tag, each.dimension,
                each.tag);
    found = &each;
  }
  require_key(found != nullptr, key, "{}", unknown_name_message("physical group", name, known));
  taken_.insert(found);
  return *found;
}

std::vector<std::size_t> MeshGroups::nodes_of(const GmshMesh::Group& group) const {
  std::set<std::size_t> nodes;
  for (const std::size_t element : group.elements) {
    const auto own = mesh_.nodes_of(mesh_.elements[element]);
    nodes.insert(own.begin(), own.end());
  }
  return {nodes.begin(), nodes.end()};
}

std::vector<std::string> MeshGroups::not_taken() const {
  std::vector<std::string> names;
  for (const GmshMesh::Group& each : mesh_.groups) {
    if (!taken_.contains(&each)) names.push_back(name_of(each));
  }
  return names;
}

}  // namespace mottle::study
