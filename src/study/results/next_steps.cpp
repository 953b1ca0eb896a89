#include "study/results/next_steps.hpp"

#include <algorithm>
#include <string_view>

#include "mottle/core/error.hpp"
#include "mottle/core/shell_word.hpp"
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

NextStep more_iterations(const SummarySources& s) {
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

std::vector<NextStep> next_steps(const SummarySources& s) {
  std::vector<NextStep> steps;
  if (s.result.status != UpdatingStatus::converged && s.result.status != UpdatingStatus::stalled) {
    steps.push_back(more_iterations(s));
  }
  if (s.verdict.conclusion == Conclusion::inadequate) steps.push_back(diagnosis(s));
  const bool has_population = s.problem.tests.values.rows() > 1;
  if (!s.result.is_population && has_population) steps.push_back(population_method(s));
  if (s.verdict.conclusion != Conclusion::inadequate && s.verdict.lacks_outputs) {
    steps.push_back(further_outputs(s));
  }
  if (steps.empty() && s.verdict.conclusion == Conclusion::undecided) {
    const bool has_noise = (s.problem.tests.repeatability_std.array() > 0.0).all();
    steps.push_back(has_noise ? diagnosis(s) : stated_noise(s));
  }
  const bool is_noise_known = (s.problem.tests.repeatability_std.array() > 0.0).all();
  if (steps.empty() && has_population && !is_noise_known) {
    steps.push_back(noise_apart(s));
  }
  if (!s.study.predict && (steps.empty() || s.verdict.conclusion == Conclusion::adequate))
    steps.push_back(prediction(s));
  if (steps.empty()) {
    steps.push_back({"", "Compare the predictions with their tests before the model is used for anything else."});
  }
  return steps;
}

}  // namespace mottle::study
