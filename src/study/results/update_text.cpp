#include "study/results/update_text.hpp"

#include <algorithm>
#include <cmath>
#include <filesystem>
#include <optional>

#include "mottle/updating/methods/interval.hpp"
#include "study/jobs/update_workings.hpp"
#include "study/results/agreement.hpp"
#include "study/results/next_steps.hpp"
#include "study/results/result_json.hpp"

namespace mottle::study {
namespace {

std::string interval_text(const Eigen::Ref<const Eigen::RowVectorXd>& ends) {
  return ends.allFinite() ? fmt::format("[{:.5g}, {:.5g}]", ends(0), ends(1)) : "not determined";
}

std::vector<std::string> table_lines(const UpdateOutcome& outcome) {
  const UpdatingProblem& problem = outcome.problem();
  const UpdatingResult& result = outcome.result;
  const std::vector<std::optional<FactorNominal>>& factors = outcome.workings->factors;
  const bool has_factors = std::ranges::any_of(factors, [](const auto& factor) { return factor.has_value(); });
  std::vector<std::string> lines;
  lines.push_back(fmt::format("{}: {}", status_text(result.status), result.message));
  const auto ends_text = [&](const std::string& mean, const std::string& std) {
    if (!result.intervals) return std::string();
    return result.is_population ? fmt::format("  {:>23} {:>23}", mean, std) : fmt::format("  {:>23}", mean);
  };
  // For a method that does not estimate the scatter, the column must not be mistaken for it.
  lines.push_back(fmt::format("{:<14} {:>13} {:>13} {:>13} {:>13}{}{}", "parameter", "prior mean", "prior std",
                              result.interval ? "lower" : "mean",
                              result.interval                          ? "upper"
                              : result.is_population                   ? "std"
                              : outcome.study.update.method == "mares" ? "std (Eq. 12)"
                                                                       : "std (mean's)",
                              ends_text("mean, 95 %", "std, 95 %"),
                              has_factors ? fmt::format("  {:>16}", "model's number") : ""));
  const Eigen::VectorXd prior_mean = problem.space.prior().mean();
  const Eigen::VectorXd prior_std = problem.space.prior().covariance().diagonal().cwiseSqrt();
  const Eigen::VectorXi active = problem.space.active_bounds(result.location());
  for (Eigen::Index i = 0; i < result.mean.size(); ++i) {
    const std::string intervals = result.intervals ? ends_text(interval_text(result.intervals->mean.row(i)),
                                                               interval_text(result.intervals->std.row(i)))
                                                   : "";
    const Parameter& parameter = problem.space.parameters()[static_cast<std::size_t>(i)];
    const std::optional<FactorNominal>& factor = factors[static_cast<std::size_t>(i)];
    lines.push_back(fmt::format(
        "{:<14} {:>13.6g} {:>13.6g} {:>13.6g} {:>13.6g}{}{}{}", parameter.name, prior_mean(i), prior_std(i),
        result.interval ? result.interval->box.lower(i) : result.mean(i),
        result.interval ? result.interval->box.upper(i) : std::sqrt(result.covariance(i, i)), intervals,
        factor        ? fmt::format("  {:>16}", fmt::format("{:.5g} {}", factor->value * result.mean(i), factor->unit))
        : has_factors ? fmt::format("  {:>16}", "")
                      : "",
        active(i) == 0 ? "" : (active(i) < 0 ? "  at its lower bound" : "  at its upper bound")));
  }
  return lines;
}

/// "next: mottle diagnose study.toml", and why.
void add_next_step(const UpdateOutcome& outcome, const NextStep& step, std::vector<std::string>& lines) {
  const std::filesystem::path folder = outcome.study.file.parent_path();
  const std::string where = folder.empty() || step.command.empty() ? "" : fmt::format(" (in {})", folder.string());
  lines.push_back(fmt::format("next{}: {}", where, step.command.empty() ? step.reason : step.command));
  if (!step.command.empty()) lines.push_back("  " + step.reason);
}

/// The answer, what it comes from, and what to do next.
std::vector<std::string> first_lines(const UpdateOutcome& outcome, const VerdictSummary& first) {
  constexpr std::size_t k_shown = 3;
  std::vector<std::string> lines{fmt::format("verdict: {}", conclusion_text(outcome.verdict.conclusion))};
  if (!first.answer.empty()) lines.push_back("  " + first.answer);
  for (std::size_t i = 0; i < std::min(first.causes.size(), k_shown); ++i)
    lines.push_back("  " + first.causes[i].sentence);
  if (first.causes.empty()) lines.push_back("  " + first.headline);
  add_next_step(outcome, first.next.front(), lines);
  return lines;
}

/// The tests in words, and what was not tested or could hide.
std::vector<std::string> reason_lines(const UpdateOutcome& outcome) {
  const Verdict& verdict = outcome.verdict;
  const CouldHide& hidden = outcome.could_hide;
  std::vector<std::string> lines;
  if (!verdict.reasons.empty()) lines.emplace_back("why:");
  for (const std::string& reason : verdict.reasons) lines.push_back("  " + reason);
  if (!verdict.not_tested.empty()) lines.emplace_back("not tested:");
  for (const std::string& sentence : verdict.not_tested) lines.push_back("  " + sentence);
  if (verdict.conclusion == Conclusion::adequate && !hidden.summary.empty()) lines.push_back("  " + hidden.summary);
  return lines;
}

}  // namespace

VerdictSummary first_screen(const UpdateOutcome& outcome, const Agreement& agreement) {
  return summarise_verdict({outcome.study, outcome.problem(), outcome.result, outcome.verdict, agreement,
                            outcome.could_hide, outcome.workings->plan.tests.doubts, outcome.numbering});
}

std::vector<std::string> verdict_lines(const UpdateOutcome& outcome) {
  std::vector<std::string> lines =
      first_lines(outcome, first_screen(outcome, compare_with_tests(outcome.problem(), outcome.result)));
  for (std::string& line : reason_lines(outcome)) lines.push_back(std::move(line));
  return lines;
}

RunSummary summarise(const UpdateOutcome& outcome, const std::filesystem::path& folder) {
  const UpdatingProblem& problem = outcome.problem();
  const UpdatingResult& result = outcome.result;
  RunSummary summary{.status = status_text(result.status), .message = result.message};
  const VerdictSummary first = first_screen(outcome, compare_with_tests(problem, result));
  summary.lines = first_lines(outcome, first);
  for (std::string& line : table_lines(outcome)) summary.lines.push_back(std::move(line));
  for (std::string& line : reason_lines(outcome)) summary.lines.push_back(std::move(line));
  const std::optional<Identifiability> seen = identify(problem, result);
  if (seen && !seen->unseen_directions.empty()) {
    summary.lines.emplace_back("not determined by the tests:");
    for (const Eigen::VectorXd& direction : seen->unseen_directions) {
      summary.lines.push_back("  " + unseen_text(direction, problem.space.names()));
    }
  }
  if (outcome.prediction) {
    for (const std::string& note : outcome.prediction->notes) summary.lines.push_back(note);
  }
  const Json json = {{"command", "update"},
                     {"status", summary.status},
                     {"message", summary.message},
                     {"conclusion", conclusion_text(outcome.verdict.conclusion)},
                     {"adequate", adequate_json(outcome.verdict.conclusion)},
                     {"causes", causes_json(first.causes)},
                     {"parameters", updated_parameters_json(problem, result)},
                     {"model_evaluations", result.model_evaluations},
                     {"folder", folder.string()},
                     {"result", (folder / "result.json").string()},
                     {"report", (folder / "report.html").string()}};
  summary.json = one_line(json);
  return summary;
}

}  // namespace mottle::study
