#include <fmt/format.h>

#include <algorithm>
#include <bit>
#include <cstring>
#include <iterator>

#include "formats/uff/datasets.hpp"
#include "mottle/core/error.hpp"
#include "mottle/formats/uff/uff.hpp"

namespace mottle::formats {
namespace {

/// Text as one line of a dataset.
std::string title(std::string text, std::size_t width = 80) {
  std::replace_if(
      text.begin(), text.end(), [](char letter) { return letter == '\n' || letter == '\r'; }, ' ');
  return text.substr(0, width);
}

/// Builds the text of a file, dataset by dataset.
class Writer {
 public:
  void begin(int dataset, const std::string& rest = "") { add("    -1\n{:6}{}\n", dataset, rest); }
  void end() { text_ += "    -1\n"; }
  template <typename... Arguments>
  void add(fmt::format_string<Arguments...> format, Arguments&&... arguments) {
    fmt::format_to(std::back_inserter(text_), format, std::forward<Arguments>(arguments)...);
  }
  void titles(const UffTitles& titles) {
    for (const std::string& line : titles) add("{}\n", title(line));
  }
  /// Numbers, `columns` on a line, each with `digits` behind the point; wide ones with the D of double precision.
  void numbers(const std::vector<double>& numbers, std::size_t columns, int width, int digits) {
    constexpr int k_double = 25;
    for (std::size_t k = 0; k < numbers.size(); ++k) {
      std::string text = fmt::format("{:{}.{}E}", numbers[k], width, digits);
      if (width == k_double) std::replace(text.begin(), text.end(), 'E', 'D');
      text_ += text;
      if (k + 1 == numbers.size() || (k + 1) % columns == 0) text_ += '\n';
    }
  }
  /// Whole numbers, eight on a line.
  void integers(const std::vector<int>& numbers) {
    constexpr std::size_t k_columns = 8;
    for (std::size_t k = 0; k < numbers.size(); ++k) {
      add("{:10}{}", numbers[k], k + 1 == numbers.size() || (k + 1) % k_columns == 0 ? "\n" : "");
    }
  }
  void bytes(const std::vector<double>& numbers, std::size_t per_point, const UffFunction& function,
             bool is_big_endian) {
    for (std::size_t k = 0; k < numbers.size(); ++k) {
      const bool is_abscissa = !function.is_even && k % per_point == 0;
      if (function.is_double && !is_abscissa) {
        put(numbers[k], is_big_endian);
      } else {
        put(static_cast<float>(numbers[k]), is_big_endian);
      }
    }
    text_ += '\n';
  }
  std::string take() { return std::move(text_); }

 private:
  template <typename Number>
  void put(Number number, bool is_big_endian) {
    std::array<char, sizeof(Number)> buffer = {};
    std::memcpy(buffer.data(), &number, sizeof number);
    if (is_big_endian != (std::endian::native == std::endian::big)) std::reverse(buffer.begin(), buffer.end());
    text_.append(buffer.data(), buffer.size());
  }

