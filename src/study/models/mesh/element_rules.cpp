#include "study/models/mesh/element_rules.hpp"

#include <algorithm>

#include "mottle/core/text.hpp"
#include "study/input/key_error.hpp"

namespace mottle::study {
namespace {

const std::vector<ElementRule>& element_rules() {
  static const std::vector<ElementRule> k_rules = {
      {1, {0, 1}},
      {2, {0, 1, 2}},
      {3, {0, 1, 2, 3}},
      {4, {0, 1, 2, 3}, SolidShape::tetrahedron4},
      {5, {0, 1, 2, 3, 4, 5, 6, 7}, SolidShape::hexahedron8},
      {6, {0, 1, 2, 3, 4, 5}, SolidShape::wedge6},
      {7, {0, 1, 2, 3, 4}, SolidShape::pyramid5},
      {9, {0, 1, 2, 3, 4, 5}},
      {11, {0, 1, 2, 3, 4, 5, 6, 7, 9, 8}, SolidShape::tetrahedron10},  // Gmsh has edge 34 before 24
      {16, {0, 1, 2, 3, 4, 5, 6, 7}},
      // Gmsh has the midside nodes of these by the lower of their corners, then by the other.
      {17, {0, 1, 2, 3, 4, 5, 6, 7, 8, 11, 13, 9, 10, 12, 14, 15, 16, 18, 19, 17}, SolidShape::hexahedron20},
      {18, {0, 1, 2, 3, 4, 5, 6, 9, 7, 8, 10, 11, 12, 14, 13}, SolidShape::wedge15},
      {19, {0, 1, 2, 3, 4, 5, 8, 10, 6, 7, 9, 11, 12}, SolidShape::pyramid13},
  };
  return k_rules;
}

}  // namespace

const ElementRule& element_rule(const GmshMesh::Element& element, const std::string& key) {
  const auto found = std::ranges::find(element_rules(), element.kind->type, &ElementRule::type);
  if (found != element_rules().end()) return *found;
  std::vector<std::string> known;
  for (const ElementRule& rule : element_rules()) known.emplace_back(gmsh_element_kind(rule.type)->name);
  throw KeyError(key,
                 fmt::format("element {} is a {}; elements are made of {}. Mesh it anew (Mesh.SecondOrderIncomplete = "
                             "1, or Mesh.ElementOrder = 1)",
                             element.tag, element.kind->name, join(known)));
}

}  // namespace mottle::study
