#include "fem/elements/tapered_beam_element.hpp"

#include <map>

#include "fem/elements/line_element.hpp"
#include "mottle/fem/elements/beam_section.hpp"
#include "mottle/fem/elements/tapered_beam.hpp"

namespace mottle::fem {
namespace {

/// A number of the section by station; the first is end A.
using Numbers = std::vector<FieldIndex>;

/// All stations of a property, end A included.
std::vector<BeamStation> stations_of(const BeamProperty& property) {
  std::vector<BeamStation> stations = {{.position = 0.0,
                                        .area = property.area,
                                        .inertia_1 = property.inertia_1,
                                        .inertia_2 = property.inertia_2,
                                        .inertia_12 = property.inertia_12,
                                        .torsion = property.torsion,
                                        .nonstructural_mass = property.nonstructural_mass,
                                        .dimensions = property.dimensions}};
  stations.insert(stations.end(), property.stations.begin(), property.stations.end());
  return stations;
}

Numbers numbers_of(const std::vector<BeamStation>& stations, FieldIndex BeamStation::*number) {
  Numbers fields;
  for (const BeamStation& station : stations) fields.push_back(station.*number);
  return fields;
}

/// How each field acts along the beam: one at its own station, linear where a station between the ends leaves it out.
std::map<FieldIndex, std::vector<LineWeight>> weights_of(const std::vector<BeamStation>& stations,
                                                         const Numbers& fields) {
  std::map<FieldIndex, std::vector<LineWeight>> weights;
  const auto add = [&](FieldIndex field, std::size_t station, double weight) {
    if (field == k_no_field) return;
    std::vector<LineWeight>& line = weights[field];
    if (line.empty()) {
      for (const BeamStation& one : stations) line.push_back({one.position, 0.0});
    }
    line[station].weight += weight;
  };
  for (std::size_t i = 0; i < stations.size(); ++i) {
    const bool is_end = i == 0 || i + 1 == stations.size();
    if (is_end || fields[i] != k_no_field) {
      add(fields[i], i, 1.0);
    } else {
      add(fields.front(), i, 1.0 - stations[i].position);
      add(fields.back(), i, stations[i].position);
    }
  }
  return weights;
}

double value_at(const FiniteElementModel& model, const std::vector<BeamStation>& stations, const Numbers& fields,
                std::size_t station) {
  double value = 0.0;
  for (const auto& [field, line] : weights_of(stations, fields)) value += line[station].weight * model.value(field);
  return value;
}

BeamSection section_at(const FiniteElementModel& model, const BeamProperty& property,
                       const std::vector<BeamStation>& stations, std::size_t station) {
  if (!property.section.empty()) {
    std::vector<double> dimensions;
    for (std::size_t d = 0; d < property.dimensions.size(); ++d) {
      Numbers fields;
      for (const BeamStation& one : stations) fields.push_back(one.dimensions[d]);
      dimensions.push_back(value_at(model, stations, fields, station));
    }
    return beam_section(property.section, dimensions);
  }
  const auto at = [&](FieldIndex BeamStation::*number) {
    return value_at(model, stations, numbers_of(stations, number), station);
  };
  return {.area = at(&BeamStation::area),
          .inertia_1 = at(&BeamStation::inertia_1),
          .inertia_2 = at(&BeamStation::inertia_2),
          .inertia_12 = at(&BeamStation::inertia_12),
          .torsion = at(&BeamStation::torsion),
          .shear_1 = property.shear_1,
          .shear_2 = property.shear_2};
}

std::vector<FieldIndex> all_fields(const std::vector<BeamStation>& stations) {
  std::vector<FieldIndex> fields;
  for (const BeamStation& one : stations) {
    for (const FieldIndex field : {one.area, one.inertia_1, one.inertia_2, one.inertia_12, one.torsion})
      fields.push_back(field);
    fields.insert(fields.end(), one.dimensions.begin(), one.dimensions.end());
  }
  return fields;
}

/// The mass of a number along the beam, each field by itself: exactly linear in all of them.
void add_mass(ElementPieces& result, const std::vector<BeamStation>& stations, const Numbers& fields,
              const Coefficient& per_number, double weigh, const BeamGeometry& geometry, MassKind kind,
              BeamMatrix BeamMass::*part) {
  for (const auto& [field, line] : weights_of(stations, fields)) {
    add_piece(result, ElementPiece::Kind::mass, weigh, times(per_number, field),
              tapered_beam_mass(geometry, line, kind).*part);
  }
}

}  // namespace

void add_tapered_beam(const FiniteElementModel& model, const BeamElement& element, PieceSelection selection,
                      ElementPieces& result) {
  const BeamProperty& property = model.beam_properties[static_cast<std::size_t>(element.property)];
  const Material& material = model.materials[static_cast<std::size_t>(property.material)];
  const BeamGeometry geometry{ends_of(model, element.nodes), element.offsets, element.orientation, element.pins};
  const std::vector<BeamStation> stations = stations_of(property);
  std::vector<BeamSectionAt> sections;
  for (std::size_t i = 0; i < stations.size(); ++i)
    sections.push_back({stations[i].position, section_at(model, property, stations, i)});
  const MassKind kind = mass_kind(model);
  const double weigh = model.settings.mass_factor;
  const Coefficient density = times({}, material.density);
  const auto add_number = [&](FieldIndex BeamStation::*number, const Coefficient& per_number,
                              BeamMatrix BeamMass::*part) {
    add_mass(result, stations, numbers_of(stations, number), per_number, weigh, geometry, kind, part);
  };
  add_number(&BeamStation::nonstructural_mass, {}, &BeamMass::line);
  if (property.section.empty()) {
    add_number(&BeamStation::area, density, &BeamMass::line);
    if (element.has_torsional_inertia) {
      add_number(&BeamStation::inertia_1, density, &BeamMass::torsional);
      add_number(&BeamStation::inertia_2, density, &BeamMass::torsional);
    }
  } else {
    Coefficient of_dimensions = density;
    of_dimensions.matrix_fields = all_fields(stations);
    std::vector<LineWeight> area, polar;
    for (const BeamSectionAt& at : sections) {
      area.push_back({at.position, at.section.area});
      polar.push_back({at.position, at.section.inertia_1 + at.section.inertia_2});
    }
    add_piece(result, ElementPiece::Kind::mass, weigh, of_dimensions, tapered_beam_mass(geometry, area, kind).line);
    if (element.has_torsional_inertia)
      add_piece(result, ElementPiece::Kind::mass, weigh, of_dimensions,
                tapered_beam_mass(geometry, polar, kind).torsional);
  }
  if (selection == PieceSelection::mass) return;
  Coefficient young = young_coefficient(model, material), shear = shear_coefficient(model, material);
  const double ratio = value_of(model, shear) > 0.0 ? value_of(model, young) / value_of(model, shear) : 2.0;
  for (const FieldIndex field : all_fields(stations)) {
    young.matrix_fields.push_back(field);
    shear.matrix_fields.push_back(field);
  }
  const BeamSection& first = sections.front().section;
  if (first.shear_1 > 0.0 || first.shear_2 > 0.0) {
    for (const FieldIndex field : {material.young, material.shear, material.poisson}) {
      if (material.shear != k_no_field || field == material.poisson) young.matrix_fields.push_back(field);
    }
  }
  for (const BeamPiece& piece : tapered_beam_stiffness(geometry, sections, ratio)) {
    add_piece(result, ElementPiece::Kind::stiffness, 1.0, piece.coefficient == BeamCoefficient::E ? young : shear,
              piece.matrix);
  }
}

}  // namespace mottle::fem
