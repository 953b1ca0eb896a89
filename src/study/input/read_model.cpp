// [model] of a study.
#include <algorithm>
#include <cctype>
#include <set>

#include "mottle/core/text.hpp"
#include "study/input/study_sections.hpp"
#include "study/input/toml_writer.hpp"

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
    connector.name = reader.name("name");
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

void read_reduction(TomlReader& reader, StudyModelSource& source) {
  source.may_reduce = reader.choice("reduction", {"auto", "off"}, 0) == 0;
  source.frequency_error = reader.number_or("frequency_error", source.frequency_error, {1e-8, 0.1});
}

std::string matrix_place(TomlReader& reader, const std::string& key, const std::filesystem::path& folder) {
  return reader.raw(key) == nullptr ? "" : (folder / reader.text(key)).string();
}

void read_matrices(TomlReader& reader, const std::filesystem::path& folder, StudyModelSource& source) {
  constexpr OptionRange k_exponents{.lower = -9.0, .upper = 9.0};
  source.constant_part.stiffness = matrix_place(reader, "stiffness", folder);
  source.constant_part.mass = matrix_place(reader, "mass", folder);
  source.row_names = matrix_place(reader, "degrees_of_freedom", folder);
  for (TomlReader& entry : reader.tables("terms")) {
    StudyMatrixPart part{.name = entry.name("name")};
    part.stiffness = matrix_place(entry, "stiffness", folder);
    part.mass = matrix_place(entry, "mass", folder);
    if (part.stiffness.empty() && part.mass.empty()) entry.fail("stiffness", "give stiffness, mass or both");
    if (entry.raw("nominal") != nullptr) part.nominal = entry.number("nominal", k_positive);
    part.exponent = static_cast<int>(entry.integer_or("exponent", 1, k_exponents));
    if (part.exponent == 0) entry.fail_value("exponent", "a whole number from -9 to 9 other than 0");
    entry.finish();
    source.parts.push_back(std::move(part));
  }
}

}  // namespace

StudyModelSource read_model(TomlReader reader, const std::filesystem::path& folder) {
  StudyModelSource source;
  reader.text("kind");
  using Kind = StudyModelSource::Kind;
  const std::vector kinds{Kind::mass_spring, Kind::nastran, Kind::matrices, Kind::calculix, Kind::command};
  source.kind = kinds[reader.choice("kind", {"mass-spring", "nastran", "matrices", "calculix", "command"}, 0)];
  if (source.kind == StudyModelSource::Kind::mass_spring) {
    source.system = read_mass_springs(reader);
    return source;
  }
  if (source.kind == Kind::matrices) {
    read_matrices(reader, folder, source);
    read_reduction(reader, source);
    reader.finish();
    return source;
  }
  if (source.kind == Kind::command) {
    source.command = read_command(reader, folder);
    reader.finish();
    return source;
  }
  source.deck = folder / reader.text("file");
  if (source.kind == Kind::calculix) {
    source.program = reader.text_or("program", source.program);
    source.timeout = read_duration(reader, "timeout", source.timeout);
    source.parallel = static_cast<int>(reader.integer_or("parallel", source.parallel, {.lower = 1.0, .upper = 1000.0}));
  } else if (reader.raw("ignore_cards") != nullptr) {
    for (std::string& card : reader.texts("ignore_cards")) {
      std::transform(card.begin(), card.end(), card.begin(),
                     [](unsigned char letter) { return static_cast<char>(std::toupper(letter)); });
      source.ignore_cards.insert(card);
    }
  }
  read_reduction(reader, source);
  reader.finish();
  return source;
}

}  // namespace mottle
