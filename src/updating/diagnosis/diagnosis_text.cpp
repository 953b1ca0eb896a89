// A diagnosis in plain words.
#include <algorithm>
#include <cmath>
#include <set>

#include "mottle/core/error.hpp"
#include "mottle/core/text.hpp"
#include "mottle/updating/diagnosis/diagnosis.hpp"

namespace mottle::updating {
namespace {

constexpr double k_parallel = 0.95;
constexpr std::size_t k_max_sentences = 12;

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
  const CandidateFit& fit = finding.answer();
  const std::string how =
      fit.is_random
          ? fmt::format("as a random effect, with mean {:.4g} and standard deviation {:.2g}", fit.mean,
                        fit.standard_deviation)
          : fmt::format("as a fixed effect, changed from {:.4g} to {:.4g}", finding.detectability.nominal, fit.mean);
  return fmt::format("{}{} (log-likelihood {:+.1f}, BIC {:+.1f}, {} after correction for all candidates)", how,
                     std::isnan(fit.needed) ? "" : ", where a bound or physical limit holds it",
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
  const std::string opening = diagnosis.is_linear ? "In the linear model, " : "";
  if (!diagnosis.is_explained) {
    sentences.push_back(
        fmt::format("{} candidate explains the tests significantly better than the given parameters alone (level "
                    "{:.3g}, all candidates together).",
                    diagnosis.is_linear ? "In the linear model, no" : "No", level));
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
    sentences.push_back(fmt::format("{}{} best explains what the given parameters cannot: {}.", opening,
                                    best.detectability.name, fit_text(best)));
    if (diagnosis.candidates.size() > 1) {
      const CandidateFinding& next = diagnosis.candidates[1];
      const bool is_comparable = next.is_fitted() == best.is_fitted() && next.answer().is_possible;
      if (is_comparable && std::isfinite(next.answer().bic))
        sentences.push_back(fmt::format("The BIC of the next best, {}, is higher by {:.1f}.", next.detectability.name,
                                        next.answer().bic - best.answer().bic));
    }
    return;
  }
  sentences.push_back(
      fmt::format("{}{} explain the tests equally well (their BIC differ by too little): these tests cannot "
                  "distinguish them. The best by a small margin is {}: {}.",
                  opening, listed(diagnosis.alike), best.detectability.name, fit_text(best)));
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
      const bool are_fitted = one.is_fitted() && other.is_fitted();
      const bool are_inseparable = std::ranges::count(one.inseparable, other.detectability.name) > 0;
      if (!are_fitted || are_inseparable || std::abs(diagnosis.cosines(i, j)) < k_parallel) continue;
      if (sentences.size() > k_max_sentences) return;
      sentences.push_back(fmt::format(
          "{} and {} move the outputs in the same direction, apart from the effects that the given parameters can "
          "reproduce (cosine {:.2f}).",
          one.detectability.name, other.detectability.name, diagnosis.cosines(i, j)));
    }
  }
}

/// Groups of candidates that cannot be told apart, where one of them lowers BIC.
void add_inseparable(const Diagnosis& diagnosis, std::vector<std::string>& sentences) {
  std::set<std::string> named;
  for (const CandidateFinding& finding : diagnosis.candidates) {
    const std::string& name = finding.detectability.name;
    if (finding.inseparable.empty() || named.contains(name) || !(finding.answer().bic < 0.0)) continue;
    std::vector<std::string> group = {name};
    group.insert(group.end(), finding.inseparable.begin(), finding.inseparable.end());
    named.insert(group.begin(), group.end());
    if (sentences.size() > k_max_sentences) return;
    sentences.push_back(
        fmt::format("{} cannot be told apart: their effects on the outputs, apart from what the given parameters can "
                    "reproduce, differ by an angle of no more than {:.3g} degrees.",
                    listed(group), diagnosis.inseparable_degrees));
  }
}

