// The clouds of a run as the page draws them: from clouds.csv, with as many samples and digits as a plot can show.
#pragma once

#include <Eigen/Core>
#include <filesystem>
#include <nlohmann/json.hpp>
#include <vector>

#include "mottle/formats/tables/csv.hpp"
#include "mottle/layers.hpp"

namespace mottle::report {

using Json = nlohmann::ordered_json;

std::vector<Eigen::VectorXd> read_columns(const CsvTable& table);

/// `count` cells of a row, from column `first` on; nan becomes null.
Json row_json(const std::vector<Eigen::VectorXd>& columns, std::size_t first, std::size_t count, Eigen::Index row);

/// Samples by iteration, with six digits of each column's range. The first and the last cloud are whole; those between
/// share 60,000 numbers, so that a page stays small after many iterations.
///
/// @param file        its first column is the iteration, then come the parameters, then the outputs
/// @param parameters  their number
/// @throws FormatError  the file does not have these columns
Json clouds_json(const std::filesystem::path& file, std::size_t parameters);

}  // namespace mottle::report
