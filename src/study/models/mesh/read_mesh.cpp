#include <algorithm>
#include <array>
#include <set>

#include "mottle/core/text.hpp"
#include "mottle/fem/elements/beam_section.hpp"
#include "study/models/mesh/mesh_spec.hpp"

namespace mottle::study {
namespace {

const OptionRange k_positive{.lower = 0.0, .excludes_lower = true};
const OptionRange k_not_negative{.lower = 0.0};
constexpr std::array<const char*, 6> k_directions = {"X", "Y", "Z", "RX", "RY", "RZ"};

/// Numbers of sections, and whether they may be zero.
struct SectionKey {
  const char* name;
  bool may_vanish;
};
constexpr SectionKey k_section_keys[] = {{"thickness", false}, {"area", false},   {"inertia_1", false},
                                         {"inertia_2", false}, {"torsion", true}, {"nonstructural_mass", true}};

int direction_of(const TomlReader& reader, const std::string& key, const std::string& name) {
  const auto found = std::ranges::find(k_directions, capitals(name));
  if (found == k_directions.end()) {
    reader.fail(key, fmt::format("'{}' is no direction; there are X, Y, Z and the rotations RX, RY, RZ", name));
  }
  return static_cast<int>(found - k_directions.begin());
}

void require_new(TomlReader& reader, const std::string& key, const std::string& name, std::set<std::string>& seen) {
  if (!seen.insert(name).second) reader.fail(key, fmt::format("'{}' is given twice", name));
}

std::vector<MeshMaterial> read_materials(TomlReader& model) {
  std::vector<MeshMaterial> materials;
  std::set<std::string> seen;
  for (TomlReader& reader : model.tables("materials")) {
    MeshMaterial material{.name = reader.name("name")};
    require_new(reader, "name", material.name, seen);
    material.young = reader.number("young", k_positive);
    material.poisson = reader.number("poisson", {.lower = -1.0, .upper = 0.5, .excludes_lower = true});
    if (material.poisson == 0.5) reader.fail_value("poisson", "less than 0.5");
    material.density = reader.number("density", k_not_negative);
    reader.finish();
    materials.push_back(material);
  }
  if (materials.empty()) {
    model.fail("materials",
               "is missing or empty; give for example materials = [ { name = \"steel\", young = 2.1e11, poisson = 0.3, "
               "density = 7850 } ]");
  }
  return materials;
}

MeshSection read_section(TomlReader& reader) {
  MeshSection section{.group = reader.name("group"), .material = reader.name("material")};
  for (const auto& [key, may_vanish] : k_section_keys) {
    if (reader.has(key)) section.numbers[key] = reader.number(key, may_vanish ? k_not_negative : k_positive);
  }
  if (reader.has("shape")) {
    section.shape = capitals(reader.text("shape"));
    const int count = beam_section_dimensions(section.shape);
    if (count == 0) reader.fail("shape", unknown_name_message("section", section.shape, beam_section_names()));
    section.dimensions = reader.numbers("dimensions");
    if (std::ssize(section.dimensions) != count) {
      reader.fail("dimensions", fmt::format("{} numbers, {} has {}", section.dimensions.size(), section.shape, count));
    }
    try {
      beam_section(section.shape, section.dimensions);
    } catch (const InvalidInput& error) {
      reader.fail("dimensions", error.what());
    }
  }
  if (reader.has("orientation")) {
    const std::vector<double> vector = reader.numbers("orientation");
    if (vector.size() != 3) reader.fail_value("orientation", "three numbers, like [0, 0, 1]");
    section.orientation = Eigen::Vector3d(vector[0], vector[1], vector[2]);
  }
  reader.finish();
  return section;
}

std::vector<MeshSection> read_sections(TomlReader& model) {
  std::vector<MeshSection> sections;
  std::set<std::string> seen;
  for (TomlReader& reader : model.tables("sections")) {
    sections.push_back(read_section(reader));
    require_new(reader, "group", sections.back().group, seen);
  }
  if (sections.empty()) {
    model.fail(
        "sections",
        "is missing or empty; give for example sections = [ { group = \"plate\", material = \"steel\", thickness = "
        "0.002 } ]");
  }
  return sections;
}

std::vector<MeshSupport> read_supports(TomlReader& model) {
  std::vector<MeshSupport> supports;
  for (TomlReader& reader : model.tables("supports")) {
    MeshSupport support{.group = reader.name("group")};
    if (reader.has("directions")) {
      support.components = 0;
      for (const std::string& name : reader.texts("directions")) {
        support.components |= static_cast<Components>(1 << direction_of(reader, "directions", name));
      }
    }
    reader.finish();
    supports.push_back(support);
  }
  return supports;
}

std::vector<MeshMass> read_masses(TomlReader& model) {
  std::vector<MeshMass> masses;
  std::set<std::string> seen;
  for (TomlReader& reader : model.tables("masses")) {
    masses.push_back({reader.name("group"), reader.number("mass", k_not_negative)});
    require_new(reader, "group", masses.back().group, seen);
    reader.finish();
  }
  return masses;
}

std::vector<MeshSpring> read_springs(TomlReader& model) {
  std::vector<MeshSpring> springs;
  std::set<std::string> seen;
  for (TomlReader& reader : model.tables("springs")) {
    MeshSpring spring{.name = reader.name("name"), .groups = reader.texts("groups")};
    require_new(reader, "name", spring.name, seen);
    if (spring.groups.empty() || spring.groups.size() > 2) {
      reader.fail_value("groups", "one group (springs to ground) or two, like [\"mount\"] or [\"a\", \"b\"]");
    }
    spring.component = direction_of(reader, "direction", reader.text("direction"));
    spring.stiffness = reader.number("stiffness", k_not_negative);
    reader.finish();
    springs.push_back(spring);
  }
  return springs;
}

}  // namespace

MeshSpec read_mesh_spec(TomlReader& reader, const std::filesystem::path& folder) {
  MeshSpec spec;
  spec.file = folder / reader.text("file");
  spec.length_factor = reader.number_or("length_factor", 1.0, k_positive);
  spec.is_mass_lumped = reader.choice("mass", {"consistent", "lumped"}, 0) == 1;
  spec.materials = read_materials(reader);
  spec.sections = read_sections(reader);
  spec.supports = read_supports(reader);
  spec.masses = read_masses(reader);
  spec.springs = read_springs(reader);
  return spec;
}

}  // namespace mottle::study
