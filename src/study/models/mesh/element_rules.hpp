// Which of Gmsh's elements are made, and the numbers of their sections: tables.
#pragma once

#include <string>
#include <vector>

#include "mottle/fem/elements/solid.hpp"
#include "mottle/formats/gmsh/mesh.hpp"
#include "mottle/layers.hpp"

namespace mottle::study {

/// Gmsh's elements that are made, with their nodes in the order of the element here. One line a kind.
struct ElementRule {
  int type;  ///< Gmsh's number
  std::vector<int> order;
  SolidShape shape = SolidShape::hexahedron8;  ///< of solids
};

/// Keys of sections: of which dimension, whether they must be there, and what they are on Nastran's cards, whose names
/// the fields have.
struct SectionNumber {
  const char* key;
  int dimension;
  bool is_needed;
  const char* field;
};
inline constexpr SectionNumber k_section_numbers[] = {{"thickness", 2, true, "T"},
                                                      {"nonstructural_mass", 2, false, "NSM"},
                                                      {"area", 1, true, "A"},
                                                      {"inertia_1", 1, true, "I1"},
                                                      {"inertia_2", 1, true, "I2"},
                                                      {"torsion", 1, true, "J"},
                                                      {"nonstructural_mass", 1, false, "NSM"}};

inline constexpr const char* k_dimension_names[] = {"points", "lines", "surfaces", "volumes"};

/// The rule of an element. Throws KeyError(key) where its kind is not made.
const ElementRule& element_rule(const GmshMesh::Element& element, const std::string& key);

}  // namespace mottle::study
