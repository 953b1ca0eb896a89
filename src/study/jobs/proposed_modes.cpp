#include "study/jobs/proposed_modes.hpp"

#include <algorithm>
#include <cmath>
#include <limits>
#include <map>
#include <numeric>
#include <optional>

#include "mottle/core/error.hpp"
#include "mottle/core/text.hpp"
#include "mottle/stats/moments/robust.hpp"
#include "mottle/study/jobs/study_objects.hpp"
#include "study/jobs/table_shapes.hpp"
#include "study/tests/pair_by_frequency.hpp"
#include "study/tests/pair_modes.hpp"
#include "study/tests/table_values.hpp"
#include "study/tests/unit_errors.hpp"

namespace mottle::study {
namespace {

constexpr double k_nan = std::numeric_limits<double>::quiet_NaN();

constexpr double k_alike = 0.7;  // MAC
constexpr double k_far = 0.15;   // relative difference of frequencies

/// Standard deviation that an outlier does not raise; of few values the usual one.
double robust_std(const Eigen::VectorXd& values, double standard_deviation) {
  constexpr Eigen::Index k_fewest = 6;
  return values.size() < k_fewest ? standard_deviation : std::min(standard_deviation, robust_deviation(values));
}

/// Mean, scatter and count of the values that there are.
void add_values(const Eigen::VectorXd& values, InitMode& mode) {
  std::vector<double> found;
  for (const double value : values) {
    if (!std::isnan(value)) found.push_back(value);
  }
  mode.specimens = static_cast<int>(found.size());
  if (found.empty()) return;
  const Eigen::Map<const Eigen::VectorXd> list(found.data(), mode.specimens);
  mode.test_mean = list.mean();
  if (mode.specimens < 2) return;
  mode.test_std = std::sqrt((list.array() - list.mean()).square().sum() / (mode.specimens - 1));
  mode.robust_std = robust_std(list, mode.test_std);
}

/// Mean MAC of the paired modes, by mode, from a column of the table of pairs.
std::map<int, double> mean_mac(const std::string& pairs, const char* column) {
  const CsvTable table = parse_csv(pairs, "pairing.csv");
  const Eigen::VectorXd modes = numbers_of_column(table, table.find("mode"));
  const Eigen::VectorXd mac = numbers_of_column(table, table.find(column));
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

/// Shapes that agree, with one mode alone, while all frequencies are off by one factor are those of tests in another
/// unit.
void refuse_other_unit(const Study& draft, const TestContents& contents, const std::vector<InitMode>& modes) {
  std::vector<double> ratios;
  for (const InitMode& mode : modes) {
    if (mode.specimens > 0 && mode.mac >= k_alike && mode.remark.empty())
      ratios.push_back(std::log(mode.test_mean / mode.model));
  }
  const UnitFactor* const factor = ratios.size() > 1 ? find_unit_factor(ratios) : nullptr;
  if (factor == nullptr) return;
  const double mean = std::accumulate(ratios.begin(), ratios.end(), 0.0) / static_cast<double>(ratios.size());
  const bool is_of_model = std::abs(std::log(factor->value)) > std::log(100.0);
  throw FormatError(
      contents.specimens.front().file, 0,
      fmt::format(
          "in the {} modes whose shapes are those of the model the frequencies are {:.4g} times the model's. The "
          "factor is near {}, which a wrong unit makes: {}{}",
          ratios.size(), std::exp(mean), factor->name, factor->remedy,
          is_of_model ? fmt::format(" The deck's units are taken for {}; --units names others.", draft.units) : ""));
}

void pair_by_mac(const Study& draft, const StructureModel& model, const TestContents& contents, PairedTests& found) {
  constexpr double k_lead = 0.1;
  constexpr double k_other_mode = 2.0;  // ratio of frequencies
  const PairedModes paired = pair_modes(model, contents.specimens, true);
  for (const std::string& note : paired.notes) {
    if (!note.starts_with("Modes that were not found")) found.notes.push_back(note);  // all of the model are asked for
  }
  const std::map<int, double> mac = mean_mac(paired.table, "mac");
  const std::map<int, double> second = mean_mac(paired.table, "second_mac");
  for (std::size_t k = 0; k < model.measured().size(); ++k) {
    const int number = model.measured()[k].number;
    const auto mode = std::ranges::find(found.modes, number, &InitMode::mode);
    add_values(paired.values.col(static_cast<Eigen::Index>(k)), *mode);
    if (mac.contains(number)) mode->mac = mac.at(number);
    if (mode->specimens > 0 && mode->mac < k_alike) {
      mode->doubt = fmt::format("MAC {:.2f}: the shapes are not alike", mode->mac);
    } else if (mode->specimens > 0 && std::abs(std::log(mode->model / mode->test_mean)) > std::log(k_other_mode)) {
      mode->doubt = fmt::format("{:+.0f} % apart: alike by chance at the points measured, or the model is far off",
                                100.0 * (mode->model / mode->test_mean - 1.0));
    }
    if (second.contains(number) && second.at(number) > mode->mac - k_lead) {
      mode->remark = fmt::format("another mode has MAC {:.2f}; more sensors would tell them apart", second.at(number));
    }
  }
  refuse_other_unit(draft, contents, found.modes);
}

/// Why a pair by frequency is none to build on; empty: it is.
std::string doubt_of(const FrequencyPair& pair, const InitMode& mode, const std::vector<InitMode>& modes) {
  if (!pair.is_doubtful) return {};
  const std::string apart = fmt::format("{:+.1f} %", 100.0 * (mode.model / mode.test_mean - 1.0));
  const auto rival = std::ranges::find(modes, pair.rival + 1, &InitMode::mode);
  if (pair.rival < 0 || rival == modes.end()) return apart + " apart";
  return fmt::format(
      "{} apart, and the model's f{} at {:.5g} is as near ({:+.1f} %): frequencies alone do not tell which of the two "
      "was "
      "measured, shapes would",
      apart, rival->mode, rival->model, 100.0 * (rival->model / mode.test_mean - 1.0));
}

/// The other mode of the model nearest to the test, where it is as near as the one that the order gives; empty: none.
std::string tie_of(const InitMode& mode, const std::vector<InitMode>& modes) {
  constexpr double k_equal = 0.002;
  const auto distance = [&](const InitMode& one) { return std::abs(std::log(one.model / mode.test_mean)); };
  const InitMode* nearest = nullptr;
  for (const InitMode& other : modes) {
    if (other.mode == mode.mode || distance(other) > distance(mode) + k_equal) continue;
    if (nearest == nullptr || distance(other) < distance(*nearest)) nearest = &other;
  }
  if (nearest == nullptr) return {};
  return fmt::format("f{} at {:.5g} is as near, and only the order of the frequencies tells them apart", nearest->mode,
                     nearest->model);
}

void pair_by_frequency(const Study& draft, const StructureModel& model, TestContents& contents, PairedTests& found) {
  CsvTable& table = *contents.table;
  const FrequencyPairing pairing(table, model, true);
  pairing.renumber(table, model);
  std::map<int, FrequencyPair> doubtful;  // by the model's number
  for (const FrequencyPair& pair : pairing.pairs()) doubtful[pair.mode + 1] = pair;
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
    mode->doubt = doubt_of(doubtful[mode->mode], *mode, found.modes);
    if (mode->doubt.empty()) mode->remark = tie_of(*mode, found.modes);
  }
}

/// Whether most columns of frequencies are near the model's modes of their numbers.
bool are_frequencies_named(const CsvTable& table, const std::vector<InitMode>& modes) {
  int near = 0;
  int far = 0;
  for (std::size_t column = 0; column < table.header.size(); ++column) {
    const auto title = numbered_title(table.header[column]);
    if (!title || title->stem != traits_of(QuantityKind::frequency).stem) continue;
    const auto mode = std::ranges::find(modes, title->number, &InitMode::mode);
    InitMode tested{.test_mean = k_nan};
    add_values(numbers_of_column(table, static_cast<int>(column)), tested);
    const bool is_near = mode != modes.end() && std::abs(mode->model / tested.test_mean - 1.0) <= k_far;
    ++(is_near ? near : far);
  }
  return near > far;
}

/// Whether the means of the columns of frequencies do not ascend with their numbers: who numbers modes by rank has none
/// such, so these are numbers of a model's modes.
bool are_out_of_order(const CsvTable& table) {
  std::map<int, double> means;
  for (std::size_t column = 0; column < table.header.size(); ++column) {
    const auto title = numbered_title(table.header[column]);
    if (!title || title->stem != traits_of(QuantityKind::frequency).stem) continue;
    InitMode tested{.test_mean = k_nan};
    add_values(numbers_of_column(table, static_cast<int>(column)), tested);
    if (tested.specimens > 0) means[title->number] = tested.test_mean;
  }
  const auto falls = [](const auto& one, const auto& next) { return one.second > next.second; };
  return std::adjacent_find(means.begin(), means.end(), falls) != means.end();
}

/// A table whose columns have the numbers of the model's modes.
void take_by_number(const TableShapes& table_shapes, const TestContents& contents, PairedTests& found) {
  const CsvTable& table = *contents.table;
  found.pairing = "named";
  found.shapes = table_shapes.shapes;
  for (std::size_t column = 0; column < table.header.size(); ++column) {
    const auto title = numbered_title(table.header[column]);
    if (!title || title->stem != traits_of(QuantityKind::frequency).stem) continue;
    const auto mode = std::ranges::find(found.modes, title->number, &InitMode::mode);
    if (mode == found.modes.end()) continue;
    add_values(numbers_of_column(table, static_cast<int>(column)), *mode);
    const auto match = table_shapes.matches.find(mode->mode);
    const bool has_shape = std::ranges::count(table_shapes.shapes.modes, mode->mode) > 0;
    if (match != table_shapes.matches.end()) mode->mac = match->second.mac;
    const double difference = mode->model / mode->test_mean - 1.0;
    if (has_shape && !(mode->mac >= k_alike)) mode->doubt = "the shapes are not alike";
    if (!has_shape && std::abs(difference) > k_far) mode->doubt = fmt::format("{:+.1f} % apart", 100.0 * difference);
  }
}

/// What the shapes of a table say of its modes, where its columns count otherwise than the model.
std::string shapes_note(const TableShapes& table_shapes) {
  std::vector<std::string> pairs;
  for (const auto& [number, match] : table_shapes.matches) {
    pairs.push_back(fmt::format("f{} is the model's f{} (MAC {:.2f})", number, match.mode, match.mac));
  }
  return fmt::format(
      "The table's columns count modes otherwise than the model, so its modes are paired by frequency and its shapes "
      "are "
      "no outputs. By the shapes with these numbers {}. Name the columns after the model's modes (f7, phi7:101:+Z), "
      "and "
      "the shapes can be outputs.",
      pairs.empty() ? "they are none of the model's" : join(pairs));
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

PairedTests pair_for_proposal(const Study& draft, TestContents contents, const Eigen::VectorXd& frequencies,
                              const RunSettings& settings) {
  const StudyModel made = make_model(draft, draft.parameters, settings);
  PairedTests found{.pairing = contents.table ? "frequency" : "mac", .modes = elastic_modes(frequencies)};
  found.notes = contents.notes;
  if (contents.table) {
    const CsvTable& table = *contents.table;
    const auto is_empty = [](const std::vector<std::string>& row) {
      return std::ranges::all_of(row, [](const std::string& cell) { return cell.empty() || capitals(cell) == "NAN"; });
    };
    found.specimens =
        static_cast<int>(table.rows.size() - static_cast<std::size_t>(std::ranges::count_if(table.rows, is_empty)));
    const std::optional<TableShapes> shapes = shapes_of_table(table, *made.model);
    const bool shapes_agree = shapes && shapes->counts_as_model();
    if ((shapes_agree || (!shapes && are_out_of_order(table))) && are_frequencies_named(table, found.modes)) {
      if (!shapes) {
        found.notes.emplace_back(
            "The columns' frequencies do not ascend with their numbers, so these are taken for the numbers of the "
            "model's modes: column f3 is the model's mode 3. If they are not, say test.pairing = \"frequency\".");
      }
      take_by_number(shapes.value_or(TableShapes{}), contents, found);
    } else {
      if (shapes) found.notes.push_back(shapes_note(*shapes));
      pair_by_frequency(draft, *made.model, contents, found);
    }
  } else {
    found.specimens = static_cast<int>(contents.specimens.size());
    pair_by_mac(draft, *made.model, contents, found);
  }
  for (InitMode& mode : found.modes) add_rare(found.specimens, mode);
  return found;
}

}  // namespace mottle::study
