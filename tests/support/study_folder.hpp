// A folder with a study and its tests, and the jobs run on them as functions, without the command.
#pragma once

#include <fmt/format.h>
#include <gmock/gmock.h>

#include <algorithm>
#include <cstdint>
#include <cstdlib>
#include <fstream>
#include <nlohmann/json.hpp>
#include <optional>
#include <string>
#include <vector>

#include "core/message_of.hpp"
#include "core/temporary_folder.hpp"
#include "mottle/core/files.hpp"
#include "mottle/study/jobs/check.hpp"
#include "mottle/study/jobs/forward.hpp"
#include "mottle/study/jobs/update.hpp"
#include "mottle/study/results/run_folder.hpp"
#include "support/study_texts.hpp"

namespace mottle::test {

/// A table as a job wrote it.
struct WrittenTable {
  std::vector<std::string> header;
  std::vector<std::vector<std::string>> rows;

  std::size_t index(const std::string& name) const {
    const auto found = std::find(header.begin(), header.end(), name);
    if (found == header.end()) throw std::logic_error("no column is called '" + name + "'");
    return static_cast<std::size_t>(found - header.begin());
  }
  std::vector<std::string> texts(const std::string& name) const {
    std::vector<std::string> cells;
    for (const auto& row : rows) cells.push_back(row.at(index(name)));
    return cells;
  }
  std::vector<double> numbers(const std::string& name) const {
    std::vector<double> values;
    for (const std::string& cell : texts(name)) values.push_back(std::strtod(cell.c_str(), nullptr));
    return values;
  }
};

inline WrittenTable table_of(const std::string& text) {
  WrittenTable table;
  const std::vector<std::string> lines = lines_of(text);
  for (std::size_t i = 0; i < lines.size(); ++i) {
    (i == 0 ? table.header : table.rows.emplace_back()) = split(lines[i], ',');
  }
  return table;
}

/// Text of a table of numbers, in as many digits as tell them apart.
inline std::string csv_text(const std::string& header, const std::vector<std::vector<double>>& rows) {
  std::string text = header + "\n";
  for (const auto& row : rows) text += fmt::format("{}\n", fmt::join(row, ","));
  return text;
}

/// Rows of numbers of a table without gaps.
inline std::vector<std::vector<double>> numbers_of(const std::string& csv) {
  std::vector<std::vector<double>> rows;
  for (const auto& cells : table_of(csv).rows) {
    rows.emplace_back();
    for (const std::string& cell : cells) rows.back().push_back(std::strtod(cell.c_str(), nullptr));
  }
  return rows;
}

/// Where and how a job of a study runs.
struct StudyCall {
  std::string study = "study.toml";
  std::string out = "out";
  std::vector<std::string> set = {};
  std::optional<std::uint64_t> seed = std::nullopt;
  int threads = 1;
  bool resume = false;
};

/// Keeps what a job tells while it runs: "warning: ..." and notes, a line each.
class ToldText final : public ProgressObserver {
 public:
  void progress(const std::string&, std::int64_t, std::int64_t) override {}
  void warning(const std::string& words) override { text += "warning: " + words + "\n"; }
  void note(const std::string& words) override { text += words + "\n"; }
  std::string text;
};

/// A folder of its own with study.toml and tests.csv of three masses.
class StudyFolder {
 public:
  StudyFolder() {
    write("study.toml", k_three_masses_study);
    write("tests.csv", k_three_masses_tests);
  }

  std::filesystem::path operator/(const std::string& name) const { return folder_ / name; }
  void write(const std::string& name, const std::string& content) const {
    std::filesystem::create_directories((folder_ / name).parent_path());
    std::ofstream(folder_ / name, std::ios::binary) << content;  // quicker than what is kept through a power cut
  }
  std::string text(const std::string& name) const { return read_file(folder_ / name); }
  bool has(const std::string& name) const { return std::filesystem::exists(folder_ / name); }
  /// Makes study.toml the good study with changes.
  void change(const std::vector<TextChange>& changes) const { write("study.toml", three_masses(changes)); }

