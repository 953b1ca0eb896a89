#include "mottle/updating/diagnosis/diagnosis.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <set>
#include <span>
#include <string>

#include "mottle/core/error.hpp"
#include "updating/diagnosis/candidate_rounds.hpp"
#include "updating/verdict/scatter_tests.hpp"

namespace mottle::updating {
namespace {

constexpr Eigen::Index k_min_specimens = 3;
constexpr std::size_t k_shown = 12;  // of the linear answer, while the fits go on

ParameterSet given_set(Eigen::Index given) {
  ParameterSet set;
  for (Eigen::Index i = 0; i < given; ++i) set.members.push_back(i);
  set.has_scatter.assign(static_cast<std::size_t>(given), true);
  return set;
}

/// Findings of a round on the candidates beside a set, for the reader.
DiagnosisRound round_of(const std::vector<CandidateFinding>& findings, const Diagnosis& diagnosis) {
  DiagnosisRound round;
  for (const ProposedParameter& parameter : diagnosis.proposed) {
    if (!parameter.is_given) round.beside.push_back(parameter.name);
  }
  for (const std::size_t c : best_first(findings)) round.candidates.push_back(findings[c]);
  return round;
}

/// Adds candidates as long as the best one is an explanation.
void propose(CandidateFits& fits, ParameterSet set, SetFit base, std::vector<Eigen::Index> candidates,
             std::vector<CandidateFinding> findings, const std::vector<Detectability>& analysis, Diagnosis& diagnosis) {
  while (!candidates.empty()) {
    const std::size_t best = best_first(findings).front();
    const CandidateFit& better = findings[best].better();
    if (!is_explanation(better, fits.problem().level)) return;
    diagnosis.proposed.push_back({findings[best].detectability.name, false, better.is_random, -better.bic});
    const auto next = static_cast<Eigen::Index>(set.members.size()) + 2;
    const bool is_more_than_seen = next > fits.problem().tests.values.cols();
    if (candidates.size() == 1 || is_more_than_seen || !fits.has_room_for(next)) return;
    const std::size_t number = diagnosis.later_rounds.size() + 2;
    fits.context().phase({.name = "the proposed set"});
    base = fits.fit_beside(set, base, candidates[best], better.is_random);
    if (!base.failure.empty()) return;
    fits.context().finding(fmt::format(
        "{} is proposed (BIC {:+.3g}). Round {}: the other candidates are tried in addition to the proposed set.",
        findings[best].detectability.name, better.bic, number));
    set = set.with(candidates[best], better.is_random);
    candidates.erase(candidates.begin() + static_cast<std::ptrdiff_t>(best));
    const CandidateRound round{number, set, base, candidates, analysis};
    findings = linear_findings(fits, round, fits.slope_at(base, set));
    fit_best(fits, round, findings);
    diagnosis.later_rounds.push_back(round_of(findings, diagnosis));
  }
}

void require_problem(const UpdatingProblem& problem, const DiagnosisSettings& settings) {
  require(settings.given >= 1 && settings.given < problem.space.count(),
          "diagnose: there is no candidate in addition to the {} parameters", settings.given);
  require(problem.tests.values.rows() >= k_min_specimens,
          "diagnose: {} specimens are too few to compare likelihoods; at least {} are needed",
          problem.tests.values.rows(), k_min_specimens);
  require_repeated_outputs(problem.tests, problem.model.outputs());
  const bool is_noise_known = (problem.tests.repeatability_std.array() > 0.0).all();
  require(is_noise_known || (counts_with_scatter(test_moments(problem.tests)).array() > 0).any(),
          "diagnose: the {} specimens are the same to the last digits, so their likelihood has no maximum; give [test] "
          "repeatability of every output, or different specimens",
          problem.tests.values.rows());
}

/// What the fit of the given parameters alone says.
void describe_base(const UpdatingProblem& problem, const SetFit& base, Diagnosis& diagnosis) {
  diagnosis.log_likelihood = base.fit.effects.log_likelihood;
  diagnosis.converged = base.fit.converged;
  diagnosis.mean = base.mean;
  diagnosis.standard_deviation = base.standard_deviation;
  diagnosis.residuals = base.residuals;
  for (const bool converged : base.fit.specimens.converged) diagnosis.unreproduced += converged ? 0 : 1;
  Eigen::VectorXd x = problem.space.prior().mean();
  x.head(base.mean.size()) = base.location;
  const Eigen::VectorXi active = problem.space.active_bounds(x);
  for (Eigen::Index i = 0; i < base.mean.size(); ++i) {
    if (active(i) != 0) diagnosis.at_bound.push_back(problem.space.parameters()[static_cast<std::size_t>(i)].name);
  }
}

/// What the tests see of the given parameters, and the proposal before any candidate.
void describe_given(const DetectabilityAnalysis& analysis, Eigen::Index given, Diagnosis& diagnosis) {
  diagnosis.judging = analysis.judging;
  diagnosis.given.assign(analysis.all.begin(), analysis.all.begin() + given);
  for (const Detectability& each : diagnosis.given) diagnosis.proposed.push_back({each.name});
  std::stable_sort(diagnosis.given.begin(), diagnosis.given.end(), [](const Detectability& a, const Detectability& b) {
    return a.visibility * a.own_share > b.visibility * b.own_share;
  });
}

/// The candidates' findings, best first, and which explain as well as the best.
void describe_candidates(const std::vector<CandidateFinding>& findings, const Eigen::MatrixXd& cosines,
                         const DiagnosisSettings& settings, double level, Diagnosis& diagnosis) {
  const std::vector<std::size_t> order = best_first(findings);
  const CandidateFinding& best = findings[order.front()];
  const bool is_answered = diagnosis.is_linear || best.is_fitted();
  diagnosis.is_explained = is_answered && is_explanation(best.answer(), level);
  std::vector<Eigen::Index> rows;
  std::set<std::string> alike;
  for (const std::size_t c : order) {
    const CandidateFinding& finding = findings[c];
    diagnosis.candidates.push_back(finding);
    rows.push_back(static_cast<Eigen::Index>(c));
    const bool is_comparable = finding.is_fitted() == best.is_fitted() && finding.answer().failure.empty();
    const bool is_as_good = finding.answer().bic <= best.answer().bic + settings.like_evidence &&
                            finding.answer().is_possible == best.answer().is_possible;
    if (!(is_comparable && is_as_good) && c != order.front()) continue;
    alike.insert(finding.detectability.name);
    alike.insert(finding.inseparable.begin(), finding.inseparable.end());
  }
  for (const CandidateFinding& finding : diagnosis.candidates) {
    if (alike.contains(finding.detectability.name)) diagnosis.alike.push_back(finding.detectability.name);
  }
  diagnosis.cosines = cosines(rows, rows);
}

/// The best of the linear answer, told while the fits go on.
void tell(const Diagnosis& linear, double level, const RunContext& context) {
  context.finding(diagnosis_headline(linear, level));
  const std::size_t shown = std::min(linear.candidates.size(), k_shown);
  for (const CandidateFinding& finding : std::span(linear.candidates).first(shown)) {
    const CandidateFit& fit = finding.linear;
    if (!fit.failure.empty()) continue;
    const std::string needed =
        fit.is_possible ? "" : fmt::format("; it would need {:.4g}, which cannot be", fit.needed);
    context.finding(fmt::format("{}: log-likelihood {:+.3g}, BIC {:+.3g} (linear){}", finding.detectability.name,
                                fit.log_likelihood_increase, fit.bic, needed));
  }
}

}  // namespace

Diagnosis diagnose(const UpdatingProblem& problem, const DiagnosisSettings& settings, const RunContext& context,
                   const std::function<void(const Diagnosis&)>& linear_answer) {
  require_problem(problem, settings);
  CandidateFits fits(problem, settings, context);
  const ParameterSet set = given_set(settings.given);
  context.phase({.name = "the given parameters alone"});
  const SetFit base = fits.fit(set);
  if (!base.failure.empty()) throw ModelFailure(base.failure);
  Diagnosis diagnosis;
  diagnosis.inseparable_degrees = settings.inseparable_degrees;
  describe_base(problem, base, diagnosis);
  context.phase({.name = "sensitivities to all candidates"});
  const Eigen::MatrixXd slope = fits.slope_at(base, set);
  const DetectabilityAnalysis analysis = analyse_detectability(fits, base, slope);
  describe_given(analysis, settings.given, diagnosis);
  std::vector<Eigen::Index> candidates;
  for (Eigen::Index i = settings.given; i < problem.space.count(); ++i) candidates.push_back(i);
  const CandidateRound round{1, set, base, candidates, analysis.all};
  std::vector<CandidateFinding> findings = linear_findings(fits, round, slope);
  name_inseparable(analysis.cosines, settings, findings);

  const Eigen::Index outputs = problem.tests.values.cols();
  Diagnosis linear = diagnosis;
  linear.is_linear = true;
  describe_candidates(findings, analysis.cosines, settings, problem.level, linear);
  linear.model_evaluations = fits.evaluations();
  linear.sentences = diagnosis_sentences(linear, outputs, problem.level);
  tell(linear, problem.level, context);
  if (linear_answer) linear_answer(linear);

  fit_best(fits, round, findings);
  name_inseparable(analysis.cosines, settings, findings);
  describe_candidates(findings, analysis.cosines, settings, problem.level, diagnosis);
  propose(fits, set, base, candidates, findings, analysis.all, diagnosis);
  diagnosis.model_evaluations = fits.evaluations();
  diagnosis.sentences = diagnosis_sentences(diagnosis, outputs, problem.level);
  return diagnosis;
}

}  // namespace mottle::updating
