// What every model of a structure offers to the methods: named outputs of a batch of parameter vectors.
#pragma once

#include <Eigen/Core>
#include <algorithm>
#include <cstdint>
#include <string>
#include <vector>

#include "mottle/core/run_context.hpp"
#include "mottle/layers.hpp"
#include "mottle/model/quantity.hpp"

namespace mottle::model {

class SampleRegion;

/// One model run that gave no result.
struct FailedRun {
  Eigen::Index sample = 0;
  std::string reason;
};

/// A remark on a successful run: modes that crossed or veered.
struct SampleNote {
  Eigen::Index sample = 0;
  std::string text;
};

/// How the modes of a batch were found.
struct SolverUse {
  std::int64_t reduced = 0;      ///< samples solved by the reduced model, each with a bound on its error
  std::int64_t refined = 0;      ///< of them those that took steps with the nominal factor
  std::int64_t exact = 0;        ///< samples solved with the full matrices
  std::int64_t basis = 0;        ///< vectors of the largest reduced basis
  double frequency_error = 0.0;  ///< the largest bound on a frequency's relative error among the reduced ones
  double reduced_seconds = 0.0;  ///< processor time of the reduced model, its construction included
  double exact_seconds = 0.0;    ///< and of one exact solution; 0: not known
  std::int64_t runs = 0;         ///< samples that an external solver was to run
  std::int64_t repeated = 0;     ///< of them those whose results were there from a run before

  SolverUse& operator+=(const SolverUse& other) {
    reduced += other.reduced;
    refined += other.refined;
    exact += other.exact;
    basis = std::max(basis, other.basis);
    frequency_error = std::max(frequency_error, other.frequency_error);
    reduced_seconds += other.reduced_seconds;
    exact_seconds = std::max(exact_seconds, other.exact_seconds);
    runs += other.runs;
    repeated += other.repeated;
    return *this;
  }
};

/// Outputs of a batch. A failed run is a row of nan and an entry in `failures`, never an exception.
struct Evaluation {
  Eigen::MatrixXd outputs;             ///< [sample x output]
  std::vector<FailedRun> failures;     ///< ascending in sample
  std::vector<SampleNote> notes = {};  ///< ascending in sample
  SolverUse use = {};
};

/// Relative step of central differences for outputs accurate to rounding: balances truncation (h^2) and rounding
/// (eps / h).
inline constexpr double k_usual_difference_step = 1e-4;

/// The same for outputs within a tolerance (a reduced model) or of few digits (a solver's printed tables).
inline constexpr double k_coarse_difference_step = 0.05;

/// A structure with q uncertain parameters x and p outputs y = f(x).
class Model {
 public:
  virtual ~Model() = default;

  virtual Eigen::Index parameter_count() const = 0;
  virtual const std::vector<Quantity>& outputs() const = 0;

  /// Evaluates every row of `samples` [sample x parameter]. A row's result depends on that row alone, but for models
  /// that answer within a tolerance: there on the batch that it is in, and on nothing before.
  virtual Evaluation evaluate(const Eigen::Ref<const Eigen::MatrixXd>& samples, const RunContext& context) const = 0;

  /// The same where the caller knows in which region these and further samples lie: a model that answers within a
  /// tolerance adapts itself to it. A batch's results depend on the batch and the region, and on nothing before.
  virtual Evaluation evaluate_in(const SampleRegion& /*region*/, const Eigen::Ref<const Eigen::MatrixXd>& samples,
                                 const RunContext& context) const {
    return evaluate(samples, context);
  }

  /// Whether evaluate_in() differs from evaluate().
  virtual bool adapts_to_regions() const { return false; }

  /// Number of samples after which results are saved: about so many may be lost when a run is killed.
  virtual Eigen::Index batch_size() const { return 8192; }

  /// Step of central differences in prior standard deviations: small against curvature, large against the error of
  /// outputs.
  virtual double difference_step() const { return k_usual_difference_step; }
};

/// A model that knows its own derivatives: a second interface, found by dynamic_cast.
class DifferentiableModel {
 public:
  virtual ~DifferentiableModel() = default;

  /// dy/dx at `parameters` [parameter]: [output x parameter]; nan where no analytic derivative is to be had
  /// (frequency or shape of a repeated eigenvalue, frequency zero, damping ratio): the caller takes differences there.
  virtual Eigen::MatrixXd jacobian(const Eigen::Ref<const Eigen::VectorXd>& parameters) const = 0;

  /// Whether a Jacobian costs no more than the evaluations of central differences. Not where evaluations come from a
  /// reduced model and the Jacobian from the full matrices.
  virtual bool has_cheap_jacobian() const { return true; }
};

}  // namespace mottle::model
