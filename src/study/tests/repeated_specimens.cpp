#include "study/tests/repeated_specimens.hpp"

#include <algorithm>
#include <cmath>
#include <filesystem>
#include <map>
#include <optional>

#include "mottle/core/text.hpp"
#include "study/input/first_few.hpp"
#include "study/tests/table_values.hpp"

namespace mottle::study {
namespace {

/// What was measured of one specimen, empty where it was not.
struct Specimen {
  std::string name;        ///< "5 (plate5.uff)"
  std::string label = {};  ///< in the column "specimen"
  std::vector<std::optional<double>> values = {};

  void add(double value) { values.push_back(std::isnan(value) ? std::nullopt : std::optional(value)); }
  std::ptrdiff_t measured() const {
    return std::ranges::count_if(values, [](const auto& value) { return value.has_value(); });
  }
};

std::vector<Specimen> specimens_of(const CsvTable& table) {
  const int labels = table.find("specimen");
  const std::vector<int> numbers = specimen_numbers(table);
  std::vector<Specimen> specimens;
  for (std::size_t row = 0; row < table.rows.size(); ++row) {
    Specimen specimen{.name = fmt::format("{}", numbers[row])};
    for (std::size_t column = 0; column < table.header.size(); ++column) {
      const std::string& cell = table.rows[row][column];
      double value = 0.0;
      if (static_cast<int>(column) == labels) {
        specimen.label = cell;
      } else {
        specimen.add(parse_number(cell, value) ? value : std::nan(""));
      }
    }
    specimens.push_back(std::move(specimen));
  }
  return specimens;
}

std::vector<Specimen> specimens_of(const std::vector<MeasuredModes>& tests) {
  std::vector<Specimen> specimens;
  for (const MeasuredModes& modes : tests) {
    Specimen specimen{
        .name = fmt::format("{} ({})", specimens.size() + 1, std::filesystem::path(modes.file).filename().string())};
    for (Eigen::Index mode = 0; mode < modes.frequencies.size(); ++mode) {
      const Eigen::ArrayXd shape = modes.shapes.col(mode).array().isNaN().select(0.0, modes.shapes.col(mode).array());
      specimen.add(modes.frequencies(mode));
      specimen.add(modes.damping(mode));
      specimen.add(shape.sum());  // stand for all components, of which there may be millions
      specimen.add(shape.square().sum());
    }
    specimens.push_back(std::move(specimen));
  }
  return specimens;
}

/// Labels of the column "specimen" that several rows have.
std::string repeated_labels(const std::vector<Specimen>& specimens) {
  std::vector<std::string> order;
  std::map<std::string, int> rows;
  for (const Specimen& specimen : specimens) {
    if (specimen.label.empty() || specimen.measured() == 0) continue;
    if (++rows[specimen.label] == 2) order.push_back(specimen.label);
  }
  if (order.empty()) return {};
  std::vector<std::string> repeated;
  for (const std::string& label : order) repeated.push_back(fmt::format("{} in {} rows", label, rows[label]));
  return fmt::format(
      "The column \"specimen\" names a specimen several times, and every row is taken for a specimen of its own: {}. "
      "If "
      "they are repeated tests, give test.file one row for each specimen, the mean of its tests, and this table as "
      "test.repeatability.",
      first_few(repeated));
}

std::string copies(const std::vector<Specimen>& specimens) {
  constexpr std::ptrdiff_t k_fewest = 2;  // one value alone may be the same by chance
  std::map<std::vector<std::optional<double>>, std::string> first;
  std::vector<std::string> found;
  for (const Specimen& specimen : specimens) {
    if (specimen.measured() < k_fewest) continue;
    const auto [earlier, is_new] = first.emplace(specimen.values, specimen.name);
    if (!is_new) found.push_back(fmt::format("specimen {} equals {}", specimen.name, earlier->second));
  }
  if (found.empty()) return {};
  return fmt::format(
      "Specimens that equal an earlier one in every value, as copies do: {}. Each is taken for a specimen of its own, "
      "and copies make intervals too narrow: take them out.",
      first_few(found));
}

}  // namespace

std::vector<std::string> repeated_specimens(const TestContents& contents) {
  const std::vector<Specimen> specimens =
      contents.table ? specimens_of(*contents.table) : specimens_of(contents.specimens);
  std::vector<std::string> sentences{repeated_labels(specimens), copies(specimens)};
  std::erase(sentences, "");
  return sentences;
}

}  // namespace mottle::study
