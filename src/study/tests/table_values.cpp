#include "study/tests/table_values.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <set>

#include "mottle/core/text.hpp"

namespace mottle::study {
namespace {

struct ColumnTitle {
  std::string name;
  std::string unit;  // as stated, without brackets; empty: none is
};

/// "f1_Hz", "f1 [Hz]", "f1 (Hz)", "u1:m2_m".
ColumnTitle split_title(const std::string& title, const std::vector<Quantity>& outputs) {
  for (const Quantity& output : outputs) {
    if (title == output.name()) return {title, ""};
    if (title.starts_with(output.name() + "_")) return {output.name(), title.substr(output.name().size() + 1)};
  }
  for (const std::string open : {" [", " (", "[", "("}) {
    const std::size_t position = title.find(open);
    if (position == std::string::npos || position == 0) continue;
    const std::size_t start = position + open.size();
    const std::size_t end = std::max(title.rfind(open.back() == '[' ? ']' : ')'), start);
    return {title.substr(0, position), title.substr(start, (end == std::string::npos ? title.size() : end) - start)};
  }
  const std::size_t underscore = title.find('_');  // of what is no output
  const bool has_unit =
      underscore != std::string::npos && !may_name_quantity(title) && may_name_quantity(title.substr(0, underscore));
  if (has_unit) return {title.substr(0, underscore), title.substr(underscore + 1)};
  return {title, ""};
}

/// What turns values in one unit into another's; empty: not known.
std::string conversion_text(const std::string& from, const std::string& to) {
  struct Conversion {
    const char *from, *to, *text;
  };
  static constexpr std::array k_conversions = {Conversion{"rad/s", "Hz", "divide it by 2 pi"},
                                               Conversion{"rpm", "Hz", "divide it by 60"},
                                               Conversion{"1/min", "Hz", "divide it by 60"},
                                               Conversion{"kHz", "Hz", "multiply it by 1000"},
                                               Conversion{"Hz", "kHz", "divide it by 1000"},
                                               Conversion{"mHz", "Hz", "divide it by 1000"},
                                               Conversion{"rad/ms", "kHz", "divide it by 2 pi"},
                                               Conversion{"rad/s", "kHz", "divide it by 2000 pi"},
                                               Conversion{"Hz^2", "(rad/s)^2", "multiply it by 4 pi^2"},
                                               Conversion{"kHz^2", "(rad/ms)^2", "multiply it by 4 pi^2"}};
  for (const Conversion& known : k_conversions) {
    if (known.from == from && known.to == to) return fmt::format(" ({})", known.text);
  }
  return {};
}

/// Whether values in the unit that a column states are those of the output. Shapes have the unit of their mode's size,
/// and a user's own output may have none that is known.
bool is_unit_of(const std::string& stated, const Quantity& output) {
  if (stated.empty() || stated == output.unit) return true;
  if (output.kind == QuantityKind::damping_ratio) return stated == "1";
  if (output.kind == QuantityKind::eigenvalue) {
    return stated == (output.unit == "(rad/s)^2" ? "rad^2/s^2" : "rad^2/ms^2");
  }
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
      fmt::format("column '{}' is in {}, but in units = \"{}\" {} is in {}; convert the column{}, or set the "
                  "study's units",
                  title, stated, study.units, output.name(), output.unit, conversion_text(stated, output.unit)));
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

std::vector<int> specimen_numbers(const CsvTable& table) {
  const int column = table.find("specimen");
  if (column < 0) return table.numbers;
  std::vector<int> numbers;
  for (const std::vector<std::string>& row : table.rows) {
    double number = 0.0;
    const bool is_read = parse_number(row[static_cast<std::size_t>(column)], number);
    if (!is_read || !(number >= 1.0 && number <= 1e9) || number != std::floor(number)) return table.numbers;
    numbers.push_back(static_cast<int>(number));
  }
  const std::set<int> different(numbers.begin(), numbers.end());
  return different.size() == numbers.size() ? numbers : table.numbers;
}

Eigen::VectorXd measured_numbers(const CsvTable& table, int column, bool is_positive) {
  Eigen::VectorXd numbers = numbers_of_column(table, column);
  for (Eigen::Index row = 0; row < numbers.size(); ++row) {
    const char* fault = nullptr;
    if (is_too_large(numbers(row))) fault = "whose square is no number any more; give the tests other units";
    if (is_positive && numbers(row) <= 0.0) {
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
    const bool is_positive = traits_of(model.measured()[k].kind).is_positive;
    values.col(static_cast<Eigen::Index>(k)) = measured_numbers(table, columns[k], is_positive);
  }
  return values;
}

}  // namespace mottle::study
