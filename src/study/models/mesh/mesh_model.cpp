#include "study/models/mesh/mesh_model.hpp"

#include <algorithm>
#include <array>
#include <set>

#include "mottle/core/text.hpp"
#include "study/input/key_error.hpp"
#include "study/models/mesh/element_rules.hpp"
#include "study/models/mesh/mesh_groups.hpp"

namespace mottle::study {
namespace {

using Group = GmshMesh::Group;

class Builder {
 public:
  Builder(const MeshSpec& spec, const GmshMesh& mesh)
      : spec_(spec),
        mesh_(mesh),
        groups_of_mesh_(mesh),
        is_used_(mesh.nodes.size(), false),
        section_of_(mesh.elements.size(), -1),
        index_(mesh.nodes.size(), -1) {}

  MeshModel build() {
    model().settings.coupled_mass = !spec_.is_mass_lumped;
    add_materials();
    find_groups();
    add_nodes();
    for (std::size_t k = 0; k < spec_.sections.size(); ++k) add_section(k);
    add_supports();
    add_masses();
    add_springs();
    note_the_rest();
    return std::move(result_);
  }

 private:
  FiniteElementModel& model() { return result_.model; }

  FieldIndex field(const char* card, int id, std::string name, double value, std::string own_name) {
    model().fields.push_back({card, id, std::move(name), value});
    result_.names.push_back(std::move(own_name));
    return static_cast<FieldIndex>(model().fields.size()) - 1;
  }

  void add_materials() {
    for (const MeshMaterial& given : spec_.materials) {
      Material material{.id = static_cast<int>(model().materials.size()) + 1};
      const std::string name = "material:" + given.name;
      material.young = field("MAT1", material.id, "E", given.young, name + ":young");
      material.poisson = field("MAT1", material.id, "NU", given.poisson, name + ":poisson");
      material.density = field("MAT1", material.id, "RHO", given.density, name + ":density");
      model().materials.push_back(std::move(material));
    }
    std::set<std::string> used;
    for (const MeshSection& section : spec_.sections) used.insert(section.material);
    for (std::size_t k = 0; k < spec_.materials.size(); ++k) {
      require_key(used.contains(spec_.materials[k].name), fmt::format("model.materials[{}].name", k),
                  "no section is made of '{}'", spec_.materials[k].name);
    }
  }

  /// The points of a group of dimension 0, which exist from now on.
  std::vector<std::size_t> points_of(const std::string& name, const std::string& key) {
    const Group& points = groups_of_mesh_.find(name, key);
    require_key(points.dimension == 0, key, "'{}' is a group of {}; masses and springs stand at physical points", name,
                k_dimension_names[points.dimension]);
    std::vector<std::size_t> nodes = groups_of_mesh_.nodes_of(points);
    for (const std::size_t node : nodes) {
      require_key(is_used_[node], key, "point {} of '{}' is on no element of a section", mesh_.nodes[node].tag, name);
    }
    return nodes;
  }

  void find_groups() {
    for (std::size_t k = 0; k < spec_.sections.size(); ++k) {
      const std::string key = fmt::format("model.sections[{}].group", k);
      const Group& found = groups_of_mesh_.find(spec_.sections[k].group, key);
      require_key(found.dimension > 0, key, "'{}' is a group of points, which have no section", name_of(found));
      groups_.push_back(&found);
      for (const std::size_t element : found.elements) {
        int& section = section_of_[element];
        require_key(section < 0, key, "element {} of '{}' is in '{}' too, which has a section of its own",
                    mesh_.elements[element].tag, name_of(found),
                    section < 0 ? "" : spec_.sections[static_cast<std::size_t>(section)].group);
        section = static_cast<int>(k);
        element_rule(mesh_.elements[element], key);
        for (const std::size_t node : mesh_.nodes_of(mesh_.elements[element])) is_used_[node] = true;
      }
    }
  }

  void add_nodes() {
    for (std::size_t k = 0; k < mesh_.nodes.size(); ++k) {
      if (!is_used_[k]) continue;
      index_[k] = static_cast<int>(model().nodes.size());
      model().nodes.push_back({.id = mesh_.nodes[k].tag, .position = spec_.length_factor * mesh_.nodes[k].position});
      next_id_ = std::max(next_id_, mesh_.nodes[k].tag);
    }
    for (const GmshMesh::Element& element : mesh_.elements) next_id_ = std::max(next_id_, element.tag);
  }

