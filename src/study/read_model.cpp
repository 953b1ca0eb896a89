// [model] of a study.
#include <algorithm>
#include <cctype>
#include <set>

#include "mottle/core/text.hpp"
#include "study_sections.hpp"
#include "toml_writer.hpp"

namespace mottle {
namespace {

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
    connector.name = reader.text("name");
    if (!seen.insert(connector.name).second) reader.fail("name", fmt::format("'{}' stands twice", connector.name));
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

}  // namespace

StudyModelSource read_model(TomlReader reader, const std::filesystem::path& folder) {
  StudyModelSource source;
  reader.text("kind");
  const std::vector kinds{StudyModelSource::Kind::mass_spring, StudyModelSource::Kind::nastran};
  source.kind = kinds[reader.choice("kind", {"mass-spring", "nastran"}, 0)];
  if (source.kind == StudyModelSource::Kind::mass_spring) {
    source.system = read_mass_springs(reader);
    return source;
  }
  source.deck = folder / reader.text("file");
  if (reader.raw("ignore_cards") != nullptr) {
    for (std::string& card : reader.texts("ignore_cards")) {
      std::transform(card.begin(), card.end(), card.begin(),
                     [](unsigned char letter) { return static_cast<char>(std::toupper(letter)); });
      source.ignore_cards.insert(card);
    }
  }
  source.may_reduce = reader.choice("reduction", {"auto", "off"}, 0) == 0;
  source.frequency_error = reader.number_or("frequency_error", source.frequency_error, {1e-8, 0.1});
  reader.finish();
  return source;
}

}  // namespace mottle
