// Updating of a model that is a function in Python.
#include <pybind11/eigen.h>
#include <pybind11/stl.h>

#include <algorithm>
#include <memory>
#include <optional>
#include <set>

#include "bindings.hpp"
#include "function_specs.hpp"
#include "mottle/mottle.hpp"
#include "mottle/updating/methods/surrogate_update.hpp"
#include "python_model.hpp"

namespace mottle::python {
namespace {

namespace py = pybind11;

/// What is asked for beside model, parameters and tests.
struct FunctionSettings {
  std::string method = "maximum-likelihood";
  OptionValues options;
  CloudSettings cloud;
  int iterations = 30;
  double level = 0.05;
  double tolerance = 1e-3;
  std::uint64_t seed = 1;
  int threads = 0;
  std::optional<SurrogateSettings> surrogate = std::nullopt;
};

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

/// The result, judged by the problem as the method saw it.
Verdict update_and_judge(const Updater& method, const UpdatingProblem& problem,
                         const std::optional<SurrogateSettings>& surrogate, const RunContext& context,
                         UpdatingResult& result) {
  std::optional<SurrogateUpdate> update;
  if (surrogate) update.emplace(problem, *surrogate);
  result = update ? update->run(method, context) : method.update(problem, context);
  if (result.status == UpdatingStatus::stopped) throw Stopped(result.message);
  return judge(update ? update->problem() : problem, result);
}

/// An update of a function, with all that its result refers to.
struct FunctionOutcome {
  ParameterSpace space;
  std::unique_ptr<PythonModel> model;
  TestData tests;
  FunctionSettings settings;
  UpdatingResult result = {};
  Verdict verdict = {};

