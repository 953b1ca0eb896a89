#include "python_model.hpp"

#include <fmt/format.h>
#include <pybind11/eigen.h>
#include <pybind11/numpy.h>

#include <cmath>
#include <map>

#include "mottle/core/error.hpp"

namespace mottle::python {
namespace {

namespace py = pybind11;
using RowMajor = Eigen::Matrix<double, Eigen::Dynamic, Eigen::Dynamic, Eigen::RowMajor>;
using Array = py::array_t<double, py::array::c_style | py::array::forcecast>;

std::string shape_text(const py::array& array) {
  std::string text = "(";
  for (py::ssize_t axis = 0; axis < array.ndim(); ++axis) {
    text += fmt::format("{}{}", axis > 0 ? ", " : "", array.shape(axis));
  }
  return text + (array.ndim() == 1 ? ",)" : ")");
}

/// What `from` returned, as a matrix of that shape.
Eigen::MatrixXd matrix_of(const py::object& value, const char* from, Eigen::Index rows, Eigen::Index columns) {
  const Array array = Array::ensure(value);
  if (!array) {
    PyErr_Clear();
    throw InvalidInput(fmt::format("{} returned {}, an array of {} x {} numbers is needed", from,
                                   std::string(py::str(py::type::of(value).attr("__name__"))), rows, columns));
  }
  const bool fits = array.ndim() == 2 && array.shape(0) == rows && array.shape(1) == columns;
  require(fits, "{} returned an array of shape {}, ({}, {}) is needed", from, shape_text(array), rows, columns);
  return Eigen::Map<const RowMajor>(array.data(), rows, columns);
}

/// The reasons that came with the outputs, by sample.
std::map<std::int64_t, std::string> reasons_of(const py::object& value) {
  std::map<std::int64_t, std::string> reasons;
  require(py::isinstance<py::dict>(value),
          "the model function returned a pair whose second is {}; a dict from the number of a failed sample to the "
          "reason is needed",
          std::string(py::str(py::type::of(value).attr("__name__"))));
  for (const auto& [sample, reason] : value.cast<py::dict>()) {
    reasons.emplace(sample.cast<std::int64_t>(), std::string(py::str(reason)));
  }
  return reasons;
}

}  // namespace

void PythonModel::ask(const std::function<void()>& request) const {
  if (caller_ == nullptr) throw SystemFailure("the model is a function in Python, which serves it during a job alone");
  caller_->ask(request);
}

Evaluation PythonModel::evaluate(const Eigen::Ref<const Eigen::MatrixXd>& samples, const RunContext& context) const {
  context.throw_if_stopped();
  Evaluation evaluation;
  const auto outputs = static_cast<Eigen::Index>(outputs_.size());
  std::map<std::int64_t, std::string> reasons;
  if (samples.rows() > 0) {
    ask([&] {
      py::object found = function_(Array(py::cast(RowMajor(samples))));
      if (py::isinstance<py::tuple>(found) && py::len(found) == 2) {
        reasons = reasons_of(found.cast<py::tuple>()[1]);
        found = found.cast<py::tuple>()[0];
      }
      evaluation.outputs = matrix_of(found, "the model function", samples.rows(), outputs);
    });
  }
  evaluation.outputs.conservativeResize(samples.rows(), outputs);
  for (Eigen::Index s = 0; s < samples.rows(); ++s) {
    const auto reason = reasons.find(s);
    if (reason == reasons.end() && evaluation.outputs.row(s).allFinite()) continue;
    evaluation.failures.push_back(
        {s, reason != reasons.end() ? reason->second : "the model function returned a value that is not finite"});
    evaluation.outputs.row(s).setConstant(std::nan(""));
  }
  return evaluation;
}

Eigen::MatrixXd DifferentiablePythonModel::jacobian(const Eigen::Ref<const Eigen::VectorXd>& parameters) const {
  Eigen::MatrixXd derivatives;
  ask([&] {
    derivatives = matrix_of(function().attr("jacobian")(Eigen::VectorXd(parameters)), "the model's jacobian",
                            static_cast<Eigen::Index>(outputs().size()), parameter_count());
  });
  return derivatives;
}

}  // namespace mottle::python
