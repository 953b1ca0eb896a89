// Which parameter is missing: candidates that are not updated, each tried beside the parameters that are.
#pragma once

#include <Eigen/Core>
#include <functional>
#include <limits>
#include <string>
#include <vector>

#include "mottle/layers.hpp"
#include "mottle/updating/methods/updater.hpp"

namespace mottle::updating {

/// How a diagnosis is made.
struct DiagnosisSettings {
  Eigen::Index given = 0;  ///< the first so many of the problem's parameters are updated, the others candidates
  int screened = 12;      ///< most candidates that are fitted in the model itself; of more, those best by linear models
  bool fits_all = false;  ///< all candidates are fitted in the first round, however many
  double like_evidence = 6.0;  ///< candidates whose BIC is no more than this above the best one's count as alike
  /// Candidates whose effects on the outputs, apart from what the given parameters can reproduce, form no larger angle
  /// than this cannot be told apart.
  double inseparable_degrees = 5.0;
  double rank_tolerance = 1e-3;
};

/// One candidate put beside the parameters: with a mean of its own that all specimens share (fixed), or a mean and a
/// scatter (random).
struct CandidateFit {
  bool is_random = false;
  double log_likelihood_increase = 0.0;  ///< of the log-likelihood over the parameters alone
  double bic = 0.0;                      ///< BIC less that of the parameters alone; negative: better
  double p_value = 1.0;                  ///< of the likelihood ratio
  double adjusted_p = 1.0;               ///< after Holm, over all candidates and both kinds
  double mean = 0.0;                     ///< of the candidate, on its own axis, within its bounds and physical limits
  double standard_deviation = 0.0;       ///< of the candidate
  /// The mean that the tests ask for, where a bound or a physical limit holds it; nan: none does.
  double needed = std::numeric_limits<double>::quiet_NaN();
  bool is_possible = true;    ///< false: the tests refuse the bound or limit that holds the mean, at a level of 5 %
  Eigen::VectorXd residuals;  ///< means of the tests less those of the fit, in standard errors of the former [output]
  bool is_within = true;      ///< no given parameter's mean lies on a bound
  bool converged = false;
  std::string failure;  ///< why there is no fit; empty: there is
};

/// What one parameter or candidate is to the tests.
struct Detectability {
  std::string name;
  double nominal = 0.0;     ///< prior mean
  double scale = 0.0;       ///< prior deviation
  double visibility = 0.0;  ///< by how many standard errors of the tests' mean one prior deviation moves it
  double own_share = 0.0;   ///< part of that which the (other) given parameters cannot imitate, 0 to 1
  double inflation = 1.0;   ///< variance inflation, 1 / own_share^2
};

/// A candidate and all that is known of it.
struct CandidateFinding {
  Detectability detectability;
  CandidateFit linear;  ///< in the linear model at the fit of the parameters: the better of both kinds
  CandidateFit fixed;
  CandidateFit random;
  bool is_screened_out = false;          ///< tried in the linear model only, and not among the best there
  std::vector<std::string> inseparable;  ///< other candidates that the tests cannot tell from this one
  double bic() const { return random.bic < fixed.bic ? random.bic : fixed.bic; }
  const CandidateFit& better() const { return random.bic < fixed.bic ? random : fixed; }
  bool is_fitted() const { return better().failure.empty(); }
  /// What is known best of it: the fit in the model itself, else the linear answer.
  const CandidateFit& answer() const { return is_fitted() ? better() : linear; }
};

/// One parameter of the set that is proposed.
struct ProposedParameter {
  std::string name;
  bool is_given = true;
  bool is_random = true;  ///< false: its mean is to be moved, it has no scatter of its own
  double bic = 0.0;       ///< by which it lowered BIC when it was added
};

/// A later round of forward selection: the remaining candidates, each tried in addition to the parameters and to what
/// earlier rounds proposed.
struct DiagnosisRound {
  std::vector<std::string> beside;           ///< what earlier rounds proposed
  std::vector<CandidateFinding> candidates;  ///< best explanation first
};

/// Answer of diagnose().
struct Diagnosis {
  bool is_linear = false;       ///< the linear answer: no candidate is fitted in the model itself yet
  double log_likelihood = 0.0;  ///< of the parameters alone
  bool converged = false;       ///< and whether their fit came to rest
  Eigen::VectorXd mean;         ///< of the parameters alone, on their own axes
  Eigen::VectorXd standard_deviation;
  Eigen::VectorXd residuals;                 ///< of the parameters alone, as CandidateFit::residuals
  std::vector<std::string> at_bound;         ///< parameters whose mean lies on a bound, without candidates
  int unreproduced = 0;                      ///< specimens that no parameters reproduce
  Eigen::Index judging = 0;                  ///< directions of the tests' mean that the given parameters cannot reach
  std::vector<Detectability> given;          ///< most visible first
  std::vector<CandidateFinding> candidates;  ///< best explanation first
  std::vector<std::string> alike;            ///< candidates that explain as well as the best, itself included
  Eigen::MatrixXd cosines;                   ///< between the candidates' own parts, in the order of `candidates`
  double inseparable_degrees = 5.0;          ///< the angle up to which candidates cannot be told apart
  bool is_explained = false;                 ///< the best candidate's gain is significant
  std::vector<DiagnosisRound> later_rounds;  ///< from the second on
  std::vector<ProposedParameter> proposed;
  std::vector<std::string> sentences;
  std::int64_t model_evaluations = 0;
};

/// Fits the population (plain maximum likelihood) with the parameters alone, with each candidate's mean beside them,
/// and with its mean and an independent scatter, and compares the likelihoods of the same tests:
///
///   BIC = -2 log L + k log n;   p of 2 (log L1 - log L0): chi-squared with 1 degree of freedom (mean), equal mixture
///   of 1 and 2 (mean and scatter, whose zero lies on the border); Holm's correction over all tries
///
/// A parameter held on its bound and a specimen that cannot be reproduced both lower L: the candidate that mends it
/// gains. Shapes are turned to the tests' sign before they are compared. Then forward selection by BIC proposes a set.
/// Before any of these fits all candidates are compared in the linear model at the fit of the parameters alone, and
/// what this says is handed to `linear_answer`.
///
/// @param problem  its space: the given parameters first, then the candidates at their nominal values (prior means);
///                 covariance_groups: of the given parameters, or empty
/// @throws InvalidInput  no candidate, fewer than 3 specimens, noise unknown where it would decide everything
/// Source: [Schwarz1978]; [Holm1979]; [Self1987] for the mixture.
Diagnosis diagnose(const UpdatingProblem& problem, const DiagnosisSettings& settings, const RunContext& context,
                   const std::function<void(const Diagnosis&)>& linear_answer = {});

/// The answer in one sentence.
std::string diagnosis_headline(const Diagnosis& diagnosis, double level);
/// Sentences of a diagnosis, in plain words.
std::vector<std::string> diagnosis_sentences(const Diagnosis& diagnosis, Eigen::Index outputs, double level);

}  // namespace mottle::updating
