// diagnosis.json and the summary of a diagnosis.
#include "mottle/study/jobs/diagnose.hpp"
#include "mottle/study/results/run_folder.hpp"
#include "study/results/diagnosis_names.hpp"
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

Json candidate_json(const CandidateFinding& finding, const std::vector<std::string>& targets) {
  Json json = detectability_json(finding.detectability);
  json["targets"] = targets;
  json["bic"] = number_json(finding.bic());
  json["best"] = finding.better().is_random ? "freed" : "shifted";
  json["shifted"] = fit_json(finding.fixed);
  json["freed"] = fit_json(finding.random);
  json["screened_out"] = finding.is_screened_out;
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
  json["proposed"] = proposed_json(diagnosis);
  json["model_evaluations"] = diagnosis.model_evaluations;
  return json;
}

std::vector<std::string> table_lines(const Diagnosis& diagnosis) {
  std::vector<std::string> lines;
  lines.push_back(fmt::format("{:<16} {:>11} {:>9} {:>11} {:>11} {:>9} {:>11} {:>11}  effect", "candidate", "nominal",
                              "BIC", "mean", "std", "p (Holm)", "sensitivity", "independent"));
  for (const CandidateFinding& finding : diagnosis.candidates) {
    const CandidateFit& fit = finding.better();
    const std::string start =
        fmt::format("{:<16} {:>11.5g}", finding.detectability.name, finding.detectability.nominal);
    const std::string seen =
        fmt::format("{:>11.3g} {:>11.3f}", finding.detectability.visibility, finding.detectability.own_share);
    if (!fit.failure.empty()) {
      lines.push_back(fmt::format("{} {:>9} {:>11} {:>11} {:>9} {}  {}", start, "", "", "", "", seen, fit.failure));
      continue;
    }
    lines.push_back(fmt::format("{} {:>+9.1f} {:>11.5g} {:>11.4g} {:>9.2g} {}  {}", start, fit.bic, fit.mean,
                                fit.standard_deviation, fit.adjusted_p, seen, fit.is_random ? "random" : "fixed"));
  }
  lines.push_back(fmt::format("{:<16} {:>11} {:>9} {:>11} {:>11} {:>9} {:>11} {:>11}", "parameter", "prior", "", "", "",
                              "", "sensitivity", "independent"));
  for (const Detectability& each : diagnosis.given) {
    lines.push_back(fmt::format("{:<16} {:>11.5g} {:>9} {:>11} {:>11} {:>9} {:>11.3g} {:>11.3f}", each.name,
                                each.nominal, "", "", "", "", each.visibility, each.own_share));
  }
  for (const std::string& sentence : diagnosis.sentences) lines.push_back(sentence);
  return lines;
}

}  // namespace

void write_results(const DiagnoseOutcome& outcome, const std::filesystem::path& path) {
  const RunFolder folder(path);
  Json json = outcome_json(outcome);
  json["timings_s"] = {{"total", outcome.seconds}};
  folder.write(k_diagnosis, pretty(json));
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
                     {"folder", folder.string()},
                     {"result", file}};
  RunSummary summary{.status = "done", .lines = table_lines(diagnosis), .json = one_line(json)};
  summary.lines.push_back("diagnosis: " + file);
  return summary;
}

}  // namespace mottle::study
