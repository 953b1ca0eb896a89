// The files and the summary of a diagnosis.
#include <algorithm>
#include <map>
#include <set>
#include <utility>

#include "mottle/core/text.hpp"
#include "mottle/study/jobs/diagnose.hpp"
#include "mottle/study/results/run_folder.hpp"
#include "study/results/diagnosis_json.hpp"
#include "study/results/diagnosis_names.hpp"
#include "study/results/proposed_toml.hpp"

namespace mottle::study {
namespace {

/// "not fitted in the model (reason): a, b and 12 more": a line for each reason.
void add_not_fitted(const std::vector<CandidateFinding>& candidates, std::vector<std::string>& lines) {
  std::map<std::string, std::vector<std::string>> names;
  for (const CandidateFinding& finding : candidates) {
    const std::string& failure = finding.better().failure;
    if (!failure.empty()) names[failure].push_back(finding.detectability.name);
  }
  constexpr std::size_t k_named = 20;
  for (auto& [reason, list] : names) {
    const std::size_t more = list.size() > k_named ? list.size() - k_named : 0;
    list.resize(list.size() - more);
    lines.push_back(fmt::format("without a fit in the model ({}): {}{}", reason, join(list),
                                more > 0 ? fmt::format(" and {} more", more) : ""));
  }
}

std::string fit_cells(const CandidateFit& fit) {
  return fmt::format("{:>+9.1f} {:>11.5g} {:>11.4g} {:>9.2g}", fit.bic, fit.mean, fit.standard_deviation,
                     fit.adjusted_p);
}

/// "fixed", "random (linear); would need -0.01, which cannot be".
std::string effect_text(const CandidateFinding& finding) {
  const CandidateFit& fit = finding.answer();
  return fmt::format("{}{}{}{}", fit.is_random ? "random" : "fixed", finding.is_fitted() ? "" : " (linear)",
                     fit.is_possible ? "" : fmt::format("; would need {:.4g}, which cannot be", fit.needed),
                     finding.inseparable.empty() ? "" : "; cannot be told apart from " + join(finding.inseparable));
}

/// One line for all that cannot be told apart; of linear answers the best that lower BIC.
void add_candidates(const Diagnosis& diagnosis, std::vector<std::string>& lines) {
  constexpr int k_max_linear = 8;
  int linear = 0;
  std::set<std::string> named;
  for (const CandidateFinding& finding : diagnosis.candidates) {
    const CandidateFit& fit = finding.answer();
    if (!fit.failure.empty() || named.contains(finding.detectability.name)) continue;
    if (!finding.is_fitted() && (!(fit.bic < 0.0) || ++linear > k_max_linear)) continue;
    named.insert(finding.inseparable.begin(), finding.inseparable.end());
    lines.push_back(fmt::format("{:<16} {:>11.5g} {} {:>11.3g} {:>11.3f}  {}", finding.detectability.name,
                                finding.detectability.nominal, fit_cells(fit), finding.detectability.visibility,
                                finding.detectability.own_share, effect_text(finding)));
  }
}

/// The rounds after the first: what they fitted in the model.
void add_later_rounds(const Diagnosis& diagnosis, std::vector<std::string>& lines) {
  for (std::size_t r = 0; r < diagnosis.later_rounds.size(); ++r) {
    const DiagnosisRound& round = diagnosis.later_rounds[r];
    lines.push_back(fmt::format("round {}, in addition to {}:", r + 2, join(round.beside)));
    for (const CandidateFinding& finding : round.candidates) {
      const CandidateFit& fit = finding.better();
      if (!fit.failure.empty()) continue;
      lines.push_back(fmt::format("{:<16} {:>11.5g} {} {:>23}  {}", finding.detectability.name,
                                  finding.detectability.nominal, fit_cells(fit), "", effect_text(finding)));
    }
    add_not_fitted(round.candidates, lines);
  }
}

void add_evidences(const DiagnosisEvidence& evidence, std::vector<std::string>& lines) {
  if (evidence.models.empty()) return;
  lines.push_back(fmt::format("{:<27} {:>12} {:>9} {:>12} {:>11}  {:>18}",
                              fmt::format("by evidence ({})", evidence.method), "ln evidence", "std error",
                              "ln B against", "probability", "95 %"));
  for (const ModelEvidence& model : evidence.models) {
    const std::string name = model.candidate.empty() ? "the parameters alone" : "with " + model.candidate;
    if (!model.failure.empty()) {
      lines.push_back(fmt::format("{:<27} {}", name, model.failure));
      continue;
    }
    const ModelProbability& against = model.against;
    lines.push_back(fmt::format("{:<27} {:>12.4f} {:>9.3f} {:>12.3f} {:>11.3g}  {:>18}{}", name,
                                model.evidence.log_evidence, model.evidence.standard_error, against.log_bayes_factor,
                                against.probability, fmt::format("[{:.3g}, {:.3g}]", against.lower, against.upper),
                                model.is_converged ? "" : "  sampling did not converge"));
  }
}

std::vector<std::string> table_lines(const DiagnoseOutcome& outcome) {
  const Diagnosis& diagnosis = outcome.diagnosis;
  std::vector<std::string> lines = {diagnosis_headline(diagnosis, outcome.study.update.level)};
  lines.push_back(fmt::format("{:<16} {:>11} {:>9} {:>11} {:>11} {:>9} {:>11} {:>11}  effect", "candidate", "nominal",
                              "BIC", "mean", "std", "p (Holm)", "sensitivity", "independent"));
  add_candidates(diagnosis, lines);
  add_not_fitted(diagnosis.candidates, lines);
  add_later_rounds(diagnosis, lines);
  lines.push_back(fmt::format("{:<16} {:>11} {:>9} {:>11} {:>11} {:>9} {:>11} {:>11}", "parameter", "prior", "", "", "",
                              "", "sensitivity", "independent"));
  for (const Detectability& each : diagnosis.given) {
    lines.push_back(fmt::format("{:<16} {:>11.5g} {:>9} {:>11} {:>11} {:>9} {:>11.3g} {:>11.3f}", each.name,
                                each.nominal, "", "", "", "", each.visibility, each.own_share));
  }
  add_evidences(outcome.evidence, lines);
  for (const std::string& sentence : diagnosis.sentences) lines.push_back(sentence);
  if (std::ranges::any_of(diagnosis.candidates, &CandidateFinding::is_screened_out))
    lines.emplace_back("`mottle diagnose --thorough` fits all candidates in the model itself.");
  if (const std::string proposed = proposed_toml(outcome); !proposed.empty()) {
    lines.push_back(fmt::format(
        "To update what is proposed too, add to {} (and update with another --out to keep the present results):",
        outcome.study.file.filename().string()));
    for (std::size_t begin = 0; begin < proposed.size();) {
      const std::size_t end = proposed.find('\n', begin);
      lines.push_back(proposed.substr(begin, end - begin));
      begin = end + 1;
    }
  }
  return lines;
}

}  // namespace

std::string result_text(const DiagnoseOutcome& outcome) {
  Json json = diagnosis_json(outcome);
  json["timings_s"] = {{"total", outcome.seconds}};
  json["ranks"] = outcome.ranks;
  return pretty(json);
}

void write_results(const DiagnoseOutcome& outcome, const std::filesystem::path& path) {
  const RunFolder folder(path);
  if (!outcome.drawing.empty()) folder.write(k_diagnosis_model, outcome.drawing);
  folder.write(k_diagnosis, result_text(outcome));
  if (outcome.diagnosis.is_linear) return;
  folder.remove(k_diagnosis_journal);
  folder.forget_previous(diagnosis_names());
}

RunSummary summarise(const DiagnoseOutcome& outcome, const std::filesystem::path& folder) {
  const Diagnosis& diagnosis = outcome.diagnosis;
  const std::string file = (folder / k_diagnosis).string();
  const Json json = {{"command", "diagnose"},
                     {"headline", diagnosis_headline(diagnosis, outcome.study.update.level)},
                     {"explained", diagnosis.is_explained},
                     {"best", diagnosis.candidates.front().detectability.name},
                     {"alike", diagnosis.alike},
                     {"sentences", diagnosis.sentences},
                     {"proposed", proposed_json(diagnosis)},
                     {"proposed_toml", proposed_toml(outcome)},
                     {"folder", folder.string()},
                     {"result", file}};
  RunSummary summary{.status = "done", .lines = table_lines(outcome), .json = one_line(json)};
  summary.lines.push_back("diagnosis: " + file);
  return summary;
}

}  // namespace mottle::study
