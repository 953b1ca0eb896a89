#include "mottle/updating/diagnosis/diagnosis.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <numeric>
#include <span>
#include <tuple>

#include "mottle/core/error.hpp"
#include "mottle/stats/distributions/chi_squared.hpp"
#include "updating/diagnosis/candidate_reference.hpp"
#include "updating/verdict/scatter_tests.hpp"

namespace mottle::updating {
namespace {

constexpr Eigen::Index k_min_specimens = 3;
constexpr Eigen::Index k_many_specimens = 30;  // chi-squared serves from there on
// Candidates that are fitted in the model itself whatever the linear models say. Once the set explains the tests
// better, its linear models are at the right place: the best of them is evidence enough.
constexpr std::size_t k_min_fitted = 3;
constexpr std::size_t k_min_fitted_later = 1;
constexpr std::size_t k_shown = 6;  // of the linear models, while the fits go on

ParameterSet given_set(Eigen::Index given) {
  ParameterSet set;
  for (Eigen::Index i = 0; i < given; ++i) set.members.push_back(i);
  set.has_scatter.assign(static_cast<std::size_t>(given), true);
  return set;
}

/// Holm's adjusted p-values of all tries; what was not tried counts as a try with p = 1.
void adjust(std::vector<CandidateFinding>& findings) {
  std::vector<CandidateFit*> tries;
  for (CandidateFinding& finding : findings) {
    tries.push_back(&finding.fixed);
    tries.push_back(&finding.random);
  }
  std::stable_sort(tries.begin(), tries.end(),
                   [](const CandidateFit* a, const CandidateFit* b) { return a->p_value < b->p_value; });
  double largest = 0.0;
  for (std::size_t i = 0; i < tries.size(); ++i) {
    largest = std::max(largest, static_cast<double>(tries.size() - i) * tries[i]->p_value);
    tries[i]->adjusted_p = std::min(largest, 1.0);
  }
}

CandidateFit not_tried(bool is_random, const std::string& why) {
  CandidateFit fit;
  fit.is_random = is_random;
  fit.bic = std::numeric_limits<double>::infinity();
  fit.failure = why;
  return fit;
}

/// Derivatives at the specimens of a fit, computed when somebody first asks.
class SpecimenDerivatives {
 public:
  SpecimenDerivatives(CandidateFits& fits, const ParameterSet& set, const SetFit& base)
      : fits_(fits), set_(set), base_(base) {}

  const std::vector<Eigen::MatrixXd>& get() {
    if (found_.empty()) found_ = fits_.derivatives_at(base_, set_);
    return found_;
  }

