#include "python_model.hpp"

#include <pybind11/eigen.h>
#include <pybind11/numpy.h>
#include <pybind11/stl.h>

#include <cmath>
#include <map>

#include "mottle/core/error.hpp"

namespace mottle::python {
namespace {

namespace py = pybind11;
using RowMajor = Eigen::Matrix<double, Eigen::Dynamic, Eigen::Dynamic, Eigen::RowMajor>;
using Array = py::array_t<double, py::array::c_style | py::array::forcecast>;

/// What the package has checked, as a matrix.
Eigen::MatrixXd matrix_of(const py::object& value) {
  const auto array = value.cast<Array>();
  return Eigen::Map<const RowMajor>(array.data(), array.shape(0), array.shape(1));
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
      const auto found = function_(Array(py::cast(RowMajor(samples)))).cast<py::tuple>();
      evaluation.outputs = matrix_of(found[0]);
      reasons = found[1].cast<std::map<std::int64_t, std::string>>();
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
  ask([&] { derivatives = matrix_of(function().attr("jacobian")(Eigen::VectorXd(parameters))); });
  return derivatives;
}

}  // namespace mottle::python
