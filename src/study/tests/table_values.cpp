#include "study/tests/table_values.hpp"

#include <algorithm>

#include "mottle/core/text.hpp"

namespace mottle::study {
namespace {

struct ColumnTitle {
  std::string name;
  std::string unit;  // as stated, without brackets; empty: none is
};

/// "f1_Hz", "f1 [Hz]", "f1 (Hz)", "u1:m2_m".
ColumnTitle split_title(const std::string& title, const std::vector<Quantity>& outputs) {
  for (const std::string open : {" [", " (", "[", "("}) {
    const std::size_t position = title.find(open);
    if (position == std::string::npos || position == 0) continue;
    const std::size_t start = position + open.size();
    return {title.substr(0, position), title.substr(start, title.find_first_of("])", start) - start)};
  }
  for (const std::string unit : {"kHz", "Hz"}) {
    const std::string end = "_" + unit;
    if (title.size() > end.size() && title.ends_with(end)) return {title.substr(0, title.size() - end.size()), unit};
  }
  for (const Quantity& output : outputs) {
    if (title.ends_with("_" + output.unit) && title == output.name() + "_" + output.unit)
      return {output.name(), output.unit};
  }
  return {title, ""};
}

/// Whether values in the unit that a column states are those of the output. Shapes have the unit of their mode's size,
/// and a user's own output may have none that is known.
bool is_unit_of(const std::string& stated, const Quantity& output) {
  if (stated.empty() || stated == output.unit) return true;
  if (output.kind == QuantityKind::damping_ratio) return stated == "1";
  return output.unit == "-";
}

/// A column in another unit than the study's would be read wrong by a factor.
void require_unit(const CsvTable& table, const Study& study, const std::string& title, const std::string& stated,
                  const Quantity& output) {
  if (is_unit_of(stated, output)) return;
  if (output.kind == QuantityKind::damping_ratio) {
    throw FormatError(table.file, 1,
                      fmt::format("column '{}' is in {}, but damping ratios are fractions of critical damping (0.01, "
                                  "not 1 %); convert the column",
                                  title, stated));
  }
  throw FormatError(
      table.file, 1,
      fmt::format("column '{}' is in {}, but in units = \"{}\" {} is in {}; convert the column, or set the "
                  "study's units",
                  title, stated, study.units, output.name(), output.unit));
}

}  // namespace

std::vector<std::string> output_names(const std::vector<Quantity>& outputs) {
  std::vector<std::string> names;
  for (const Quantity& output : outputs) names.push_back(output.name());
  return names;
}

std::vector<int> match_columns(const CsvTable& table, const Study& study, const std::vector<Quantity>& quantities,
                               std::vector<std::string>& notes) {
  const std::vector<std::string> outputs = output_names(quantities);
  std::vector<int> columns(outputs.size(), -1);
  std::vector<std::string> unused;
  for (std::size_t column = 0; column < table.header.size(); ++column) {
    const ColumnTitle title = split_title(table.header[column], quantities);
    const std::string& name = title.name;
    const std::string& unit = title.unit;
    const auto output = std::find(outputs.begin(), outputs.end(), name);
    if (output != outputs.end()) {
      const auto index = static_cast<std::size_t>(std::distance(outputs.begin(), output));
      require_unit(table, study, table.header[column], unit, quantities[index]);
      int& found = columns[index];
      if (found >= 0) throw FormatError(table.file, 1, fmt::format("output '{}' has two columns", name));
      found = static_cast<int>(column);
      continue;
    }
    const bool is_parameter = std::any_of(study.parameters.list.begin(), study.parameters.list.end(),
                                          [&](const StudyParameter& parameter) { return parameter.name == name; });
    const bool is_label = name == "specimen" || name == "status";
    if (!is_parameter && !is_label && !may_name_quantity(name)) {
      throw FormatError(table.file, 1, unknown_name_message("column", table.header[column], outputs));
    }
    if (!is_label) unused.push_back(table.header[column]);
  }
  for (std::size_t i = 0; i < outputs.size(); ++i) {
    if (columns[i] < 0) {
      throw FormatError(table.file, 1,
                        fmt::format("output '{}' has no column; the columns are {}", outputs[i], join(table.header)));
    }
  }
  if (!unused.empty()) notes.push_back(fmt::format("Columns of the test file that are not used: {}.", join(unused)));
  return columns;
}

Eigen::VectorXd measured_numbers(const CsvTable& table, int column, bool is_frequency) {
  Eigen::VectorXd numbers = numbers_of_column(table, column);
  for (Eigen::Index row = 0; row < numbers.size(); ++row) {
    const char* fault = nullptr;
    if (is_too_large(numbers(row))) fault = "whose square is no number any more; give the tests other units";
    if (is_frequency && numbers(row) <= 0.0) {
      fault = "but a natural frequency is greater than 0; a mode that was not measured has an empty cell";
    }
    if (fault == nullptr) continue;
    throw FormatError(
        table.file, table.lines[static_cast<std::size_t>(row)],
        fmt::format("column '{}' holds {:g}, {}", table.header[static_cast<std::size_t>(column)], numbers(row), fault));
  }
  return numbers;
}

Eigen::MatrixXd values_of_columns(const CsvTable& table, const std::vector<int>& columns, const StructureModel& model) {
  Eigen::MatrixXd values(static_cast<Eigen::Index>(table.rows.size()), static_cast<Eigen::Index>(columns.size()));
  for (std::size_t k = 0; k < columns.size(); ++k) {
    const bool is_frequency = model.measured()[k].kind == QuantityKind::frequency;
    values.col(static_cast<Eigen::Index>(k)) = measured_numbers(table, columns[k], is_frequency);
  }
  return values;
}

}  // namespace mottle::study