  std::string text_;
};

void write_head(Writer& writer, const UffFile& contents) {
  if (contents.header) {
    writer.begin(151);
    for (const std::string& line : contents.header->lines) writer.add("{}\n", title(line));
    writer.end();
  }
  if (contents.units) {
    const UffUnits& units = *contents.units;
    writer.begin(164);
    writer.add("{:10}{:<20}{:10}\n", units.code, title(units.description, 20), units.temperature_mode);
    writer.numbers({units.length, units.force, units.temperature, units.temperature_offset}, 3, 25, 17);
    writer.end();
  }
}

void write_systems(Writer& writer, const UffFile& contents) {
  if (contents.systems.empty()) return;
  writer.begin(2420);
  writer.add("{:10}\npart\n", 1);
  for (const UffCoordinateSystem& system : contents.systems) {
    require(system.reference == 0, "coordinate system {}: dataset 2420 knows global ones alone", system.system.id);
    writer.add("{:10}{:10}{:10}\n{}\n", system.system.id, static_cast<int>(system.system.kind), system.color,
               title(system.name));
    for (int axis = 0; axis < 3; ++axis) {
      const Eigen::Vector3d row = system.system.axes.col(axis);
      writer.numbers({row(0), row(1), row(2)}, 3, 25, 16);
    }
    const Eigen::Vector3d& origin = system.system.origin;
    writer.numbers({origin(0), origin(1), origin(2)}, 3, 25, 16);
  }
  writer.end();
}

void write_nodes(Writer& writer, const UffFile& contents, int dataset) {
  require(dataset == 15 || dataset == 2411, "nodes are written as dataset 15 or 2411, not {}", dataset);
  if (contents.nodes.empty()) return;
  writer.begin(dataset);
  for (const UffNode& node : contents.nodes) {
    writer.add("{:10}{:10}{:10}{:10}{}", node.id, node.definition_system, node.displacement_system, node.color,
               dataset == 15 ? "" : "\n");
    const Eigen::Vector3d& at = node.position;
    writer.numbers({at(0), at(1), at(2)}, 3, dataset == 15 ? 13 : 25, dataset == 15 ? 5 : 16);
  }
  writer.end();
}

void write_trace_lines(Writer& writer, const UffFile& contents) {
  for (const UffTraceLine& trace : contents.trace_lines) {
    writer.begin(82);
    writer.add("{:10}{:10}{:10}\n{}\n", trace.id, trace.nodes.size(), trace.color, title(trace.name));
    writer.integers(trace.nodes);
    writer.end();
  }
}

void write_elements(Writer& writer, const UffFile& contents) {
  if (contents.elements.empty()) return;
  writer.begin(2412);
  for (const UffElement& element : contents.elements) {
    writer.add("{:10}{:10}{:10}{:10}{:10}{:10}\n", element.id, element.descriptor, element.physical_property,
               element.material_property, element.color, element.nodes.size());
    if (is_uff_line(element.descriptor)) writer.integers({element.beam.begin(), element.beam.end()});
    writer.integers(element.nodes);
  }
  writer.end();
}

void write_mode_55(Writer& writer, const UffShape& shape, int type) {
  writer.add("{:10}{:10}{:10}{:10}{:10}{:10}\n", shape.model_type, shape.analysis_type,
             shape.values.cols() == 3 ? 2 : 3, shape.quantity, type, shape.values.cols());
  const bool is_normal = shape.analysis_type == 2;
  writer.add("{:10}{:10}{:10}{:10}\n", 2, is_normal ? 4 : 6, shape.load_case, shape.mode);
  if (is_normal) {
    writer.numbers({shape.frequency, shape.modal_mass, shape.viscous_damping, shape.hysteretic_damping}, 6, 13, 5);
  } else {
    writer.numbers({shape.eigenvalue.real(), shape.eigenvalue.imag(), shape.modal_a.real(), shape.modal_a.imag(),
                    shape.modal_b.real(), shape.modal_b.imag()},
                   6, 13, 5);
  }
}

void write_mode_2414(Writer& writer, const UffShape& shape, int type) {
  writer.add("{:10}{:10}{:10}{:10}{:10}{:10}\n", shape.model_type, shape.analysis_type,
             shape.values.cols() == 3 ? 2 : 3, shape.quantity, type, shape.values.cols());
  writer.add("{:10}{:10}{:10}{:10}{:10}{:10}{:10}{:10}\n", 0, 0, 0, 0, shape.load_case, shape.mode, 0, 0);
  writer.add("{:10}{:10}\n", 0, 0);
  const double eigenvalue = 0.0;  // follows from the frequency
  writer.numbers({0.0, shape.frequency, eigenvalue, shape.modal_mass, shape.viscous_damping, shape.hysteretic_damping},
                 6, 13, 5);
  writer.numbers({shape.eigenvalue.real(), shape.eigenvalue.imag(), shape.modal_a.real(), shape.modal_a.imag(),
                  shape.modal_b.real(), shape.modal_b.imag()},
                 6, 13, 5);
}

void write_shape(Writer& writer, const UffShape& shape, int dataset, int number) {
  require(dataset == 55 || dataset == 2414, "shapes are written as dataset 55 or 2414, not {}", dataset);
  writer.begin(dataset);
  if (dataset == 2414) writer.add("{:10}\n{}\n{:10}\n", number, title(shape.titles[0]), 1);
  writer.titles(shape.titles);
  const int type = shape.is_complex ? 5 : 2;
  dataset == 55 ? write_mode_55(writer, shape, type) : write_mode_2414(writer, shape, type);
  for (std::size_t k = 0; k < shape.nodes.size(); ++k) {
    std::vector<double> numbers;
    for (const std::complex<double>& value : shape.values.row(static_cast<Eigen::Index>(k))) {
      numbers.push_back(value.real());
      if (shape.is_complex) numbers.push_back(value.imag());
    }
    writer.add("{:10}\n", shape.nodes[k]);
    writer.numbers(numbers, 6, 13, 5);
  }
  writer.end();
}

void write_axis(Writer& writer, const UffAxis& axis) {
  writer.add("{:10}{:5}{:5}{:5} {:<20} {:<20}\n", axis.quantity, axis.units[0], axis.units[1], axis.units[2],
             title(axis.label, 20), title(axis.unit, 20));
}

std::vector<double> numbers_of(const UffFunction& function) {
  std::vector<double> numbers;
  for (Eigen::Index k = 0; k < function.values.size(); ++k) {
    if (!function.is_even) numbers.push_back(function.abscissa(k));
    numbers.push_back(function.values(k).real());
    if (function.is_complex) numbers.push_back(function.values(k).imag());
  }
  return numbers;
}

void write_values(Writer& writer, const UffFunction& function, const std::vector<double>& numbers,
                  std::size_t per_point) {
  if (!function.is_double) {
    writer.numbers(numbers, function.is_complex && !function.is_even ? 3 : 6, 13, 5);
  } else if (function.is_even) {
    writer.numbers(numbers, 4, 20, 11);
  } else {
    const std::size_t columns = function.is_complex ? 3 : 4;
    for (std::size_t k = 0; k < numbers.size(); ++k) {
      const bool is_abscissa = k % per_point == 0;
      const bool is_last = k + 1 == numbers.size() || (k + 1) % columns == 0;
      writer.add("{:{}.{}E}{}", numbers[k], is_abscissa ? 13 : 20, is_abscissa ? 5 : 11, is_last ? "\n" : "");
    }
  }
}

void write_function(Writer& writer, const UffFunction& function, bool is_big_endian) {
  const std::vector<double> numbers = numbers_of(function);
  const std::size_t per_point = (function.is_complex ? 2 : 1) + (function.is_even ? 0 : 1);
  const std::size_t abscissae = function.is_even ? 0 : numbers.size() / per_point;
  const std::size_t bytes = numbers.size() * (function.is_double ? 8 : 4) - (function.is_double ? abscissae * 4 : 0);
  writer.begin(58, function.is_binary ? fmt::format("b{:6}{:6}{:12}{:12}{:6}{:6}{:12}{:12}", is_big_endian ? 2 : 1, 2,
                                                    11, bytes, 0, 0, 0, 0)
                                      : "");
  writer.titles(function.titles);
  writer.add("{:5}{:10}{:5}{:10} {:<10}{:10}{:4} {:<10}{:10}{:4}\n", function.type, function.id, function.version,
             function.load_case, title(function.response_name, 10), function.response_node, function.response_direction,
             title(function.reference_name, 10), function.reference_node, function.reference_direction);
  const int type = (function.is_complex ? 5 : 2) + (function.is_double ? (function.is_complex ? 1 : 2) : 0);
  writer.add("{:10}{:10}{:10}{:13.5E}{:13.5E}{:13.5E}\n", type, function.values.size(), function.is_even ? 1 : 0,
             function.start, function.step, function.z);
  for (const UffAxis* axis :
       {&function.abscissa_axis, &function.ordinate_axis, &function.denominator_axis, &function.z_axis}) {
    write_axis(writer, *axis);
  }
  if (function.is_binary) {
    writer.bytes(numbers, per_point, function, is_big_endian);
  } else {
    write_values(writer, function, numbers, per_point);
  }
  writer.end();
}

}  // namespace

std::string format_uff(const UffFile& contents, const UffWriteOptions& options) {
  Writer writer;
  write_head(writer, contents);
  write_systems(writer, contents);
  write_nodes(writer, contents, options.nodes);
  write_trace_lines(writer, contents);
  write_elements(writer, contents);
  int number = 0;
  for (const UffShape& shape : contents.shapes) write_shape(writer, shape, options.shapes, ++number);
  for (const UffFunction& function : contents.functions) write_function(writer, function, options.is_big_endian);
  return writer.take();
}

}  // namespace mottle::formats
