// Updating of a model that is a function in Python.
#include <pybind11/eigen.h>
#include <pybind11/stl.h>
#include <pybind11/stl/filesystem.h>

#include <algorithm>
#include <memory>
#include <optional>

#include "bindings.hpp"
#include "function_specs.hpp"
#include "jobs.hpp"
#include "mottle/mottle.hpp"
#include "mottle/study/jobs/given_model.hpp"
#include "python_model.hpp"

namespace mottle::python {
namespace {

namespace py = pybind11;

SurrogateSettings surrogate_of(const std::string& kind, int runs, double spread, int rounds, double tolerance) {
  const std::vector<std::string>& names = surrogate_kinds();
  const auto found = std::find(names.begin(), names.end(), kind);
  require(found != names.end(), "surrogate: {}", unknown_name_message("kind", kind, names));
  return {.kind = static_cast<SurrogateKind>(found - names.begin()),
          .runs = runs,
          .spread = spread,
          .rounds = rounds,
          .tolerance = tolerance};
}

std::shared_ptr<PythonModel> make_python_model(const py::object& function, Eigen::Index parameters,
                                               const std::vector<OutputSpec>& outputs, PythonModel::Manner manner) {
  std::vector<Quantity> quantities;
  for (const OutputSpec& output : outputs) quantities.push_back(quantity_of(output));
  if (py::hasattr(function, "jacobian")) {
    return std::make_shared<DifferentiablePythonModel>(function, parameters, std::move(quantities), manner);
  }
  return std::make_shared<PythonModel>(function, parameters, std::move(quantities), manner);
}

/// Serves the model for as long as it lives. Afterwards the model holds nothing of Python, and the results that refer
/// to it may go in any thread.
class Service {
 public:
  Service(PythonModel& model, CallingThread& caller) : model_(model) { model_.serve_by(&caller); }
  ~Service() { model_.let_go(); }
  Service(const Service&) = delete;
  Service& operator=(const Service&) = delete;

 private:
  PythonModel& model_;
};

std::shared_ptr<UpdateOutcome> update_function(const std::shared_ptr<PythonModel>& model, study::GivenStudy given,
                                               const JobArguments& arguments) {
  given.model = model;
  given.notes = leave_out_empty(given.tests);
  if (given.tests.repeatability_std.size() == 0) {
    given.tests.repeatability_std.setZero(static_cast<Eigen::Index>(model->outputs().size()));
  }
  CallingThread caller(arguments.progress);
  const Service service(*model, caller);
  return run_job<UpdateOutcome>(
      caller, arguments, [&](const RunSettings& settings) { return study::update(std::move(given), settings); },
      finish_with_report);
}

void add_specs(py::module_& module) {
  py::class_<SurrogateSettings>(module, "SurrogateSettings")
      .def(py::init(&surrogate_of), py::arg("kind"), py::arg("runs"), py::arg("spread"), py::arg("rounds"),
           py::arg("tolerance"));
  py::class_<ParameterSpec>(module, "ParameterSpec")
      .def(py::init([](const std::string& name, const std::string& kind, double mean, double std, double lower,
                       double upper, double lower_bound, double upper_bound, double lower_limit,
                       const std::string& scale, const std::string& unit) {
             return ParameterSpec{name,  kind,  scale,       unit,        mean,       std,
                                  lower, upper, lower_bound, upper_bound, lower_limit};
           }),
           py::arg("name"), py::arg("kind"), py::arg("mean"), py::arg("std"), py::arg("lower"), py::arg("upper"),
           py::arg("lower_bound"), py::arg("upper_bound"), py::arg("lower_limit"), py::arg("scale"), py::arg("unit"));
  py::class_<OutputSpec>(module, "OutputSpec")
      .def(py::init([](const std::string& name, const std::string& unit) {
             return OutputSpec{name, unit};
           }),
           py::arg("name"), py::arg("unit"));
}

}  // namespace

void add_models(py::module_& module) {
  add_specs(module);
  module.def(
      "update_function",
      [](const py::object& function, const std::vector<ParameterSpec>& parameters, const Eigen::MatrixXd& correlation,
         const std::vector<OutputSpec>& outputs, const Eigen::MatrixXd& tests, const Eigen::VectorXd& repeatability,
         const Eigen::VectorXd& model_error, const std::string& method, const OptionValues& options, int samples,
         double max_failed, int iterations, double level, double tolerance, const std::optional<int>& starts,
         std::uint64_t seed, int threads, int batch, double difference_step,
         const std::optional<SurrogateSettings>& surrogate, const std::string& title, const std::string& text,
         const std::optional<std::filesystem::path>& folder, bool resume, const py::object& progress) {
        study::StudyUpdate update;
        update.method = method;
        update.samples = samples;
        update.iterations = iterations;
        update.tolerance = tolerance;
        update.level = level;
        update.starts = starts;
        update.max_failed = max_failed;
        update.method_options[method] = options;
        TestData data{.values = tests, .repeatability_std = repeatability, .model_error_std = model_error};
        study::GivenStudy given{.model = nullptr, .space = space_of(parameters, correlation), .tests = std::move(data)};
        given.update = std::move(update);
        given.surrogate = surrogate;
        given.seed = seed;
        given.title = title;
        given.text = text;
        return update_function(make_python_model(function, static_cast<Eigen::Index>(parameters.size()), outputs,
                                                 {batch, difference_step}),
                               std::move(given),
                               {.folder = folder, .threads = threads, .resume = resume, .progress = progress});
      },
      py::arg("function"), py::kw_only(), py::arg("parameters"), py::arg("correlation"), py::arg("outputs"),
      py::arg("tests"), py::arg("repeatability"), py::arg("model_error"), py::arg("method"), py::arg("options"),
      py::arg("samples"), py::arg("max_failed"), py::arg("iterations"), py::arg("level"), py::arg("tolerance"),
      py::arg("starts") = py::none(), py::arg("seed"), py::arg("threads"), py::arg("batch"), py::arg("difference_step"),
      py::arg("surrogate"), py::arg("title"), py::arg("text"), py::arg("folder"), py::arg("resume"),
      py::arg("progress"));
}

}  // namespace mottle::python
