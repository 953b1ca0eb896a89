// A mesh with what a study says about it, as a finite-element model.
#pragma once

#include <string>
#include <vector>

#include "mottle/fem/finite_element_model.hpp"
#include "mottle/formats/gmsh/mesh.hpp"
#include "mottle/layers.hpp"
#include "study/models/mesh/mesh_spec.hpp"

namespace mottle::study {

struct MeshModel {
  FiniteElementModel model;
  /// Names of the model's fields in the study: "material:steel:young", "section:plate:thickness", "mass:tip",
  /// "spring:mount" [field].
  std::vector<std::string> names;
  std::vector<std::string> notes;
};

/// Nodes and elements keep Gmsh's tags as their ids. Nodes that nothing is made of are left out.
///
/// @throws KeyError  a group that the mesh does not have, or of a dimension that does not fit; numbers that a section
/// of
///                   that dimension lacks or does not have; elements of a kind that is not known, or in two sections; a
///                   material that no section uses
MeshModel make_mesh_model(const MeshSpec& spec, const GmshMesh& mesh);

}  // namespace mottle::study