  /// The fields of a section by the names that they have on cards. Refuses keys of another dimension, and missing ones.
  std::map<std::string, FieldIndex> section_fields(std::size_t k, int dimension, const char* card) {
    const MeshSection& section = spec_.sections[k];
    const std::string of = fmt::format("model.sections[{}]", k);
    const bool has_shape = !section.shape.empty();
    std::set<std::string> known;
    std::map<std::string, FieldIndex> fields;
    for (const SectionNumber& number : k_section_numbers) {
      const bool is_from_shape = has_shape && number.dimension == 1 && number.is_needed;
      if (number.dimension != dimension || is_from_shape) continue;
      known.insert(number.key);
      const auto given = section.numbers.find(number.key);
      require_key(given != section.numbers.end() || !number.is_needed, fmt::format("{}.{}", of, number.key),
                  "is missing; '{}' is a group of {}{}", section.group, k_dimension_names[dimension],
                  dimension == 1 ? ", which need area, inertia_1, inertia_2 and torsion, or shape and dimensions" : "");
      if (given == section.numbers.end()) continue;
      fields[number.field] = field(card, static_cast<int>(k) + 1, number.field, given->second,
                                   fmt::format("section:{}:{}", section.group, number.key));
    }
    for (const auto& [key, value] : section.numbers) {
      require_key(known.contains(key), fmt::format("{}.{}", of, key), "'{}' is a group of {}, which have no {}{}",
                  section.group, k_dimension_names[dimension], key, has_shape ? " beside a shape" : " here");
    }
    require_key(dimension == 1 || !has_shape, of + ".shape", "'{}' is a group of {}; lines alone have a shape",
                section.group, k_dimension_names[dimension]);
    require_key((dimension == 1) == section.orientation.has_value(), of + ".orientation",
                "'{}' is a group of {}; lines need an orientation, others have none", section.group,
                k_dimension_names[dimension]);
    return fields;
  }

  int material_of(std::size_t k) const {
    std::vector<std::string> known;
    for (const MeshMaterial& material : spec_.materials) known.push_back(material.name);
    const auto found = std::ranges::find(known, spec_.sections[k].material);
    require_key(found != known.end(), fmt::format("model.sections[{}].material", k), "{}",
                unknown_name_message("material", spec_.sections[k].material, known));
    return static_cast<int>(found - known.begin());
  }

  void add_section(std::size_t k) {
    const Group& group = *groups_[k];
    const int material = material_of(k);
    if (group.dimension == 3) return add_solids(k, material);
    if (group.dimension == 2) return add_shells(k, material);
    add_beams(k, material);
  }

  /// Calls add(element, its rule) for the elements of a section.
  template <typename Add>
  void each_element(std::size_t k, const Add& add) {
    for (const std::size_t element : groups_[k]->elements) {
      const GmshMesh::Element& each = mesh_.elements[element];
      add(each, element_rule(each, ""));
    }
  }

  template <typename Nodes>
  void copy_nodes(const GmshMesh::Element& element, const ElementRule& rule, Nodes& nodes) const {
    const auto own = mesh_.nodes_of(element);
    for (std::size_t n = 0; n < rule.order.size(); ++n) nodes[n] = index_[own[static_cast<std::size_t>(rule.order[n])]];
  }

  void add_solids(std::size_t k, int material) {
    section_fields(k, 3, "PSOLID");
    each_element(k, [&](const GmshMesh::Element& each, const ElementRule& rule) {
      SolidElement solid{
          .id = each.tag, .property_id = static_cast<int>(k) + 1, .shape = rule.shape, .material = material};
      copy_nodes(each, rule, solid.nodes);
      model().elements<SolidElement>().push_back(solid);
    });
  }

  void add_shells(std::size_t k, int material) {
    const auto fields = section_fields(k, 2, "PSHELL");
    ShellProperty property{.id = static_cast<int>(k) + 1,
                           .membrane_material = material,
                           .bending_material = material,
                           .shear_material = material,
                           .thickness = fields.at("T")};
    if (fields.contains("NSM")) property.nonstructural_mass = fields.at("NSM");
    const int index = static_cast<int>(model().shell_properties.size());
    model().shell_properties.push_back(property);
    each_element(k, [&](const GmshMesh::Element& each, const ElementRule& rule) {
      ShellElement shell{.id = each.tag, .node_count = each.kind->nodes, .property = index};
      copy_nodes(each, rule, shell.nodes);
      if (shell.node_count != 3) hold_ratios(model(), shell);
      model().elements<ShellElement>().push_back(shell);
    });
  }

