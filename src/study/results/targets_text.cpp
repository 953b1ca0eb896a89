// What `mottle targets` prints.
#include <algorithm>
#include <cmath>

#include "mottle/model/units.hpp"
#include "mottle/study/jobs/targets.hpp"
#include "study/results/result_json.hpp"

namespace mottle::study {
namespace {

/// "+0.48 (mode 3)" of the mode that changes most.
std::string most_changed(const Target& target) {
  Eigen::Index mode = 0;
  const Eigen::RowVectorXd sizes = target.sensitivity.array().isNaN().select(0.0, target.sensitivity.array().abs());
  if (sizes.maxCoeff(&mode) == 0.0) return "none";
  return fmt::format("{:+.3f} (mode {})", target.sensitivity(mode), mode + 1);
}

/// "12.5 %", the largest value; 0 where modes have none, empty where nothing is known.
std::string largest_percent(const Eigen::RowVectorXd& values) {
  if (values.size() == 0) return "";
  return fmt::format("{:.1f} %", 100.0 * std::max(0.0, values.array().isNaN().select(0.0, values.array()).maxCoeff()));
}

Json target_json(const Target& target) {
  return {{"target", target.name},
          {"value", target.value},
          {"unit", target.unit},
          {"elements", target.has_energies() ? Json(target.elements) : Json(nullptr)},
          {"strain_energy", target.has_energies() ? to_json(target.strain.transpose()) : Json(nullptr)},
          {"kinetic_energy", target.has_energies() ? to_json(target.kinetic.transpose()) : Json(nullptr)},
          {"sensitivity", to_json(target.sensitivity.transpose())}};
}

std::vector<std::string> table_lines(const TargetsOutcome& outcome) {
  std::size_t width = 6;
  for (const Target& target : outcome.targets) width = std::max(width, target.name.size());
  std::vector<std::string> lines;
  lines.push_back(fmt::format("{:<{}} {:>13} {:<9} {:>8} {:>8} {:>8}  {}", "target", width, "value", "unit", "elements",
                              "strain", "kinetic", "largest change of a frequency"));
  lines.push_back(fmt::format("{:<{}} {:>13} {:<9} {:>8} {:>8} {:>8}  {}", "", width, "", "", "", "energy", "energy",
                              "in % per %"));
  for (const Target& target : outcome.targets) {
    lines.push_back(fmt::format("{:<{}} {:>13.6g} {:<9} {:>8} {:>8} {:>8}  {}", target.name, width, target.value,
                                target.unit, target.has_energies() ? fmt::format("{}", target.elements) : "",
                                largest_percent(target.strain), largest_percent(target.kinetic), most_changed(target)));
  }
  return lines;
}

}  // namespace

RunSummary summarise(const TargetsOutcome& outcome) {
  RunSummary summary{.status = "done"};
  std::vector<std::string>& lines = summary.lines;
  for (const std::string& note : outcome.notes) lines.push_back("note: " + note);
  const char* const unit = unit_names(outcome.settings.units.value_or("SI")).frequency;
  std::string frequencies = fmt::format("modes [{}]:", unit);
  for (const double frequency : outcome.frequencies) frequencies += fmt::format(" {:.5g}", frequency);
  lines.push_back(frequencies);
  for (std::string& line : table_lines(outcome)) lines.push_back(std::move(line));
  const bool has_energies = std::ranges::any_of(outcome.targets, &Target::has_energies);
  lines.emplace_back(has_energies ? "Energies: of the elements that use the number, in the mode where the fraction is "
                                    "largest; every mode is in --csv and --json."
                                  : "Every mode is in --csv and --json.");
  if (outcome.left_out > 0 && !has_energies) {
    lines.push_back(fmt::format(
        "{} other numbers change none of these modes, or are thicknesses: --all takes those too.", outcome.left_out));
  } else if (outcome.left_out > 0) {
    lines.push_back(
        fmt::format("{} other numbers are zero, change none of these modes or are seldom wrong: --all lists "
                    "them. Coordinates and offsets can be targets too (GRID:12:X, CBAR:3:W1A).",
                    outcome.left_out));
  }
  Json targets = Json::array();
  for (const Target& target : outcome.targets) targets.push_back(target_json(target));
  summary.json = one_line(Json{{"command", "targets"},
                               {"model", outcome.settings.model.string()},
                               {"units", outcome.settings.units.value_or("SI")},
                               {"frequency_unit", unit},
                               {"frequencies", to_json(outcome.frequencies)},
                               {"targets", targets},
                               {"left_out", outcome.left_out},
                               {"notes", outcome.notes}});
  return summary;
}

std::string targets_csv(const TargetsOutcome& outcome) {
  std::string text = "target,value,unit,elements";
  for (const char* name : {"strain", "kinetic", "sensitivity"}) {
    for (Eigen::Index mode = 1; mode <= outcome.frequencies.size(); ++mode) text += fmt::format(",{}_{}", name, mode);
  }
  text += '\n';
  for (const Target& target : outcome.targets) {
    text += fmt::format("{},{},{},{}", target.name, target.value, target.unit,
                        target.has_energies() ? fmt::format("{}", target.elements) : "");
    for (const Eigen::RowVectorXd* values : {&target.strain, &target.kinetic, &target.sensitivity}) {
      if (values->size() == 0) text += std::string(static_cast<std::size_t>(outcome.frequencies.size()), ',');
      for (const double value : *values) text += std::isnan(value) ? "," : fmt::format(",{}", value);
    }
    text += '\n';
  }
  return text;
}

}  // namespace mottle::study
