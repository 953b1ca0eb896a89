#include "study/input/noise_rules.hpp"

#include <algorithm>
#include <cmath>

#include "mottle/core/text.hpp"
#include "study/input/first_few.hpp"
#include "study/input/toml_writer.hpp"

namespace mottle::study {
namespace {

bool is_pattern(const std::string& text) {
  return text.find_first_of("*?") != std::string::npos;
}

/// Precedence of a rule, larger first: exact names, then the number of letters of the pattern.
std::size_t precedence(const NoiseRule& rule) {
  if (!is_pattern(rule.pattern)) return std::string::npos;
  return rule.pattern.size() - static_cast<std::size_t>(std::count(rule.pattern.begin(), rule.pattern.end(), '*') +
                                                        std::count(rule.pattern.begin(), rule.pattern.end(), '?'));
}

std::string rule_text(const NoiseRule& rule) {
  return rule.is_relative ? fmt::format("{} = {} %", rule.pattern, number_text(100.0 * rule.value))
                          : fmt::format("{} = {}", rule.pattern, number_text(rule.value));
}

}  // namespace

std::vector<NoiseRule> read_noise_rules(TomlReader& reader, const std::string& key) {
  std::vector<NoiseRule> rules;
  if (!reader.has(key)) {
    reader.raw(key);
    return rules;
  }
  TomlReader entries = reader.table(key);
  for (const std::string& name : keys_in_file_order(*reader.raw(key)->as_table())) {
    NoiseRule rule{.pattern = name};
    const toml::node& node = *entries.raw(name);
    if (auto text = node.value_exact<std::string>()) {
      rule.is_relative = true;
      const std::size_t sign = text->find_last_not_of(' ');
      double percent = -1.0;
      const bool is_read = sign != std::string::npos && (*text)[sign] == '%' &&
                           parse_number(std::string_view(*text).substr(0, sign), percent);
      if (!is_read || !std::isfinite(percent) || percent < 0.0)
        entries.fail_value(name, "a number >= 0, or a fraction of the mean like \"1 %\"");
      rule.value = 0.01 * percent;
    } else {
      rule.value = entries.number(name, {.lower = 0.0});
    }
    rules.push_back(std::move(rule));
  }
  return rules;
}

const NoiseRule* rule_for(const std::vector<NoiseRule>& rules, const std::string& output) {
  const NoiseRule* best = nullptr;
  for (const NoiseRule& rule : rules) {
    const bool fits = is_pattern(rule.pattern) ? matches_pattern(output, rule.pattern) : output == rule.pattern;
    if (fits && (best == nullptr || precedence(rule) >= precedence(*best))) best = &rule;
  }
  return best;
}

NoiseStandardDeviations noise_standard_deviations(const std::vector<NoiseRule>& rules,
                                                  const std::vector<std::string>& outputs,
                                                  const Eigen::Ref<const Eigen::VectorXd>& means,
                                                  const std::string& what) {
  for (const NoiseRule& rule : rules) {
    const bool fits = std::any_of(outputs.begin(), outputs.end(), [&](const std::string& name) {
      return is_pattern(rule.pattern) ? matches_pattern(name, rule.pattern) : name == rule.pattern;
    });
    if (fits) continue;
    if (!is_pattern(rule.pattern)) {
      throw InvalidInput(unknown_name_message("output", rule.pattern, outputs));
    }
    throw InvalidInput(fmt::format("'{}' fits no output; outputs are {}", rule.pattern, join(outputs)));
  }
  NoiseStandardDeviations result{Eigen::VectorXd::Zero(means.size()), {}};
  std::vector<std::vector<std::string>> matched(rules.size());
  for (std::size_t k = 0; k < outputs.size(); ++k) {
    const auto index = static_cast<Eigen::Index>(k);
    const NoiseRule* best = rule_for(rules, outputs[k]);
    if (best == nullptr) continue;
    result.std(index) = best->is_relative ? best->value * std::abs(means(index)) : best->value;
    matched[static_cast<std::size_t>(best - rules.data())].push_back(outputs[k]);
  }
  for (std::size_t r = 0; r < rules.size(); ++r) {
    result.notes.push_back(
        matched[r].empty()
            ? fmt::format("{} {}: applies to no output, other rules take precedence.", what, rule_text(rules[r]))
            : fmt::format("{} {}: applies to {}.", what, rule_text(rules[r]), first_few(matched[r])));
  }
  return result;
}

}  // namespace mottle::study