/// Candidates that would explain the tests with a value that they cannot have.
void add_impossible(const Diagnosis& diagnosis, double level, std::vector<std::string>& sentences) {
  for (const CandidateFinding& finding : diagnosis.candidates) {
    const CandidateFit& fit = finding.answer();
    if (!fit.failure.empty() || fit.is_possible || !(fit.bic < 0.0) || fit.adjusted_p > level) continue;
    if (sentences.size() > k_max_sentences) return;
    sentences.push_back(
        fmt::format("{}{} would need {:.4g}, which cannot be: the tests refuse the nearest value that it can have, "
                    "{:.4g}.",
                    diagnosis.is_linear || !finding.is_fitted() ? "In the linear model, " : "",
                    finding.detectability.name, fit.needed, fit.mean));
  }
}

/// How many candidates have a linear answer only.
void add_not_fitted(const Diagnosis& diagnosis, std::vector<std::string>& sentences) {
  if (diagnosis.is_linear) {
    sentences.emplace_back("This is a first answer: the best candidates are fitted in the model itself next.");
    return;
  }
  const auto count = std::ranges::count_if(diagnosis.candidates, &CandidateFinding::is_screened_out);
  if (count == 0) return;
  sentences.push_back(fmt::format("{} of {} candidates {} compared in the linear model only.", count,
                                  diagnosis.candidates.size(), count == 1 ? "was" : "were"));
}

/// Of candidates that explain nothing: whether they were in sight at all.
void add_unseen(const Diagnosis& diagnosis, double level, std::vector<std::string>& sentences) {
  std::vector<std::string> unseen;
  std::vector<std::string> imitated;
  for (const CandidateFinding& finding : diagnosis.candidates) {
    if (finding.answer().adjusted_p <= level) continue;
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

/// "changed from 2 to 3.003", "varying about 3 with a standard deviation of 0.2".
std::string change_text(const CandidateFinding& finding) {
  const CandidateFit& fit = finding.answer();
  if (!fit.is_random) return fmt::format("changed from {:.4g} to {:.4g}", finding.detectability.nominal, fit.mean);
  return fmt::format("varying from specimen to specimen about {:.4g} with a standard deviation of {:.2g}", fit.mean,
                     fit.standard_deviation);
}

}  // namespace

std::string diagnosis_headline(const Diagnosis& diagnosis, double level) {
  constexpr std::size_t k_named = 4;
  const std::string opening = diagnosis.is_linear ? "Linear answer: " : "";
  const CandidateFinding& best = diagnosis.candidates.front();
  if (diagnosis.is_explained && diagnosis.alike.size() == 1) {
    return fmt::format("{}{} explains the tests best, {}.", opening, best.detectability.name, change_text(best));
  }
  if (diagnosis.is_explained) {
    std::vector<std::string> names = diagnosis.alike;
    const std::size_t more = names.size() > k_named ? names.size() - k_named : 0;
    names.resize(names.size() - more);
    if (more > 0) names.push_back(fmt::format("{} more", more));
    return fmt::format("{}{} explain the tests equally well; best by a small margin is {}, {}.", opening, listed(names),
                       best.detectability.name, change_text(best));
  }
  for (const CandidateFinding& finding : diagnosis.candidates) {
    const CandidateFit& fit = finding.answer();
    if (!fit.failure.empty() || fit.is_possible || !(fit.bic < 0.0) || fit.adjusted_p > level) continue;
    return fmt::format("{}No candidate explains the tests with a value that it can have: {} would need {:.4g}.",
                       opening, finding.detectability.name, fit.needed);
  }
  return fmt::format("{}No candidate explains the tests better than the given parameters alone.", opening);
}

std::vector<std::string> diagnosis_sentences(const Diagnosis& diagnosis, Eigen::Index outputs, double level) {
  std::vector<std::string> sentences;
  add_base(diagnosis, sentences);
  add_answer(diagnosis, outputs, level, sentences);
  add_impossible(diagnosis, level, sentences);
  add_inseparable(diagnosis, sentences);
  add_angles(diagnosis, sentences);
  add_unseen(diagnosis, level, sentences);
  add_not_fitted(diagnosis, sentences);
  if (!diagnosis.is_linear) add_proposal(diagnosis, sentences);
  return sentences;
}

}  // namespace mottle::updating
