#include "mottle/drivers/command/extraction.hpp"

#include <cmath>
#include <nlohmann/json.hpp>
#include <numbers>

#include "mottle/core/error.hpp"
#include "mottle/core/files.hpp"
#include "mottle/core/text.hpp"
#include "mottle/drivers/command/number_pattern.hpp"
#include "mottle/formats/calculix/results.hpp"
#include "mottle/formats/nastran/modes.hpp"
#include "mottle/formats/tables/csv.hpp"
#include "mottle/formats/text_lines.hpp"

namespace mottle::drivers {
namespace {

constexpr double k_two_pi = 2.0 * std::numbers::pi;

/// A file that a run has left.
std::filesystem::path output_file(const std::filesystem::path& folder, const std::string& file) {
  std::filesystem::path path = folder / file;
  std::error_code error;
  const auto status = std::filesystem::status(path, error);
  require(status.type() != std::filesystem::file_type::not_found, "the run left no file '{}'", file);
  require(std::filesystem::is_regular_file(status), "'{}' is no regular file", file);
  return path;
}

/// The bytes of a file whose format needs it as a whole.
std::string read_output(const std::filesystem::path& folder, const std::string& file) {
  return read_file(output_file(folder, file));
}

/// The lines of a printed file, which may be larger than the memory.
LineWalker lines_of(const std::filesystem::path& folder, const std::string& file) {
  return {BlockReader(output_file(folder, file)), file};
}

[[noreturn]] void refuse_cut_file(const std::string& file) {
  throw FormatError(file, 0, "ends within a line: it was cut short");
}

/// The same of a file by a finite-element program, which ends every line: a last number that is cut short would be read
/// as another one.
LineWalker whole_lines_of(const std::filesystem::path& folder, const std::string& file) {
  BlockReader reader(output_file(folder, file));
  if (!reader.ends_with_line()) refuse_cut_file(file);
  return {std::move(reader), file};
}

std::string read_whole_output(const std::filesystem::path& folder, const std::string& file) {
  std::string bytes = read_output(folder, file);
  if (!bytes.empty() && bytes.back() != '\n') refuse_cut_file(file);
  return bytes;
}

double number_at(std::string_view text, const std::string& file, int line) {
  double value = 0.0;
  if (!parse_printed_number(text, value)) throw FormatError(file, line, fmt::format("'{}' is not a number", text));
  return value;
}

Eigen::VectorXd to_vector(const std::vector<double>& values) {
  return Eigen::Map<const Eigen::VectorXd>(values.data(), static_cast<Eigen::Index>(values.size()));
}

/// Moves to the line before the first line of the next table; false where there is no table any more.
bool find_table(LineWalker& walker, const std::string& after, int line) {
  if (!after.empty()) {
    do {
      if (!walker.next()) return false;
    } while (walker.line().find(after) == std::string_view::npos);
  }
  for (int skipped = 1; skipped < line; ++skipped) {
    if (!walker.next()) return false;
  }
  return true;
}

Eigen::VectorXd read_column(LineWalker walker, const FrequencyRule& rule) {
  if (!find_table(walker, rule.after, rule.line)) {
    throw FormatError(rule.file, 0,
                      rule.after.empty() ? fmt::format("has no line {}", rule.line)
                                         : fmt::format("has no table after '{}'", rule.after));
  }
  const auto column = static_cast<std::size_t>(std::stoi(rule.column));
  std::vector<double> values;
  while ((rule.modes == 0 || static_cast<int>(values.size()) < rule.modes) && walker.next()) {
    const std::vector<std::string_view> words = words_of(walker.line());
    if (words.empty()) break;
    if (words.size() < column) {
      throw FormatError(rule.file, walker.number(),
                        fmt::format("has {} columns, the frequency is in column {}", words.size(), column));
    }
    values.push_back(number_at(words[column - 1], rule.file, walker.number()));
  }
  return to_vector(values);
}

Eigen::VectorXd read_matches(LineWalker walker, const FrequencyRule& rule) {
  const NumberPattern pattern(rule.pattern);
  std::vector<double> values;
  while (walker.next()) {
    for (const std::string_view number : pattern.first_groups(walker.line())) {
      values.push_back(number_at(number, rule.file, walker.number()));
    }
  }
  return to_vector(values);
}

Eigen::VectorXd read_csv_column(std::string_view bytes, const FrequencyRule& rule) {
  const CsvTable table = parse_csv(bytes, rule.file);
  const int column = table.find(rule.column);
  if (column < 0) throw FormatError(rule.file, 1, unknown_name_message("column", rule.column, table.header));
  Eigen::VectorXd values = numbers_of_column(table, column);
  for (Eigen::Index row = 0; row < values.size(); ++row) {
    if (std::isnan(values(row))) {
      throw FormatError(rule.file, table.lines[static_cast<std::size_t>(row)], "has no frequency");
    }
  }
  return values;
}

Eigen::VectorXd read_json_list(const std::string& bytes, const FrequencyRule& rule) {
  if (nests_deeper_than(bytes, k_deepest_json)) {
    throw FormatError(rule.file, 0, fmt::format("is JSON nested deeper than {} levels", k_deepest_json));
  }
  const nlohmann::json root = nlohmann::json::parse(bytes, nullptr, false);
  if (root.is_discarded()) throw FormatError(rule.file, 0, "is not JSON");
  const nlohmann::json* node = &root;
  std::string_view path = rule.column;
  while (!path.empty()) {
    const std::string key(path.substr(0, path.find('.')));
    path.remove_prefix(std::min(path.size(), key.size() + 1));
    if (!node->is_object() || !node->contains(key))
      throw FormatError(rule.file, 0, fmt::format("has no '{}'", rule.column));
    node = &node->at(key);
  }
  if (!node->is_array()) throw FormatError(rule.file, 0, fmt::format("'{}' is not a list", rule.column));
  std::vector<double> values;
  for (const auto& entry : *node) {
    if (!entry.is_number()) {
      throw FormatError(rule.file, 0, fmt::format("number {} of '{}' is not a number", values.size() + 1, rule.column));
    }
    values.push_back(entry.get<double>());
  }
  return to_vector(values);
}

Eigen::VectorXd read_frequencies(const std::filesystem::path& folder, const FrequencyRule& rule) {
  using Format = FrequencyRule::Format;
  switch (rule.format) {
    case Format::f06:
      return read_f06_eigenvalues(whole_lines_of(folder, rule.file), rule.file);
    case Format::punch:
      return read_punch_eigenvalues(whole_lines_of(folder, rule.file), rule.file);
    case Format::calculix:
      return parse_calculix_eigenvalues(read_whole_output(folder, rule.file), rule.file);
    case Format::regex:
      return read_matches(lines_of(folder, rule.file), rule);
    case Format::csv:
      return read_csv_column(read_output(folder, rule.file), rule);
    case Format::json:
      return read_json_list(read_output(folder, rule.file), rule);
    case Format::column:
      break;
  }
  return read_column(lines_of(folder, rule.file), rule);
}

/// Eigenvalues from the rule's quantity; a negative frequency is an error, a negative eigenvalue is not.
Eigen::VectorXd to_eigenvalues(const Eigen::VectorXd& numbers, const FrequencyRule& rule) {
  using Quantity = FrequencyRule::Quantity;
  const bool is_eigenvalue = rule.has_eigenvalues();
  Eigen::VectorXd eigenvalues = numbers;
  for (Eigen::Index k = 0; k < numbers.size(); ++k) {
    const double slack = 1e-6 * std::abs(numbers(k)) + (is_eigenvalue ? 1e-9 * numbers.cwiseAbs().maxCoeff() : 0.0);
    if (!is_eigenvalue && numbers(k) < 0.0) {
      throw FormatError(rule.file, 0, fmt::format("the frequency of mode {}, {:.6g}, is negative", k + 1, numbers(k)));
    }
    if (k > 0 && numbers(k) < numbers(k - 1) - slack) {
      throw FormatError(rule.file, 0,
                        fmt::format("modes do not ascend: mode {} has {:.6g}, mode {} has {:.6g}", k, numbers(k - 1),
                                    k + 1, numbers(k)));
    }
    const double omega = rule.quantity == Quantity::hertz ? k_two_pi * numbers(k) : numbers(k);
    if (!is_eigenvalue) eigenvalues(k) = omega * omega;
    if (!std::isfinite(eigenvalues(k))) {
      throw FormatError(rule.file, 0, fmt::format("the frequency of mode {}, {:.6g}, is too large", k + 1, numbers(k)));
    }
  }
  return eigenvalues;
}

NamedShapes read_shape_tables(LineWalker walker, const ShapeRule& rule) {
  ShapeCollector collector(rule.file);
  for (int mode = 1; find_table(walker, rule.after, rule.line); ++mode) {
    collector.begin_mode(mode, walker.number());
    while (walker.next()) {
      const std::vector<std::string_view> words = words_of(walker.line());
      if (words.empty()) break;
      if (words.size() < rule.components.size() + 1) {
        throw FormatError(
            rule.file, walker.number(),
            fmt::format("has {} columns, node and {} components are needed", words.size(), rule.components.size()));
      }
      for (std::size_t c = 0; c < rule.components.size(); ++c) {
        collector.add(fmt::format("{}:{}", words[0], rule.components[c]),
                      number_at(words[c + 1], rule.file, walker.number()));
      }
    }
  }
  return collector.shapes();
}

NamedShapes read_shape_csv(std::string_view bytes, const ShapeRule& rule) {
  const CsvTable table = parse_csv(bytes, rule.file);
  ShapeCollector collector(rule.file);
  for (std::size_t mode = 1; mode < table.header.size(); ++mode) {
    collector.begin_mode(static_cast<int>(mode), 1);
    for (std::size_t row = 0; row < table.rows.size(); ++row) {
      collector.add(table.rows[row][0], number_at(table.rows[row][mode], rule.file, table.lines[row]));
    }
  }
  return collector.shapes();
}

NamedShapes read_calculix_shapes(std::string_view bytes, const std::string& file) {
  ShapeCollector collector(file);
  int mode = 0;
  for (const CalculixShape& shape : parse_calculix_shapes(bytes, file)) {
    collector.begin_mode(++mode, 0);
    for (const auto& [node, displacement] : shape.displacements) {
      collector.add(fmt::format("{}:+X", node), displacement(0));
      collector.add(fmt::format("{}:+Y", node), displacement(1));
      collector.add(fmt::format("{}:+Z", node), displacement(2));
    }
  }
  return collector.shapes();
}

NamedShapes read_shapes(const std::filesystem::path& folder, const ShapeRule& rule) {
  using Format = ShapeRule::Format;
  switch (rule.format) {
    case Format::f06:
      return read_f06_shapes(whole_lines_of(folder, rule.file), rule.file);
    case Format::punch:
      return read_punch_shapes(whole_lines_of(folder, rule.file), rule.file);
    case Format::calculix:
      return read_calculix_shapes(read_whole_output(folder, rule.file), rule.file);
    case Format::column:
      return read_shape_tables(lines_of(folder, rule.file), rule);
    case Format::csv:
      break;
  }
  return read_shape_csv(read_output(folder, rule.file), rule);
}

}  // namespace

ExtractedModes extract_modes(const std::filesystem::path& folder, const FrequencyRule& frequencies,
                             const std::optional<ShapeRule>& shapes, int min_modes) {
  ExtractedModes modes;
  modes.eigenvalues = to_eigenvalues(read_frequencies(folder, frequencies), frequencies);
  const auto found = static_cast<int>(modes.eigenvalues.size());
  if (found < min_modes)
    throw FormatError(frequencies.file, 0, fmt::format("{} modes are there, {} are needed", found, min_modes));
  if (!shapes) return modes;
  NamedShapes read = read_shapes(folder, *shapes);
  if (read.values.cols() < found) {
    throw FormatError(
        shapes->file, 0,
        fmt::format("has shapes of {} modes, '{}' has frequencies of {}", read.values.cols(), frequencies.file, found));
  }
  modes.shapes = read.values.leftCols(found);
  modes.degree_of_freedom_names = std::move(read.names);
  for (int k = 0; k < found; ++k) {
    if (modes.shapes.col(k).isZero(0.0))
      throw FormatError(shapes->file, 0, fmt::format("the shape of mode {} is zero", k + 1));
  }
  return modes;
}

}  // namespace mottle::drivers
