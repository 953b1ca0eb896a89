#include "updating/diagnosis/candidate_rounds.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <numbers>
#include <numeric>
#include <string>
#include <tuple>

#include "mottle/core/parallel.hpp"
#include "mottle/core/work_counter.hpp"
#include "mottle/stats/distributions/chi_squared.hpp"
#include "updating/diagnosis/candidate_reference.hpp"

namespace mottle::updating {
namespace {

constexpr Eigen::Index k_many_specimens = 30;  // chi-squared serves from there on
constexpr double k_infinity = std::numeric_limits<double>::infinity();
// Candidates that are fitted in the first round whatever the linear model says. Once the set explains the tests better,
// its linear model is at the right place: where it shows nothing, there is nothing to fit.
constexpr std::size_t k_min_fitted = 3;
constexpr std::size_t k_kinds = 2;  // of effects in which a candidate is tried

/// Holm's adjusted p-values; `count` tries in all, those that are not among `tries` with p = 1.
void adjust(std::vector<CandidateFit*> tries, std::size_t count) {
  std::stable_sort(tries.begin(), tries.end(),
                   [](const CandidateFit* a, const CandidateFit* b) { return a->p_value < b->p_value; });
  double largest = 0.0;
  for (std::size_t i = 0; i < tries.size(); ++i) {
    largest = std::max(largest, static_cast<double>(count - i) * tries[i]->p_value);
    tries[i]->adjusted_p = std::min(largest, 1.0);
  }
}

/// Of the fits in the model itself.
void adjust_fits(std::vector<CandidateFinding>& findings) {
  std::vector<CandidateFit*> tries;
  for (CandidateFinding& finding : findings) {
    tries.push_back(&finding.fixed);
    tries.push_back(&finding.random);
  }
  adjust(tries, tries.size());
}

CandidateFit not_tried(bool is_random, const std::string& why) {
  CandidateFit fit;
  fit.is_random = is_random;
  fit.bic = k_infinity;
  fit.failure = why;
  return fit;
}

void leave_out(const std::string& why, CandidateFinding& finding) {
  finding.fixed = not_tried(false, why);
  finding.random = not_tried(true, why);
}

/// Significance of tries by replications where specimens are few: only of those that chi-squared calls significant, it
/// errs to that side.
void refer_small_samples(CandidateFits& fits, const CandidateRound& round, std::vector<CandidateFinding>& findings) {
  if (fits.specimens() >= k_many_specimens) return;
  std::vector<CandidateTry> tries;
  for (std::size_t c = 0; c < findings.size(); ++c) {
    CandidateEffects effects;
    for (CandidateFit* fit : {&findings[c].fixed, &findings[c].random}) {
      const bool is_significant = fit->failure.empty() && fit->adjusted_p <= fits.problem().level;
      if (!is_significant) continue;
      if (effects.empty()) effects = fits.effects_at_specimens(round.base, round.set, round.candidates[c]);
      tries.push_back({round.candidates[c], fit, effects});
    }
  }
  if (tries.empty()) return;
  refer_to_replications(fits, round.set, round.base, round.candidates.size(), tries);
  adjust_fits(findings);
}

/// The increase in the linear model from which on a candidate is worth a fit in the model itself: twice as much could
/// be significant after Holm's correction, and within `like_evidence` of the best fit so far.
double worthwhile_increase(const CandidateFits& fits, std::size_t candidates, double best) {
  const auto tries = static_cast<double>(k_kinds * candidates);
  const double significant = 0.5 * chi_squared_quantile(1.0 - fits.problem().level / tries, 1.0);
  return 0.5 * std::max(significant, best - 0.5 * fits.settings().like_evidence);
}

/// The two fits of a candidate beside a set, told as soon as they are known.
void fit_candidate(CandidateFits& fits, const CandidateRound& round, Eigen::Index candidate,
                   CandidateFinding& finding) {
  std::tie(finding.fixed, finding.random) = fits.compare_both(round.set, round.base, candidate);
  for (CandidateFit* fit : {&finding.fixed, &finding.random}) {
    if (!fit->failure.empty()) fit->bic = k_infinity;
  }
  const CandidateFit& better = finding.better();
  if (!better.failure.empty()) return;
  fits.context().finding(
      fmt::format("{}: {} effect, log-likelihood {:+.3g}, BIC {:+.3g}{}", finding.detectability.name,
                  better.is_random ? "random" : "fixed", better.log_likelihood_increase, better.bic,
                  better.is_possible ? "" : fmt::format("; it would need {:.4g}, which cannot be", better.needed)));
}

/// Of the candidates that cannot be told from this one, the one that is fitted; empty: none is.
std::string fitted_twin(const CandidateFinding& finding, const std::vector<CandidateFinding>& findings) {
  for (const std::string& name : finding.inseparable) {
    for (const CandidateFinding& other : findings) {
      if (other.detectability.name == name && other.is_fitted() && other.better().is_possible) return name;
    }
  }
  return {};
}

double linear_increase(const CandidateFinding& finding) {
  return finding.linear.failure.empty() ? finding.linear.log_likelihood_increase : -1.0;
}

std::vector<std::size_t> by_linear_increase(const std::vector<CandidateFinding>& findings) {
  std::vector<std::size_t> order(findings.size());
  std::iota(order.begin(), order.end(), std::size_t{0});
  std::stable_sort(order.begin(), order.end(), [&](std::size_t a, std::size_t b) {
    return linear_increase(findings[a]) > linear_increase(findings[b]);
  });
  return order;
}

/// How many candidates of a round are fitted, and how far that has come.
struct FitPlan {
  std::size_t most = 0;
  std::size_t least = 0;
  bool are_all_fitted = false;
  std::size_t fitted = 0;
  double best_increase = 0.0;
};

FitPlan plan_of(const DiagnosisSettings& settings, const CandidateRound& round) {
  const std::size_t all = round.candidates.size();
  const auto screened = static_cast<std::size_t>(settings.screened);
  FitPlan plan;
  plan.most = std::min(all, round.number == 1 ? screened : (screened + 1) / 2);
  if (round.number == 1 && settings.fits_all) plan.most = all;
  plan.are_all_fitted = plan.most == all;
  plan.least = plan.are_all_fitted ? all : round.number == 1 ? k_min_fitted : 0;
  return plan;
}

/// Why a candidate is not fitted next; empty: it is.
std::string reason_against(const CandidateFits& fits, const FitPlan& plan, const CandidateFinding& finding,
                           const std::vector<CandidateFinding>& findings) {
  if (plan.are_all_fitted) return {};
  const std::string twin = fitted_twin(finding, findings);
  if (!twin.empty()) return fmt::format("cannot be told apart from {}, which is fitted", twin);
  const bool is_worth_it = plan.fitted < plan.least ||
                           linear_increase(finding) >= worthwhile_increase(fits, findings.size(), plan.best_increase);
  return plan.fitted < plan.most && is_worth_it ? "" : "less increase of the log-likelihood in the linear models";
}

/// Whether the answers of two candidates are alike, by fits where both have one.
bool are_alike(const CandidateFinding& a, const CandidateFinding& b, double like_evidence) {
  const bool are_fitted = a.is_fitted() && b.is_fitted();
  const CandidateFit& one = are_fitted ? a.better() : a.linear;
  const CandidateFit& other = are_fitted ? b.better() : b.linear;
  return one.is_possible == other.is_possible && std::abs(one.bic - other.bic) <= like_evidence;
}

}  // namespace

std::vector<CandidateFinding> linear_findings(const CandidateFits& fits, const CandidateRound& round,
                                              const Eigen::MatrixXd& slope) {
  fits.context().phase({.name = "candidates in the linear model"});
  std::vector<CandidateFinding> findings(round.candidates.size());
  const auto count = static_cast<std::int64_t>(findings.size());
  WorkCounter counter(fits.context(), "candidates", count);
  parallel_for(count, 1, fits.context().threads, [&](std::int64_t begin, std::int64_t end) {
    for (std::int64_t c = begin; c < end; ++c) {
      fits.context().throw_if_stopped();
      CandidateFinding& finding = findings[static_cast<std::size_t>(c)];
      const Eigen::Index candidate = round.candidates[static_cast<std::size_t>(c)];
      finding.detectability = round.analysis[static_cast<std::size_t>(candidate)];
      const bool is_seen = finding.detectability.visibility > 0.0;
      finding.linear = is_seen && !(finding.detectability.own_share > 0.0)
                           ? not_tried(false, "the given parameters reproduce its effect")
                           : fits.linear_answer(round.base, round.set, candidate, slope.col(candidate));
      leave_out("not fitted yet", finding);
      counter.add();
    }
  });
  std::vector<CandidateFit*> tries;
  for (CandidateFinding& finding : findings) tries.push_back(&finding.linear);
  adjust(tries, k_kinds * tries.size());
  return findings;
}

void fit_best(CandidateFits& fits, const CandidateRound& round, std::vector<CandidateFinding>& findings) {
  const std::string phase = fmt::format("round {}, candidate in the model", round.number);
  FitPlan plan = plan_of(fits.settings(), round);
  for (const std::size_t index : by_linear_increase(findings)) {
    fits.context().throw_if_stopped();
    CandidateFinding& finding = findings[index];
    if (!(finding.detectability.visibility > 0.0)) {
      leave_out("no effect on any output", finding);
      continue;
    }
    const std::string why = reason_against(fits, plan, finding, findings);
    finding.is_screened_out = !why.empty();
    if (finding.is_screened_out) {
      leave_out(why, finding);
      continue;
    }
    fits.context().phase({.name = phase,
                          .step = static_cast<std::int64_t>(plan.fitted) + 1,
                          .steps = static_cast<std::int64_t>(plan.most),
                          .may_end_early = !plan.are_all_fitted});
    fit_candidate(fits, round, round.candidates[index], finding);
    plan.best_increase = std::max(plan.best_increase, finding.better().log_likelihood_increase);
    ++plan.fitted;
  }
  adjust_fits(findings);
  refer_small_samples(fits, round, findings);
}

std::vector<std::size_t> best_first(const std::vector<CandidateFinding>& findings) {
  std::vector<std::size_t> order(findings.size());
  std::iota(order.begin(), order.end(), std::size_t{0});
  const auto key = [](const CandidateFinding& finding) {
    return std::tuple(!finding.is_fitted(), !finding.answer().is_possible, finding.answer().bic);
  };
  std::stable_sort(order.begin(), order.end(),
                   [&](std::size_t a, std::size_t b) { return key(findings[a]) < key(findings[b]); });
  return order;
}

bool is_explanation(const CandidateFit& answer, double level) {
  return answer.failure.empty() && answer.bic < 0.0 && answer.adjusted_p <= level && answer.is_possible;
}

void name_inseparable(const Eigen::MatrixXd& cosines, const DiagnosisSettings& settings,
                      std::vector<CandidateFinding>& findings) {
  const double least = std::cos(settings.inseparable_degrees * std::numbers::pi / 180.0);
  std::vector<std::size_t> left = best_first(findings);
  while (!left.empty()) {
    const std::size_t leader = left.front();
    std::vector<std::size_t> group;
    std::vector<std::size_t> others;
    for (const std::size_t c : left) {
      const double cosine = std::abs(cosines(static_cast<Eigen::Index>(leader), static_cast<Eigen::Index>(c)));
      const bool belongs =
          c == leader || (cosine >= least && are_alike(findings[leader], findings[c], settings.like_evidence));
      (belongs ? group : others).push_back(c);
    }
    for (const std::size_t c : group) {
      findings[c].inseparable.clear();
      for (const std::size_t other : group) {
        if (other != c) findings[c].inseparable.push_back(findings[other].detectability.name);
      }
    }
    left = std::move(others);
  }
}

}  // namespace mottle::updating
