// PBAR, PBARL, PBEAM, PBEAML: sections that do not change along the beam.
#include <fmt/ranges.h>

#include <array>

#include "formats/nastran/builder.hpp"
#include "formats/nastran/card_table.hpp"
#include "formats/nastran/rows.hpp"
#include "mottle/core/error.hpp"
#include "mottle/fem/elements/beam_section.hpp"

namespace mottle::formats::nastran {
namespace {

BeamProperty started(ModelBuilder& builder, const Card& card, int id) {
  BeamProperty property;
  property.card = card.name();
  property.id = id;
  property.material = builder.material(card, 2, "MID");
  return property;
}

void finish(ModelBuilder& builder, std::string_view kinds, BeamProperty property) {
  builder.properties<int>(kinds)[property.id] = static_cast<int>(builder.model.beam_properties.size());
  builder.model.beam_properties.push_back(std::move(property));
}

/// PID MID A I1 I2 J NSM - / C1 ... F2 / K1 K2 I12.
void read_pbar(ModelBuilder& builder, const Card& card) {
  const int id = card.id(1, "PID");
  if (!builder.is_first(card, id, IdSpace::bar_property)) return;
  BeamProperty property = started(builder, card, id);
  property.area = builder.read_field(card, 3, "A", id);
  property.inertia_1 = builder.read_field(card, 4, "I1", id);
  property.inertia_2 = builder.read_field(card, 5, "I2", id);
  property.torsion = builder.read_field(card, 6, "J", id);
  property.nonstructural_mass = builder.read_field(card, 7, "NSM", id);
  property.shear_1 = builder.real(card, 17, "K1", 0.0);
  property.shear_2 = builder.real(card, 18, "K2", 0.0);
  property.inertia_12 = builder.read_field(card, 19, "I12", id);
  finish(builder, "PBAR or PBARL", std::move(property));
}

/// Whether field n repeats the number of a field at end A (blank: it does by default).
bool repeats(const ModelBuilder& builder, const Card& card, int n, std::string_view what, FieldIndex at_end_a) {
  return card.is_blank(n) || card.real(n, what) == builder.model.value(at_end_a);
}

constexpr std::string_view k_constant_only = "differs from end A: tapered beams are not supported, write several PBEAM";

/// The stations behind a PBEAML's end A: SO X DIM1 .. NSM each.
void require_constant_dimensions(const ModelBuilder& builder, const Card& card, const BeamProperty& property, int n) {
  const int dimensions = static_cast<int>(property.dimensions.size());
  for (; n <= card.size(); n += dimensions + 3) {
    for (int i = 0; i < dimensions; ++i) {
      const std::string name = fmt::format("DIM{}", i + 1);
      if (!repeats(builder, card, n + 2 + i, name, property.dimensions[static_cast<std::size_t>(i)])) {
        card.fail(fmt::format("{} {}", name, k_constant_only));
      }
    }
    if (!repeats(builder, card, n + 2 + dimensions, "NSM", property.nonstructural_mass)) {
      card.fail(fmt::format("NSM {}", k_constant_only));
    }
  }
}

void require_sound_section(const ModelBuilder& builder, const Card& card, const BeamProperty& property) {
  std::vector<double> dimensions;
  for (const FieldIndex dimension : property.dimensions) dimensions.push_back(builder.model.value(dimension));
  try {
    beam_section(property.section, dimensions);
  } catch (const InvalidInput& error) {
    card.fail(error.what());
  }
}

/// PID MID GROUP TYPE - - - - / DIM1 ... NSM.
BeamProperty read_section(ModelBuilder& builder, const Card& card, int id) {
  BeamProperty property = started(builder, card, id);
  property.section = card.at(4);
  const int dimensions = beam_section_dimensions(property.section);
  if (dimensions == 0) {
    card.fail(fmt::format("TYPE '{}' is not known; allowed are {}", shown(property.section),
                          fmt::join(beam_section_names(), ", ")));
  }
  for (int i = 0; i < dimensions; ++i) {
    const std::string name = fmt::format("DIM{}", i + 1);
    if (card.is_blank(9 + i))
      card.fail(fmt::format("{} is blank; {} has {} dimensions", name, property.section, dimensions));
    property.dimensions.push_back(builder.read_field(card, 9 + i, name, id));
  }
  property.nonstructural_mass = builder.read_field(card, 9 + dimensions, "NSM", id);
  require_sound_section(builder, card, property);
  return property;
}

void read_pbarl(ModelBuilder& builder, const Card& card) {
  const int id = card.id(1, "PID");
  if (!builder.is_first(card, id, IdSpace::bar_property)) return;
  finish(builder, "PBAR or PBARL", read_section(builder, card, id));
}

void read_pbeaml(ModelBuilder& builder, const Card& card) {
  const int id = card.id(1, "PID");
  if (!builder.is_first(card, id, IdSpace::beam_property)) return;
  BeamProperty property = read_section(builder, card, id);
  require_constant_dimensions(builder, card, property, 10 + static_cast<int>(property.dimensions.size()));
  finish(builder, "PBEAM or PBEAML", std::move(property));
}

bool is_station(std::string_view field) {
  return field == "YES" || field == "YESA" || field == "NO";
}

/// Walks over the stations behind end A, which must repeat it. Returns the field where K1 stands.
int require_constant_stations(const ModelBuilder& builder, const Card& card, const BeamProperty& property) {
  const std::array<FieldIndex, 6> at_end_a = {property.area,       property.inertia_1, property.inertia_2,
                                              property.inertia_12, property.torsion,   property.nonstructural_mass};
  constexpr std::array<std::string_view, 6> k_names = {"A", "I1", "I2", "I12", "J", "NSM"};
  int n = is_station(card.at(9)) ? 9 : 17;
  while (is_station(card.at(n))) {
    for (std::size_t i = 0; i < 6; ++i) {
      if (!repeats(builder, card, n + 2 + static_cast<int>(i), k_names[i], at_end_a[i])) {
        card.fail(fmt::format("{} {}", k_names[i], k_constant_only));
      }
    }
    const bool has_stress_points = card.at(n) == "YES" && !is_station(card.at(n + 8));
    n += has_stress_points ? 16 : 8;
  }
  return n;
}

/// PID MID A I1 I2 I12 J NSM / C1 ... F2 / stations / K1 K2 S1 S2 NSI NSI CW CW / M1 M2 M1 M2 N1 N2 N1 N2.
void read_pbeam(ModelBuilder& builder, const Card& card) {
  const int id = card.id(1, "PID");
  if (!builder.is_first(card, id, IdSpace::beam_property)) return;
  BeamProperty property = started(builder, card, id);
  property.area = builder.read_field(card, 3, "A", id);
  property.inertia_1 = builder.read_field(card, 4, "I1", id);
  property.inertia_2 = builder.read_field(card, 5, "I2", id);
  property.inertia_12 = builder.read_field(card, 6, "I12", id);
  property.torsion = builder.read_field(card, 7, "J", id);
  property.nonstructural_mass = builder.read_field(card, 8, "NSM", id);
  const int n = require_constant_stations(builder, card, property);
  property.shear_1 = builder.real(card, n, "K1", 1.0);
  property.shear_2 = builder.real(card, n + 1, "K2", 1.0);
  for (const int taper : {n + 2, n + 3})
    card.require_absent(taper, "S", "shear relief of tapered beams is not supported");
  for (const int inertia : {n + 4, n + 5}) {
    card.require_absent(inertia, "NSI", "the inertia of nonstructural mass is not supported");
  }
  if (card.has_any(n + 6, n + 7)) builder.count("{} PBEAM cards hold warping coefficients (CW), which were ignored");
  for (int i = n + 8; i < n + 16; ++i) {
    card.require_absent(i, i < n + 12 ? "M" : "N", "offsets of the neutral axis or the mass are not supported");
  }
  finish(builder, "PBEAM or PBEAML", std::move(property));
}

constexpr std::array<CardRule, 4> k_beam_property_rules = {{
    {"PBAR", Phase::properties, read_pbar, 19, "A I1 I2 J"},
    {"PBARL", Phase::properties, read_pbarl, 0, "DIM*"},
    {"PBEAM", Phase::properties, read_pbeam, 0, "A I1 I2 J"},
    {"PBEAML", Phase::properties, read_pbeaml, 0, "DIM*"},
}};

}  // namespace

CardFamily beam_property_cards() {
  return {"", k_beam_property_rules};
}

}  // namespace mottle::formats::nastran
