// PBAR, PBARL, PBEAM, PBEAML; the latter two may change along the beam.
#include <fmt/ranges.h>

#include <algorithm>
#include <array>
#include <vector>

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
  if (builder.model.value(property.inertia_12) != 0.0 && (property.shear_1 > 0.0 || property.shear_2 > 0.0)) {
    builder.note(fmt::format("PBAR {}: K1 and K2 are not used where I12 is not 0, as in Nastran", id));
    property.shear_1 = property.shear_2 = 0.0;
  }
  finish(builder, "PBAR or PBARL", std::move(property));
}

/// Whether field n repeats the number of a field at end A (blank: it does by default).
bool repeats(const ModelBuilder& builder, const Card& card, int n, std::string_view what, FieldIndex at_end_a) {
  return card.is_blank(n) || card.real(n, what) == builder.model.value(at_end_a);
}

/// X/XB of a station behind end A, in field n.
double read_position(const Card& card, int n) {
  const double position = card.real(n, "X/XB");
  if (!(position > 0.0 && position <= 1.0))
    card.fail(fmt::format("X/XB is {}, it must lie in (0, 1]; the numbers of end A stand in front", position));
  return position;
}

/// "A(B)" at end B, "A(1)" at the first station between the ends.
std::string name_at(std::string_view name, double position, std::size_t number) {
  return position == 1.0 ? fmt::format("{}(B)", name) : fmt::format("{}({})", name, number);
}

/// A number at a station: blank at end B it is that of end A, blank between them it varies linearly.
FieldIndex read_at_station(ModelBuilder& builder, const Card& card, int n, const std::string& name, bool is_end_b,
                           FieldIndex at_end_a, int id) {
  if (card.is_blank(n)) return is_end_b ? at_end_a : k_no_field;
  return builder.read_field(card, n, name, id);
}

/// Sorts the stations; the section of end A holds at end B where no station is there.
void close_stations(const Card& card, BeamProperty& property) {
  std::vector<BeamStation>& stations = property.stations;
  std::ranges::sort(stations, {}, &BeamStation::position);
  if (stations.back().position < 1.0) {
    stations.push_back({1.0, property.area, property.inertia_1, property.inertia_2, property.inertia_12,
                        property.torsion, property.nonstructural_mass, property.dimensions});
  }
  for (std::size_t i = 1; i < stations.size(); ++i) {
    if (stations[i].position == stations[i - 1].position)
      card.fail(fmt::format("two stations have X/XB = {}", stations[i].position));
  }
}

/// The stations behind a PBEAML's end A: SO X DIM1 .. NSM each. None where all repeat end A.
void read_section_stations(ModelBuilder& builder, const Card& card, BeamProperty& property) {
  const int dimensions = static_cast<int>(property.dimensions.size()), width = dimensions + 3;
  const int first = 10 + dimensions;
  bool is_constant = true;
  const auto at_end_a = [&](int i) {
    return i < dimensions ? property.dimensions[static_cast<std::size_t>(i)] : property.nonstructural_mass;
  };
  for (int n = first; n <= card.size(); n += width) {
    for (int i = 0; i <= dimensions; ++i)
      is_constant = is_constant && repeats(builder, card, n + 2 + i, "DIM", at_end_a(i));
  }
  if (is_constant) return;
  for (int n = first; n <= card.size(); n += width) {
    if (!card.has_any(n, n + width - 1)) continue;
    BeamStation station{.position = card.is_blank(n + 1) ? 1.0 : read_position(card, n + 1)};
    const auto read = [&](int i, std::string_view name) {
      return read_at_station(builder, card, n + 2 + i, name_at(name, station.position, property.stations.size() + 1),
                             station.position == 1.0, at_end_a(i), property.id);
    };
    for (int i = 0; i < dimensions; ++i) station.dimensions.push_back(read(i, fmt::format("DIM{}", i + 1)));
    station.nonstructural_mass = read(dimensions, "NSM");
    property.stations.push_back(std::move(station));
  }
  close_stations(card, property);
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
  read_section_stations(builder, card, property);
  finish(builder, "PBEAM or PBEAML", std::move(property));
}

bool is_station(std::string_view field) {
  return field == "YES" || field == "YESA" || field == "NO";
}

