// One round of a diagnosis: every candidate beside a set of parameters, all in the linear model, the best ones in the
// model itself.
#pragma once

#include <Eigen/Core>
#include <cstddef>
#include <vector>

#include "mottle/layers.hpp"
#include "updating/diagnosis/candidate_fits.hpp"

namespace mottle::updating {

/// What the candidates of a round are tried beside.
struct CandidateRound {
  std::size_t number = 1;
  const ParameterSet& set;
  const SetFit& base;  ///< of the set alone
  const std::vector<Eigen::Index>& candidates;
  const std::vector<Detectability>& analysis;  ///< of all parameters and candidates of the problem
};

/// The linear answer of every candidate, in the order of the round's candidates; none is fitted.
///
/// @param slope  at the mean of the round's base, see CandidateFits::slope_at()
std::vector<CandidateFinding> linear_findings(const CandidateFits& fits, const CandidateRound& round,
                                              const Eigen::MatrixXd& slope);

/// Fits candidates in the model itself, in the order of their linear answers: all where there are no more than
/// `screened` (half of it from the second round on), else the best ones, and none that could not become significant.
/// Of candidates that cannot be told apart only the best one is fitted then.
void fit_best(CandidateFits& fits, const CandidateRound& round, std::vector<CandidateFinding>& findings);

/// Order of the findings: candidates that are fitted first, those that need an impossible value after the others, and
/// then by BIC.
std::vector<std::size_t> best_first(const std::vector<CandidateFinding>& findings);

/// Whether a candidate lowers BIC, significantly after Holm's correction, with a value that it can have.
bool is_explanation(const CandidateFit& answer, double level);

/// Names the candidates that cannot be told apart: their effects form an angle of at most `inseparable_degrees`, and
/// their BIC differ by `like_evidence` at most.
///
/// @param cosines  between the candidates' own parts, in the order of the findings
void name_inseparable(const Eigen::MatrixXd& cosines, const DiagnosisSettings& settings,
                      std::vector<CandidateFinding>& findings);

}  // namespace mottle::updating
