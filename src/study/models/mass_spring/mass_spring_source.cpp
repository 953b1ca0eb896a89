// [model] of kind "mass-spring".
#include <algorithm>
#include <set>

#include "mottle/core/text.hpp"
#include "mottle/fem/assembly/mass_spring.hpp"
#include "mottle/model/solvers/dense_solver.hpp"
#include "mottle/model/units.hpp"
#include "study/input/key_error.hpp"
#include "study/input/toml_writer.hpp"
#include "study/models/registry.hpp"

namespace mottle::study {
namespace {

constexpr std::size_t k_max_locations = 12;  // where shapes are thought to be measured
const OptionRange k_positive{.lower = 0.0, .excludes_lower = true};
const OptionRange k_not_negative{.lower = 0.0};

/// Masses in the order in which they stand in the file.
std::vector<PointMass> read_masses(TomlReader& model) {
  const std::map<std::string, double> values = model.number_map("masses", k_positive);
  if (values.empty()) model.fail("masses", "is missing or empty; give for example masses = { m1 = 1.0 }");
  if (values.contains("ground")) {
    model.fail("masses", "the name 'ground' stands for the fixed point; choose another name for that mass");
  }
  std::vector<PointMass> masses;
  for (const std::string& name : keys_in_file_order(*model.raw("masses")->as_table())) {
    masses.push_back({name, values.at(name)});
  }
  return masses;
}

int point_index(const TomlReader& reader, const std::vector<PointMass>& masses, const std::string& name) {
  if (name == "ground") return k_ground;
  std::vector<std::string> known{"ground"};
  for (std::size_t i = 0; i < masses.size(); ++i) {
    if (masses[i].name == name) return static_cast<int>(i);
    known.push_back(masses[i].name);
  }
  reader.fail("between", unknown_name_message("point", name, known));
}

std::vector<Connector> read_connectors(TomlReader& model, const std::string& list, const std::string& value_key,
                                       const std::vector<PointMass>& masses) {
  std::vector<Connector> connectors;
  std::set<std::string> seen;
  for (TomlReader& reader : model.tables(list)) {
    Connector connector;
    connector.name = reader.name("name");
    if (!seen.insert(connector.name).second) reader.fail("name", fmt::format("'{}' is given twice", connector.name));
    const std::vector<std::string> ends = reader.texts("between");
    if (ends.size() != 2) reader.fail_value("between", "two points, like [\"ground\", \"m1\"]");
    connector.first = point_index(reader, masses, ends[0]);
    connector.second = point_index(reader, masses, ends[1]);
    if (connector.first == connector.second) {
      reader.fail("between", fmt::format("both ends are '{}', so '{}' acts on nothing", ends[0], connector.name));
    }
    connector.value = reader.number(value_key, k_not_negative);
    reader.finish();
    connectors.push_back(connector);
  }
  return connectors;
}

MassSpringSystem read_mass_springs(TomlReader& reader) {
  MassSpringSystem system;
  system.masses = read_masses(reader);
  system.springs = read_connectors(reader, "springs", "stiffness", system.masses);
  system.dampers = read_connectors(reader, "dampers", "damping", system.masses);
  reader.finish();
  try {
    system.validate();
  } catch (const InvalidInput& error) {
    throw InvalidInput(fmt::format("{} {}", reader.where(), error.what()));
  }
  return system;
}

void set_number(MassSpringSystem& system, const std::string& target, double value) {
  std::vector<std::string> known;
  for (PointMass& mass : system.masses) {
    known.push_back("mass:" + mass.name);
    if (known.back() == target) mass.mass = value;
  }
  for (Connector& spring : system.springs) {
    known.push_back("spring:" + spring.name);
    if (known.back() == target) spring.value = value;
  }
  for (Connector& damper : system.dampers) {
    known.push_back("damper:" + damper.name);
    if (known.back() == target) damper.value = value;
  }
  require_key(std::find(known.begin(), known.end(), target) != known.end(), "predict.model", "{}",
              unknown_name_message("target", target, known));
}

class MassSpringSource final : public ModelSource {
 public:
  explicit MassSpringSource(MassSpringSystem system) : system_(std::move(system)) {}

  ModelParts make(const std::vector<ParameterTargets>& parameters, const JointDistribution& prior,
                  const RunSettings& /*settings*/) const override {
    ModelParts parts;
    parts.reference = prior.mean();
    parts.solver = std::make_unique<DenseSolver>(DenseStructure(separate(system_, parameters), parts.reference.size()));
    for (const ParameterTargets& parameter : parameters) parts.limits.push_back(physical_limit(parameter));
    return parts;
  }

  std::string target_unit(const std::string& target, const UnitNames& units) const override {
    if (target.starts_with("mass:")) return units.mass;
    return target.starts_with("damper:") ? units.damping : units.stiffness;
  }

  bool shows_numbers() const override { return true; }
  std::vector<ModelNumber> numbers() const override {
    std::vector<ModelNumber> numbers;
    for (const Connector& spring : system_.springs) {
      numbers.push_back({"spring:" + spring.name, "spring", spring.value, true});
    }
    for (const PointMass& mass : system_.masses) numbers.push_back({"mass:" + mass.name, "mass", mass.mass});
    for (const Connector& damper : system_.dampers) {
      numbers.push_back({"damper:" + damper.name, "damper", damper.value});
    }
    return numbers;
  }
  std::unique_ptr<ModelSource> with_number(const std::string& target, double value) const override {
    MassSpringSystem other = system_;
    set_number(other, target, value);
    return std::make_unique<MassSpringSource>(std::move(other));
  }

  bool tracks_by_mac() const override { return false; }
  std::vector<std::string> shape_locations() const override {
    std::vector<std::string> locations;
    for (const PointMass& mass : system_.masses) {
      if (locations.size() < k_max_locations) locations.push_back(mass.name);
    }
    return locations;
  }

 private:
  MassSpringSystem system_;
};

}  // namespace

std::shared_ptr<const ModelSource> read_mass_spring_source(TomlReader& reader, const std::filesystem::path&) {
  return std::make_shared<MassSpringSource>(read_mass_springs(reader));
}

}  // namespace mottle::study