  void add_beams(std::size_t k, int material) {
    const MeshSection& section = spec_.sections[k];
    const char* card = section.shape.empty() ? "PBEAM" : "PBEAML";
    const auto fields = section_fields(k, 1, card);
    const auto field_of = [&](const char* name) { return fields.contains(name) ? fields.at(name) : k_no_field; };
    BeamProperty property;
    property.card = card;
    property.id = static_cast<int>(k) + 1;
    property.material = material;
    property.area = field_of("A");
    property.inertia_1 = field_of("I1");
    property.inertia_2 = field_of("I2");
    property.torsion = field_of("J");
    property.nonstructural_mass = field_of("NSM");
    property.section = section.shape;
    for (std::size_t d = 0; d < section.dimensions.size(); ++d) {
      property.dimensions.push_back(field(card, property.id, fmt::format("DIM{}", d + 1), section.dimensions[d],
                                          fmt::format("section:{}:dimension_{}", section.group, d + 1)));
    }
    const int index = static_cast<int>(model().beam_properties.size());
    model().beam_properties.push_back(std::move(property));
    each_element(k, [&](const GmshMesh::Element& each, const ElementRule& rule) {
      BeamElement beam{.card = "CBEAM", .id = each.tag, .property = index, .orientation = *section.orientation};
      copy_nodes(each, rule, beam.nodes);
      model().elements<BeamElement>().push_back(std::move(beam));
    });
  }

  void add_supports() {
    for (std::size_t k = 0; k < spec_.supports.size(); ++k) {
      const MeshSupport& support = spec_.supports[k];
      const std::string key = fmt::format("model.supports[{}].group", k);
      bool holds_anything = false;
      for (const std::size_t node : groups_of_mesh_.nodes_of(groups_of_mesh_.find(support.group, key))) {
        if (!is_used_[node]) continue;
        holds_anything = true;
        model().fixed.emplace_back(index_[node], support.components);
      }
      require_key(holds_anything, key, "no node of '{}' is on an element of a section", support.group);
    }
  }

  void add_masses() {
    for (std::size_t k = 0; k < spec_.masses.size(); ++k) {
      const MeshMass& mass = spec_.masses[k];
      const std::vector<std::size_t> points = points_of(mass.group, fmt::format("model.masses[{}].group", k));
      const FieldIndex value = field("CONM2", static_cast<int>(k) + 1, "M", mass.mass, "mass:" + mass.group);
      for (const std::size_t node : points) {
        model().elements<PointMassElement>().push_back(
            {.card = "CONM2", .id = ++next_id_, .node = index_[node], .mass = value});
      }
    }
  }

  void add_springs() {
    for (std::size_t k = 0; k < spec_.springs.size(); ++k) {
      const MeshSpring& spring = spec_.springs[k];
      const std::string key = fmt::format("model.springs[{}].groups", k);
      const FieldIndex value = field("CELAS2", static_cast<int>(k) + 1, "K", spring.stiffness, "spring:" + spring.name);
      std::vector<std::vector<std::size_t>> ends;
      for (const std::string& name : spring.groups) {
        ends.push_back(points_of(name, key));
        require_key(spring.groups.size() == 1 || ends.back().size() == 1, key,
                    "'{}' has {} points; a spring between two groups needs one point in each", name,
                    ends.back().size());
      }
      for (const std::size_t node : ends.front()) {
        const int other = ends.size() == 2 ? index_[ends[1].front()] : -1;
        require_key(other != index_[node], key, "both ends of '{}' are one point", spring.name);
        model().elements<ScalarElement>().push_back({ScalarElement::Kind::spring,
                                                     ++next_id_,
                                                     {index_[node], other},
                                                     {spring.component, spring.component},
                                                     value});
      }
    }
  }

  void note_the_rest() {
    const std::vector<std::string> names = groups_of_mesh_.not_taken();
    if (!names.empty()) {
      result_.notes.push_back(fmt::format("physical groups that the study does not name: {}", join(names)));
    }
  }

  const MeshSpec& spec_;
  const GmshMesh& mesh_;
  MeshGroups groups_of_mesh_;
  MeshModel result_;
  std::vector<bool> is_used_;         // by node of the mesh: on an element of a section
  std::vector<int> section_of_;       // by element of the mesh; -1: none
  std::vector<int> index_;            // of the model's node, by node of the mesh
  std::vector<const Group*> groups_;  // by section
  int next_id_ = 0;
};

}  // namespace

MeshModel make_mesh_model(const MeshSpec& spec, const GmshMesh& mesh) {
  return Builder(spec, mesh).build();
}

}  // namespace mottle::study
