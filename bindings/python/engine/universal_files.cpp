// Universal files: the library's structures, whose members mottle/universal.py reads and sets by name.
#include <pybind11/complex.h>
#include <pybind11/eigen.h>
#include <pybind11/stl.h>

#include <algorithm>
#include <array>
#include <memory>
#include <optional>
#include <string>

#include "bindings.hpp"
#include "calling_thread.hpp"
#include "mottle/formats/uff/frames.hpp"
#include "mottle/formats/uff/uff.hpp"
#include "mottle/mottle.hpp"

namespace mottle::python {
namespace {

namespace py = pybind11;
using fem::CoordinateSystem;
using namespace formats;  // NOLINT(google-build-using-namespace): this source is of nothing else

/// Bytes of a text that are not UTF-8 are kept, as Python keeps those of names of files.
py::str text_of(const std::string& bytes) {
  PyObject* const text = PyUnicode_DecodeUTF8(bytes.data(), static_cast<Py_ssize_t>(bytes.size()), "surrogateescape");
  if (text == nullptr) throw py::error_already_set();
  return py::reinterpret_steal<py::str>(text);
}

std::string bytes_of(const py::str& text) {
  return text.attr("encode")("utf-8", "surrogateescape").cast<std::string>();
}

template <std::size_t Count>
std::array<py::str, Count> texts_of(const std::array<std::string, Count>& lines) {
  std::array<py::str, Count> texts;
  std::transform(lines.begin(), lines.end(), texts.begin(), text_of);
  return texts;
}

template <std::size_t Count>
std::array<std::string, Count> lines_of(const std::array<py::str, Count>& texts) {
  std::array<std::string, Count> lines;
  std::transform(texts.begin(), texts.end(), lines.begin(), bytes_of);
  return lines;
}

template <typename Type>
void add_text(py::class_<Type>& type, const char* name, std::string Type::*member) {
  type.def_property(
      name, [member](const Type& self) { return text_of(self.*member); },
      [member](Type& self, const py::str& text) { self.*member = bytes_of(text); });
}

template <typename Type>
void add_titles(py::class_<Type>& type) {
  type.def_property(
      "titles", [](const Type& self) { return texts_of(self.titles); },
      [](Type& self, const std::array<py::str, 5>& texts) { self.titles = lines_of(texts); });
}

void add_geometry(py::module_& module) {
  py::class_<UffUnits> units(module, "UffUnits");
  units.def(py::init<>())
      .def_readwrite("code", &UffUnits::code)
      .def_readwrite("temperature_mode", &UffUnits::temperature_mode)
      .def_readwrite("length", &UffUnits::length)
      .def_readwrite("force", &UffUnits::force)
      .def_readwrite("temperature", &UffUnits::temperature)
      .def_readwrite("temperature_offset", &UffUnits::temperature_offset);
  add_text(units, "description", &UffUnits::description);
  py::class_<UffNode>(module, "UffNode")
      .def(py::init<>())
      .def_readwrite("id", &UffNode::id)
      .def_readwrite("definition_system", &UffNode::definition_system)
      .def_readwrite("displacement_system", &UffNode::displacement_system)
      .def_readwrite("color", &UffNode::color)
      .def_readwrite("position", &UffNode::position)
      .def_readwrite("is_local", &UffNode::is_local);
  py::class_<UffTraceLine> line(module, "UffTraceLine");
  line.def(py::init<>())
      .def_readwrite("id", &UffTraceLine::id)
      .def_readwrite("color", &UffTraceLine::color)
      .def_readwrite("nodes", &UffTraceLine::nodes);
  add_text(line, "name", &UffTraceLine::name);
  py::class_<UffElement>(module, "UffElement")
      .def(py::init<>())
      .def_readwrite("id", &UffElement::id)
      .def_readwrite("descriptor", &UffElement::descriptor)
      .def_readwrite("physical_property", &UffElement::physical_property)
      .def_readwrite("material_property", &UffElement::material_property)
      .def_readwrite("color", &UffElement::color)
      .def_readwrite("beam", &UffElement::beam)
      .def_readwrite("nodes", &UffElement::nodes);
  py::class_<UffCoordinateSystem> system(module, "UffCoordinateSystem");
  system.def(py::init<>())
      .def_property(
          "id", [](const UffCoordinateSystem& self) { return self.system.id; },
          [](UffCoordinateSystem& self, int id) { self.system.id = id; })
      .def_property(
          "kind", [](const UffCoordinateSystem& self) { return static_cast<int>(self.system.kind); },
          [](UffCoordinateSystem& self, int kind) {
            require(kind >= 0 && kind <= 2, "kind: {} is outside 0 to 2", kind);
            self.system.kind = static_cast<CoordinateSystem::Kind>(kind);
          })
      .def_property(
          "origin", [](const UffCoordinateSystem& self) { return self.system.origin; },
          [](UffCoordinateSystem& self, const Eigen::Vector3d& origin) { self.system.origin = origin; })
      .def_property(
          "axes", [](const UffCoordinateSystem& self) { return self.system.axes; },
          [](UffCoordinateSystem& self, const Eigen::Matrix3d& axes) { self.system.axes = axes; })
      .def_readwrite("reference", &UffCoordinateSystem::reference)
      .def_readwrite("color", &UffCoordinateSystem::color);
  add_text(system, "name", &UffCoordinateSystem::name);
}

void add_shape(py::module_& module) {
  py::class_<UffShape> shape(module, "UffShape");
  shape.def(py::init<>())
      .def_readwrite("model_type", &UffShape::model_type)
      .def_readwrite("analysis_type", &UffShape::analysis_type)
      .def_readwrite("quantity", &UffShape::quantity)
      .def_readwrite("is_complex", &UffShape::is_complex)
      .def_readwrite("load_case", &UffShape::load_case)
      .def_readwrite("mode", &UffShape::mode)
      .def_readwrite("frequency", &UffShape::frequency)
      .def_readwrite("modal_mass", &UffShape::modal_mass)
      .def_readwrite("viscous_damping", &UffShape::viscous_damping)
      .def_readwrite("hysteretic_damping", &UffShape::hysteretic_damping)
      .def_readwrite("eigenvalue", &UffShape::eigenvalue)
      .def_readwrite("modal_a", &UffShape::modal_a)
      .def_readwrite("modal_b", &UffShape::modal_b)
      .def_readwrite("nodes", &UffShape::nodes)
      .def_readwrite("values", &UffShape::values);
  add_titles(shape);
}

void add_function(py::module_& module) {
  py::class_<UffAxis> axis(module, "UffAxis");
  axis.def(py::init<>()).def_readwrite("quantity", &UffAxis::quantity).def_readwrite("units", &UffAxis::units);
  add_text(axis, "label", &UffAxis::label);
  add_text(axis, "unit", &UffAxis::unit);
  py::class_<UffFunction> function(module, "UffFunction");
  function.def(py::init<>())
      .def_readwrite("type", &UffFunction::type)
      .def_readwrite("id", &UffFunction::id)
      .def_readwrite("version", &UffFunction::version)
      .def_readwrite("load_case", &UffFunction::load_case)
      .def_readwrite("response_node", &UffFunction::response_node)
      .def_readwrite("response_direction", &UffFunction::response_direction)
      .def_readwrite("reference_node", &UffFunction::reference_node)
      .def_readwrite("reference_direction", &UffFunction::reference_direction)
      .def_readwrite("is_complex", &UffFunction::is_complex)
      .def_readwrite("is_double", &UffFunction::is_double)
      .def_readwrite("is_even", &UffFunction::is_even)
      .def_readwrite("is_binary", &UffFunction::is_binary)
      .def_readwrite("start", &UffFunction::start)
      .def_readwrite("step", &UffFunction::step)
      .def_readwrite("z", &UffFunction::z)
      .def_readwrite("abscissa_axis", &UffFunction::abscissa_axis)
      .def_readwrite("ordinate_axis", &UffFunction::ordinate_axis)
      .def_readwrite("denominator_axis", &UffFunction::denominator_axis)
      .def_readwrite("z_axis", &UffFunction::z_axis)
      .def_readwrite("abscissa", &UffFunction::abscissa)
      .def_readwrite("values", &UffFunction::values);
  add_text(function, "response_name", &UffFunction::response_name);
  add_text(function, "reference_name", &UffFunction::reference_name);
  add_titles(function);
}

void add_file(py::module_& module) {
  py::class_<UffFile, std::shared_ptr<UffFile>>(module, "UffFile")
      .def(py::init<>())
      .def_property(
          "header", [](const UffFile& self) { return self.header ? std::optional(self.header->lines) : std::nullopt; },
          [](UffFile& self, const std::optional<std::array<py::str, 7>>& lines) {
            self.header = lines ? std::optional(UffHeader{lines_of(*lines)}) : std::nullopt;
          })
      .def_readwrite("units", &UffFile::units)
      .def_readwrite("systems", &UffFile::systems)
      .def_readwrite("nodes", &UffFile::nodes)
      .def_readwrite("trace_lines", &UffFile::trace_lines)
      .def_readwrite("elements", &UffFile::elements)
      .def_readwrite("shapes", &UffFile::shapes)
      .def_readwrite("functions", &UffFile::functions)
      .def_readwrite("notes", &UffFile::notes);
}

}  // namespace

void add_universal_files(py::module_& module) {
  add_geometry(module);
  add_shape(module);
  add_function(module);
  add_file(module);
  module.def(
      "parse_uff",
      [](const std::string& bytes, const std::string& file, bool is_in_si) {
        return CallingThread::run_by_itself([=](const auto* /*stop*/) {
          auto contents = std::make_shared<UffFile>(formats::parse_uff(bytes, file));
          if (is_in_si) {
            const std::string note = convert_to_si(*contents);
            if (!note.empty()) contents->notes.push_back(note);
          }
          return contents;
        });
      },
      py::arg("bytes"), py::arg("file"), py::arg("is_in_si"));
  module.def(
      "format_uff",
      [](const UffFile& contents, int nodes, int shapes, bool is_big_endian) {
        return py::bytes(
            formats::format_uff(contents, {.nodes = nodes, .shapes = shapes, .is_big_endian = is_big_endian}));
      },
      py::arg("contents"), py::kw_only(), py::arg("nodes"), py::arg("shapes"), py::arg("is_big_endian"));
}

}  // namespace mottle::python
