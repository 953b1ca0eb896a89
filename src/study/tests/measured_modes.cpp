#include "study/tests/measured_modes.hpp"

#include <algorithm>
#include <cmath>
#include <limits>
#include <map>
#include <set>

#include "mottle/core/error.hpp"
#include "mottle/core/text.hpp"
#include "mottle/dynamics/modes/complex_shape.hpp"
#include "mottle/formats/uff/frames.hpp"
#include "mottle/model/units.hpp"

namespace mottle::study {
namespace {

constexpr double k_not_measured = std::numeric_limits<double>::quiet_NaN();
constexpr double k_two_pi = 6.283185307179586;

/// A node and one of its six components.
using NodeComponent = std::pair<int, int>;

/// Components of nodes that are not zero in all modes: a component that is zero throughout was not measured.
std::map<NodeComponent, Eigen::Index> measured_components(const std::vector<UffShape>& shapes) {
  std::set<NodeComponent> moving;
  for (const UffShape& shape : shapes) {
    for (std::size_t k = 0; k < shape.nodes.size(); ++k) {
      for (Eigen::Index c = 0; c < shape.values.cols(); ++c) {
        if (shape.values(static_cast<Eigen::Index>(k), c) != 0.0) moving.emplace(shape.nodes[k], static_cast<int>(c));
      }
    }
  }
  std::map<NodeComponent, Eigen::Index> rows;
  for (const NodeComponent& moving_component : moving)
    rows.emplace(moving_component, static_cast<Eigen::Index>(rows.size()));
  return rows;
}

std::vector<MeasuredComponent> components_at(const std::map<NodeComponent, Eigen::Index>& rows,
                                             const UffFile& contents) {
  const UffFrames frames(contents);
  std::vector<MeasuredComponent> components;
  for (const auto& [moving_component, row] : rows) {
    const auto& [node, component] = moving_component;
    components.push_back({.node = node,
                          .is_rotation = component > 2,
                          .direction = frames.directions_at(node).col(component % 3),
                          .axis = component % 3});
  }
  return components;
}

/// Frequency, damping and the number by whose root the shape is divided; 0: not given.
struct Scalars {
  double frequency = k_not_measured, damping = k_not_measured;
  std::complex<double> mass = 0.0;
};

Scalars scalars_of(const UffShape& shape) {
  Scalars scalars;
  const double speed = std::abs(shape.eigenvalue);
  if (shape.analysis_type == 2 || speed == 0.0) {
    scalars.frequency = shape.frequency;
    scalars.mass = shape.modal_mass;
    if (shape.viscous_damping > 0.0) scalars.damping = shape.viscous_damping;
    return scalars;
  }
  scalars.frequency = speed / k_two_pi;
  scalars.damping = -shape.eigenvalue.real() / speed;
  // Modal A of a real mode is 2 i omega_d times its modal mass.
  const double damped = std::abs(shape.eigenvalue.imag());
  if (damped > 0.0) scalars.mass = shape.modal_a / std::complex<double>(0.0, 2.0 * damped);
  return scalars;
}

Eigen::VectorXcd column_of(const UffShape& shape, const std::map<NodeComponent, Eigen::Index>& rows) {
  Eigen::VectorXcd column = Eigen::VectorXcd::Constant(static_cast<Eigen::Index>(rows.size()), k_not_measured);
  for (std::size_t k = 0; k < shape.nodes.size(); ++k) {
    for (Eigen::Index c = 0; c < shape.values.cols(); ++c) {
      const auto row = rows.find({shape.nodes[k], static_cast<int>(c)});
      if (row != rows.end()) column(row->second) = shape.values(static_cast<Eigen::Index>(k), c);
    }
  }
  return column;
}

/// The real shape, nan where it was not measured.
RealShape real_shape(const Eigen::VectorXcd& column) {
  std::vector<Eigen::Index> measured;
  for (Eigen::Index k = 0; k < column.size(); ++k) {
    if (!std::isnan(column(k).real())) measured.push_back(k);
  }
  const RealShape part = nearest_real_shape(column(measured));
  RealShape whole{Eigen::VectorXd::Constant(column.size(), k_not_measured), part.collinearity};
  whole.shape(measured) = part.shape;
  return whole;
}

}  // namespace

MeasuredComponent named_component(const std::string& name) {
  const std::size_t minus = name.rfind(":-");
  if (minus == std::string::npos) return {.name = name};
  std::string opposite = name;
  opposite[minus + 1] = '+';
  return {.name = opposite, .sign = -1.0};
}

MeasuredModes modes_from_uff(std::string_view bytes, const std::string& file, const std::string& units,
                             std::vector<std::string>& notes) {
  UffFile contents = parse_uff(bytes, file);
  const bool states_units = contents.units.has_value();
  const std::string conversion = convert_to_si(contents);
  if (!conversion.empty()) notes.push_back(fmt::format("{}: {}.", file, conversion));
  const UnitSizes sizes = states_units ? unit_sizes(units) : UnitSizes{};  // else the numbers are in the study's units
  const std::map<NodeComponent, Eigen::Index> rows = measured_components(contents.shapes);
  if (rows.empty()) throw FormatError(file, 0, "holds no mode shape (datasets 55 and 2414 of modes at nodes)");
  MeasuredModes modes;
  modes.file = file;
  modes.components = components_at(rows, contents);
  modes.has_own_axes = std::any_of(modes.components.begin(), modes.components.end(), [](const MeasuredComponent& one) {
    return !one.direction.isApprox(Eigen::Vector3d::Unit(one.axis), 1e-6);
  });
  const auto count = static_cast<Eigen::Index>(contents.shapes.size());
  modes.frequencies.resize(count);
  modes.damping.resize(count);
  modes.collinearity.resize(count);
  modes.shapes.resize(static_cast<Eigen::Index>(rows.size()), count);
  for (Eigen::Index t = 0; t < count; ++t) {
    const UffShape& shape = contents.shapes[static_cast<std::size_t>(t)];
    const Scalars scalars = scalars_of(shape);
    const bool is_scaled = scalars.mass != 0.0;
    const std::complex<double> divisor = is_scaled ? std::sqrt(scalars.mass / sizes.mass) : 1.0;
    const RealShape real = real_shape(column_of(shape, rows) / divisor);
    modes.frequencies(t) = scalars.frequency / unit_sizes(units).frequency;
    modes.damping(t) = scalars.damping;
    modes.collinearity(t) = real.collinearity;
    modes.shapes.col(t) = real.shape;
    modes.is_scaled.push_back(is_scaled);
  }
  for (std::size_t k = 0; k < modes.components.size(); ++k) {
    if (modes.components[k].is_rotation) modes.shapes.row(static_cast<Eigen::Index>(k)) *= sizes.length;
  }
  return modes;
}

MeasuredModes modes_from_table(const CsvTable& table, const std::string& units) {
  const int column = table.find("dof");
  MeasuredModes modes;
  modes.file = table.file;
  for (const auto& row : table.rows) {
    modes.components.push_back(named_component(row[static_cast<std::size_t>(column)]));
  }
  if (table.rows.empty())
    throw FormatError(table.file, 0,
                      "holds no row: one row for each degree of freedom is "
                      "needed");
  const auto count = static_cast<Eigen::Index>(table.header.size()) - 1;
  if (count < 1) throw FormatError(table.file, 1, "holds no mode: one column for each mode is needed beside 'dof'");
  modes.frequencies.resize(count);
  modes.shapes.resize(static_cast<Eigen::Index>(table.rows.size()), count);
  Eigen::Index mode = 0;
  for (std::size_t k = 0; k < table.header.size(); ++k) {
    if (static_cast<int>(k) == column) continue;
    const std::string& name = table.header[k];
    const bool is_kilohertz = name.ends_with("kHz");
    const std::string number = name.substr(0, name.size() - (is_kilohertz ? 3 : name.ends_with("Hz") ? 2 : 0));
    if (!parse_number(number, modes.frequencies(mode)) || !std::isfinite(modes.frequencies(mode))) {
      throw FormatError(table.file, 1, fmt::format("column '{}' is no frequency; name a mode like \"5.99 Hz\"", name));
    }
    const bool states_unit = number.size() < name.size();
    if (states_unit) modes.frequencies(mode) *= (is_kilohertz ? 1e3 : 1.0) / unit_sizes(units).frequency;
    modes.shapes.col(mode++) = numbers_of_column(table, static_cast<int>(k));
  }
  modes.damping = Eigen::VectorXd::Constant(count, k_not_measured);
  modes.collinearity = Eigen::VectorXd::Ones(count);
  modes.is_scaled.assign(static_cast<std::size_t>(count), false);
  return modes;
}

}  // namespace mottle::study
