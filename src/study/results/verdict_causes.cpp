#include "study/results/verdict_causes.hpp"

#include <algorithm>
#include <cmath>

#include "mottle/core/text.hpp"
#include "study/results/next_steps.hpp"
#include "study/results/specimen_causes.hpp"

namespace mottle::study {
namespace {

using Causes = std::vector<VerdictCause>;

void add_doubts_of_tests(const SummarySources& s, Causes& causes) {
  for (const TestDoubt& doubt : s.doubts)
    causes.push_back({.kind = doubt.kind, .sentence = doubt.sentence, .next = checked_tests(s, doubt)});
}

void add_crossing(const SummarySources& s, Causes& causes) {
  if (!s.numbering) return;
  causes.push_back({.kind = "crossing-modes",
                    .sentence = *s.numbering + '.',
                    .next = {"", "Pair the modes by shape: give tests with shapes, and set test.pairing = \"mac\"."}});
}

/// Outputs for which `claim` is known not to hold, the worst first.
std::vector<std::string> not_reproduced(const SummarySources& s, std::optional<bool> OutputAgreement::*claim) {
  std::vector<std::string> names;
  for (const OutputAgreement& output : s.agreement.outputs) {
    if (!(output.*claim).value_or(true))
      names.push_back(s.problem.model.outputs()[static_cast<std::size_t>(output.output)].name());
  }
  return names;
}

std::vector<std::string> parameters_at_bounds(const SummarySources& s) {
  std::vector<std::string> names;
  const Eigen::VectorXi active = s.problem.space.active_bounds(s.result.location());
  for (Eigen::Index i = 0; i < active.size(); ++i) {
    if (active(i) != 0) names.push_back(s.problem.space.names()[static_cast<std::size_t>(i)]);
  }
  return names;
}

/// "f3, f1 and 4 more".
std::string few(const std::vector<std::string>& names) {
  constexpr std::size_t k_named = 4;
  if (names.size() <= k_named) return join(names);
  return fmt::format("{} and {} more", join({names.begin(), names.begin() + k_named}), names.size() - k_named);
}

/// Which aspect of the tests a failed test is of.
std::string kind_of(const VerdictTest& test) {
  for (const char* name : {"mean-residuals", "mean-agreement", "residuals", "reproduction"}) {
    if (test.name == name) return "means";
  }
  for (const char* name : {"scatter-of-residuals", "scatter-agreement", "correlations", "specimens"}) {
    if (test.name == name) return "scatter";
  }
  return test.name;  // "bounds", "prior-shift", "cover"
}

VerdictCause failed_means(const SummarySources& s, const VerdictTest& test) {
  VerdictCause cause{.kind = "means", .outputs = not_reproduced(s, &OutputAgreement::is_mean_reproduced)};
  if (test.name == "reproduction") {
    cause.sentence = "No parameters reproduce the tests of some specimens.";
  } else if (cause.outputs.empty()) {
    cause.sentence =
        "What no parameter can change in the outputs' means differs between model and tests, in several outputs "
        "together.";
  } else {
    cause.sentence =
        fmt::format("The means of {} differ from the tests' by more than chance allows.", few(cause.outputs));
  }
  return cause;
}

VerdictCause failed_scatter(const SummarySources& s, const VerdictTest& test) {
  VerdictCause cause{.kind = "scatter", .outputs = not_reproduced(s, &OutputAgreement::is_scatter_reproduced)};
  if (test.name == "specimens") {
    cause.sentence =
        "The specimens differ by more than the measurement's noise, and this method takes them for one structure.";
  } else if (test.name == "correlations") {
    cause.sentence = "Parameters that may not be correlated in this study are correlated in the tests.";
  } else if (cause.outputs.empty()) {
    cause.sentence = "The outputs scatter together in a way that the parameters and the noise do not explain.";
  } else {
    cause.sentence =
        fmt::format("The scatter of {} is not what the parameters and the noise explain.", few(cause.outputs));
  }
  return cause;
}

VerdictCause failed_limit(const SummarySources& s, const VerdictTest& test) {
  if (test.name == "bounds") {
    return {.kind = "bounds",
            .sentence = fmt::format("The tests ask for values beyond the bounds of {}.", few(parameters_at_bounds(s)))};
  }
  if (test.name == "prior-shift") {
    return {.kind = "prior-shift",
            .sentence =
                fmt::format("A mean lies {:.3g} standard deviations from its prior: another unit, model or structure.",
                            test.statistic)};
  }
  return {.kind = kind_of(test), .sentence = test.meaning + " They do not."};
}

/// One cause for each aspect that a test refused.
void add_failed_tests(const SummarySources& s, Causes& causes) {
  if (s.verdict.conclusion != Conclusion::inadequate) return;
  for (const VerdictTest& test : s.verdict.tests) {
    const std::string kind = kind_of(test);
    if (test.passed || std::ranges::any_of(causes, [&](const VerdictCause& made) { return made.kind == kind; }))
      continue;
    VerdictCause cause = kind == "means"     ? failed_means(s, test)
                         : kind == "scatter" ? failed_scatter(s, test)
                                             : failed_limit(s, test);
    cause.next = kind == "scatter" && !s.result.is_population && s.problem.tests.values.rows() > 1
                     ? population_method(s)
                     : diagnosis(s);
    causes.push_back(std::move(cause));
  }
}

void add_solutions(const SummarySources& s, Causes& causes) {
  double others = 0.0;
  for (const OtherSolution& other : s.result.other_solutions) others += other.weight;
  if (others > s.verdict.level) {
    causes.push_back(
        {.kind = "other-solutions",
         .sentence = fmt::format(
             "{} other {} the tests as well, with a probability of {:.2g} % together.", s.result.other_solutions.size(),
             s.result.other_solutions.size() == 1 ? "set of parameters explains" : "sets of parameters explain",
             100.0 * others),
         .next = {"",
                  "Measure an output that differs between the solutions (a shape at a place that tells like parts "
                  "apart, a frequency with a known mass added), or state a prior or bounds that leave one of them."}});
  }
  if (s.result.search && s.result.search->starts > 0 && !s.result.search->is_settled) {
    causes.push_back({.kind = "search-not-settled",
                      .sentence = fmt::format(
                          "The search for all solutions ended after {} starts and had met some of them only once.",
                          s.result.search->starts),
                      .next = more_starts(s)});
  }
}

/// What keeps a verdict from being decided.
void add_open_questions(const SummarySources& s, Causes& causes) {
  if (s.verdict.conclusion != Conclusion::undecided) return;
  const bool has_population = s.problem.tests.values.rows() > 1;
  if (s.result.status != UpdatingStatus::converged) {
    const bool is_stalled = s.result.status == UpdatingStatus::stalled;  // more of the same would not help
    causes.push_back(
        {.kind = "not-converged",
         .sentence = (s.result.posterior ? "The sampling is in doubt: " : "The iteration did not converge: ") +
                     s.result.message + (s.result.message.ends_with('.') ? "" : "."),
         .next = !is_stalled              ? more_iterations(s)
                 : s.result.is_population ? diagnosis(s)
                                          : population_method(s)});
  }
  if (!s.result.is_population && has_population && !s.result.interval) {
    causes.push_back(
        {.kind = "scatter-not-estimated",
         .sentence = fmt::format("Method '{}' does not estimate the scatter of the specimens.", s.study.update.method),
         .next = population_method(s)});
  }
  if (s.verdict.lacks_outputs) {
    causes.push_back(
        {.kind = "too-few-outputs",
         .sentence = fmt::format(
             "{} outputs are no more than the parameters can match, whatever they are: the means could not be tested.",
             s.problem.model.outputs().size()),
         .next = further_outputs(s)});
  }
  add_solutions(s, causes);
  const bool is_noise_known = (s.problem.tests.repeatability_std.array() > 0.0).all();
  if (!is_noise_known) {
    causes.push_back(
        {.kind = "unknown-noise",
         .sentence = "The measurement's noise is not stated for every output, so that the tests find little.",
         .next = stated_noise(s)});
  }
}

void add_bounds(const SummarySources& s, Causes& causes) {
  const std::vector<std::string> names = parameters_at_bounds(s);
  if (names.empty() || std::ranges::any_of(causes, [](const VerdictCause& made) { return made.kind == "bounds"; }))
    return;
  causes.push_back({.kind = "at-bound",
                    .sentence = fmt::format("{} ended on {}, which the tests neither refuse nor determine.", few(names),
                                            names.size() == 1 ? "its bound" : "their bounds"),
                    .next = {"", fmt::format("Look at the bounds of {}: widen them where the structure allows, or do "
                                             "not update what the tests do not see.",
                                             few(names))}});
}

}  // namespace

std::vector<VerdictCause> find_causes(const SummarySources& s) {
  Causes causes;
  add_doubts_of_tests(s, causes);
  add_causes_of_specimens(s, causes);
  add_crossing(s, causes);
  add_failed_tests(s, causes);
  add_open_questions(s, causes);
  if (!s.result.interval) add_bounds(s, causes);
  return causes;
}

Json causes_json(const std::vector<VerdictCause>& causes) {
  Json list = Json::array();
  for (const VerdictCause& cause : causes) {
    list.push_back({{"kind", cause.kind},
                    {"sentence", cause.sentence},
                    {"specimens", cause.specimens},
                    {"outputs", cause.outputs},
                    {"next", step_json(cause.next)}});
  }
  return list;
}

}  // namespace mottle::study