  study::Study study(const StudyCall& call = {}) const {
    return study::read_study(folder_ / call.study, {.assignments = call.set, .seed = call.seed});
  }

  /// Updates and writes the results; hands back result.json.
  nlohmann::json update(const StudyCall& call = {}) {
    const study::UpdateOutcome outcome = study::update(study(call), settings(call));
    study::write_results(outcome, folder_ / call.out);
    study::RunFolder(folder_ / call.out).finish();
    return result(call.out);
  }
  /// The same of the good study with changes.
  nlohmann::json update_changed(const std::vector<TextChange>& changes, const StudyCall& call = {}) {
    change(changes);
    return update(call);
  }
  /// Runs the cloud, or given points, and writes it; hands back cloud.csv.
  WrittenTable propagate(const std::optional<std::string>& points = std::nullopt, const StudyCall& call = {}) {
    std::optional<std::filesystem::path> file;
    if (points) {
      file = folder_ / "points.csv";
      write("points.csv", *points);
    }
    study::write_results(study::propagate(study(call), file, settings(call)), folder_ / call.out);
    study::RunFolder(folder_ / call.out).finish();
    return table(call.out + "/cloud.csv");
  }
  /// Draws and writes the specimens of the truth; hands back specimens.csv.
  WrittenTable simulate(const StudyCall& call = {.out = "drawn"}) {
    study::write_results(study::simulate(study(call), settings(call)), folder_ / call.out);
    return table(call.out + "/specimens.csv");
  }
  /// What is said of the study, a line each.
  std::string check_lines(const StudyCall& call = {}) const {
    return fmt::format("{}\n", fmt::join(summarise(study::check(study(call), {})).lines, "\n"));
  }
  /// The same with its sentences on one line.
  std::string check(const StudyCall& call = {}) const { return on_one_line(check_lines(call)); }

  nlohmann::json result(const std::string& out = "out") const {
    return nlohmann::json::parse(text(out + "/result.json"));
  }
  WrittenTable table(const std::string& name) const { return table_of(text(name)); }
  /// What the jobs have told so far.
  const std::string& told() const { return told_.text; }

  /// Why `check` refuses the study, which `update` does in the same words; without the folder's path.
  std::string refusal(const StudyCall& call = {}) const {
    const std::string of_check = message_of<InvalidInput>([&] { (void)study::check(study(call), {}); });
    EXPECT_EQ(message_of<InvalidInput>([&] { (void)study::update(study(call), {.folder = folder_ / call.out}); }),
              of_check);
    return without_path(of_check);
  }
  std::string without_path(std::string message) const {
    const std::string path = folder_.path().string() + "/";
    for (std::size_t at = message.find(path); at != std::string::npos; at = message.find(path, at))
      message.erase(at, path.size());
    return message;
  }
  /// Names of all files within, sorted.
  std::vector<std::string> files() const {
    std::vector<std::string> names;
    for (const auto& entry : std::filesystem::recursive_directory_iterator(folder_.path())) {
      if (entry.is_regular_file()) names.push_back(entry.path().lexically_relative(folder_.path()).string());
    }
    std::sort(names.begin(), names.end());
    return names;
  }

 private:
  study::RunSettings settings(const StudyCall& call) {
    return {.folder = folder_ / call.out, .threads = call.threads, .resume = call.resume, .observer = &told_};
  }

  TemporaryFolder folder_;
  ToldText told_;
};

/// result.json without its timings, to be compared.
inline nlohmann::json untimed(nlohmann::json result) {
  result.erase("timings_s");
  result.erase("study_files");
  return result;
}

inline std::vector<double> doubles(const nlohmann::json& list) {
  return list.get<std::vector<double>>();
}

/// All sentences of a list in one text.
inline std::string sentences(const nlohmann::json& list) {
  return fmt::format("{}", fmt::join(list.get<std::vector<std::string>>(), " "));
}

}  // namespace mottle::test
