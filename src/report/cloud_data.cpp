#include "report/cloud_data.hpp"

#include <algorithm>
#include <cmath>
#include <limits>

#include "mottle/core/error.hpp"
#include "mottle/core/rounding.hpp"
#include "mottle/study/input/text_file.hpp"

namespace mottle::report {
namespace {

constexpr std::size_t k_numbers_between = 60'000;  // half a megabyte
constexpr std::size_t k_least_samples = 25;        // of a cloud that is drawn

/// Rows of the file that belong to one iteration.
struct CloudRows {
  double iteration = 0.0;
  Eigen::Index begin = 0;
  Eigen::Index end = 0;
};

std::vector<CloudRows> clouds_of(const Eigen::VectorXd& iterations) {
  std::vector<CloudRows> clouds;
  for (Eigen::Index row = 0; row < iterations.size(); ++row) {
    if (clouds.empty() || clouds.back().iteration != iterations(row)) clouds.push_back({iterations(row), row, row});
    clouds.back().end = row + 1;
  }
  return clouds;
}

void round_to_range(Eigen::VectorXd& column) {
  double least = std::numeric_limits<double>::infinity();
  double greatest = -least;
  for (const double value : column) {
    if (!std::isfinite(value)) continue;
    least = std::min(least, value);
    greatest = std::max(greatest, value);
  }
  const int digits = digits_of_range(greatest - least, std::max(std::abs(least), std::abs(greatest)));
  for (double& value : column) value = rounded(value, digits);
}

/// Samples that each cloud between the first and the last may have.
Eigen::Index samples_between(std::size_t clouds, std::size_t columns) {
  if (clouds <= 2) return std::numeric_limits<Eigen::Index>::max();
  return static_cast<Eigen::Index>(std::max(k_least_samples, k_numbers_between / ((clouds - 2) * columns)));
}

}  // namespace

std::vector<Eigen::VectorXd> read_columns(const CsvTable& table) {
  std::vector<Eigen::VectorXd> columns;
  for (std::size_t i = 0; i < table.header.size(); ++i)
    columns.push_back(numbers_of_column(table, static_cast<int>(i)));
  return columns;
}

Json row_json(const std::vector<Eigen::VectorXd>& columns, std::size_t first, std::size_t count, Eigen::Index row) {
  Json cells = Json::array();
  for (std::size_t column = first; column < first + count; ++column) {
    const double value = columns[column](row);
    cells.push_back(std::isnan(value) ? Json(nullptr) : Json(value));
  }
  return cells;
}

Json clouds_json(const std::filesystem::path& file, std::size_t parameters) {
  const CsvTable table = parse_csv(read_text_file(file), file.string());
  if (table.header.size() < parameters + 2 || table.header.front() != "iteration") {
    throw FormatError(file.string(), 1, "does not fit result.json; run the study again");
  }
  std::vector<Eigen::VectorXd> columns = read_columns(table);
  for (std::size_t column = 1; column < columns.size(); ++column) round_to_range(columns[column]);
  const std::size_t outputs = columns.size() - 1 - parameters;
  const std::vector<CloudRows> clouds = clouds_of(columns[0]);
  const Eigen::Index most_between = samples_between(clouds.size(), columns.size() - 1);
  Json list = Json::array();
  for (std::size_t k = 0; k < clouds.size(); ++k) {
    const CloudRows& cloud = clouds[k];
    const bool is_whole = k == 0 || k + 1 == clouds.size();
    const Eigen::Index rows = is_whole ? cloud.end - cloud.begin : std::min(cloud.end - cloud.begin, most_between);
    Json json = {{"iteration", cloud.iteration}, {"parameters", Json::array()}, {"outputs", Json::array()}};
    for (Eigen::Index row = cloud.begin; row < cloud.begin + rows; ++row) {
      json["parameters"].push_back(row_json(columns, 1, parameters, row));
      json["outputs"].push_back(row_json(columns, 1 + parameters, outputs, row));
    }
    list.push_back(std::move(json));
  }
  return list;
}

}  // namespace mottle::report
