// What every updating method is given and what it gives back.
#pragma once

#include <Eigen/Core>
#include <cstdint>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "mottle/core/options.hpp"
#include "mottle/core/run_context.hpp"
#include "mottle/layers.hpp"
#include "mottle/model/model.hpp"
#include "mottle/model/parameters/parameter_space.hpp"
#include "mottle/stats/surrogates/regression.hpp"
#include "mottle/stats/tests/normality.hpp"
#include "mottle/stats/tests/outliers.hpp"
#include "mottle/updating/estimate/mixture_population.hpp"
#include "mottle/updating/estimate/normal_estimates.hpp"
#include "mottle/updating/estimate/posterior.hpp"
#include "mottle/updating/methods/cloud.hpp"

namespace mottle::updating {

/// The tests of all specimens.
struct TestData {
  Eigen::MatrixXd values;             ///< [specimen x output], nan where not measured
  Eigen::VectorXd repeatability_std;  ///< measurement noise of each output, 0 where not known [output]
  /// Degrees of freedom of `repeatability_std` where it comes from repeated tests, 0 where it was given as a number;
  /// empty: 0 for all [output].
  Eigen::VectorXi repeatability_degrees_of_freedom = {};
  /// Standard deviation of the model's own error d, shared by all specimens, z_s = f(x_s) + d + e_s, 0 where none;
  /// empty: none [output].
  Eigen::VectorXd model_error_std = {};
  bool is_model_error_estimated = false;  ///< `model_error_std` is empty, levels of all outputs are estimated
  /// Number by which a reader knows each specimen, from 1, such as the row of its file; empty: 1, 2, ... [specimen].
  std::vector<int> numbers = {};

  int number_of(Eigen::Index specimen) const {
    return numbers.empty() ? static_cast<int>(specimen) + 1 : numbers[static_cast<std::size_t>(specimen)];
  }
  /// Row of the specimen with that number; -1: there is none.
  Eigen::Index find(int number) const;
  /// Variance of the model's error where it is given, else 0 [output].
  Eigen::VectorXd model_error_variance() const;
  bool has_model_error() const { return is_model_error_estimated || !model_error_std.isZero(0.0); }
};

/// Of the search for all solutions: see UpdatingProblem::starts.
inline constexpr int k_usual_starts = 64;
/// As many times the starts are tried where the best solution that they led to was met only once.
inline constexpr int k_more_starts = 2;

/// One updating problem. What it refers to must outlive it.
struct UpdatingProblem {
  const Model& model;
  const DifferentiableModel* derivatives = nullptr;  ///< of the same model; null where it has none
  const ParameterSpace& space;
  TestData tests = {};
  CloudSettings cloud = {};
  int iterations = 30;      ///< most updates that may be made
  double level = 0.05;      ///< false-alarm rate of the verdict's tests
  double tolerance = 1e-3;  ///< converged when no mean and no deviation moves by more than this part of a deviation
  /// Group of each parameter: those of one group may be correlated in the population, those of different groups are
  /// not. Empty: all may be.
  std::vector<int> covariance_groups = {};

  /// Most starting points of the search for all parameters that explain the tests' mean, which ends when two of them
  /// have led to each; 0: no search. 64 miss a solution that a twentieth of them lead to in 4 % of searches.
  int starts = k_usual_starts;