/// Numbers of a PBEAM's section in the order of its fields.
struct SectionNumber {
  std::string_view name;
  FieldIndex BeamProperty::*at_end_a;
  FieldIndex BeamStation::*at_station;
};
constexpr std::array<SectionNumber, 6> k_section_numbers = {{
    {"A", &BeamProperty::area, &BeamStation::area},
    {"I1", &BeamProperty::inertia_1, &BeamStation::inertia_1},
    {"I2", &BeamProperty::inertia_2, &BeamStation::inertia_2},
    {"I12", &BeamProperty::inertia_12, &BeamStation::inertia_12},
    {"J", &BeamProperty::torsion, &BeamStation::torsion},
    {"NSM", &BeamProperty::nonstructural_mass, &BeamStation::nonstructural_mass},
}};

/// Fields where the stations behind end A begin; `end`: the field behind them, where K1 stands.
std::vector<int> find_stations(const Card& card, int& end) {
  std::vector<int> stations;
  int n = is_station(card.at(9)) ? 9 : 17;
  while (is_station(card.at(n))) {
    stations.push_back(n);
    const bool has_stress_points = card.at(n) == "YES" && !is_station(card.at(n + 8));
    n += has_stress_points ? 16 : 8;
  }
  end = n;
  return stations;
}

/// Reads the stations of a PBEAM, none where all repeat end A. Returns the field where K1 stands.
int read_stations(ModelBuilder& builder, const Card& card, BeamProperty& property) {
  int end = 0;
  const std::vector<int> stations = find_stations(card, end);
  const auto repeats_end_a = [&](int n) {
    return std::ranges::all_of(k_section_numbers, [&, i = n + 1](const SectionNumber& number) mutable {
      return repeats(builder, card, ++i, number.name, property.*number.at_end_a);
    });
  };
  if (std::ranges::all_of(stations, repeats_end_a)) return end;
  for (const int n : stations) {
    BeamStation station{.position = read_position(card, n + 1)};
    int field = n + 2;
    for (const SectionNumber& number : k_section_numbers) {
      const std::string name = name_at(number.name, station.position, property.stations.size() + 1);
      station.*number.at_station = read_at_station(builder, card, field++, name, station.position == 1.0,
                                                   property.*number.at_end_a, property.id);
    }
    property.stations.push_back(std::move(station));
  }
  close_stations(card, property);
  return end;
}

/// M1(A) M2(A) M1(B) M2(B) or N1(A)...: where the nonstructural mass and the neutral axis lie; blank at B as at A.
Eigen::Vector2d read_center(ModelBuilder& builder, const Card& card, int n, char letter, const BeamProperty& property) {
  Eigen::Vector2d center;
  for (int i = 0; i < 2; ++i) {
    const std::string name = fmt::format("{}{}", letter, i + 1);
    const double at_a = center(i) = builder.real(card, n + i, name + "(A)", 0.0);
    const double at_b = builder.real(card, n + 2 + i, name + "(B)", at_a);
    if (at_a != at_b) {
      card.fail(
          fmt::format("{0}(A) is {1}, {0}(B) is {2}; they must be equal, for an axis that is inclined to the "
                      "shear centres' line is not supported",
                      name, at_a, at_b));
    }
  }
  if (!center.isZero(0.0) && !property.stations.empty()) {
    card.fail(
        fmt::format("{0}1, {0}2 are given for a tapered beam; they are supported for constant beams only", letter));
  }
  return center;
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
  const int n = read_stations(builder, card, property);
  property.shear_1 = builder.real(card, n, "K1", 1.0);
  property.shear_2 = builder.real(card, n + 1, "K2", 1.0);
  for (const int taper : {n + 2, n + 3})
    card.require_absent(taper, "S", "shear relief of tapered beams is not supported");
  for (const int inertia : {n + 4, n + 5}) {
    card.require_absent(inertia, "NSI", "the inertia of nonstructural mass is not supported");
  }
  if (card.has_any(n + 6, n + 7)) builder.count("{} PBEAM cards hold warping coefficients (CW), which were ignored");
  property.nonstructural_center = read_center(builder, card, n + 8, 'M', property);
  property.neutral_axis = read_center(builder, card, n + 12, 'N', property);
  finish(builder, "PBEAM or PBEAML", std::move(property));
}

constexpr std::array<CardRule, 4> k_beam_property_rules = {{
    {"PBAR", Phase::properties, read_pbar, 19, "A I1 I2 J"},
    {"PBARL", Phase::properties, read_pbarl, 0, "DIM*"},
    {"PBEAM", Phase::properties, read_pbeam, 0, "A I1 I2 J A(B) I1(B) I2(B) J(B)"},
    {"PBEAML", Phase::properties, read_pbeaml, 0, "DIM*"},
}};

}  // namespace

CardFamily beam_property_cards() {
  return {"", k_beam_property_rules};
}

}  // namespace mottle::formats::nastran
