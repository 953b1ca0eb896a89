#include "study/results/init_parameter_text.hpp"

#include <algorithm>
#include <cmath>
#include <utility>
#include <vector>

#include "mottle/core/text.hpp"
#include "study/input/first_few.hpp"
#include "study/results/init_text.hpp"

namespace mottle::study {
namespace {

std::string explanation_text(const InitParameter& parameter) {
  return fmt::format("without it the tests' ln likelihood would be {:.0f} lower", parameter.explained);
}

std::string targets_text(const InitParameter& parameter) {
  if (parameter.twins.empty()) return toml_string(parameter.target);
  return fmt::format("[{}, {}]", toml_string(parameter.target), listed(parameter.twins, toml_string));
}

}  // namespace

std::string parameter_text(const InitParameter& parameter) {
  constexpr double k_bounds = 5.0;  // standard deviations of the logarithm
  const double factor = std::exp(k_bounds * parameter.spread);
  std::string text = "\n[[parameter]]\n";
  text += fmt::format("name = {}\n", toml_string(parameter.name));
  text += fmt::format("target = {:<24} # {:.6g}{}{}", targets_text(parameter), parameter.value,
                      parameter.unit == "-" ? "" : " ", parameter.unit == "-" ? "" : parameter.unit);
  if (parameter.elements > 0) {
    text += fmt::format(" in {} element{}", parameter.elements, parameter.elements == 1 ? "" : "s");
  }
  if (parameter.mode > 0) text += fmt::format("; f{} by {:+.2f} % per %", parameter.mode, parameter.sensitivity);
  if (!std::isnan(parameter.explained)) text += fmt::format("\n# {}", explanation_text(parameter));
  text += "\nrelative = true                    # a factor on the deck's value\n";
  text += fmt::format("distribution = {{ kind = \"lognormal\", mean = 1.0, std = {:.2g} }}   # GUESSED: {}\n",
                      parameter.spread, parameter.spread_reason);
  return text + fmt::format("bounds = [{:.2g}, {:.2g}]\n", 1.0 / factor, factor);
}

std::string where_others_are(const InitOutcome& outcome) {
  return outcome.kind == "nastran" ? ": `mottle targets`" : "";
}

std::string left_out_text(const InitOutcome& outcome) {
  constexpr std::size_t k_listed = 12;
  std::vector<std::pair<std::string, std::vector<std::string>>> reasons;  // numbers of one reason in one line
  std::size_t count = 0;
  for (const InitParameter& parameter : outcome.parameters) {
    if (parameter.left_out.empty() || ++count > k_listed) continue;
    const auto reason = std::ranges::find(reasons, parameter.left_out, [](const auto& item) { return item.first; });
    if (reason != reasons.end()) {
      reason->second.push_back(parameter.target);
    } else {
      reasons.push_back({parameter.left_out, {parameter.target}});
    }
  }
  if (count == 0) return "";
  std::string text;
  for (const auto& [reason, targets] : reasons) text += fmt::format("#   {}: {}\n", reason, join(targets));
  if (count > k_listed) text += fmt::format("#   and {} more{}\n", count - k_listed, where_others_are(outcome));
  return "\n# Numbers of the deck that are no parameters, and why:\n" + text;
}

std::string chosen_text(const InitParameter& parameter) {
  std::string text = parameter.name;
  if (!parameter.twins.empty()) text += ", with " + first_few(parameter.twins);
  if (!std::isnan(parameter.explained)) text += "; " + explanation_text(parameter);
  return text;
}

}  // namespace mottle::study
