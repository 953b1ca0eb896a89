// A model that is a function in Python.
#pragma once

#include <pybind11/pybind11.h>

#include <string>
#include <vector>

#include "calling_thread.hpp"
#include "mottle/mottle.hpp"

namespace mottle::python {

/// Calls function(samples) on the calling thread with one array a batch [sample x parameter]; it returns the outputs
/// [sample x output], or a pair of them and a dict from sample to the reason of its failure. A row that is not finite
/// has failed.
class PythonModel : public Model {
 public:
  /// @param caller    serves the calls; null while no job runs
  PythonModel(pybind11::object function, Eigen::Index parameters, std::vector<Quantity> outputs)
      : function_(std::move(function)), parameters_(parameters), outputs_(std::move(outputs)) {}

  Eigen::Index parameter_count() const override { return parameters_; }
  const std::vector<Quantity>& outputs() const override { return outputs_; }
  /// Throws InvalidInput: what the function returned is no array of the shape that is needed; Stopped: it raised.
  Evaluation evaluate(const Eigen::Ref<const Eigen::MatrixXd>& samples, const RunContext& context) const override;

  /// Who serves the calls of the job that begins; null: none runs.
  void serve_by(CallingThread* caller) { caller_ = caller; }

 protected:
  const pybind11::object& function() const { return function_; }
  /// Runs `request` where Python may be called.
  void ask(const std::function<void()>& request) const;

 private:
  pybind11::object function_;
  Eigen::Index parameters_;
  std::vector<Quantity> outputs_;
  CallingThread* caller_ = nullptr;
};

/// One whose function has an attribute `jacobian`: jacobian(parameters) -> dy/dx [output x parameter].
class DifferentiablePythonModel final : public PythonModel, public DifferentiableModel {
 public:
  using PythonModel::PythonModel;
  Eigen::MatrixXd jacobian(const Eigen::Ref<const Eigen::VectorXd>& parameters) const override;
};

}  // namespace mottle::python
