// Columns of a table of tests as values of the model's outputs.
#pragma once

#include <Eigen/Core>
#include <string>
#include <vector>

#include "mottle/formats/tables/csv.hpp"
#include "mottle/layers.hpp"
#include "mottle/model/structure_model.hpp"
#include "mottle/study/input/study.hpp"

namespace mottle::study {

std::vector<std::string> output_names(const std::vector<Quantity>& outputs);

/// Column of each quantity, by its name with or without a unit behind ("f1", "f1_Hz", "f1 [Hz]").
///
/// @param notes  columns that are not used are added
/// @throws FormatError  a quantity has no column or two, a column is nothing known, or in another unit than the study's
std::vector<int> match_columns(const CsvTable& table, const Study& study, const std::vector<Quantity>& quantities,
                               std::vector<std::string>& notes);

/// Numbers of the specimens in the rows of a table: those of its column "specimen" where it holds whole numbers, each
/// once, else those of the rows.
std::vector<int> specimen_numbers(const CsvTable& table);

/// The numbers of a column; nan: not measured.
///
/// @param is_positive  they are frequencies or eigenvalues
/// @throws FormatError  a frequency that is not greater than 0, a number whose square is none
Eigen::VectorXd measured_numbers(const CsvTable& table, int column, bool is_positive);

/// Rows are specimens, columns StructureModel::measured(); nan: not measured.
///
/// @throws FormatError  a frequency that is not greater than 0, a number whose square is none
Eigen::MatrixXd values_of_columns(const CsvTable& table, const std::vector<int>& columns, const StructureModel& model);

/// Covariances hold products of two values.
inline bool is_too_large(double value) {
  constexpr double k_largest = 1e150;
  return value > k_largest || value < -k_largest;
}

}  // namespace mottle::study
