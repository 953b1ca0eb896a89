// A diagnosis in plain words.
#include <algorithm>
#include <cmath>

#include "mottle/core/error.hpp"
#include "mottle/core/text.hpp"
#include "mottle/updating/diagnosis/diagnosis.hpp"

namespace mottle::updating {
namespace {

constexpr double k_parallel = 0.95;

/// "k3, k4 and k6"
std::string listed(const std::vector<std::string>& names) {
  if (names.size() < 2) return join(names);
  const std::vector<std::string> first(names.begin(), names.end() - 1);
  return fmt::format("{} and {}", join(first), names.back());
}

std::string chance_text(double p) {
  return p < 1e-4 ? "p < 0.0001" : fmt::format("p = {:.2g}", p);
}

std::string fit_text(const CandidateFinding& finding) {
  const CandidateFit& fit = finding.better();
  const std::string how =
      fit.is_random
          ? fmt::format("as a random effect, with mean {:.4g} and standard deviation {:.2g}", fit.mean,
                        fit.standard_deviation)
          : fmt::format("as a fixed effect, changed from {:.4g} to {:.4g}", finding.detectability.nominal, fit.mean);
  return fmt::format("{} (log-likelihood +{:.1f}, BIC {:+.1f}, {} after correction for all candidates)", how,
                     fit.log_likelihood_increase, fit.bic, chance_text(fit.adjusted_p));
}

void add_base(const Diagnosis& diagnosis, std::vector<std::string>& sentences) {
  if (!diagnosis.at_bound.empty()) {
    sentences.push_back(
        fmt::format("With the given parameters alone {} {} a bound: the tests ask for more than the "
                    "bounds allow.",
                    listed(diagnosis.at_bound), diagnosis.at_bound.size() == 1 ? "ends on" : "end on"));
  }
  if (diagnosis.unreproduced > 0) {
    const bool is_one = diagnosis.unreproduced == 1;
    sentences.push_back(fmt::format("{} {} reproduced by the given parameters: {} at a limit or did not converge.",
                                    diagnosis.unreproduced, is_one ? "specimen was not" : "specimens were not",
                                    is_one ? "its solution ended" : "their solutions ended"));
  }
  if (!diagnosis.converged) {
    sentences.emplace_back(
        "The fit of the given parameters alone did not converge: increases of the "
        "log-likelihood over it are approximate.");
  }
}

/// Names of all candidates that move the outputs.
std::vector<std::string> seen_names(const Diagnosis& diagnosis) {
  std::vector<std::string> names;
  for (const CandidateFinding& finding : diagnosis.candidates) {
    if (finding.detectability.visibility > 0.0) names.push_back(finding.detectability.name);
  }
  return names;
}

void add_answer(const Diagnosis& diagnosis, Eigen::Index outputs, double level, std::vector<std::string>& sentences) {
  const CandidateFinding& best = diagnosis.candidates.front();
  if (!diagnosis.is_explained) {
    sentences.push_back(
        fmt::format("No candidate explains the tests significantly better than the given parameters alone (level "
                    "{:.3g}, all candidates together).",
                    level));
    if (diagnosis.judging == 0) {
      sentences.push_back(fmt::format(
          "Near their estimate, where the outputs are nearly linear, the given parameters can match every mean and "
          "covariance of the {} outputs: these tests cannot say whether a candidate is wrong, and cannot "
          "distinguish {}. Measure more outputs, for example mode shapes.",
          outputs, listed(seen_names(diagnosis))));
    }
    return;
  }
  if (diagnosis.alike.size() == 1) {
    sentences.push_back(
        fmt::format("{} best explains what the given parameters cannot: {}.", best.detectability.name, fit_text(best)));
    if (diagnosis.candidates.size() > 1 && std::isfinite(diagnosis.candidates[1].bic())) {
      const CandidateFinding& next = diagnosis.candidates[1];
      sentences.push_back(fmt::format("The BIC of the next best, {}, is higher by {:.1f}.", next.detectability.name,
                                      next.bic() - best.bic()));
    }
    return;
  }
  sentences.push_back(
      fmt::format("{} explain the tests equally well (their BIC differ by too little): these tests cannot "
                  "distinguish them. The best by a small margin is {}: {}.",
                  listed(diagnosis.alike), best.detectability.name, fit_text(best)));
  if (diagnosis.judging <= 1) {
    sentences.push_back(fmt::format(
        "The given parameters that are not on a bound can match {} of the {} directions of the tests' mean: any "
        "candidate that moves the rest explains the tests. Measure more outputs, for example mode shapes.",
        outputs - diagnosis.judging, outputs));
  }
}

void add_angles(const Diagnosis& diagnosis, std::vector<std::string>& sentences) {
  for (Eigen::Index i = 0; i < diagnosis.cosines.rows(); ++i) {
    for (Eigen::Index j = i + 1; j < diagnosis.cosines.cols(); ++j) {
      const CandidateFinding& one = diagnosis.candidates[static_cast<std::size_t>(i)];
      const CandidateFinding& other = diagnosis.candidates[static_cast<std::size_t>(j)];
      const bool are_fitted = !one.is_screened_out && !other.is_screened_out;
      if (!are_fitted || std::abs(diagnosis.cosines(i, j)) < k_parallel || sentences.size() > 12) continue;
      sentences.push_back(fmt::format(
          "{} and {} move the outputs in the same direction, apart from the effects that the given parameters can "
          "reproduce (cosine {:.2f}).",
          one.detectability.name, other.detectability.name, diagnosis.cosines(i, j)));
    }
  }
}

/// Of candidates that explain nothing: whether they were in sight at all.
void add_unseen(const Diagnosis& diagnosis, double level, std::vector<std::string>& sentences) {
  std::vector<std::string> unseen;
  std::vector<std::string> imitated;
  for (const CandidateFinding& finding : diagnosis.candidates) {
    if (finding.better().adjusted_p <= level) continue;
    if (finding.detectability.visibility < 1.0) {
      unseen.push_back(finding.detectability.name);
    } else if (finding.detectability.visibility * finding.detectability.own_share < 1.0) {
      imitated.push_back(finding.detectability.name);
    }
  }
  if (!unseen.empty()) {
    sentences.push_back(
        fmt::format("{}: one prior standard deviation moves the tests' mean by less than its standard error; it "
                    "cannot be identified from these tests.",
                    listed(unseen)));
  }
  if (!imitated.empty()) {
    sentences.push_back(
        fmt::format("{}: the given parameters reproduce its effect within the standard error of "
                    "the tests' mean.",
                    listed(imitated)));
  }
}

void add_proposal(const Diagnosis& diagnosis, std::vector<std::string>& sentences) {
  std::vector<std::string> names;
  bool has_more = false;
  for (const ProposedParameter& parameter : diagnosis.proposed) {
    const std::string how = parameter.is_given ? "" : parameter.is_random ? " (new)" : " (new, mean only)";
    names.push_back(parameter.name + how);
    has_more = has_more || !parameter.is_given;
  }
  if (!has_more) {
    sentences.emplace_back("Proposed set: the given parameters; no candidate improves on them.");
    return;
  }
  sentences.push_back(fmt::format(
      "Proposed set: {}{}.", listed(names),
      diagnosis.alike.size() > 1 ? fmt::format("; instead of {} it may be any of {}",
                                               diagnosis.candidates.front().detectability.name, listed(diagnosis.alike))
                                 : ""));
  sentences.emplace_back(
      "The new parameters were chosen by these tests: an update to the same tests is then refused less often than its "
      "level says. Check it with tests that were kept back.");
}

}  // namespace

std::vector<std::string> diagnosis_sentences(const Diagnosis& diagnosis, Eigen::Index outputs, double level) {
  std::vector<std::string> sentences;
  add_base(diagnosis, sentences);
  add_answer(diagnosis, outputs, level, sentences);
  add_angles(diagnosis, sentences);
  add_unseen(diagnosis, level, sentences);
  add_proposal(diagnosis, sentences);
  return sentences;
}

}  // namespace mottle::updating
