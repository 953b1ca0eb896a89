// Tests in the variables of a MATLAB file.
#include <algorithm>
#include <cmath>
#include <limits>
#include <numeric>

#include "mottle/core/error.hpp"
#include "mottle/core/text.hpp"
#include "mottle/model/units.hpp"
#include "study/tests/measured_modes.hpp"

namespace mottle::study {
namespace {

using Variables = std::map<std::string, MatVariable>;

std::string sizes_text(const std::vector<std::size_t>& sizes) {
  std::vector<std::string> texts;
  for (const std::size_t size : sizes) texts.push_back(fmt::format("{}", size));
  return join(texts, " x ");
}

/// Numbers of a variable whose sizes are as wanted, but for dimensions of 1 at the end.
const std::vector<double>& numbers_of(const Variables& variables, const std::string& file, const std::string& name,
                                      std::vector<std::size_t> wanted) {
  const auto found = variables.find(name);
  if (found == variables.end() || found->second.numbers.empty()) {
    throw FormatError(file, 0, fmt::format("has no variable '{}' with numbers", name));
  }
  std::vector<std::size_t> sizes = found->second.sizes;
  while (sizes.size() > 2 && sizes.back() == 1) sizes.pop_back();
  while (wanted.size() > 2 && wanted.back() == 1) wanted.pop_back();
  if (sizes != wanted) {
    throw FormatError(file, 0,
                      fmt::format("variable '{}' is {}, it should be {}", name, sizes_text(sizes), sizes_text(wanted)));
  }
  return found->second.numbers;
}

/// Tests of more structures than anybody builds would take gigabytes from a file of kilobytes.
void require_few(std::size_t specimens, const std::string& file) {
  constexpr std::size_t k_max = 1'000'000;
  if (specimens > k_max)
    throw FormatError(file, 0, fmt::format("holds {} specimens, at most {} are read", specimens, k_max));
}

}  // namespace

std::vector<MeasuredModes> modes_from_mat(const Variables& variables, const std::string& file,
                                          const std::string& units) {
  const auto dofs = variables.find("dofs");
  if (dofs == variables.end() || dofs->second.texts.empty()) {
    throw FormatError(file, 0, "has no variable 'dofs', a cell array with the name of each row of 'shapes'");
  }
  const auto given = variables.find("frequencies");
  const std::vector<std::size_t> counts =
      given == variables.end() ? std::vector<std::size_t>{0, 0} : given->second.sizes;
  const std::size_t specimens = counts[0];
  const std::size_t modes = counts[1];
  const std::size_t rows = dofs->second.texts.size();
  require_few(specimens, file);
  const std::vector<double>& frequencies = numbers_of(variables, file, "frequencies", {specimens, modes});
  const std::vector<double>& shapes = numbers_of(variables, file, "shapes", {rows, modes, specimens});
  const bool has_masses = variables.contains("modal_masses");
  const std::vector<double> masses =
      has_masses ? numbers_of(variables, file, "modal_masses", {specimens, modes}) : std::vector<double>();
  std::vector<MeasuredModes> result(specimens);
  for (std::size_t s = 0; s < specimens; ++s) {
    MeasuredModes& specimen = result[s];
    specimen.file = file;
    for (const std::string& name : dofs->second.texts) specimen.components.push_back(named_component(name));
    std::vector<std::size_t> found;
    for (std::size_t mode = 0; mode < modes; ++mode) {
      if (std::isfinite(frequencies[s + mode * specimens])) found.push_back(mode);
    }
    const auto count = static_cast<Eigen::Index>(found.size());
    specimen.frequencies.resize(count);
    specimen.damping = Eigen::VectorXd::Constant(count, std::numeric_limits<double>::quiet_NaN());
    specimen.collinearity = Eigen::VectorXd::Ones(count);
    specimen.shapes.resize(static_cast<Eigen::Index>(rows), count);
    for (Eigen::Index t = 0; t < count; ++t) {
      const std::size_t mode = found[static_cast<std::size_t>(t)];
      const double mass = has_masses ? masses[s + mode * specimens] : 0.0;
      const bool is_scaled = mass > 0.0;
      specimen.frequencies(t) = frequencies[s + mode * specimens] / unit_sizes(units).frequency;
      specimen.shapes.col(t) = Eigen::Map<const Eigen::VectorXd>(shapes.data() + (s * modes + mode) * rows,
                                                                 static_cast<Eigen::Index>(rows)) /
                               (is_scaled ? std::sqrt(mass) : 1.0);
      specimen.is_scaled.push_back(is_scaled);
    }
  }
  return result;
}

CsvTable table_from_mat(const Variables& variables, const std::string& file) {
  CsvTable table;
  table.file = file;
  std::size_t rows = 0;
  for (const auto& [name, variable] : variables) {
    const std::size_t count = variable.numbers.empty() ? variable.texts.size() : variable.numbers.size();
    const bool is_column =
        std::count_if(variable.sizes.begin(), variable.sizes.end(), [](std::size_t size) { return size != 1; }) <= 1;
    if (!is_column || (rows != 0 && count != rows)) {
      throw FormatError(file, 0,
                        fmt::format("variable '{}' is {}; every column needs one number for each specimen, or the "
                                    "file holds 'frequencies', 'shapes' and 'dofs'",
                                    name, sizes_text(variable.sizes)));
    }
    rows = count;
    require_few(rows, file);
    table.header.push_back(name);
    table.rows.resize(rows);
    for (std::size_t row = 0; row < rows; ++row) {
      table.rows[row].push_back(variable.numbers.empty() ? variable.texts[row] : number_text(variable.numbers[row]));
    }
  }
  table.lines.resize(rows);
  table.numbers.resize(rows);
  std::iota(table.numbers.begin(), table.numbers.end(), 1);
  return table;
}

}  // namespace mottle::study
