#include "study/results/init_text.hpp"

#include <algorithm>
#include <cmath>

#include "mottle/core/text.hpp"
#include "mottle/model/units.hpp"
#include "study/results/init_parameter_text.hpp"
#include "study/results/relative_scatter.hpp"
#include "study/results/result_json.hpp"

namespace mottle::study {
namespace {

std::string mode_comment(const InitMode& mode, const std::string& unit) {
  std::string comment = fmt::format("#   f{:<3} {:>10.5g} {}", mode.mode, mode.model, unit);
  if (!std::isnan(mode.test_mean) && mode.specimens > 0) {
    comment += fmt::format(", tests {:.5g} ({:+.1f} %)", mode.test_mean, 100.0 * (mode.model / mode.test_mean - 1.0));
    if (!std::isnan(mode.test_std))
      comment += fmt::format(", scatter {:.2g} %", 100.0 * relative_scatter(mode.test_std, mode.test_mean));
    comment += fmt::format(", {} specimens", mode.specimens);
    if (!std::isnan(mode.mac)) comment += fmt::format(", MAC {:.2f}", mode.mac);
  }
  if (!mode.doubt.empty()) comment += "; left out: " + mode.doubt;
  if (mode.doubt.empty() && !mode.remark.empty()) comment += "; DOUBTFUL: " + mode.remark;
  return comment + '\n';
}

std::string shapes_text(const InitShapes& shapes) {
  const std::string modes = listed(shapes.modes, [](int mode) { return fmt::format("{}", mode); });
  const std::string dofs = listed(shapes.degrees_of_freedom, toml_string);
  if (shapes.has_size()) {
    return fmt::format(
        "# Taken as mass-normalised, as the model's are: their sizes agree. Otherwise say size = \"free\".\n"
        "shapes = {{ modes = [{}], dofs = [{}] }}\n",
        modes, dofs);
  }
  return fmt::format(
      "# The model's shapes are {:.2g} times as large as the tests', so the tests' are not mass-normalised: GUESSED "
      "that "
      "their\n# size is unknown; directions alone are compared.\n"
      "shapes = {{ modes = [{}], dofs = [{}], size = \"free\" }}\n",
      shapes.size, modes, dofs);
}

std::string outputs_text(const InitOutcome& outcome) {
  const std::string unit = unit_names(*outcome.settings.units).frequency;
  std::vector<InitMode> outputs;
  std::string text = "\n[outputs]\n# The model's modes against the tests (difference of the model in brackets).\n";
  for (const InitMode& mode : outcome.modes) {
    const bool is_tested = mode.specimens > 0 || outcome.settings.tests.empty();
    if (is_tested) text += mode_comment(mode, unit);
    if (mode.doubt.empty()) outputs.push_back(mode);
  }
  text += fmt::format("frequencies = [{}]\n",
                      listed(outputs, [](const InitMode& mode) { return fmt::format("{}", mode.mode); }));
  if (!outcome.shapes.modes.empty()) return text + shapes_text(outcome.shapes);
  if (outcome.pairing == "mac") {
    text += "# Shapes can be outputs too: shapes = { modes = [...], dofs = [\"101:+Z\", ...] }\n";
  }
  return text;
}

std::string test_text(const InitOutcome& outcome) {
  const InitSettings& settings = outcome.settings;
  if (settings.tests.empty()) {
    return "\n# [test]                 # UNKNOWN: no tests were given; without them `mottle propagate` shows the "
           "prior\n"
           "# file = \"tests.csv\"\n";
  }
  std::string text = fmt::format("\n[test]\nfile = {}\n", test_files_text(settings));
  if (outcome.pairing == "frequency") {
    text +=
        "pairing = \"frequency\"     # the tests' modes in ascending frequency are taken for the model's, see above\n";
  } else if (outcome.pairing == "named") {
    text +=
        "pairing = \"named\"         # its columns already have the numbers of the model's modes, as shapes or their "
        "order show\n";
  } else {
    text += fmt::format("pairing = {}\n", toml_string(outcome.pairing));
  }
  text +=
      "# repeatability = { \"f*\" = \"0.1 %\" }   # UNKNOWN: the scatter of repeated tests of one specimen; without it "
      "all\n"
      "#                                        scatter is taken for that of the parameters\n";
  return text;
}

/// Correlations of q parameters need more than q specimens; a few more, so that they are more than chance.
bool has_few_specimens(const InitOutcome& outcome) {
  constexpr std::ptrdiff_t k_more = 3;
  const auto is_parameter = [](const InitParameter& parameter) { return parameter.left_out.empty(); };
  return outcome.specimens < std::ranges::count_if(outcome.parameters, is_parameter) + k_more;
}

std::string update_text(const InitOutcome& outcome) {
  if (outcome.specimens >= 2) {
    std::string text = "\n[update]\nmethod = \"maximum-likelihood\"\n";
    if (!has_few_specimens(outcome)) return text;
    return text +
           fmt::format("covariance = \"diagonal\"   # {} specimens are too few for correlations of the parameters\n",
                       outcome.specimens);
  }
  return "\n[update]\nmethod = \"deterministic\"   # one specimen has no scatter to explain\n";
}

std::string cell(double value, int digits) {
  return std::isnan(value) ? "" : fmt::format("{:.{}g}", value, digits);
}

void add_mode_lines(const InitOutcome& outcome, std::vector<std::string>& lines) {
  lines.push_back(fmt::format("{:>5} {:>11} {:>11} {:>8} {:>8} {:>9} {:>5}  {}", "mode", "model", "tests", "diff. %",
                              "std %", "specimens", "MAC", "output"));
  int untested = 0;
  for (const InitMode& mode : outcome.modes) {
    const bool is_shown = mode.specimens > 0 || outcome.settings.tests.empty();
    if (!is_shown) ++untested;
    if (!is_shown) continue;
    const double difference = 100.0 * (mode.model / mode.test_mean - 1.0);
    lines.push_back(fmt::format("{:>5} {:>11.5g} {:>11} {:>8} {:>8} {:>9} {:>5}  {}", mode.mode, mode.model,
                                cell(mode.test_mean, 5),
                                std::isnan(difference) ? "" : fmt::format("{:+.1f}", difference),
                                cell(100.0 * relative_scatter(mode.test_std, mode.test_mean), 2), mode.specimens,
                                std::isnan(mode.mac) ? "" : fmt::format("{:.2f}", mode.mac),
                                !mode.doubt.empty()   ? "no: " + mode.doubt
                                : mode.remark.empty() ? "yes"
                                                      : "yes, but doubtful: " + mode.remark));
  }
  if (untested > 0) lines.push_back(fmt::format("      {} more modes of the model were not tested", untested));
}

void add_parameter_lines(const InitOutcome& outcome, std::vector<std::string>& lines) {
  constexpr int k_listed = 12;
  lines.push_back(fmt::format("{:<24} {:>12} {:<10} {:>7}  {:>15}  {}", "target", "value", "unit", "std %", "% per %",
                              "parameter"));
  int left_out = 0;
  for (const InitParameter& parameter : outcome.parameters) {
    if (!parameter.left_out.empty() && ++left_out > k_listed) continue;
    lines.push_back(
        fmt::format("{:<24} {:>12.6g} {:<10} {:>7.0f}  {:>15}  {}", parameter.target, parameter.value, parameter.unit,
                    100.0 * parameter.spread,
                    parameter.mode > 0 ? fmt::format("{:+.2f} of f{}", parameter.sensitivity, parameter.mode) : "",
                    parameter.left_out.empty() ? chosen_text(parameter) : "no: " + parameter.left_out));
  }
  if (left_out > k_listed) {
    lines.push_back(fmt::format("and {} more{}", left_out - k_listed, where_others_are(outcome)));
  }
}

Json mode_json(const InitMode& mode) {
  return {{"mode", mode.mode},
          {"model", number_json(mode.model)},
          {"test_mean", number_json(mode.test_mean)},
          {"test_std", number_json(mode.test_std)},
          {"specimens", mode.specimens},
          {"mac", number_json(mode.mac)},
          {"is_output", mode.doubt.empty()},
          {"doubt", mode.doubt},
          {"remark", mode.remark}};
}

Json parameter_json(const InitParameter& parameter) {
  return {
      {"target", parameter.target},     {"name", parameter.name},   {"value", parameter.value},
      {"unit", parameter.unit},         {"std", parameter.spread},  {"is_parameter", parameter.left_out.empty()},
      {"left_out", parameter.left_out}, {"twins", parameter.twins}, {"explained", number_json(parameter.explained)}};
}

}  // namespace

/// A basic string of TOML.
std::string toml_string(const std::string& text) {
  return Json(text).dump();
}

std::string relative_path(const std::filesystem::path& file, const std::filesystem::path& study) {
  namespace fs = std::filesystem;
  std::error_code error;
  const fs::path folder = fs::weakly_canonical(fs::absolute(study).parent_path(), error);
  const fs::path relative = fs::weakly_canonical(fs::absolute(file), error).lexically_relative(folder);
  return (relative.empty() || error ? fs::absolute(file) : relative).generic_string();
}

std::string test_files_text(const InitSettings& settings) {
  const auto path = [&](const std::string& file) { return toml_string(relative_path(file, settings.study)); };
  const std::string files = listed(settings.tests, path);
  return settings.tests.size() > 1 ? fmt::format("[{}]", files) : files;
}

std::string study_text_of(const InitOutcome& outcome) {
  if (outcome.kind == "command") return template_study_text(outcome);
  const InitSettings& settings = outcome.settings;
  std::string text =
      "# Proposed by `mottle init`. What is GUESSED or UNKNOWN is for you to decide; `mottle check` says what becomes "
      "of it.\n";
  text += fmt::format("title = {}\n", toml_string(settings.model.stem().string()));
  text += fmt::format("units = {}{}\n", toml_string(*settings.units),
                      outcome.units_reason.empty() ? "" : fmt::format("   # {}", outcome.units_reason));
  text += fmt::format("\n[model]\nkind = {}\nfile = {}\n", toml_string(outcome.kind),
                      toml_string(relative_path(settings.model, settings.study)));
  if (!settings.ignore_cards.empty()) {
    text += fmt::format("ignore_cards = [{}]\n", listed(settings.ignore_cards, toml_string));
  }
  text += outputs_text(outcome) + test_text(outcome) + update_text(outcome);
  for (const InitParameter& parameter : outcome.parameters) {
    if (parameter.left_out.empty()) text += parameter_text(parameter);
  }
  return text + left_out_text(outcome);
}

namespace {

std::string pairing_text(const std::string& pairing) {
  if (pairing.empty()) return "";
  return pairing == "named" ? ", its columns named as the model's modes" : ", paired by " + pairing;
}

}  // namespace

RunSummary summarise(const InitOutcome& outcome) {
  RunSummary summary{.status = "done"};
  std::vector<std::string>& lines = summary.lines;
  lines.push_back(fmt::format("units: {}{}", *outcome.settings.units,
                              outcome.units_reason.empty() ? "" : fmt::format(" ({})", outcome.units_reason)));
  if (outcome.specimens > 0) {
    lines.push_back(fmt::format("tests: {} specimens{}", outcome.specimens, pairing_text(outcome.pairing)));
  }
  if (outcome.kind == "command") {
    for (const InitParameter& parameter : outcome.parameters) lines.push_back("placeholder: " + parameter.name);
  } else {
    add_mode_lines(outcome, lines);
    add_parameter_lines(outcome, lines);
  }
  for (const std::string& note : outcome.notes) lines.push_back("note: " + note);
  Json modes = Json::array();
  for (const InitMode& mode : outcome.modes) modes.push_back(mode_json(mode));
  Json parameters = Json::array();
  for (const InitParameter& parameter : outcome.parameters) parameters.push_back(parameter_json(parameter));
  summary.json = one_line(Json{{"command", "init"},
                               {"study", outcome.settings.study.string()},
                               {"kind", outcome.kind},
                               {"units", *outcome.settings.units},
                               {"pairing", outcome.pairing},
                               {"specimens", outcome.specimens},
                               {"modes", modes},
                               {"parameters", parameters},
                               {"notes", outcome.notes}});
  return summary;
}

}  // namespace mottle::study
