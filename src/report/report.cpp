#include "mottle/report/report.hpp"

#include <algorithm>
#include <initializer_list>
#include <string>
#include <vector>

#include "mottle/core/error.hpp"
#include "mottle/core/files.hpp"
#include "mottle/core/text.hpp"
#include "mottle/formats/tables/csv.hpp"
#include "mottle/study/input/text_file.hpp"
#include "mottle/study/results/run_folder.hpp"
#include "report/cloud_data.hpp"
#include "report/page.hpp"

namespace mottle::report {
namespace {

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

Json tests_json(const std::filesystem::path& file) {
  const CsvTable table = parse_csv(read_text_file(file), file.string());
  const std::vector<Eigen::VectorXd> columns = read_columns(table);
  Json rows = Json::array();
  for (std::size_t row = 0; row < table.rows.size(); ++row) {
    rows.push_back(row_json(columns, 0, columns.size(), static_cast<Eigen::Index>(row)));
  }
  return {{"columns", table.header}, {"rows", rows}};
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

/// The page of a diagnosis in the folder, where it was made beside the parameters of this result; null: there is none.
Json link_to_diagnosis(const std::filesystem::path& folder, const Json& result) {
  constexpr const char* k_page = "diagnosis.html";
  if (!std::filesystem::exists(folder / k_page) || !std::filesystem::exists(folder / "diagnosis.json")) return nullptr;
  try {
    const Json diagnosis = read_result(folder / "diagnosis.json");
    const Json::json_pointer names("/parameters/names");
    const bool is_of_these = diagnosis.contains(names) && diagnosis[names] == result[names];
    return is_of_these ? Json(k_page) : Json(nullptr);
  } catch (const InvalidInput&) {  // the report does not depend on it
    return nullptr;
  }
}

/// Those of an object's entries that are there.
Json some_of(const Json& object, std::initializer_list<const char*> keys) {
  Json some = Json::object();
  for (const char* key : keys) {
    if (object.is_object() && object.contains(key)) some[key] = object[key];
  }
  return some;
}

/// What the page of a comparison shows of a result: curves, clouds and histories are in its own report.
Json compared(const Json& result) {
  Json some = some_of(result, {"title", "method", "status", "command", "timings_s", "agreement"});
  const auto part = [&](const char* key) { return result.contains(key) ? result[key] : Json(); };
  some["parameters"] =
      some_of(part("parameters"), {"names", "units", "bounds", "prior_mean", "mean", "std", "mean_ci95", "std_ci95",
                                   "is_population", "at_bound", "findings", "quantiles"});
  some["outputs"] = some_of(part("outputs"), {"names", "units", "test_count"});
  some["verdict"] = some_of(part("verdict"), {"conclusion", "adequate", "headline", "is_reassuring"});
  return some;
}

/// The run's own report, as a link from the page; null where there is none.
Json link_to_report(const std::filesystem::path& folder, const std::filesystem::path& page) {
  const std::filesystem::path report = std::filesystem::absolute(folder).lexically_normal() / "report.html";
  if (!std::filesystem::exists(report)) return nullptr;
  const std::filesystem::path from = std::filesystem::absolute(page).lexically_normal().parent_path();
  return report.lexically_proximate(from).generic_string();
}

}  // namespace

void write_comparison_page(const Comparison& comparison, const RunSummary& summary, const std::filesystem::path& page) {
  require(page.extension() == ".html", "--out {}: the page is one HTML file; give it a name that ends in .html",
          page.string());
  if (page.has_parent_path()) make_writable_folder(page.parent_path());
  Json runs = Json::array();
  for (const ComparedRun& run : comparison.runs) {
    runs.push_back({{"label", run.label},
                    {"report", link_to_report(run.folder, page)},
                    {"result", compared(read_result(run.folder / "result.json"))}});
  }
  require(!std::filesystem::exists(page) || is_page_of(page, "compare"),
          "--out {}: is there and is not a page of a comparison; move it, or give another name", page.string());
  const Json data = {
      {"kind", "compare"}, {"runs", std::move(runs)}, {"evidence", Json::parse(summary.json)["evidence"]}};
  write_file_atomically(page, render_page(data.dump(-1, ' ', false, Json::error_handler_t::replace)));
}

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
  if (const Json link = link_to_diagnosis(folder, page["result"]); !link.is_null()) page["diagnosis"] = link;
  const std::string data = page.dump(-1, ' ', false, Json::error_handler_t::replace);
  RunFolder(folder).write("report.html", render_page(data));
}

void write_diagnosis_page(const std::filesystem::path& folder) {
  Json page = {{"kind", "diagnosis"}, {"result", read_result(folder / "diagnosis.json")}};
  if (std::filesystem::exists(folder / "diagnosis-model.json")) {
    page["model"] = read_result(folder / "diagnosis-model.json");
  }
  RunFolder(folder).write("diagnosis.html", render_page(page.dump(-1, ' ', false, Json::error_handler_t::replace)));
}

void write_modes_page(const std::filesystem::path& folder) {
  RunFolder(folder).write("modes.html", render_page(read_file(folder / "modes.json")));
}

}  // namespace mottle::report
