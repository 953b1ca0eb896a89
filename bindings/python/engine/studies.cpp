// Studies and their jobs.
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

/// What every job is given.
struct JobArguments {
  std::optional<Path> folder;
  int threads = 0;
  bool resume = false;
  bool may_run_programs = true;
  Path cache;
  py::object progress;
};

RunSettings settings_of(const JobArguments& arguments, CallingThread& caller) {
  return {.folder = arguments.folder.value_or(Path()),
          .cache = arguments.cache,
          .threads = arguments.threads > 0 ? arguments.threads : available_threads(),
          .resume = arguments.resume,
          .may_run_programs = arguments.may_run_programs,
          .observer = &caller,
          .stop = caller.stop()};
}

/// Does the job and, where there is a folder, what the command of its name does with it.
template <typename Outcome, typename Job, typename Finish>
std::shared_ptr<Outcome> run_job(const JobArguments& arguments, const Job& job, const Finish& finish) {
  CallingThread caller(arguments.progress);
  const RunSettings settings = settings_of(arguments, caller);
  return caller.run([&] {
    std::optional<FolderLock> lock;
    if (arguments.folder) lock.emplace(*arguments.folder);
    auto outcome = std::make_shared<Outcome>(job(settings));
    if (arguments.folder) {
      write_results(*outcome, *arguments.folder);
      finish(*arguments.folder);
    }
    return outcome;
  });
}

void finish_with_report(const Path& folder) {
  write_report(folder);
  RunFolder(folder).finish();
}

using Study = study::Study;

std::vector<std::string> names_of(const Study& study) {
  std::vector<std::string> names;
  for (const study::StudyParameter& parameter : study.parameters.list) names.push_back(parameter.name);
  return names;
}

JobArguments job_arguments(const std::optional<Path>& folder, int threads, bool resume, bool may_run_programs,
                           const std::optional<Path>& cache, const py::object& progress) {
  return {folder, threads, resume, may_run_programs, cache.value_or(Path()), progress};
}

/// Adds a job with the arguments that all have.
template <typename Outcome, typename Job, typename Finish>
void add_job(py::class_<Study, std::shared_ptr<Study>>& study, const char* name, Job job, Finish finish) {
  study.def(
      name,
      [job, finish](const Study& self, const std::optional<Path>& folder, int threads, bool resume,
                    bool may_run_programs, const std::optional<Path>& cache, const py::object& progress) {
        const JobArguments arguments = job_arguments(folder, threads, resume, may_run_programs, cache, progress);
        return run_job<Outcome>(
            arguments, [&](const RunSettings& settings) { return job(self, settings); }, finish);
      },
      py::kw_only(), py::arg("folder") = py::none(), py::arg("threads") = 0, py::arg("resume") = false,
      py::arg("may_run_programs") = true, py::arg("cache") = py::none(), py::arg("progress") = py::none());
}

}  // namespace

void add_studies(py::module_& module) {
  py::class_<Study, std::shared_ptr<Study>> study(module, "Study");
  study.def_static(
      "read",
      [](const Path& file, const std::vector<std::string>& assignments, std::optional<std::uint64_t> seed) {
        return std::make_shared<Study>(study::read_study(file, {.assignments = assignments, .seed = seed}));
      },
      py::arg("file"), py::kw_only(), py::arg("assignments") = std::vector<std::string>(),
      py::arg("seed") = py::none());
  study.def_static(
      "from_text",
      [](const std::string& text, const Path& file) {
        return std::make_shared<Study>(study::read_study_text(text, file));
      },
      py::arg("text"), py::arg("file"));
  study.def_property_readonly("file", [](const Study& self) { return self.file; });
  study.def_property_readonly("title", [](const Study& self) { return self.title; });
  study.def_property_readonly("units", [](const Study& self) { return self.units; });
  study.def_property_readonly("seed", [](const Study& self) { return self.seed; });
  study.def_property_readonly("method", [](const Study& self) { return self.update.method; });
  study.def_property_readonly("parameters", names_of);
  study.def_property_readonly("text", [](const Study& self) { return self.text; });
  study.def(
      "check",
      [](const Study& self, int threads, bool may_run_programs, const std::optional<Path>& cache,
         const py::object& progress) {
        CallingThread caller(progress);
        const JobArguments arguments = job_arguments({}, threads, false, may_run_programs, cache, progress);
        const RunSettings settings = settings_of(arguments, caller);
        return caller.run([&] { return std::make_shared<CheckOutcome>(study::check(self, settings)); });
      },
      py::kw_only(), py::arg("threads") = 0, py::arg("may_run_programs") = true, py::arg("cache") = py::none(),
      py::arg("progress") = py::none());
  add_job<UpdateOutcome>(
      study, "update", [](const Study& self, const RunSettings& settings) { return study::update(self, settings); },
      finish_with_report);
  add_job<DiagnoseOutcome>(
      study, "diagnose", [](const Study& self, const RunSettings& settings) { return study::diagnose(self, settings); },
      [](const Path&) {});
  add_job<SimulateOutcome>(
      study, "simulate", [](const Study& self, const RunSettings& settings) { return study::simulate(self, settings); },
      [](const Path&) {});
  study.def(
      "propagate",
      [](const Study& self, const std::optional<Path>& points, const std::optional<Path>& folder, int threads,
         bool resume, bool may_run_programs, const std::optional<Path>& cache, const py::object& progress) {
        const JobArguments arguments = job_arguments(folder, threads, resume, may_run_programs, cache, progress);
        return run_job<PropagateOutcome>(
            arguments, [&](const RunSettings& settings) { return study::propagate(self, points, settings); },
            finish_with_report);
      },
      py::arg("points") = py::none(), py::kw_only(), py::arg("folder") = py::none(), py::arg("threads") = 0,
      py::arg("resume") = false, py::arg("may_run_programs") = true, py::arg("cache") = py::none(),
      py::arg("progress") = py::none());
}

}  // namespace mottle::python
