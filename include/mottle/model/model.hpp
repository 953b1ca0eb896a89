// What every model of a structure offers to the methods: named outputs of a batch of parameter vectors.
#pragma once

#include <Eigen/Core>
#include <cstdint>
#include <string>
#include <vector>

#include "mottle/core/run_context.hpp"

namespace mottle {

/// One quantity that the model predicts and a test measures.
struct Output {
  std::string name;  ///< as in the header of a test file: f1, phi1:m2, zeta1
  std::string unit;  ///< "Hz", "1/sqrt(kg)", "-"
};

/// One model run that gave no result.
struct FailedRun {
  Eigen::Index sample = 0;
  std::string reason;
};

/// Something worth knowing about a run that did give a result: modes that crossed or mixed.
struct SampleNote {
  Eigen::Index sample = 0;
  std::string text;
};

/// Outputs of a batch. A failed run is a row of nan and an entry in `failures`, never an exception.
struct Evaluation {
  Eigen::MatrixXd outputs;             ///< [sample x output]
  std::vector<FailedRun> failures;     ///< ascending in sample
  std::vector<SampleNote> notes = {};  ///< ascending in sample
};

/// A structure with q uncertain parameters x and p outputs y = f(x).
class Model {
 public:
  virtual ~Model() = default;

  virtual Eigen::Index parameter_count() const = 0;
  virtual const std::vector<Output>& outputs() const = 0;

  /// Evaluates every row of `samples` [sample x parameter]. A row's result depends on that row alone.
  virtual Evaluation evaluate(const Eigen::Ref<const Eigen::MatrixXd>& samples, const RunContext& context) const = 0;

  /// The parts of a batch that may be lost when a run is killed: about so many samples.
  virtual Eigen::Index batch_size() const { return 8192; }
};

/// A model that knows its own derivatives: a second interface, found by dynamic_cast.
class DifferentiableModel {
 public:
  virtual ~DifferentiableModel() = default;

  /// dy/dx at `parameters` [parameter]: [output x parameter]; nan where no analytic derivative is to be had
  /// (frequency or shape of a repeated eigenvalue, frequency zero, damping ratio): the caller takes differences there.
  virtual Eigen::MatrixXd jacobian(const Eigen::Ref<const Eigen::VectorXd>& parameters) const = 0;
};

}  // namespace mottle
