// Rules by which modes are read from the files of a solver's run. Strict: text instead of a number, frequencies that do
// not ascend and missing values are errors with file and line.
#pragma once

#include <Eigen/Core>
#include <filesystem>
#include <optional>
#include <string>
#include <vector>

#include "mottle/layers.hpp"

namespace mottle::drivers {

/// Natural frequencies.
struct FrequencyRule {
  enum class Format { column, regex, csv, json, f06, punch, calculix };
  enum class Quantity { hertz, radians, eigenvalue };

  std::string file = {};  ///< in the run's folder
  Format format = Format::column;
  Quantity quantity = Quantity::hertz;  ///< what the numbers are; of f06, punch and calculix known
  std::string pattern = {};             ///< regex: its first group is the number; every match on every line is a mode
  std::string after = {};               ///< column: text in the line before the table; empty: the file's beginning
  int line = 1;                         ///< column: the table's first line, counted from that one
  std::string column = {};  ///< csv: of the header; column: number counted from 1; json: "modes.frequencies"
  int modes = 0;            ///< how many a run must give; 0: as many as the first run gave

  /// Whether the numbers are eigenvalues: of some formats they always are.
  bool has_eigenvalues() const {
    return format == Format::f06 || format == Format::punch || format == Format::calculix ||
           quantity == Quantity::eigenvalue;
  }
};

/// Shapes at named degrees of freedom.
struct ShapeRule {
  enum class Format { csv, column, f06, punch, calculix };

  std::string file = {};
  Format format = Format::csv;
  std::string after = {};                                    ///< column: text before the table of each mode
  int line = 1;                                              ///< column: as of a FrequencyRule
  std::vector<std::string> components = {"+X", "+Y", "+Z"};  ///< column: what follows the node's number
};

/// What was read.
struct ExtractedModes {
  Eigen::VectorXd eigenvalues = {};                       ///< (rad/s)^2, ascending
  Eigen::MatrixXd shapes = {};                            ///< [degree of freedom x mode]; empty without a rule
  std::vector<std::string> degree_of_freedom_names = {};  ///< "101:+Z"; of csv whatever stands there
};

/// @param folder  where the run was
/// @param min_modes  smallest number of modes
/// @throws InvalidInput  a file is missing; FormatError (file, line) it does not hold what the rule says
ExtractedModes extract_modes(const std::filesystem::path& folder, const FrequencyRule& frequencies,
                             const std::optional<ShapeRule>& shapes, int min_modes);

}  // namespace mottle::drivers