  /// The same problem with another model of the same parameters and outputs, which must outlive it.
  UpdatingProblem with_model(const Model& other, const DifferentiableModel* other_derivatives) const {
    return {other, other_derivatives, space, tests, cloud, iterations, level, tolerance, covariance_groups, starts};
  }
};

/// How a method ended.
enum class UpdatingStatus { converged, max_iterations, stalled, stopped, failed };

/// "converged", "max-iterations", "stalled", "stopped", "failed".
std::string status_text(UpdatingStatus status);

/// 95 % confidence intervals of the population's parameters, on the parameters' own axes.
struct ParameterIntervals {
  Eigen::MatrixXd mean;               ///< lower and upper end [parameter x 2]
  Eigen::MatrixXd std;                ///< [parameter x 2]
  Eigen::MatrixXd correlation_lower;  ///< [parameter x parameter], 1 on the diagonal
  Eigen::MatrixXd correlation_upper;
  std::string made_by;  ///< "analytic" | "bootstrap" | "posterior" | "simulation"
};

/// The model's error as a fit has it. Given the tests, d ~ N(shift, covariance), and the population's mean, on the
/// parameters' scales, moves by gain (d - shift) with it.
struct ModelError {
  Eigen::VectorXd std;                          ///< standard deviation before the tests, given or estimated [output]
  Eigen::VectorXd shift;                        ///< d^, what the tests say of it [output]
  Eigen::MatrixXd covariance;                   ///< of d, the tests given [output x output]
  Eigen::MatrixXd gain;                         ///< [parameter x output]
  std::vector<double> degrees_of_freedom = {};  ///< of each estimated level; empty: given
};

/// What a method knows of every specimen.
struct SpecimenEstimates {
  Eigen::MatrixXd parameters;  ///< [specimen x parameter]
  /// C^-1/2 (z - f(mean)) with the linearised covariance C of a test in the population: each N(0, 1) where the model is
  /// right; nan: missing [specimen x output]
  Eigen::MatrixXd residuals;
  /// Ends of 95 % intervals of `parameters`, of methods that sample them; else empty [specimen x parameter].
  Eigen::MatrixXd lower = {};
  Eigen::MatrixXd upper = {};
};

/// One state of the iteration: the parameters' distribution and the cloud that it gives.
struct IterationRecord {
  Eigen::VectorXd parameter_mean;
  Eigen::MatrixXd parameter_covariance;
  Eigen::VectorXd output_mean;
  Eigen::MatrixXd output_covariance;
  double distance_euclidean = 0.0;    ///< between the means of cloud and tests, in the outputs' unit
  double distance_mahalanobis = 0.0;  ///< the same measured by the tests' covariance, dimensionless
  std::vector<FailedRun> failures;    ///< of the whole cloud
  std::vector<SampleNote> notes;      ///< of the whole cloud: modes that crossed or mixed
  std::int64_t rejected_draws = 0;
  Cloud cloud;  ///< whole in the first and last state, in those between a few samples for drawing
};

/// One statistical test of the updated model against the tests.
struct VerdictTest {
  std::string name;
  double statistic = 0.0;
  double critical = 0.0;  ///< the test fails where the statistic is larger
  double p_value = 1.0;
  bool passed = true;
  std::string meaning = {};  ///< the question it answers, as a sentence
};

/// Whether the specimens come from a normal population.
struct NormalityReport {
  NormalityTest test;                    ///< [parameter], on the parameters' scales
  double level = 0.05;                   ///< of the whole
  bool is_remarkable = false;            ///< it is said in the notes
  std::vector<std::string> suggestions;  ///< what each parameter looks like; empty: normal [parameter]
};

/// Parameters that explain the tests as well as the estimate does.
struct OtherSolution {
  Eigen::VectorXd mean;                ///< [parameter]
  Eigen::VectorXd std = {};            ///< of the population there; empty: the method estimates none [parameter]
  Eigen::MatrixXd mean_interval = {};  ///< ends of 95 % intervals of `mean` [parameter x 2]
  double weight = 0.0;                 ///< its share of the probability, estimate and other solutions together 1
};

/// A search for all solutions: see find_mean_solutions().
struct SolutionSearch {
  int starts = 0;           ///< that were tried; 0: no search
  bool is_settled = false;  ///< each solution was met twice before the starts were used up
};

struct IntervalResult;
struct AbcFindings;

/// What a method found.
struct UpdatingResult {
  UpdatingStatus status = UpdatingStatus::failed;
  std::string message;
  std::shared_ptr<const Estimate> estimate;  ///< of the parameters; null where the method was stopped before it had one
  Eigen::VectorXd mean;                      ///< of `estimate` [parameter]
  Eigen::MatrixXd covariance;                ///< of `estimate` [parameter x parameter]
  std::vector<IterationRecord> history;      ///< first: the prior's cloud; last: the cloud of `estimate`
  Eigen::MatrixXd sensitivity;  ///< dy/dx at `mean`, of a posterior at its peak [output x parameter]; else 0 x 0
  std::int64_t model_evaluations = 0;
  std::optional<ParameterIntervals> intervals = std::nullopt;   ///< of methods that estimate a population
  std::shared_ptr<const SampledPosterior> posterior = nullptr;  ///< of methods that sample one
  std::shared_ptr<const IntervalResult> interval = nullptr;     ///< of methods that find a box
  std::shared_ptr<const MixtureFindings> mixture = nullptr;     ///< of methods that look for batches of specimens
  std::shared_ptr<const AbcFindings> abc = nullptr;             ///< of methods that compare simulated tests
  std::optional<SpecimenEstimates> specimens = std::nullopt;    ///< of methods that look at each specimen
  std::optional<ModelError> model_error = std::nullopt;         ///< of methods that estimate it; see TestData
  std::vector<Outlier> outliers = {};                           ///< specimens that do not belong to the others
  std::optional<NormalityReport> normality = std::nullopt;      ///< of methods that look at each specimen
  std::vector<OtherSolution> other_solutions = {};              ///< that explain the tests' mean as well
  std::optional<SolutionSearch> search = std::nullopt;          ///< of methods that search for all solutions
  /// Bias of `mean` by the curvature of the outputs, in its standard errors, to second order; empty: not known.
  Eigen::VectorXd curvature_bias = {};
  Eigen::MatrixXd noise_covariance;          ///< R as used or estimated [output x output]; else 0 x 0
  bool is_population = false;                ///< `covariance` estimates the scatter of the specimens
  std::vector<VerdictTest> tests;            ///< of the final state, at the problem's level together
  std::vector<std::string> not_tested = {};  ///< sentences: what of the model no test could see, and why
  bool lacks_outputs = false;                ///< parameters can match any outputs, so that these cannot be tested
  std::vector<std::string> notes;            ///< what a reader of the numbers must know
  std::vector<std::string> warnings = {};    ///< notes that cast doubt on the estimate, to be seen at once

