// The fits that a diagnosis compares: the same tests, the same noise, other sets of parameters.
#pragma once

#include <Eigen/Core>
#include <string>
#include <utility>
#include <vector>

#include "mottle/layers.hpp"
#include "mottle/updating/diagnosis/diagnosis.hpp"
#include "mottle/updating/methods/iteration.hpp"
#include "updating/diagnosis/candidate_model.hpp"
#include "updating/population/population_fit.hpp"

namespace mottle::updating {

/// A set of parameters: those of the problem that are fitted, and which of them scatter.
struct ParameterSet {
  std::vector<Eigen::Index> members;
  std::vector<bool> has_scatter;

  ParameterSet with(Eigen::Index member, bool is_random) const;
};

/// One fit of a set.
struct SetFit {
  PopulationFit fit;
  Eigen::VectorXd mean;      ///< on the parameters' own axes [member]
  Eigen::VectorXd location;  ///< what their bounds hold for, see Estimate::location() [member]
  Eigen::VectorXd standard_deviation;
  Eigen::MatrixXd covariance;
  Eigen::VectorXd unbounded;  ///< where the mean would be if no bound held it, in the last linear models [member]
  double bound_cost = 0.0;    ///< of log-likelihood there: what the bounds take from it
  Eigen::VectorXd residuals;  ///< as CandidateFit::residuals
  bool is_within = true;      ///< no given parameter on a bound
  std::string failure;        ///< empty: there is a fit
};

/// A linear random-effects problem and where its estimate starts.
struct LinearProblem {
  std::vector<RandomEffectsUnit> units;
  Eigen::MatrixXd start;
  RandomEffectsSettings settings;
};

/// dy/dx of one candidate, on its own axis, at each specimen [output]; nan where the model fails on both sides.
using CandidateEffects = std::vector<Eigen::VectorXd>;

/// Log-likelihood over the set alone, and what follows from it: BIC and p-value, by whether the fit is random.
void note_increase(double log_likelihood_increase, Eigen::Index specimens, CandidateFit& fit);

class CandidateFits {
 public:
  CandidateFits(const UpdatingProblem& problem, const DiagnosisSettings& settings, const RunContext& context);

  /// Plain maximum likelihood of a set.
  ///
  /// @param start  on the scales [member]; empty: the prior's mean
  SetFit fit(const ParameterSet& set, const Eigen::VectorXd& start = {});

  /// Where fits of a set and one candidate beside it start: of some values of the candidate, from nominal to far off,
  /// those at which the set, bounds minded, comes as near to the tests' mean as it can.
  std::vector<Eigen::VectorXd> starts_beside(const ParameterSet& set, const SetFit& base, Eigen::Index candidate);

  /// The best fit of a set and one candidate beside it, from all of these starts.
  SetFit fit_beside(const ParameterSet& set, const SetFit& base, Eigen::Index candidate, bool is_random);

  /// A set's fit and what a candidate beside it gains.
  CandidateFit compare(const ParameterSet& set, const SetFit& base, Eigen::Index candidate, bool is_random,
                       const Eigen::VectorXd& start);

  /// Both kinds of a candidate: fixed from every start, random from the best of them.
  std::pair<CandidateFit, CandidateFit> compare_both(const ParameterSet& set, const SetFit& base,
                                                     Eigen::Index candidate);

  /// dy/dx of every parameter and candidate at the mean of `base` [output x parameter]; nan where the model fails on
  /// both sides.
  Eigen::MatrixXd slope_at(const SetFit& base, const ParameterSet& set);
  /// The effect of a candidate at each specimen of `base`.
  CandidateEffects effects_at_specimens(const SetFit& base, const ParameterSet& set, Eigen::Index candidate);

  /// The linear models at the specimens of `base`: of the set alone, and with a candidate beside it.
  LinearProblem linear_problem(const SetFit& base, const ParameterSet& set) const;
  LinearProblem linear_problem(const SetFit& base, const ParameterSet& set, Eigen::Index candidate, bool is_random,
                               const CandidateEffects& effects) const;

  /// The candidate in the linear models of `base`, fixed or random, whichever has the lower BIC. Its mean is kept
  /// within its bounds, its physical limits and five prior standard deviations. May be called from several threads.
  ///
  /// @param effect  of the candidate, the same for all specimens: a column of slope_at()
  CandidateFit linear_answer(const SetFit& base, const ParameterSet& set, Eigen::Index candidate,
                             const Eigen::VectorXd& effect) const;

  /// Means of the tests less those of a linear random-effects fit, in standard errors of the tests' means [output].
  Eigen::VectorXd residuals_of(const std::vector<RandomEffectsUnit>& units, const RandomEffectsFit& fit) const;

  /// Whether more parameters can be put beside `count`: the noise must stay known or have rows to be estimated from.
  bool has_room_for(Eigen::Index count) const;

  const UpdatingProblem& problem() const { return problem_; }
  const DiagnosisSettings& settings() const { return settings_; }
  const RunContext& context() const { return context_; }
  Eigen::Index specimens() const { return tests_.values.rows(); }
  std::int64_t evaluations() const { return evaluations_; }

 private:
  /// The part of a shift of a candidate's mean that its bounds, physics and five prior standard deviations allow.
  double reachable_shift(Eigen::Index candidate, double shift) const;
  double distance_beside(const ParameterSet& set, const Eigen::VectorXd& nominal, const TestMoments& tests,
                         const Eigen::VectorXd& origin, Eigen::VectorXd& t);
  /// The same of one kind.
  CandidateFit linear_fit(const SetFit& base, const ParameterSet& set, Eigen::Index candidate, bool is_random,
                          const CandidateEffects& effects) const;
  /// dy/dx of some parameters or candidates, the others at their nominal values [output x member], at each sample.
  std::vector<Eigen::MatrixXd> derivatives_at(const Eigen::MatrixXd& samples, const std::vector<Eigen::Index>& members);
  /// The nearest mean that bounds and physical limits allow a candidate.
  double within_limits(Eigen::Index candidate, double mean) const;
  /// Whether a mean lies on the bound or limit that `needed` is beyond.
  bool is_at_limit(Eigen::Index candidate, double needed, double mean) const;
  /// Notes what mean the tests ask for, where a bound or a limit holds it: `cost` is the log-likelihood that this
  /// takes.
  static void note_limit(double needed, double cost, CandidateFit& fit);
  std::vector<int> groups_of(const ParameterSet& set) const;
  PopulationFit fit_from(const UpdatingProblem& part, const ParameterSet& set, const Eigen::VectorXd& start);

  const UpdatingProblem& problem_;
  const DiagnosisSettings& settings_;
  const RunContext& context_;
  std::vector<ShapeSign> signs_;
  TestData tests_;
  NoiseModel noise_;
  NoiseModel model_error_;
  std::int64_t evaluations_ = 0;
};

/// How the tests see every given parameter and candidate at the fit of the given ones, and the cosines between the
/// candidates' own parts; `judging`: directions of the tests' mean that the given parameters, bounds minded, cannot
/// reach.
struct DetectabilityAnalysis {
  std::vector<Detectability> all;  ///< in the order of the problem's parameters
  Eigen::MatrixXd cosines;         ///< [candidate x candidate]
  Eigen::Index judging = 0;
};
/// @param slope  at the mean of `base`, see CandidateFits::slope_at()
DetectabilityAnalysis analyse_detectability(const CandidateFits& fits, const SetFit& base, Eigen::MatrixXd slope);

}  // namespace mottle::updating
