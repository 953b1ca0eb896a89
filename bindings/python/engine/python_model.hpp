// A model that is a function in Python.
#pragma once

#include <pybind11/pybind11.h>

#include <string>
#include <vector>

#include "calling_thread.hpp"
#include "mottle/mottle.hpp"

namespace mottle::python {

/// Calls function(samples) on the calling thread with one array a batch [sample x parameter]; it returns a pair of the
/// outputs [sample x output] and a dict from sample to the reason of its failure, as mottle/_model.py has checked them.
/// A row that is not finite has failed.
class PythonModel : public Model {
 public:
  /// What is asked of it.
  struct Manner {
    Eigen::Index batch = 0;        ///< most samples of one call
    double difference_step = 0.0;  ///< in prior standard deviations
  };

  PythonModel(pybind11::object function, Eigen::Index parameters, std::vector<Quantity> outputs, Manner manner)
      : function_(std::move(function)), parameters_(parameters), outputs_(std::move(outputs)), manner_(manner) {}

  Eigen::Index parameter_count() const override { return parameters_; }
  const std::vector<Quantity>& outputs() const override { return outputs_; }
  Eigen::Index batch_size() const override { return manner_.batch; }
  double difference_step() const override { return manner_.difference_step; }
  /// Throws Stopped: the function raised.
  Evaluation evaluate(const Eigen::Ref<const Eigen::MatrixXd>& samples, const RunContext& context) const override;

  /// Who serves the calls of the job that begins.
  void serve_by(CallingThread* caller) { caller_ = caller; }
  /// No job asks any more: the function is let go, which may hold the job's result itself.
  void let_go() {
    caller_ = nullptr;
    function_ = pybind11::object();
  }

 protected:
  const pybind11::object& function() const { return function_; }
  /// Runs `request` where Python may be called.
  void ask(const std::function<void()>& request) const;

 private:
  pybind11::object function_;
  Eigen::Index parameters_;
  std::vector<Quantity> outputs_;
  Manner manner_;
  CallingThread* caller_ = nullptr;
};

/// One whose function has an attribute `jacobian`: jacobian(parameters) -> dy/dx [output x parameter], finite.
class DifferentiablePythonModel final : public PythonModel, public DifferentiableModel {
 public:
  using PythonModel::PythonModel;
  Eigen::MatrixXd jacobian(const Eigen::Ref<const Eigen::VectorXd>& parameters) const override;
};

}  // namespace mottle::python
