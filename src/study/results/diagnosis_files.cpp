// diagnosis.json and the summary of a diagnosis.
#include <map>
#include <utility>

#include "mottle/core/text.hpp"
#include "mottle/study/jobs/diagnose.hpp"
#include "mottle/study/results/run_folder.hpp"
#include "study/results/diagnosis_names.hpp"
#include "study/results/evidence_json.hpp"
#include "study/results/proposed_toml.hpp"
#include "study/results/result_json.hpp"

namespace mottle::study {
namespace {

Json detectability_json(const Detectability& detectability) {
  return {{"name", detectability.name},
          {"nominal", detectability.nominal},
          {"scale", detectability.scale},
          {"visibility", number_json(detectability.visibility)},
          {"own_share", number_json(detectability.own_share)},
          {"variance_inflation", number_json(detectability.inflation)}};
}

Json fit_json(const CandidateFit& fit) {
  if (!fit.failure.empty()) return {{"failure", fit.failure}};
  return {{"gain", number_json(fit.log_likelihood_increase)},
          {"bic", number_json(fit.bic)},
          {"p_value", number_json(fit.p_value)},
          {"adjusted_p_value", number_json(fit.adjusted_p)},
          {"mean", number_json(fit.mean)},
          {"std", number_json(fit.standard_deviation)},
          {"within_bounds", fit.is_within},
          {"converged", fit.converged}};
}

void add_fits(const CandidateFinding& finding, Json& json) {
  json["bic"] = number_json(finding.bic());
  json["best"] = finding.better().is_random ? "freed" : "shifted";
  json["shifted"] = fit_json(finding.fixed);
  json["freed"] = fit_json(finding.random);
  json["screened_out"] = finding.is_screened_out;
}

Json candidate_json(const CandidateFinding& finding, const std::vector<std::string>& targets) {
  Json json = detectability_json(finding.detectability);
  json["targets"] = targets;
  add_fits(finding, json);
  return json;
}

Json proposed_json(const Diagnosis& diagnosis) {
  Json proposed = Json::array();
  for (const ProposedParameter& parameter : diagnosis.proposed) {
    proposed.push_back({{"name", parameter.name},
                        {"given", parameter.is_given},
                        {"scatter", parameter.is_random},
                        {"bic_lowered", parameter.bic}});
  }
  return proposed;
}

Json rounds_json(const Diagnosis& diagnosis) {
  Json rounds = Json::array();
  for (const DiagnosisRound& round : diagnosis.later_rounds) {
    Json candidates = Json::array();
    for (const CandidateFinding& finding : round.candidates) {
      Json candidate = {{"name", finding.detectability.name}};
      add_fits(finding, candidate);
      candidates.push_back(std::move(candidate));
    }
    rounds.push_back({{"beside", round.beside}, {"candidates", candidates}});
  }
  return rounds;
}

/// null where the study does not ask for it.
Json candidates_by_evidence_json(const DiagnosisEvidence& evidence) {
  if (evidence.models.empty()) return nullptr;
  Json models = Json::array();
  for (const ModelEvidence& model : evidence.models) {
    Json json = {{"candidate", model.candidate.empty() ? Json(nullptr) : Json(model.candidate)}};
    if (model.failure.empty()) {
      add_evidence_among(model.evidence, model.against, json);
      json["converged"] = model.is_converged;
      json["model_evaluations"] = model.model_evaluations;
    } else {
      json["failure"] = model.failure;
    }
    models.push_back(std::move(json));
  }
  return {{"method", evidence.method}, {"models", models}};
}

Json outcome_json(const DiagnoseOutcome& outcome) {
  const Study& study = outcome.study;
  const Diagnosis& diagnosis = outcome.diagnosis;
  Json json = result_head(study, "diagnose");
  json["level"] = study.update.level;
  json["explained"] = diagnosis.is_explained;
  json["best"] = diagnosis.candidates.front().detectability.name;
  json["alike"] = diagnosis.alike;
  json["sentences"] = diagnosis.sentences;
  Json names = Json::array();
  for (const StudyParameter& parameter : study.parameters.list) names.push_back(parameter.name);
  json["parameters"] = {{"names", names},
                        {"mean", to_json(diagnosis.mean)},
                        {"std", to_json(diagnosis.standard_deviation)},
                        {"at_bound", diagnosis.at_bound},
                        {"log_likelihood", number_json(diagnosis.log_likelihood)},
                        {"converged", diagnosis.converged},
                        {"unreproduced_specimens", diagnosis.unreproduced},
                        {"directions_out_of_reach", diagnosis.judging}};
  json["given"] = Json::array();
  for (const Detectability& each : diagnosis.given) json["given"].push_back(detectability_json(each));
  json["candidates"] = Json::array();
  Json order = Json::array();
  for (const CandidateFinding& finding : diagnosis.candidates) {
    for (const StudyParameter& parameter : outcome.whole.parameters.list) {
      if (parameter.name != finding.detectability.name) continue;
      json["candidates"].push_back(candidate_json(finding, parameter.targets));
    }
    order.push_back(finding.detectability.name);
  }
  json["cosines"] = {{"names", order}, {"matrix", to_json_rows(diagnosis.cosines)}};
  json["evidence"] = candidates_by_evidence_json(outcome.evidence);
  json["later_rounds"] = rounds_json(diagnosis);
  json["proposed"] = proposed_json(diagnosis);
  json["proposed_toml"] = proposed_toml(outcome);
  json["model_evaluations"] = diagnosis.model_evaluations;
  return json;
}

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

const char* effect_text(const CandidateFit& fit) {
  return fit.is_random ? "random" : "fixed";
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
                                  finding.detectability.nominal, fit_cells(fit), "", effect_text(fit)));
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
  std::vector<std::string> lines;
  lines.push_back(fmt::format("{:<16} {:>11} {:>9} {:>11} {:>11} {:>9} {:>11} {:>11}  effect", "candidate", "nominal",
                              "BIC", "mean", "std", "p (Holm)", "sensitivity", "independent"));
  for (const CandidateFinding& finding : diagnosis.candidates) {
    const CandidateFit& fit = finding.better();
    if (!fit.failure.empty()) continue;
    lines.push_back(fmt::format("{:<16} {:>11.5g} {} {:>11.3g} {:>11.3f}  {}", finding.detectability.name,
                                finding.detectability.nominal, fit_cells(fit), finding.detectability.visibility,
                                finding.detectability.own_share, effect_text(fit)));
  }
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
  Json json = outcome_json(outcome);
  json["timings_s"] = {{"total", outcome.seconds}};
  json["ranks"] = outcome.ranks;
  return pretty(json);
}

void write_results(const DiagnoseOutcome& outcome, const std::filesystem::path& path) {
  const RunFolder folder(path);
  folder.write(k_diagnosis, result_text(outcome));
  folder.remove(k_diagnosis_journal);
  folder.forget_previous({k_diagnosis});
}

RunSummary summarise(const DiagnoseOutcome& outcome, const std::filesystem::path& folder) {
  const Diagnosis& diagnosis = outcome.diagnosis;
  const std::string file = (folder / k_diagnosis).string();
  const Json json = {{"command", "diagnose"},
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
