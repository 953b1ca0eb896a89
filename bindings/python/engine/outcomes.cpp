// What jobs found, as views of the library's own arrays.
#include <pybind11/eigen.h>
#include <pybind11/stl.h>
#include <pybind11/stl/filesystem.h>

#include <memory>

#include "bindings.hpp"
#include "calling_thread.hpp"
#include "mottle/mottle.hpp"
#include "mottle/study/results/folder_lock.hpp"
#include "mottle/study/results/run_folder.hpp"

namespace mottle::python {
namespace {

namespace py = pybind11;
using Path = std::filesystem::path;

/// Results and report, as the command leaves them.
template <typename Outcome>
void save(const Outcome& outcome, const Path& folder) {
  CallingThread(py::none()).run([&] {
    const FolderLock lock(folder);
    write_results(outcome, folder);
    write_report(folder);
    RunFolder(folder).forget_previous(study::result_names());
    return true;
  });
}

/// Of an update or cloud: the files' text, the words for a terminal.
template <typename Outcome>
void add_texts(py::class_<Outcome, std::shared_ptr<Outcome>>& type) {
  type.def("result_text",
           [](const Outcome& self) { return CallingThread(py::none()).run([&] { return study::result_text(self); }); });
  type.def("summary", [](const Outcome& self) { return study::summarise(self, Path()).lines; });
}

/// An array of the library's, which lives as long as what holds it; Python may not write into it.
template <typename Type, typename Get>
void view(Type& type, const char* name, Get get) {
  type.def_property_readonly(name, get, py::return_value_policy::reference_internal);
}

std::vector<std::string> output_names(const std::vector<Quantity>& outputs) {
  std::vector<std::string> names;
  for (const Quantity& output : outputs) names.push_back(output.name());
  return names;
}

std::vector<std::pair<std::int64_t, std::string>> failures_of(const Cloud& cloud) {
  std::vector<std::pair<std::int64_t, std::string>> failures;
  for (const FailedRun& failure : cloud.failures) failures.emplace_back(failure.sample, failure.reason);
  return failures;
}

void add_cloud(py::module_& module) {
  py::class_<Cloud> cloud(module, "Cloud");
  view(cloud, "samples", [](const Cloud& self) -> const Eigen::MatrixXd& { return self.samples; });
  view(cloud, "outputs", [](const Cloud& self) -> const Eigen::MatrixXd& { return self.outputs; });
  cloud.def_property_readonly("failures", failures_of);
  cloud.def_property_readonly("rejected", [](const Cloud& self) { return self.rejected; });
}

void add_posterior(py::module_& module) {
  py::class_<SampledPosterior> posterior(module, "Posterior");
  posterior.def_readonly("chains", &SampledPosterior::chains);
  posterior.def_readonly("draws", &SampledPosterior::draws);
  posterior.def_readonly("names", &SampledPosterior::names);
  view(posterior, "values", [](const SampledPosterior& self) -> const Eigen::MatrixXd& { return self.values; });
  view(posterior, "log_likelihood",
       [](const SampledPosterior& self) -> const Eigen::VectorXd& { return self.log_likelihood; });
}

void add_update(py::module_& module) {
  py::class_<UpdateOutcome, std::shared_ptr<UpdateOutcome>> update(module, "UpdateOutcome");
  add_texts(update);
  update.def("save", save<UpdateOutcome>);
  update.def_property_readonly("status", [](const UpdateOutcome& self) { return status_text(self.result.status); });
  update.def_property_readonly("message", [](const UpdateOutcome& self) { return self.result.message; });
  update.def_property_readonly("verdict",
                               [](const UpdateOutcome& self) { return conclusion_text(self.verdict.conclusion); });
  update.def_property_readonly("parameters", [](const UpdateOutcome& self) { return self.problem().space.names(); });
  update.def_property_readonly("outputs",
                               [](const UpdateOutcome& self) { return output_names(self.problem().model.outputs()); });
  update.def_property_readonly("reasons", [](const UpdateOutcome& self) { return self.verdict.reasons; });
  update.def_property_readonly("warnings", [](const UpdateOutcome& self) { return self.result.warnings; });
  update.def_property_readonly("model_evaluations",
                               [](const UpdateOutcome& self) { return self.result.model_evaluations; });
  update.def_property_readonly("intervals", [](const UpdateOutcome& self) -> py::object {
    if (!self.result.intervals) return py::none();
    return py::make_tuple(self.result.intervals->mean, self.result.intervals->std);
  });
  view(update, "mean", [](const UpdateOutcome& self) -> const Eigen::VectorXd& { return self.result.mean; });
  view(update, "covariance",
       [](const UpdateOutcome& self) -> const Eigen::MatrixXd& { return self.result.covariance; });
  view(update, "sensitivity",
       [](const UpdateOutcome& self) -> const Eigen::MatrixXd& { return self.result.sensitivity; });
  view(update, "tests",
       [](const UpdateOutcome& self) -> const Eigen::MatrixXd& { return self.problem().tests.values; });
  view(update, "cloud_initial",
       [](const UpdateOutcome& self) -> const Cloud& { return self.result.history.front().cloud; });
  view(update, "cloud_final",
       [](const UpdateOutcome& self) -> const Cloud& { return self.result.history.back().cloud; });
  view(update, "posterior",
       [](const UpdateOutcome& self) -> const SampledPosterior* { return self.result.posterior.get(); });
}

void add_forward(py::module_& module) {
  py::class_<PropagateOutcome, std::shared_ptr<PropagateOutcome>> propagate(module, "PropagateOutcome");
  add_texts(propagate);
  propagate.def("save", save<PropagateOutcome>);
  propagate.def_property_readonly("parameters", [](const PropagateOutcome& self) { return self.made.space->names(); });
  propagate.def_property_readonly(
      "outputs", [](const PropagateOutcome& self) { return output_names(self.made.model->outputs()); });
  view(propagate, "cloud", [](const PropagateOutcome& self) -> const Cloud& { return self.cloud; });

  py::class_<SimulateOutcome, std::shared_ptr<SimulateOutcome>> simulate(module, "SimulateOutcome");
  simulate.def_property_readonly("parameters", [](const SimulateOutcome& self) { return self.made.space->names(); });
  simulate.def_property_readonly("outputs",
                                 [](const SimulateOutcome& self) { return output_names(self.made.model->outputs()); });
  view(simulate, "truth", [](const SimulateOutcome& self) -> const Eigen::MatrixXd& { return self.cloud.samples; });
  view(simulate, "specimens", [](const SimulateOutcome& self) -> const Eigen::MatrixXd& { return self.cloud.outputs; });
  view(simulate, "exact", [](const SimulateOutcome& self) -> const Eigen::MatrixXd& { return self.exact; });
}

}  // namespace

void add_outcomes(py::module_& module) {
  add_cloud(module);
  add_posterior(module);
  add_update(module);
  add_forward(module);
  py::class_<DiagnoseOutcome, std::shared_ptr<DiagnoseOutcome>> diagnose(module, "DiagnoseOutcome");
  add_texts(diagnose);
  py::class_<CheckOutcome, std::shared_ptr<CheckOutcome>> check(module, "CheckOutcome");
  view(check, "frequencies", [](const CheckOutcome& self) -> const Eigen::VectorXd& { return self.frequencies; });
  view(check, "outputs", [](const CheckOutcome& self) -> const Eigen::VectorXd& { return self.outputs; });
  view(check, "changes", [](const CheckOutcome& self) -> const Eigen::MatrixXd& { return self.changes; });
  check.def_property_readonly("total_mass", [](const CheckOutcome& self) { return self.total_mass; });
  check.def("summary", [](const CheckOutcome& self) { return study::summarise(self).lines; });
  module.def(
      "write_report",
      [](const Path& folder) {
        CallingThread(py::none()).run([&] {
          write_report(folder);
          return true;
        });
      },
      py::arg("folder"));
}

}  // namespace mottle::python
