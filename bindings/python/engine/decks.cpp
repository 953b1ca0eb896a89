// Decks without a study: modes and targets.
#include <pybind11/eigen.h>
#include <pybind11/stl.h>
#include <pybind11/stl/filesystem.h>

#include <memory>

#include "bindings.hpp"
#include "calling_thread.hpp"
#include "mottle/mottle.hpp"
#include "mottle/study/jobs/targets.hpp"

namespace mottle::python {
namespace {

namespace py = pybind11;
using Path = std::filesystem::path;
using study::ModesOutcome;
using study::ModesSettings;
using study::Target;
using study::TargetsOutcome;
using study::TargetsSettings;

void add_modes(py::module_& module) {
  py::class_<ModesOutcome, std::shared_ptr<ModesOutcome>> modes(module, "ModesOutcome");
  modes.def_property_readonly("frequencies", &ModesOutcome::frequencies, py::return_value_policy::reference_internal);
  modes.def_property_readonly("residuals", &ModesOutcome::residuals, py::return_value_policy::reference_internal);
  modes.def("shapes", [](const ModesOutcome& self) {
    const study::GridShapes shapes = study::grid_shapes(self);
    return py::make_tuple(shapes.nodes, shapes.positions, shapes.displacements);
  });
  modes.def("summary", [](const ModesOutcome& self) { return study::summarise(self, Path()).lines; });
  module.def(
      "find_modes",
      [](const Path& model, int count, const std::set<std::string>& ignored, std::optional<int> subcase) {
        ModesSettings settings;
        settings.model = model;
        settings.modes = count;
        settings.ignore_cards = ignored;
        settings.subcase = subcase;
        return CallingThread::run_by_itself([settings](const auto* stop) {
          ModesSettings stopped = settings;
          stopped.stop = stop;
          auto outcome = std::make_shared<ModesOutcome>(study::find_modes(stopped));
          outcome->settings.stop = nullptr;
          return outcome;
        });
      },
      py::arg("model"), py::kw_only(), py::arg("modes"), py::arg("ignore_cards"), py::arg("subcase"));
}

void add_targets(py::module_& module) {
  py::class_<Target>(module, "Target")
      .def_readonly("name", &Target::name)
      .def_readonly("unit", &Target::unit)
      .def_readonly("value", &Target::value)
      .def_readonly("elements", &Target::elements)
      .def_readonly("strain", &Target::strain)
      .def_readonly("kinetic", &Target::kinetic)
      .def_readonly("sensitivity", &Target::sensitivity);
  module.def(
      "find_targets",
      [](const Path& model, int modes, const std::set<std::string>& ignored, std::optional<int> subcase,
         const std::optional<std::string>& units, bool lists_all) {
        const TargetsOutcome outcome = CallingThread::run_by_itself([=](const auto* stop) {
          return study::find_targets({.model = model,
                                      .modes = modes,
                                      .ignore_cards = ignored,
                                      .subcase = subcase,
                                      .units = units,
                                      .lists_all = lists_all,
                                      .stop = stop});
        });
        return py::make_tuple(outcome.frequencies, outcome.targets, outcome.notes);
      },
      py::arg("model"), py::kw_only(), py::arg("modes"), py::arg("ignore_cards"), py::arg("subcase"), py::arg("units"),
      py::arg("lists_all"));
}

}  // namespace

void add_decks(py::module_& module) {
  add_modes(module);
  add_targets(module);
}

}  // namespace mottle::python
