// What a study says about a mesh: materials, sections, supports, masses and springs of its physical groups.
#pragma once

#include <Eigen/Core>
#include <filesystem>
#include <map>
#include <optional>
#include <string>
#include <vector>

#include "mottle/fem/card_field.hpp"
#include "mottle/layers.hpp"
#include "study/input/toml_reader.hpp"

namespace mottle::study {

struct MeshMaterial {
  std::string name;
  double young = 0.0, poisson = 0.0, density = 0.0;
};

/// What the elements of a group are made of. Which numbers there are depends on the group's dimension.
struct MeshSection {
  std::string group, material;
  std::map<std::string, double> numbers = {};                 ///< "thickness", "area", ... as the study names them
  std::string shape = {};                                     ///< of a line's cross-section, "TUBE"
  std::vector<double> dimensions = {};                        ///< of that shape
  std::optional<Eigen::Vector3d> orientation = std::nullopt;  ///< of lines: plane 1 is spanned by the axis and this
};

struct MeshSupport {
  std::string group;
  Components components = k_all_components;
};

/// At each point of a group.
struct MeshMass {
  std::string group;
  double mass = 0.0;
};

/// From each point of a group to ground, or from the one point of a group to that of another.
struct MeshSpring {
  std::string name;
  std::vector<std::string> groups;
  int component = 0;
  double stiffness = 0.0;
};

struct MeshSpec {
  std::filesystem::path file;
  double length_factor = 1.0;  ///< coordinates of the mesh times this are lengths of the study
  bool is_mass_lumped = false;
  std::vector<MeshMaterial> materials;
  std::vector<MeshSection> sections;
  std::vector<MeshSupport> supports;
  std::vector<MeshMass> masses;
  std::vector<MeshSpring> springs;
};

/// Reads the keys of kind "mesh"; `folder` is the study's. Throws InvalidInput with file, line and key.
MeshSpec read_mesh_spec(TomlReader& reader, const std::filesystem::path& folder);

}  // namespace mottle::study