 private:
  CandidateFits& fits_;
  const ParameterSet& set_;
  const SetFit& base_;
  std::vector<Eigen::MatrixXd> found_;
};

/// Significance of tries by replications where specimens are few: only of those that chi-squared calls significant, it
/// errs to that side.
void refer_small_samples(const CandidateFits& fits, const ParameterSet& set, const SetFit& base,
                         SpecimenDerivatives& derivatives, const std::vector<Eigen::Index>& candidates,
                         std::vector<CandidateFinding>& findings) {
  if (fits.specimens() >= k_many_specimens) return;
  std::vector<CandidateTry> tries;
  for (std::size_t c = 0; c < findings.size(); ++c) {
    for (CandidateFit* fit : {&findings[c].fixed, &findings[c].random}) {
      const bool is_significant = fit->failure.empty() && fit->adjusted_p <= fits.problem().level;
      if (is_significant) tries.push_back({candidates[c], fit});
    }
  }
  if (tries.empty()) return;
  refer_to_replications(fits, set, base, derivatives.get(), candidates.size(), tries);
  adjust(findings);
}

/// A candidate and by how much it increases the log-likelihood in the linear models.
struct Screened {
  std::size_t index = 0;
  double increase = std::numeric_limits<double>::infinity();  ///< infinite: not screened, to be fitted anyway
};

/// The order in which candidates are fitted in the model itself: as given where there are no more than `most`, else by
/// linear models.
std::vector<Screened> screen(CandidateFits& fits, const ParameterSet& set, const SetFit& base,
                             SpecimenDerivatives& derivatives, const std::vector<Eigen::Index>& candidates,
                             std::size_t most) {
  std::vector<Screened> order(candidates.size());
  for (std::size_t c = 0; c < candidates.size(); ++c) order[c].index = c;
  if (candidates.size() <= most) return order;
  fits.context().phase({.name = "candidates in linear models"});
  for (Screened& each : order) {
    fits.context().throw_if_stopped();
    fits.context().progress("candidates", static_cast<std::int64_t>(each.index),
                            static_cast<std::int64_t>(candidates.size()));
    each.increase = fits.linear_gain(base, set, candidates[each.index], derivatives.get());
  }
  std::stable_sort(order.begin(), order.end(),
                   [](const Screened& a, const Screened& b) { return a.increase > b.increase; });
  const std::size_t shown = std::min(order.size(), k_shown);
  for (const Screened& each : std::span(order).first(shown)) {
    const Parameter& parameter = fits.problem().space.parameters()[static_cast<std::size_t>(candidates[each.index])];
    fits.context().finding(
        fmt::format("{}: increases the log-likelihood by {:.3g} in the linear models", parameter.name, each.increase));
  }
  return order;
}

/// The increase in the linear models from which on a candidate is worth a fit in the model itself: twice as much could
/// be significant after Holm's correction, and within `like_evidence` of the best fit so far.
double worthwhile_increase(const CandidateFits& fits, std::size_t candidates, double best) {
  const double tries = 2.0 * static_cast<double>(candidates);
  const double significant = 0.5 * chi_squared_quantile(1.0 - fits.problem().level / tries, 1.0);
  return 0.5 * std::max(significant, best - 0.5 * fits.settings().like_evidence);
}

/// The two fits of a candidate beside a set, told as soon as they are known.
void fit_candidate(CandidateFits& fits, const ParameterSet& set, const SetFit& base, Eigen::Index candidate,
                   CandidateFinding& finding) {
  std::tie(finding.fixed, finding.random) = fits.compare_both(set, base, candidate);
  for (CandidateFit* fit : {&finding.fixed, &finding.random}) {
    if (!fit->failure.empty()) fit->bic = std::numeric_limits<double>::infinity();
  }
  const CandidateFit& better = finding.better();
  if (!better.failure.empty()) return;
  fits.context().finding(fmt::format("{}: {} effect, log-likelihood {:+.3g}, BIC {:+.3g}", finding.detectability.name,
                                     better.is_random ? "random" : "fixed", better.log_likelihood_increase,
                                     better.bic));
}

/// Every candidate beside a set, in the order of `candidates`; in the first round at least `k_min_fitted` in the model
/// itself.
std::vector<CandidateFinding> try_all(CandidateFits& fits, const ParameterSet& set, const SetFit& base,
                                      const std::vector<Eigen::Index>& candidates,
                                      const std::vector<Detectability>& analysis, std::size_t round) {
  const std::size_t min_fitted = round == 1 ? k_min_fitted : k_min_fitted_later;
  const std::string phase = fmt::format("round {}, candidate in the model", round);
  SpecimenDerivatives derivatives(fits, set, base);
  // Later rounds only look for the best one, which linear models at the right place rank well.
  const auto screened = static_cast<std::size_t>(fits.settings().screened);
  const std::size_t most = std::min(candidates.size(), round == 1 ? screened : (screened + 1) / 2);
  const std::vector<Screened> order = screen(fits, set, base, derivatives, candidates, most);
  std::vector<CandidateFinding> findings(candidates.size());
  std::size_t fitted = 0;
  double best = 0.0;
  for (const auto& [index, increase] : order) {
    fits.context().throw_if_stopped();
    CandidateFinding& finding = findings[index];
    finding.detectability = analysis[static_cast<std::size_t>(candidates[index])];
    const bool is_worth_it = fitted < min_fitted || increase >= worthwhile_increase(fits, candidates.size(), best);
    finding.is_screened_out = fitted >= most || !is_worth_it;
    if (finding.is_screened_out || !(finding.detectability.visibility > 0.0)) {
      const std::string why = finding.detectability.visibility > 0.0
                                  ? "less increase of the log-likelihood in the linear models"
                                  : "no effect on any output";
      finding.fixed = not_tried(false, why);
      finding.random = not_tried(true, why);
      continue;
    }
    fits.context().phase({.name = phase,
                          .step = static_cast<std::int64_t>(fitted) + 1,
                          .steps = static_cast<std::int64_t>(most),
                          .may_end_early = order.front().increase < std::numeric_limits<double>::infinity()});
    fit_candidate(fits, set, base, candidates[index], finding);
    best = std::max(best, finding.better().log_likelihood_increase);
    ++fitted;
  }
  adjust(findings);
  refer_small_samples(fits, set, base, derivatives, candidates, findings);
  return findings;
}

std::vector<std::size_t> best_first(const std::vector<CandidateFinding>& findings) {
  std::vector<std::size_t> order(findings.size());
  std::iota(order.begin(), order.end(), std::size_t{0});
  std::stable_sort(order.begin(), order.end(),
                   [&](std::size_t a, std::size_t b) { return findings[a].bic() < findings[b].bic(); });
  return order;
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

/// Adds candidates as long as the best one lowers BIC and its gain is significant.
void propose(CandidateFits& fits, ParameterSet set, SetFit base, std::vector<Eigen::Index> candidates,
             std::vector<CandidateFinding> findings, const std::vector<Detectability>& analysis, Diagnosis& diagnosis) {
  const double level = fits.problem().level;
  while (!candidates.empty()) {
    const std::size_t best = best_first(findings).front();
    const CandidateFit& better = findings[best].better();
    if (!(better.bic < 0.0) || better.adjusted_p > level) return;
    diagnosis.proposed.push_back({findings[best].detectability.name, false, better.is_random, -better.bic});
    const auto next = static_cast<Eigen::Index>(set.members.size()) + 2;
    const bool is_more_than_seen = next > fits.problem().tests.values.cols();
    if (candidates.size() == 1 || is_more_than_seen || !fits.has_room_for(next)) return;
    const std::size_t round = diagnosis.later_rounds.size() + 2;
    fits.context().phase({.name = "the proposed set"});
    base = fits.fit_beside(set, base, candidates[best], better.is_random);
    if (!base.failure.empty()) return;
    fits.context().finding(fmt::format(
        "{} is proposed (BIC {:+.3g}). Round {}: the other candidates are tried in addition to the proposed set.",
        findings[best].detectability.name, better.bic, round));
    set = set.with(candidates[best], better.is_random);
    candidates.erase(candidates.begin() + static_cast<std::ptrdiff_t>(best));
    findings = try_all(fits, set, base, candidates, analysis, round);
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
  for (const bool converged : base.fit.specimens.converged) diagnosis.unreproduced += converged ? 0 : 1;
  Eigen::VectorXd x = problem.space.prior().mean();
  x.head(base.mean.size()) = base.location;
  const Eigen::VectorXi active = problem.space.active_bounds(x);
  for (Eigen::Index i = 0; i < base.mean.size(); ++i) {
    if (active(i) != 0) diagnosis.at_bound.push_back(problem.space.parameters()[static_cast<std::size_t>(i)].name);
  }
}

}  // namespace

Diagnosis diagnose(const UpdatingProblem& problem, const DiagnosisSettings& settings, const RunContext& context) {
  require_problem(problem, settings);
  CandidateFits fits(problem, settings, context);
  const ParameterSet set = given_set(settings.given);
  context.phase({.name = "the given parameters alone"});
  const SetFit base = fits.fit(set);
  if (!base.failure.empty()) throw ModelFailure(base.failure);
  Diagnosis diagnosis;
  describe_base(problem, base, diagnosis);
  context.phase({.name = "sensitivities to all candidates"});
  const DetectabilityAnalysis analysis = analyse_detectability(fits, base);
  diagnosis.judging = analysis.judging;
  std::vector<Eigen::Index> candidates;
  for (Eigen::Index i = settings.given; i < problem.space.count(); ++i) candidates.push_back(i);
  const std::vector<CandidateFinding> findings = try_all(fits, set, base, candidates, analysis.all, 1);

  const std::vector<std::size_t> order = best_first(findings);
  std::vector<Eigen::Index> rows;
  const CandidateFinding& best = findings[order.front()];
  diagnosis.is_explained = best.bic() < 0.0 && best.better().adjusted_p <= problem.level;
  for (const std::size_t c : order) {
    diagnosis.candidates.push_back(findings[c]);
    rows.push_back(static_cast<Eigen::Index>(c));
    if (findings[c].bic() <= best.bic() + settings.like_evidence)
      diagnosis.alike.push_back(findings[c].detectability.name);
  }
  diagnosis.cosines = analysis.cosines(rows, rows);
  diagnosis.given.assign(analysis.all.begin(), analysis.all.begin() + settings.given);
  for (const Detectability& each : diagnosis.given) diagnosis.proposed.push_back({each.name});
  std::stable_sort(diagnosis.given.begin(), diagnosis.given.end(), [](const Detectability& a, const Detectability& b) {
    return a.visibility * a.own_share > b.visibility * b.own_share;
  });
  propose(fits, set, base, candidates, findings, analysis.all, diagnosis);
  diagnosis.model_evaluations = fits.evaluations();
  diagnosis.sentences = diagnosis_sentences(diagnosis, problem.tests.values.cols(), problem.level);
  return diagnosis;
}

}  // namespace mottle::updating
