#include "study/results/verdict_summary.hpp"

#include <algorithm>
#include <cmath>
#include <limits>
#include <string_view>

#include "mottle/core/text.hpp"
#include "study/results/interval_json.hpp"
#include "study/results/method_answer.hpp"
#include "study/results/next_steps.hpp"
#include "study/results/verdict_causes.hpp"

namespace mottle::study {
namespace {

std::string name_of(const SummarySources& s, const OutputAgreement& output) {
  return s.problem.model.outputs()[static_cast<std::size_t>(output.output)].name();
}

bool has_test(const Verdict& verdict, const std::vector<std::string_view>& names) {
  return std::any_of(verdict.tests.begin(), verdict.tests.end(), [&](const VerdictTest& test) {
    return std::find(names.begin(), names.end(), test.name) != names.end();
  });
}

std::string headline_of(const SummarySources& s) {
  const bool has_means = s.agreement.are_means_reproduced();
  const bool has_scatter = s.agreement.is_scatter_reproduced();
  switch (s.verdict.conclusion) {
    case Conclusion::inadequate:
      return "The model does not explain the tests.";
    case Conclusion::adequate:
      if (s.result.interval) {
        return fmt::format("No test refuses the model, and the box covers the bounds of the tests{}.",
                           s.result.interval->excess.minCoeff() < 0.0 ? ", up to their noise" : "");
      }
      if (!s.result.outliers.empty()) return "No test refuses the model, but not all specimens are of one population.";
      if (has_means && has_scatter) return "The model explains the tests: it was tested, and no test refuses it.";
      return fmt::format("No test refuses the model, but it does not reproduce the {} of every output.",
                         has_scatter ? "mean"
                         : has_means ? "scatter"
                                     : "mean and scatter");
    default:
      if (s.result.interval) return "No test refuses the model, but too little of it could be tested to call it right.";
      if (!has_means && !has_scatter) return "Neither means nor scatter of the tests are explained.";
      if (!has_scatter) return "The scatter of the tests is not explained.";
      if (!has_means) return "The means of the tests are not explained.";
      return "No test refuses the model, but too little of it could be tested to call it right.";
  }
}

/// The output with the largest of `size`, of those where it is known.
template <class Size>
const OutputAgreement* largest(const Agreement& agreement, Size size) {
  const OutputAgreement* found = nullptr;
  for (const OutputAgreement& output : agreement.outputs) {
    if (!std::isfinite(size(output))) continue;
    if (found == nullptr || size(output) > size(*found)) found = &output;
  }
  return found;
}

std::string mean_error_text(const SummarySources& s, const OutputAgreement& output, const CloudComparison& cloud) {
  if (std::isfinite(cloud.mean_error)) {
    return fmt::format("{:.2g} % ({})", 100.0 * std::abs(cloud.mean_error), name_of(s, output));
  }
  return fmt::format("{:.2g} {} ({})", std::abs(cloud.mean_difference),
                     s.problem.model.outputs()[static_cast<std::size_t>(output.output)].unit, name_of(s, output));
}

/// "f3, f1": at most four of those for which `is_bad` holds.
template <class Claim>
std::string names_where(const SummarySources& s, Claim is_bad) {
  constexpr std::size_t k_named = 4;
  std::vector<std::string> names;
  std::size_t more = 0;
  for (const OutputAgreement& output : s.agreement.outputs) {
    if (!is_bad(output)) continue;
    if (names.size() < k_named) {
      names.push_back(name_of(s, output));
    } else {
      ++more;
    }
  }
  return more > 0 ? fmt::format("{} and {} more", join(names), more) : join(names);
}

void say_means(const SummarySources& s, std::vector<std::string>& sentences) {
  const auto in_errors = [](const OutputAgreement& output) { return std::abs(output.final.standard_errors); };
  const auto error_before = [](const OutputAgreement& output) { return std::abs(output.initial.mean_error); };
  const OutputAgreement* worst = largest(s.agreement, in_errors);
  if (worst == nullptr) worst = largest(s.agreement, [](const auto& o) { return std::abs(o.final.mean_error); });
  if (worst == nullptr) return;
  const OutputAgreement* before = largest(s.agreement, error_before);
  if (before == nullptr) before = worst;
  std::string text = fmt::format("Means: the largest error is {}", mean_error_text(s, *worst, worst->final));
  if (std::isfinite(in_errors(*worst))) text += fmt::format(", {:.2g} standard errors", in_errors(*worst));
  text += fmt::format("; before the update it was {}.", mean_error_text(s, *before, before->initial));
  if (!s.agreement.are_means_reproduced()) {
    text += fmt::format(" Beyond chance: {}.",
                        names_where(s, [](const auto& o) { return !o.is_mean_reproduced.value_or(true); }));
  }
  const bool is_tested = has_test(s.verdict, {"mean-residuals", "mean-agreement", "residuals"});
  if (!is_tested) text += " They were fitted, and not tested.";
  sentences.push_back(std::move(text));
}

std::string range_of_ratios(const SummarySources& s) {
  double least = std::numeric_limits<double>::infinity();
  double greatest = 0.0;
  for (const OutputAgreement& output : s.agreement.outputs) {
    if (!std::isfinite(output.final.std_ratio)) continue;
    least = std::min(least, output.final.std_ratio);
    greatest = std::max(greatest, output.final.std_ratio);
  }
  return fmt::format("{:.0f} % to {:.0f} %", 100.0 * least, 100.0 * greatest);
}

void say_region(const SummarySources& s, std::string& text) {
  if (!s.agreement.region) return;
  const RegionAgreement& region = *s.agreement.region;
  const bool has_gaps = region.tests < s.problem.tests.values.rows();
  text +=
      fmt::format(" {} of {} {} lie within the region that contains {:.0f} % of the updated model's outputs",
                  region.final, region.tests, has_gaps ? "tests without gaps" : "tests", 100.0 * region.probability);
  if (!region.is_judged) {
    text += ", which lacks the noise of the tests, as the study does not state it.";
  } else {
    text += region.is_reproduced() ? "." : fmt::format("; at least {} should.", region.min_inside);
  }
}

/// " with the measurement's noise", where the model's scatter holds some.
std::string noise_text(const SummarySources& s, const OutputAgreement& output) {
  const bool is_known = s.problem.tests.repeatability_std(output.output) > 0.0;
  const bool is_found =
      s.result.noise_covariance.size() > 0 && s.result.noise_covariance(output.output, output.output) > 0.0;
  return is_known || is_found ? " with the measurement's noise" : "";
}

void say_scatter(const SummarySources& s, std::vector<std::string>& sentences) {
  const OutputAgreement* worst =
      largest(s.agreement, [](const OutputAgreement& output) { return output.scatter_misfit(); });
  const bool has_zero = std::any_of(s.agreement.outputs.begin(), s.agreement.outputs.end(),
                                    [](const auto& output) { return output.final.std_ratio == 0.0; });
  std::string text;
  if (has_zero) {
    text = "Scatter: the updated model has none where the tests scatter.";
  } else if (worst == nullptr) {
    text = "Scatter: the tests show none, so it was not compared.";
  } else if (worst->is_scatter_reproduced.value_or(true)) {
    text = fmt::format(
        "Scatter: standard deviations are {} of the tests', within what chance allows (for {} {:.0f} % to {:.0f} %).",
        range_of_ratios(s), name_of(s, *worst), 100.0 * worst->min_std_ratio, 100.0 * worst->max_std_ratio);
  } else {
    text = fmt::format(
        "Scatter differs: {}'s standard deviation in the updated model{} is {:.0f} % of the tests' ({:.0f} % "
        "to "
        "{:.0f} % would be chance).",
        name_of(s, *worst), noise_text(s, *worst), 100.0 * worst->final.std_ratio, 100.0 * worst->min_std_ratio,
        100.0 * worst->max_std_ratio);
  }
  say_region(s, text);
  const bool is_noise_stated = worst == nullptr || s.problem.tests.repeatability_std(worst->output) > 0.0;
  if (worst != nullptr && !worst->is_scatter_reproduced.value_or(true) && worst->final.std_ratio < 1.0 &&
      !is_noise_stated && s.result.noise_covariance.size() == 0) {
    text += " What is missing may in part be measurement noise, which the study does not state.";
  }
  if (!s.result.is_population && s.problem.tests.values.rows() > 1) {
    text += fmt::format(" Method '{}' does not estimate the scatter.", s.study.update.method);
  } else if (!has_test(s.verdict, {"scatter-of-residuals", "scatter-agreement", "correlations", "reproduction"})) {
    text += worst == nullptr ? "" : " It was fitted, and not tested.";
  }
  sentences.push_back(std::move(text));
}

void say_assumptions(const SummarySources& s, std::vector<std::string>& sentences) {
  if (s.verdict.conclusion == Conclusion::inadequate) {
    sentences.emplace_back(
        "Something that was not updated varies or is wrong: do not take the estimates as physical values.");
    return;
  }
  std::string text =
      s.result.interval
          ? "Assumed: specimens are independent, and all that was not updated is right. Of how parameters lie in the "
            "box nothing is said."
          : "Assumed: specimens are independent, populations normal on the parameters' scales, and all that was not "
            "updated is right.";
  if (!s.could_hide.summary.empty()) text += ' ' + s.could_hide.summary;
  sentences.push_back(std::move(text));
}

}  // namespace

VerdictSummary summarise_verdict(const SummarySources& sources) {
  VerdictSummary summary;
  summary.headline = headline_of(sources);
  summary.answer = method_answer(sources.problem, sources.result);
  summary.causes = find_causes(sources);
  summary.sentences = sources.result.warnings;
  summary.is_reassuring = summary.sentences.empty() && summary.causes.empty() &&
                          sources.verdict.conclusion == Conclusion::adequate &&
                          sources.agreement.are_means_reproduced() && sources.agreement.is_scatter_reproduced();
  if (sources.result.interval) {
    for (std::string& sentence : interval_sentences(sources.problem, *sources.result.interval)) {
      summary.sentences.push_back(std::move(sentence));
    }
  } else {
    say_means(sources, summary.sentences);
    say_scatter(sources, summary.sentences);
  }
  say_assumptions(sources, summary.sentences);
  summary.next = next_steps(sources, summary.causes);
  return summary;
}

void add_summary(const VerdictSummary& summary, Json& verdict) {
  verdict["headline"] = summary.headline;
  verdict["answer"] = summary.answer.empty() ? Json(nullptr) : Json(summary.answer);
  verdict["is_reassuring"] = summary.is_reassuring;
  verdict["summary"] = summary.sentences;
  verdict["causes"] = causes_json(summary.causes);
  verdict["next"] = Json::array();
  for (const NextStep& step : summary.next) verdict["next"].push_back(step_json(step));
}

}  // namespace mottle::study
