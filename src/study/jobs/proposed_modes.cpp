#include "study/jobs/proposed_modes.hpp"

#include <algorithm>
#include <cmath>
#include <limits>
#include <map>

#include "mottle/core/error.hpp"
#include "mottle/core/text.hpp"
#include "mottle/study/jobs/study_objects.hpp"
#include "study/tests/pair_by_frequency.hpp"
#include "study/tests/pair_modes.hpp"
#include "study/tests/table_values.hpp"

namespace mottle::study {
namespace {

constexpr double k_nan = std::numeric_limits<double>::quiet_NaN();

/// Mean, scatter and count of the values that there are.
void add_values(const Eigen::VectorXd& values, InitMode& mode) {
  std::vector<double> found;
  for (const double value : values) {
    if (!std::isnan(value)) found.push_back(value);
  }
  mode.specimens = static_cast<int>(found.size());
  if (found.empty()) return;
  const Eigen::Map<const Eigen::ArrayXd> list(found.data(), mode.specimens);
  mode.test_mean = list.mean();
  if (mode.specimens > 1) mode.test_std = std::sqrt((list - list.mean()).square().sum() / (mode.specimens - 1));
}

/// Mean MAC of the paired modes, by mode, from the table of pairs.
std::map<int, double> mean_mac(const std::string& pairs) {
  const CsvTable table = parse_csv(pairs, "pairing.csv");
  const Eigen::VectorXd modes = numbers_of_column(table, table.find("mode"));
  const Eigen::VectorXd mac = numbers_of_column(table, table.find("mac"));
  const auto verdict = static_cast<std::size_t>(table.find("verdict"));
  std::map<int, std::pair<double, int>> sums;
  for (std::size_t row = 0; row < table.rows.size(); ++row) {
    const std::string& text = table.rows[row][verdict];
    if (text != "paired" && text != "doubtful") continue;
    auto& [sum, count] = sums[static_cast<int>(modes(static_cast<Eigen::Index>(row)))];
    sum += mac(static_cast<Eigen::Index>(row));
    ++count;
  }
  std::map<int, double> means;
  for (const auto& [mode, sum] : sums) means[mode] = sum.first / sum.second;
  return means;
}

void add_rare(int specimens, InitMode& mode) {
  if (mode.specimens == 0) mode.doubt = "not tested";
  if (mode.specimens == 0 || !mode.doubt.empty()) return;
  const bool is_rare = 2 * mode.specimens < specimens || (specimens > 1 && mode.specimens < 2);
  if (is_rare) mode.doubt = fmt::format("found in {} of {} specimens only", mode.specimens, specimens);
}

void pair_by_mac(const StructureModel& model, const TestContents& contents, PairedTests& found) {
  constexpr double k_alike = 0.7;
  const PairedModes paired = pair_modes(model, contents.specimens, true);
  for (const std::string& note : paired.notes) {
    if (!note.starts_with("Modes that were not found")) found.notes.push_back(note);  // all of the model are asked for
  }
  const std::map<int, double> mac = mean_mac(paired.table);
  for (std::size_t k = 0; k < model.measured().size(); ++k) {
    const int number = model.measured()[k].number;
    const auto mode = std::ranges::find(found.modes, number, &InitMode::mode);
    add_values(paired.values.col(static_cast<Eigen::Index>(k)), *mode);
    if (mac.contains(number)) mode->mac = mac.at(number);
    if (mode->specimens > 0 && mode->mac < k_alike) {
      mode->doubt = fmt::format("MAC {:.2f}: the shapes are not alike", mode->mac);
    }
  }
}

void pair_by_frequency(const Study& draft, const StructureModel& model, TestContents& contents, PairedTests& found) {
  CsvTable& table = *contents.table;
  const FrequencyPairing pairing(table, model, true);
  pairing.renumber(table);
  std::map<int, bool> doubtful;
  for (const FrequencyPair& pair : pairing.pairs()) doubtful[pair.mode + 1] = pair.is_doubtful;
  std::vector<Quantity> there;
  for (const Quantity& output : model.measured()) {
    if (doubtful.contains(output.number)) there.push_back(output);
  }
  std::vector<std::string> ignored;
  const std::vector<int> columns = match_columns(table, draft, there, ignored);
  if (!ignored.empty()) found.notes.push_back(ignored.front());
  for (std::size_t k = 0; k < there.size(); ++k) {
    const auto mode = std::ranges::find(found.modes, there[k].number, &InitMode::mode);
    if (mode == found.modes.end()) continue;
    add_values(numbers_of_column(table, columns[k]), *mode);
    if (doubtful[mode->mode]) {
      mode->doubt =
          fmt::format("{:+.0f} % apart, or another mode as near", 100.0 * (mode->model / mode->test_mean - 1.0));
    }
  }
}

}  // namespace

std::vector<InitMode> elastic_modes(const Eigen::VectorXd& frequencies) {
  std::vector<InitMode> modes;
  for (Eigen::Index k = 0; k < frequencies.size(); ++k) {
    if (frequencies(k) <= 0.0) continue;
    modes.push_back({.mode = static_cast<int>(k) + 1,
                     .model = frequencies(k),
                     .test_mean = k_nan,
                     .test_std = k_nan,
                     .specimens = 0,
                     .mac = k_nan});
  }
  return modes;
}

PairedTests pair_for_proposal(const Study& draft, TestContents contents, const Eigen::VectorXd& frequencies) {
  const StudyModel made = make_model(draft, draft.parameters);
  PairedTests found{.pairing = contents.table ? "frequency" : "mac", .modes = elastic_modes(frequencies)};
  found.notes = contents.notes;
  if (contents.table) {
    const CsvTable& table = *contents.table;
    const auto is_empty = [](const std::vector<std::string>& row) {
      return std::ranges::all_of(row, [](const std::string& cell) { return cell.empty() || capitals(cell) == "NAN"; });
    };
    found.specimens =
        static_cast<int>(table.rows.size() - static_cast<std::size_t>(std::ranges::count_if(table.rows, is_empty)));
    pair_by_frequency(draft, *made.model, contents, found);
  } else {
    found.specimens = static_cast<int>(contents.specimens.size());
    pair_by_mac(*made.model, contents, found);
  }
  for (InitMode& mode : found.modes) add_rare(found.specimens, mode);
  return found;
}

}  // namespace mottle::study
