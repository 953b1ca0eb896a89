// The physical groups of a mesh by the names that a study has for them.
#pragma once

#include <set>
#include <string>
#include <vector>

#include "mottle/formats/gmsh/mesh.hpp"
#include "mottle/layers.hpp"

namespace mottle::study {

/// The name of a group, "dimension:tag" where it has none.
std::string name_of(const GmshMesh::Group& group);

class MeshGroups {
 public:
  explicit MeshGroups(const GmshMesh& mesh) : mesh_(mesh) {}

  /// The group of a name or of "dimension:tag". Throws KeyError(key) where there is none, or two of that name.
  const GmshMesh::Group& find(const std::string& name, const std::string& key);

  /// Indices of a group's nodes, ascending.
  std::vector<std::size_t> nodes_of(const GmshMesh::Group& group) const;

  /// Names of the groups that find() never gave.
  std::vector<std::string> not_taken() const;

 private:
  const GmshMesh& mesh_;
  std::set<const GmshMesh::Group*> taken_;
};

}  // namespace mottle::study