  UpdatingProblem problem() const {
    UpdatingProblem problem{.model = *model,
                            .derivatives = dynamic_cast<const DifferentiableModel*>(model.get()),
                            .space = space,
                            .tests = tests,
                            .cloud = settings.cloud};
    problem.iterations = settings.iterations;
    problem.level = settings.level;
    problem.tolerance = settings.tolerance;
    return problem;
  }
};

std::unique_ptr<PythonModel> make_python_model(const py::object& function, Eigen::Index parameters,
                                               const std::vector<OutputSpec>& outputs) {
  std::vector<Quantity> quantities;
  for (const OutputSpec& output : outputs) quantities.push_back(quantity_of(output));
  if (py::hasattr(function, "jacobian")) {
    return std::make_unique<DifferentiablePythonModel>(function, parameters, std::move(quantities));
  }
  return std::make_unique<PythonModel>(function, parameters, std::move(quantities));
}

void require_tests(const FunctionOutcome& outcome) {
  const auto outputs = static_cast<Eigen::Index>(outcome.model->outputs().size());
  require(!outcome.tests.values.array().isInf().any(),
          "tests: a value is infinite; nan stands for what was not measured");
  for (Eigen::Index k = 0; k < outputs; ++k) {
    require(!outcome.tests.values.col(k).array().isNaN().all(),
            "tests: output '{}' is never measured; leave it out of tests and function",
            outcome.model->outputs()[static_cast<std::size_t>(k)].name());
  }
  std::set<std::string> names;
  for (const std::string& name : outcome.space.names()) names.insert(name);
  require(names.size() == outcome.space.names().size(), "parameters: one name is given twice");
  for (const Quantity& output : outcome.model->outputs()) {
    require(names.insert(output.name()).second,
            "tests: the name '{}' is given twice, to outputs or to a parameter as well", output.name());
  }
}

std::shared_ptr<FunctionOutcome> update_function(const py::object& function,
                                                 const std::vector<ParameterSpec>& parameters,
                                                 const Eigen::MatrixXd& correlation,
                                                 const std::vector<OutputSpec>& outputs, TestData tests,
                                                 FunctionSettings settings, const py::object& progress) {
  const std::vector<std::string> notes = leave_out_empty(tests);
  auto outcome = std::make_shared<FunctionOutcome>(
      FunctionOutcome{.space = space_of(parameters, correlation),
                      .model = make_python_model(function, static_cast<Eigen::Index>(parameters.size()), outputs),
                      .tests = std::move(tests),
                      .settings = std::move(settings)});
  if (outcome->tests.repeatability_std.size() == 0) {
    outcome->tests.repeatability_std.setZero(static_cast<Eigen::Index>(outputs.size()));
  }
  require_tests(*outcome);
  const FunctionSettings& wanted = outcome->settings;
  const std::unique_ptr<Updater> method = find_method(wanted.method).make(wanted.options, wanted.method + ":");
  CallingThread caller(progress);
  outcome->model->serve_by(&caller);
  const UpdatingProblem problem = outcome->problem();
  const RunContext context{.seed = wanted.seed,
                           .threads = wanted.threads > 0 ? wanted.threads : available_threads(),
                           .observer = &caller,
                           .stop = caller.stop()};
  outcome->verdict =
      caller.run([&] { return update_and_judge(*method, problem, wanted.surrogate, context, outcome->result); });
  outcome->model->let_go();
  outcome->result.notes.insert(outcome->result.notes.begin(), notes.begin(), notes.end());
  return outcome;
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

void add_function_outcome(py::module_& module) {
  py::class_<FunctionOutcome, std::shared_ptr<FunctionOutcome>> outcome(module, "FunctionOutcome");
  const auto view = [&outcome](const char* name, auto get) {
    outcome.def_property_readonly(name, get, py::return_value_policy::reference_internal);
  };
  view("mean", [](const FunctionOutcome& self) -> const Eigen::VectorXd& { return self.result.mean; });
  view("covariance", [](const FunctionOutcome& self) -> const Eigen::MatrixXd& { return self.result.covariance; });
  view("sensitivity", [](const FunctionOutcome& self) -> const Eigen::MatrixXd& { return self.result.sensitivity; });
  view("tests", [](const FunctionOutcome& self) -> const Eigen::MatrixXd& { return self.tests.values; });
  view("cloud_initial", [](const FunctionOutcome& self) -> const Cloud& { return self.result.history.front().cloud; });
  view("cloud_final", [](const FunctionOutcome& self) -> const Cloud& { return self.result.history.back().cloud; });
  view("posterior", [](const FunctionOutcome& self) -> const SampledPosterior* { return self.result.posterior.get(); });
  outcome.def_property_readonly("parameters", [](const FunctionOutcome& self) { return self.space.names(); });
  outcome.def_property_readonly("outputs", [](const FunctionOutcome& self) {
    std::vector<std::string> names;
    for (const Quantity& output : self.model->outputs()) names.push_back(output.name());
    return names;
  });
  outcome.def_property_readonly("status", [](const FunctionOutcome& self) { return status_text(self.result.status); });
  outcome.def_property_readonly("message", [](const FunctionOutcome& self) { return self.result.message; });
  outcome.def_property_readonly("verdict",
                                [](const FunctionOutcome& self) { return conclusion_text(self.verdict.conclusion); });
  outcome.def_property_readonly("reasons", [](const FunctionOutcome& self) { return self.verdict.reasons; });
  outcome.def_property_readonly("notes", [](const FunctionOutcome& self) { return self.result.notes; });
  outcome.def_property_readonly("warnings", [](const FunctionOutcome& self) { return self.result.warnings; });
  outcome.def_property_readonly("model_evaluations",
                                [](const FunctionOutcome& self) { return self.result.model_evaluations; });
  outcome.def_property_readonly("intervals", [](const FunctionOutcome& self) -> py::object {
    if (!self.result.intervals) return py::none();
    return py::make_tuple(self.result.intervals->mean, self.result.intervals->std);
  });
}

}  // namespace

void add_models(py::module_& module) {
  add_specs(module);
  add_function_outcome(module);
  module.def(
      "update_function",
      [](const py::object& function, const std::vector<ParameterSpec>& parameters, const Eigen::MatrixXd& correlation,
         const std::vector<OutputSpec>& outputs, const Eigen::MatrixXd& tests, const Eigen::VectorXd& repeatability,
         const Eigen::VectorXd& model_error, const std::string& method, const OptionValues& options, int samples,
         double max_failed, int iterations, double level, double tolerance, std::uint64_t seed, int threads,
         const std::optional<SurrogateSettings>& surrogate, const py::object& progress) {
        return update_function(function, parameters, correlation, outputs,
                               {.values = tests, .repeatability_std = repeatability, .model_error_std = model_error},
                               {.method = method,
                                .options = options,
                                .cloud = {.samples = samples, .max_failed = max_failed},
                                .iterations = iterations,
                                .level = level,
                                .tolerance = tolerance,
                                .seed = seed,
                                .threads = threads,
                                .surrogate = surrogate},
                               progress);
      },
      py::arg("function"), py::kw_only(), py::arg("parameters"), py::arg("correlation"), py::arg("outputs"),
      py::arg("tests"), py::arg("repeatability"), py::arg("model_error"), py::arg("method"), py::arg("options"),
      py::arg("samples"), py::arg("max_failed"), py::arg("iterations"), py::arg("level"), py::arg("tolerance"),
      py::arg("seed"), py::arg("threads"), py::arg("surrogate"), py::arg("progress"));
}

}  // namespace mottle::python
