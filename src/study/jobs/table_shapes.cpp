#include "study/jobs/table_shapes.hpp"

#include <algorithm>
#include <charconv>
#include <cmath>
#include <limits>
#include <set>

#include "study/tests/pair_by_frequency.hpp"
#include "study/tests/pair_modes.hpp"

namespace mottle::study {
namespace {

constexpr double k_nan = std::numeric_limits<double>::quiet_NaN();

/// Columns of the components of each mode: number -> degree of freedom -> column.
using ShapeColumns = std::map<int, std::map<std::string, int>>;

ShapeColumns find_columns(const CsvTable& table, const StructureModel& model) {
  const std::string stem = traits_of(QuantityKind::displacement).stem;
  ShapeColumns columns;
  for (std::size_t column = 0; column < table.header.size(); ++column) {
    const std::string& title = table.header[column];
    if (!title.starts_with(stem)) continue;
    int number = 0;
    const char* const end = title.data() + title.size();
    const auto [rest, error] = std::from_chars(title.data() + stem.size(), end, number);
    if (error != std::errc() || number < 1 || rest == end || *rest != ':') continue;
    const std::string location(rest + 1, end);
    const std::string name = location.substr(0, location.find_first_of(" [("));
    if (model.structure().find_degree_of_freedom(name) >= 0) columns[number][name] = static_cast<int>(column);
  }
  std::erase_if(columns, [](const auto& mode) { return mode.second.size() < 2; });
  return columns;
}

/// Column of the frequency of a mode; -1: none.
int frequency_column(const CsvTable& table, int number) {
  for (std::size_t column = 0; column < table.header.size(); ++column) {
    const auto title = numbered_title(table.header[column]);
    if (title && title->stem == traits_of(QuantityKind::frequency).stem && title->number == number) {
      return static_cast<int>(column);
    }
  }
  return -1;
}

/// One specimen for each row, one mode for each of `columns`.
std::vector<MeasuredModes> specimens_of(const CsvTable& table, const ShapeColumns& columns,
                                        const std::vector<std::string>& dofs) {
  const auto modes = static_cast<Eigen::Index>(columns.size());
  const auto rows = static_cast<Eigen::Index>(table.rows.size());
  MeasuredModes empty{.file = table.file,
                      .frequencies = Eigen::VectorXd::Constant(modes, k_nan),
                      .damping = Eigen::VectorXd::Constant(modes, k_nan),
                      .shapes = Eigen::MatrixXd::Constant(static_cast<Eigen::Index>(dofs.size()), modes, k_nan),
                      .collinearity = Eigen::VectorXd::Ones(modes),
                      .is_scaled = std::vector<bool>(columns.size(), true)};
  for (const std::string& name : dofs) empty.components.push_back({.name = name});
  std::vector<MeasuredModes> specimens(table.rows.size(), empty);
  Eigen::Index mode = 0;
  for (const auto& [number, components] : columns) {
    const int frequency = frequency_column(table, number);
    if (frequency >= 0) {
      const Eigen::VectorXd values = numbers_of_column(table, frequency);
      for (Eigen::Index s = 0; s < rows; ++s) specimens[static_cast<std::size_t>(s)].frequencies(mode) = values(s);
    }
    for (const auto& [name, column] : components) {
      const auto row = std::distance(dofs.begin(), std::ranges::find(dofs, name));
      const Eigen::VectorXd values = numbers_of_column(table, column);
      for (Eigen::Index s = 0; s < rows; ++s) specimens[static_cast<std::size_t>(s)].shapes(row, mode) = values(s);
    }
    ++mode;
  }
  return specimens;
}

/// The pair of each tested mode that most specimens have.
std::map<int, ShapeMatch> matches_of(const PairedModes& paired, const ShapeColumns& columns) {
  std::vector<int> numbers;
  for (const auto& [number, components] : columns) numbers.push_back(number);
  const CsvTable table = parse_csv(paired.table, "pairing.csv");
  const auto column = [&](const char* name) { return numbers_of_column(table, table.find(name)); };
  const Eigen::VectorXd modes = column("mode");
  const Eigen::VectorXd tests = column("test_mode");
  const Eigen::VectorXd mac = column("mac");
  const auto verdict = static_cast<std::size_t>(table.find("verdict"));
  std::map<int, std::map<int, std::vector<double>>> found;  // test -> mode -> MAC
  for (std::size_t row = 0; row < table.rows.size(); ++row) {
    const std::string& text = table.rows[row][verdict];
    if (text != "paired" && text != "doubtful") continue;
    const auto r = static_cast<Eigen::Index>(row);
    found[numbers[static_cast<std::size_t>(tests(r)) - 1]][static_cast<int>(modes(r))].push_back(mac(r));
  }
  std::map<int, ShapeMatch> matches;
  for (const auto& [test, candidates] : found) {
    const auto most =
        std::ranges::max_element(candidates, {}, [](const auto& candidate) { return candidate.second.size(); });
    double sum = 0.0;
    for (const double one : most->second) sum += one;
    matches[test] = {most->first, sum / static_cast<double>(most->second.size())};
  }
  return matches;
}

/// Median over specimens and modes of |model's shape| / |test's|.
double size_of(const std::vector<MeasuredModes>& specimens, const std::map<int, ShapeMatch>& matches,
               const ShapeColumns& columns, const StructureModel& model, const std::vector<std::string>& dofs) {
  std::vector<int> numbers;
  for (const std::string& name : dofs) numbers.push_back(model.structure().find_degree_of_freedom(name));
  const Eigen::MatrixXd reference = model.structure().displacements(model.reference_modes().shapes, numbers);
  std::vector<double> sizes;
  Eigen::Index mode = 0;
  for (const auto& [number, components] : columns) {
    const auto match = matches.find(number);
    for (const MeasuredModes& specimen : specimens) {
      const Eigen::VectorXd shape = specimen.shapes.col(mode);
      if (match == matches.end() || !shape.allFinite() || shape.isZero(0.0)) continue;
      sizes.push_back(reference.col(match->second.mode - 1).norm() / shape.norm());
    }
    ++mode;
  }
  if (sizes.empty()) return 1.0;
  std::ranges::sort(sizes);
  return sizes[sizes.size() / 2];
}

}  // namespace

bool TableShapes::counts_as_model() const {
  return std::ranges::all_of(shapes.modes, [&](int number) {
    const auto match = matches.find(number);
    return match == matches.end() || match->second.mode == number;
  });
}

std::optional<TableShapes> shapes_of_table(const CsvTable& table, const StructureModel& model) {
  const ShapeColumns columns = find_columns(table, model);
  if (columns.empty() || table.rows.empty()) return std::nullopt;
  std::set<std::string> all;
  TableShapes found;
  for (const auto& [number, components] : columns) {
    found.shapes.modes.push_back(number);
    for (const auto& [name, column] : components) all.insert(name);
  }
  const std::vector<std::string> dofs(all.begin(), all.end());
  for (const std::string& name : dofs) {
    const bool is_everywhere =
        std::ranges::all_of(columns, [&](const auto& mode) { return mode.second.contains(name); });
    if (is_everywhere) found.shapes.degrees_of_freedom.push_back(name);
  }
  const std::vector<MeasuredModes> specimens = specimens_of(table, columns, dofs);
  found.matches = matches_of(pair_modes(model, specimens, true), columns);
  found.shapes.size = size_of(specimens, found.matches, columns, model, dofs);
  return found;
}

}  // namespace mottle::study
