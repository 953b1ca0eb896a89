#include "mottle/report/report.hpp"

#include <algorithm>
#include <cmath>
#include <nlohmann/json.hpp>
#include <string>
#include <vector>

#include "mottle/core/error.hpp"
#include "mottle/core/files.hpp"
#include "mottle/core/text.hpp"
#include "mottle/formats/tables/csv.hpp"
#include "mottle/study/input/text_file.hpp"
#include "mottle/study/results/run_folder.hpp"
#include "report/page.hpp"

namespace mottle::report {
namespace {

using Json = nlohmann::ordered_json;

Json read_result(const std::filesystem::path& file) {
  const std::string bytes = read_file(file);
  if (nests_deeper_than(bytes, k_deepest_json)) {
    throw FormatError(file.string(), 0,
                      fmt::format("is nested deeper than {} levels; run the study again", k_deepest_json));
  }
  try {
    return Json::parse(bytes);
  } catch (const nlohmann::json::parse_error& error) {
    const auto line =
        1 + std::count(bytes.begin(), bytes.begin() + static_cast<std::ptrdiff_t>(std::min(error.byte, bytes.size())),
                       '\n');
    throw FormatError(file.string(), static_cast<int>(line), "is not valid JSON; run the study again");
  } catch (const nlohmann::json::exception& error) {  // a number beyond the largest double
    throw FormatError(file.string(), 0, fmt::format("cannot be read: {}; run the study again", error.what()));
  }
}

Json row_json(const std::vector<Eigen::VectorXd>& columns, std::size_t first, std::size_t count, Eigen::Index row) {
  Json cells = Json::array();
  for (std::size_t column = first; column < first + count; ++column) {
    const double value = columns[column](row);
    cells.push_back(std::isnan(value) ? Json(nullptr) : Json(value));
  }
  return cells;
}

std::vector<Eigen::VectorXd> read_columns(const CsvTable& table) {
  std::vector<Eigen::VectorXd> columns;
  for (std::size_t i = 0; i < table.header.size(); ++i)
    columns.push_back(numbers_of_column(table, static_cast<int>(i)));
  return columns;
}

Json tests_json(const std::filesystem::path& file) {
  const CsvTable table = parse_csv(read_text_file(file), file.string());
  const std::vector<Eigen::VectorXd> columns = read_columns(table);
  Json rows = Json::array();
  for (std::size_t row = 0; row < table.rows.size(); ++row) {
    rows.push_back(row_json(columns, 0, columns.size(), static_cast<Eigen::Index>(row)));
  }
  return {{"columns", table.header}, {"rows", rows}};
}

/// Samples by iteration; the first column of the file is the iteration, then `parameters` columns, then outputs.
Json clouds_json(const std::filesystem::path& file, std::size_t parameters) {
  const CsvTable table = parse_csv(read_text_file(file), file.string());
  if (table.header.size() < parameters + 2 || table.header.front() != "iteration") {
    throw FormatError(file.string(), 1, "does not fit result.json; run the study again");
  }
  const std::vector<Eigen::VectorXd> columns = read_columns(table);
  Json clouds = Json::array();
  for (std::size_t row = 0; row < table.rows.size(); ++row) {
    const auto r = static_cast<Eigen::Index>(row);
    const double iteration = columns[0](r);
    if (clouds.empty() || clouds.back()["iteration"] != iteration) {
      clouds.push_back({{"iteration", iteration}, {"parameters", Json::array()}, {"outputs", Json::array()}});
    }
    clouds.back()["parameters"].push_back(row_json(columns, 1, parameters, r));
    clouds.back()["outputs"].push_back(row_json(columns, 1 + parameters, columns.size() - 1 - parameters, r));
  }
  return clouds;
}

std::size_t parameter_count(const Json& result, const std::filesystem::path& file) {
  const Json::json_pointer path("/parameters/names");
  if (!result.contains(path) || !result[path].is_array()) {
    throw FormatError(file.string(), 0, "is not a result of this program: parameters.names is missing");
  }
  return result[path].size();
}

Json read_modes(const std::filesystem::path& file) {
  Json modes = read_result(file);
  if (!modes.is_object() || !modes.contains("modes")) {
    throw FormatError(file.string(), 0, "is not a list of modes of this program; run the study again");
  }
  return std::move(modes["modes"]);
}

}  // namespace

void write_report(const std::filesystem::path& folder) {
  require(std::filesystem::exists(folder / "result.json") || !std::filesystem::exists(folder / k_previous),
          "{}: its last run did not finish, so there is nothing to report; run it again, with --resume to go on from "
          "where it was. Results of the run before are in {}",
          folder.string(), (folder / k_previous).string());
  Json page;
  page["result"] = read_result(folder / "result.json");
  const std::size_t parameters = parameter_count(page["result"], folder / "result.json");
  if (std::filesystem::exists(folder / "tests.csv")) page["tests"] = tests_json(folder / "tests.csv");
  if (std::filesystem::exists(folder / "clouds.csv")) page["clouds"] = clouds_json(folder / "clouds.csv", parameters);
  if (std::filesystem::exists(folder / "modes.json")) page["modes"] = read_modes(folder / "modes.json");
  const std::string data = page.dump(-1, ' ', false, Json::error_handler_t::replace);
  write_file_atomically(folder / "report.html", render_page(data));
}

void write_modes_page(const std::filesystem::path& folder) {
  write_file_atomically(folder / "modes.html", render_page(read_file(folder / "modes.json")));
}

}  // namespace mottle::report