  /// Makes `found` the estimate; `mean`, `covariance` and `is_population` follow it.
  void set_estimate(std::shared_ptr<const Estimate> found);
  /// Estimate::location(), of which alone it makes sense to say that it is on a bound [parameter].
  Eigen::VectorXd location() const { return estimate ? estimate->location() : mean; }
};

/// An updating method. One struct of options, one file, one line in src/updating/methods/registry.cpp.
class Updater {
 public:
  virtual ~Updater() = default;

  /// Throws InvalidInput where the problem is not one for this method (says why and what to do instead),
  /// SystemFailure where too many model runs fail.
  virtual UpdatingResult update(const UpdatingProblem& problem, const RunContext& context) const = 0;

  /// The options in force.
  virtual OptionValues options() const = 0;
};

/// A method as the registry knows it.
struct MethodEntry {
  std::string name;
  std::string summary;
  std::vector<OptionDescription> options;
  /// Makes the method from a study's option values; `where` starts each message.
  std::unique_ptr<Updater> (*make)(const OptionValues& values, const std::string& where);
  bool samples_each_iteration = false;  ///< a cloud; the others show the first and the last only
  bool estimates_population = true;     ///< it uses the parameters' scales and UpdatingProblem::covariance_groups
};

/// Every method, in the order of documentation.
const std::vector<MethodEntry>& updating_methods();

/// The method of that name. Throws InvalidInput with the nearest known name.
const MethodEntry& find_method(const std::string& name);

}  // namespace mottle::updating
