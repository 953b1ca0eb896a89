// [model] of kind "mesh": a mesh of Gmsh whose physical groups the study gives materials, sections and supports.
#include <algorithm>
#include <map>

#include "mottle/core/subject.hpp"
#include "mottle/core/text.hpp"
#include "mottle/formats/nastran/model.hpp"
#include "mottle/model/structures/finite_element_structure.hpp"
#include "mottle/model/units.hpp"
#include "study/input/key_error.hpp"
#include "study/models/mesh/mesh_model.hpp"
#include "study/models/model_parts.hpp"
#include "study/models/nastran/field_units.hpp"
#include "study/models/registry.hpp"

namespace mottle::study {
namespace {

std::string card_name(const CardField& field) {
  return fmt::format("{}:{}:{}", field.card, field.id, field.name);
}

/// The parameters with the names of fields in place of those of the study.
std::vector<ParameterTargets> translated(const std::vector<ParameterTargets>& parameters, const MeshModel& mesh) {
  std::vector<ParameterTargets> result = parameters;
  std::map<std::string, std::string> owners;
  for (ParameterTargets& parameter : result) {
    const Subject subject = subject_parameter(parameter.parameter);
    for (std::string& target : parameter.targets) {
      const auto found = std::ranges::find(mesh.names, target);
      if (found == mesh.names.end()) {
        throw SubjectError(subject, "it acts on nothing: " + unknown_name_message("target", target, mesh.names));
      }
      const auto [owner, is_new] = owners.emplace(target, parameter.parameter);
      require_of(is_new, subject, "target '{}' is already tied to parameter '{}'", target, owner->second);
      const CardField& field = mesh.model.fields[static_cast<std::size_t>(found - mesh.names.begin())];
      require_of(!parameter.is_factor || field.value != 0.0, subject,
                 "a factor on '{}', whose nominal value is 0, acts on nothing", target);
      target = card_name(field);
    }
  }
  return result;
}

class MeshSource final : public ModelSource {
 public:
  MeshSource(MeshSpec spec, std::string file, std::optional<double> reduction_error)
      : spec_(std::move(spec)), file_(std::move(file)), reduction_error_(reduction_error) {}

  ModelParts make(const std::vector<ParameterTargets>& parameters, const JointDistribution& prior,
                  const RunSettings& /*settings*/) const override {
    MeshModel mesh = read();
    ModelParts parts;
    parts.files = {spec_.file.string()};
    parts.notes = std::move(mesh.notes);
    const std::vector<ParameterTargets> targets = translated(parameters, mesh);
    auto structure = std::make_unique<FiniteElementStructure>(std::move(mesh.model), targets, prior.mean());
    parts.reference = structure->reference();
    parts.limits = structure->limits();
    parts.sparse = std::move(structure);
    return parts;
  }

  std::optional<double> reduction_error() const override { return reduction_error_; }
  std::vector<NamedFile> files() const override { return {{"model.file", "file", file_, spec_.file}}; }

  std::string target_unit(const std::string& target, const UnitNames& units) const override {
    const std::string name = target.substr(target.rfind(':') + 1);
    if (target.starts_with("mass:")) return units.mass;
    if (target.starts_with("spring:")) return unit_of_spring(target.substr(target.find(':') + 1), units);
    static const std::map<std::string, std::pair<const char*, const char*>> k_fields = {
        {"young", {"MAT1", "E"}},       {"poisson", {"MAT1", "NU"}}, {"density", {"MAT1", "RHO"}},
        {"thickness", {"PSHELL", "T"}}, {"area", {"PBEAM", "A"}},    {"inertia_1", {"PBEAM", "I1"}},
        {"inertia_2", {"PBEAM", "I2"}}, {"torsion", {"PBEAM", "J"}}};
    if (name == "nonstructural_mass") return field_unit(is_thick(target) ? "PSHELL" : "PBEAM", "NSM", units);
    const auto found = k_fields.find(name);
    if (found != k_fields.end()) return field_unit(found->second.first, found->second.second, units);
    return name.starts_with("dimension_") ? units.length : "";
  }

  bool shows_numbers() const override { return true; }
  std::vector<ModelNumber> numbers() const override {
    const MeshModel mesh = read();
    std::vector<ModelNumber> numbers;
    for (std::size_t k = 0; k < mesh.names.size(); ++k) {
      const CardField& field = mesh.model.fields[k];
      const bool is_usual = is_design_number(field) && field.value != 0.0;
      numbers.push_back({mesh.names[k], fmt::format("{}:{}", field.card, field.name), field.value, is_usual, is_usual});
    }
    return numbers;
  }
  std::unique_ptr<ModelSource> with_number(const std::string& target, double value) const override {
    auto other = std::make_unique<MeshSource>(*this);
    other->overrides_[target] = value;
    return other;
  }

 private:
  MeshModel read() const {
    MeshModel mesh = make_mesh_model(spec_, read_gmsh_mesh(spec_.file));
    for (const auto& [target, value] : overrides_) {
      const auto found = std::ranges::find(mesh.names, target);
      require_key(found != mesh.names.end(), "predict.model", "{}", unknown_name_message("target", target, mesh.names));
      mesh.model.fields[static_cast<std::size_t>(found - mesh.names.begin())].value = value;
    }
    return mesh;
  }

  /// Of a section that has a thickness.
  bool is_thick(const std::string& target) const {
    return std::ranges::any_of(spec_.sections, [&](const MeshSection& section) {
      return target == fmt::format("section:{}:nonstructural_mass", section.group) &&
             section.numbers.contains("thickness");
    });
  }

  std::string unit_of_spring(const std::string& name, const UnitNames& units) const {
    for (const MeshSpring& spring : spec_.springs) {
      if (spring.name == name) return field_unit("CELAS2", fmt::format("K{}", spring.component + 1), units);
    }
    return "";
  }

  MeshSpec spec_;
  std::string file_;
  std::map<std::string, double> overrides_;  // numbers that are other than the study says
  std::optional<double> reduction_error_;
};

}  // namespace

std::shared_ptr<const ModelSource> read_mesh_source(TomlReader& reader, const std::filesystem::path& folder) {
  MeshSpec spec = read_mesh_spec(reader, folder);
  const std::optional<double> reduction_error = read_reduction(reader);
  reader.finish();
  std::string file = spec.file.string();
  return std::make_shared<MeshSource>(std::move(spec), std::move(file), reduction_error);
}

}  // namespace mottle::study
