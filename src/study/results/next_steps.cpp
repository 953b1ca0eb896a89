#include "study/results/next_steps.hpp"

#include <algorithm>
#include <string_view>

#include "mottle/core/error.hpp"
#include "mottle/core/shell_word.hpp"
#include "mottle/core/text.hpp"
#include "mottle/study/models/model_source.hpp"
#include "mottle/updating/methods/iteration.hpp"

namespace mottle::study {
namespace {

std::string command_of(const SummarySources& s, std::string_view verb, const std::string& more = {}) {
  const std::string file = s.study.file.filename().string();
  return fmt::format("mottle {} {}{}{}", verb, shell_word(file.starts_with('-') ? "./" + file : file),
                     more.empty() ? "" : " ", more);
}

/// Of a model that a program gives there is no file: the program does the next step.
bool is_given(const SummarySources& s) {
  return s.study.file.empty();
}

/// Without a file the reason alone.
NextStep update_with(const SummarySources& s, const std::string& setting, std::string reason) {
  if (is_given(s)) return {"", std::move(reason)};
  return {command_of(s, "update", "--set " + shell_word(setting)), std::move(reason)};
}

}  // namespace

NextStep checked_tests(const SummarySources& s, const TestDoubt& doubt) {
  const bool is_of_table = s.study.test && s.study.test->pairing != TestPairing::mac;
  if (doubt.kind == "mode-order" && is_of_table && !is_given(s)) {
    return update_with(
        s, "test.pairing=\"frequency\"",
        "Pairs the columns with the model's modes by frequency; look first whether columns of the tests are "
        "exchanged.");
  }
  if (doubt.kind == "mistaken-sensors") {
    return {"",
            "Look at the test's set-up; if it was so, exchange the columns of these sensors, or reverse the sign, in "
            "the tests."};
  }
  return {"", "Check these tests: their values, units and columns, and which modes they are."};
}

NextStep without_specimens(const SummarySources& s, const std::vector<int>& specimens) {
  std::vector<int> left_out = s.study.test ? s.study.test->left_out : std::vector<int>{};
  left_out.insert(left_out.end(), specimens.begin(), specimens.end());
  return update_with(
      s, fmt::format("test.leave_out=[{}]", fmt::join(left_out, ", ")),
      fmt::format(
          "Look at specimen {} and its test first: a loose joint, another design, a slip of the test? This updates "
          "without it.",
          fmt::join(specimens, ", ")));
}

NextStep other_population(const SummarySources& s, bool has_batches) {
  if (!has_batches) {
    return {"",
            "Set the scale that is named for a parameter, where one is: means, standard deviations and intervals "
            "assume a normal population on the parameters' scales."};
  }
  return update_with(s, "update.method=\"mixture\"",
                     "Asks whether the specimens come from several batches, and gives each its own population.");
}

NextStep more_starts(const SummarySources& s) {
  return update_with(s, fmt::format("update.starts={}", 2 * s.problem.starts),
                     "Searches longer for other parameters that explain the tests as well.");
}

NextStep more_iterations(const SummarySources& s) {
  if (s.result.posterior) {
    return {
        is_given(s) ? "" : command_of(s, "update"),
        "After allowing the sampler more model runs, or giving it fewer particles: it ended before it had reached the "
        "posterior."};
  }
  if (is_given(s)) return {"", "The update did not converge: allow more iterations, or start nearer to the solution."};
  return {command_of(s, "update", fmt::format("--set update.iterations={}", 2 * s.problem.iterations)),
          "The update did not converge: allow more iterations, or start nearer to the solution."};
}

/// A model by command has no list of numbers that could be tried.
NextStep diagnosis(const SummarySources& s) {
  if (is_given(s)) {
    return {"", "Make further numbers of the function parameters: one that is wrong may be what the tests show."};
  }
  if (!s.study.model->has_targets()) {
    return {command_of(s, "update"),
            "After making further numbers of the solver's input placeholders with parameters of their own: `mottle "
            "diagnose` cannot try them, since it does not know the input of a program."};
  }
  return {command_of(s, "diagnose"),
          "Tries the model's other numbers as further parameters, and says which of them explains the tests best."};
}

NextStep stated_noise(const SummarySources& s) {
  if (is_given(s)) {
    return {"",
            "Give the repeatability of every output: with known measurement noise what the model leaves of the tests "
            "can be tested."};
  }
  return {
      command_of(s, "update"),
      "After giving [test] repeatability of every output: with known measurement noise what the model leaves of the "
      "tests can be tested."};
}

NextStep population_method(const SummarySources& s) {
  const bool are_repeated = (test_moments(s.problem.tests).count.array() > 1).all();
  const std::string method = are_repeated ? "maximum-likelihood" : "hierarchical";
  if (is_given(s)) {
    return {"",
            fmt::format("Update by \"{}\": it estimates the scatter of the specimens too, so that it can be compared "
                        "with that of the tests.",
                        method)};
  }
  return {command_of(s, "update", "--set " + shell_word(fmt::format("update.method=\"{}\"", method))),
          "Estimates the scatter of the specimens too, so that it can be compared with that of the tests."};
}

NextStep further_outputs(const SummarySources& s) {
  if (is_given(s)) {
    return {"",
            "Add outputs to the function and its tests: with more outputs than parameters the means can be tested."};
  }
  return {command_of(s, "check"),
          "After adding outputs to the study and its tests, such as mode shapes or further frequencies: with more "
          "outputs than parameters the means can be tested."};
}

namespace {

NextStep noise_apart(const SummarySources& s) {
  const std::string why =
      ": without it scatter of the parameters and noise of the tests are told apart by the outputs' number alone, and "
      "a "
      "parameter that does not vary may seem to.";
  if (is_given(s)) return {"", "Give the repeatability of every output" + why};
  return {command_of(s, "update"), "After giving [test] repeatability of every output" + why};
}

NextStep prediction(const SummarySources& s) {
  if (is_given(s)) {
    return {"",
            "Keep tests back, update without them, and see whether the updated model's cloud holds them: only "
            "predictions of tests that were not used show whether the model predicts."};
  }
  return {
      "",
      "Keep tests back and add [predict] to the study (held_out = a file of these tests, frequencies = the modes to "
      "predict), then update again: only predictions of tests that were not used show whether the model predicts."};
}

}  // namespace

std::vector<NextStep> next_steps(const SummarySources& s, const std::vector<VerdictCause>& causes) {
  std::vector<NextStep> steps;
  const auto add = [&steps](NextStep step) {
    const bool is_new = std::ranges::none_of(
        steps, [&](const NextStep& made) { return made.command == step.command && made.reason == step.reason; });
    if (is_new) steps.push_back(std::move(step));
  };
  for (const VerdictCause& cause : causes) add(cause.next);
  const bool has_population = s.problem.tests.values.rows() > 1;
  const bool is_noise_known = (s.problem.tests.repeatability_std.array() > 0.0).all();
  if (s.verdict.conclusion == Conclusion::inadequate) add(diagnosis(s));
  if (!s.result.is_population && has_population) add(population_method(s));
  if (steps.empty() && s.verdict.conclusion == Conclusion::undecided) add(diagnosis(s));
  if (steps.empty() && has_population && !is_noise_known) add(noise_apart(s));
  if (!s.study.predict && (steps.empty() || s.verdict.conclusion == Conclusion::adequate)) add(prediction(s));
  if (steps.empty()) add({"", "Compare the predictions with their tests before the model is used for anything else."});
  return steps;
}

Json step_json(const NextStep& step) {
  return {{"command", step.command.empty() ? Json(nullptr) : Json(step.command)}, {"reason", step.reason}};
}

}  // namespace mottle::study
