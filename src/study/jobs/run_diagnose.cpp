// The job of `mottle diagnose`.
#include "mottle/core/text.hpp"
#include "mottle/model/journal.hpp"
#include "mottle/study/jobs/run.hpp"
#include "mottle/study/results/run_folder.hpp"
#include "mottle/updating/diagnosis/diagnosis.hpp"
#include "study/jobs/candidates.hpp"
#include "study/results/result_json.hpp"
#include "study/results/run_files.hpp"
#include "study/tests/rank_numbering.hpp"
#include "study/tests/unit_errors.hpp"

namespace mottle {
namespace {

constexpr const char* k_result = "diagnosis.json";

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
  return {{"gain", number_json(fit.gain)},       {"bic", number_json(fit.bic)},
          {"p_value", number_json(fit.p_value)}, {"adjusted_p_value", number_json(fit.adjusted_p)},
          {"mean", number_json(fit.mean)},       {"std", number_json(fit.deviation)},
          {"within_bounds", fit.is_within},      {"converged", fit.converged}};
}

Json candidate_json(const CandidateFinding& finding, const std::vector<std::string>& targets) {
  Json json = detectability_json(finding.detectability);
  json["targets"] = targets;
  json["bic"] = number_json(finding.bic());
  json["best"] = finding.better().is_freed ? "freed" : "shifted";
  json["shifted"] = fit_json(finding.shifted);
  json["freed"] = fit_json(finding.freed);
  json["screened_out"] = finding.is_screened_out;
  return json;
}

Json diagnosis_json(const Study& study, const Study& whole, const Diagnosis& diagnosis) {
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
                        {"std", to_json(diagnosis.deviation)},
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
    for (const StudyParameter& parameter : whole.parameters.list) {
      if (parameter.name != finding.detectability.name) continue;
      json["candidates"].push_back(candidate_json(finding, parameter.targets));
    }
    order.push_back(finding.detectability.name);
  }
  json["cosines"] = {{"names", order}, {"matrix", to_json_rows(diagnosis.cosines)}};
  json["proposed"] = Json::array();
  for (const ProposedParameter& parameter : diagnosis.proposed) {
    json["proposed"].push_back({{"name", parameter.name},
                                {"given", parameter.is_given},
                                {"scatter", parameter.is_freed},
                                {"bic_lowered", parameter.bic}});
  }
  json["model_evaluations"] = diagnosis.model_evaluations;
  return json;
}

std::vector<std::string> table_lines(const Diagnosis& diagnosis) {
  std::vector<std::string> lines;
  lines.push_back(fmt::format("{:<16} {:>11} {:>9} {:>11} {:>11} {:>9} {:>9} {:>9}  how", "candidate", "nominal", "BIC",
                              "mean", "std", "p (Holm)", "visible", "own part"));
  for (const CandidateFinding& finding : diagnosis.candidates) {
    const CandidateFit& fit = finding.better();
    const std::string start =
        fmt::format("{:<16} {:>11.5g}", finding.detectability.name, finding.detectability.nominal);
    const std::string seen =
        fmt::format("{:>9.3g} {:>9.3f}", finding.detectability.visibility, finding.detectability.own_share);
    if (!fit.failure.empty()) {
      lines.push_back(fmt::format("{} {:>9} {:>11} {:>11} {:>9} {}  {}", start, "", "", "", "", seen, fit.failure));
      continue;
    }
    lines.push_back(fmt::format("{} {:>+9.1f} {:>11.5g} {:>11.4g} {:>9.2g} {}  {}", start, fit.bic, fit.mean,
                                fit.deviation, fit.adjusted_p, seen, fit.is_freed ? "freed" : "shifted"));
  }
  lines.push_back(fmt::format("{:<16} {:>11} {:>9} {:>11} {:>11} {:>9} {:>9} {:>9}", "parameter", "prior", "", "", "",
                              "", "visible", "own part"));
  for (const Detectability& each : diagnosis.given) {
    lines.push_back(fmt::format("{:<16} {:>11.5g} {:>9} {:>11} {:>11} {:>9} {:>9.3g} {:>9.3f}", each.name, each.nominal,
                                "", "", "", "", each.visibility, each.own_share));
  }
  for (const std::string& sentence : diagnosis.sentences) lines.push_back(sentence);
  return lines;
}

}  // namespace

RunSummary run_diagnose(const Study& study, const RunSettings& settings) {
  const double start = steady_seconds();
  require(!study.parameters.list.empty(), "{}: parameter: there is none; give at least one [[parameter]]",
          study.file.string());
  const Study whole = with_candidates(study, resolve_candidates(study));
  const StudyModel made = make_model(whole, whole.parameters, settings);
  const StudyTests tests = read_tests(study, *made.model);
  refuse_unit_errors(study, made, tests);
  const RunFolder folder(settings.folder);
  LogObserver log(folder.file("diagnosis.log"), settings.observer, settings.resume);
  const std::filesystem::path journal = folder.file("diagnosis.journal");
  const JournalledModel model(*made.model, journal, study_fingerprint(whole, made), settings.resume);
  std::vector<std::string> given;
  for (const StudyParameter& parameter : study.parameters.list) given.push_back(parameter.name);
  const std::vector<int> groups = covariance_groups(study, given);
  const UpdatingProblem problem{.model = model,
                                .derivatives = made.model->structure().has_derivatives() ? made.model.get() : nullptr,
                                .space = *made.space,
                                .tests = tests.data,
                                .iterations = study.update.iterations,
                                .level = study.update.level,
                                .tolerance = study.update.tolerance,
                                .covariance_groups = groups};
  const RunContext context{.seed = study.seed, .threads = settings.threads, .observer = &log, .stop = settings.stop};
  for (const std::string& note : made.notes) context.note(note);
  for (const std::string& note : tests.notes) context.note(note);
  if (tests.is_by_rank) {
    if (const auto numbering = rank_note(made.model->selection(), tests.data.values)) context.note(*numbering);
  }
  const DiagnosisSettings rules{.given = static_cast<Eigen::Index>(study.parameters.list.size()),
                                .screened = study.diagnose.screened,
                                .like_evidence = study.diagnose.like_evidence};
  const auto forget = [&](const std::filesystem::path& file) {
    std::error_code ignored;  // a file that stays behind does no harm
    std::filesystem::remove(file, ignored);
  };
  const Diagnosis diagnosis = compute_or_discard(study, folder, {k_result}, [&] {
    try {
      return diagnose(problem, rules, context);
    } catch (const InvalidInput&) {
      forget(journal);
      forget(folder.file("diagnosis.log"));
      throw;
    }
  });

  Json json = diagnosis_json(study, whole, diagnosis);
  json["timings_s"] = {{"total", steady_seconds() - start}};
  folder.write(k_result, pretty(json));
  forget(journal);
  folder.forget_previous({k_result});
  RunSummary summary;
  summary.status = "done";
  summary.lines = table_lines(diagnosis);
  summary.lines.push_back("diagnosis: " + folder.file(k_result).string());
  summary.json = Json{{"command", "diagnose"},
                      {"explained", diagnosis.is_explained},
                      {"best", json["best"]},
                      {"alike", diagnosis.alike},
                      {"sentences", diagnosis.sentences},
                      {"proposed", json["proposed"]},
                      {"folder", folder.path().string()},
                      {"result", folder.file(k_result).string()}}
                     .dump(-1, ' ', false, Json::error_handler_t::replace);
  return summary;
}

}  // namespace mottle
