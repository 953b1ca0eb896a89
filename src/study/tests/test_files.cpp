#include "study/tests/test_files.hpp"

#include <algorithm>
#include <cctype>

#include "mottle/core/error.hpp"
#include "mottle/core/files.hpp"
#include "mottle/core/text.hpp"
#include "mottle/study/input/text_file.hpp"

namespace mottle::study {
namespace {

std::string extension_of(const std::filesystem::path& file) {
  std::string extension = file.extension().string();
  for (char& letter : extension) letter = static_cast<char>(std::tolower(static_cast<unsigned char>(letter)));
  return extension;
}

bool is_universal(const std::filesystem::path& file) {
  return extension_of(file) == ".uff" || extension_of(file) == ".unv";
}

/// Files of a folder that fit, by name.
template <typename Fits>
std::vector<std::filesystem::path> files_in(const std::filesystem::path& folder, const Fits& fits) {
  std::vector<std::filesystem::path> files;
  std::error_code error;
  for (const auto& entry : std::filesystem::directory_iterator(folder.empty() ? "." : folder, error)) {
    if (!entry.is_directory() && fits(entry.path().filename())) files.push_back(folder / entry.path().filename());
  }
  std::sort(files.begin(), files.end());
  return files;
}

/// Runs what reads a file; where the file is not there, the message names the study's key.
template <typename Read>
auto with_key(const Study& study, const std::string& key, const Read& read) {
  try {
    return read();
  } catch (const FormatError&) {
    throw;
  } catch (const InvalidInput& error) {
    throw InvalidInput(located(study, key, error.what()));
  }
}

/// Columns of a table without header are the tests' modes by number, where the study says how those are paired.
CsvTable named_modes(const Study& study, const std::string& key, CsvTable table) {
  if (table.has_header) return table;
  const bool is_stated =
      study.test && (study.test->pairing == TestPairing::frequency || study.test->pairing == TestPairing::order);
  const std::string first = table.lines.empty() ? "" : table.rows.front().front();
  if (!study.outputs.shape_modes.empty() || !study.outputs.static_loads.empty()) {
    throw FormatError(
        table.file, table.lines.front(),
        fmt::format(
            "has no line with the names of the columns, the first cell is '{}'; give it one that "
            "names its {} columns: f1, f2, phi1:{}, ...",
            first, table.header.size(),
            study.outputs.shape_degrees_of_freedom.empty() ? "m1" : study.outputs.shape_degrees_of_freedom.front()));
  }
  if (!is_stated) {
    throw FormatError(
        table.file, table.lines.front(),
        fmt::format("has no line with the names of the columns: give it one (f1,f2,...), or say under [test] (for {}) "
                    "that its {} columns are the tests' modes in ascending frequency, pairing = \"frequency\", or the "
                    "model's own modes 1, 2, ..., pairing = \"order\"",
                    key, table.header.size()));
  }
  for (std::string& name : table.header) name.insert(0, 1, 'f');
  return table;
}

void read_one(const Study& study, const std::filesystem::path& file, TestContents& contents) {
  if (is_universal(file)) {
    contents.specimens.push_back(with_key(study, study.test->key, [&] {
      return modes_from_uff(read_file(file), file.string(), study.units, contents.notes);
    }));
    return;
  }
  if (extension_of(file) == ".mat") {
    const auto variables = with_key(study, study.test->key, [&] { return read_mat(file.string()); });
    if (variables.contains("shapes")) {
      for (MeasuredModes& specimen : modes_from_mat(variables, file.string(), study.units)) {
        contents.specimens.push_back(std::move(specimen));
      }
      return;
    }
  }
  CsvTable table = read_named_table(study, study.test->key, file);
  if (table.find("dof") >= 0) {
    contents.specimens.push_back(modes_from_table(table, study.units));
  } else {
    contents.table = std::move(table);
  }
}

}  // namespace

CsvTable read_named_table(const Study& study, const std::string& key, const std::filesystem::path& file) {
  return with_key(study, key, [&] {
    return extension_of(file) == ".mat"
               ? table_from_mat(read_mat(file.string()), file.string())
               : named_modes(study, key, parse_csv(read_text_file(file), file.string(), HeaderRule::may_be_missing));
  });
}

std::vector<std::filesystem::path> list_test_files(const Study& study) {
  std::vector<std::filesystem::path> files;
  for (const std::filesystem::path& named : study.test->files) {
    std::error_code ignored;
    const bool is_folder = std::filesystem::is_directory(named, ignored);
    const std::string pattern = named.filename().string();
    if (!is_folder && pattern.find_first_of("*?") == std::string::npos) {
      files.push_back(named);
      continue;
    }
    const std::vector<std::filesystem::path> found =
        is_folder
            ? files_in(named, is_universal)
            : files_in(named.parent_path(), [&](const auto& name) { return matches_pattern(name.string(), pattern); });
    if (found.empty()) {
      throw InvalidInput(
          located(study, study.test->key,
                  fmt::format("{}: {}", named.string(),
                              is_folder ? "this folder holds no .uff or .unv file" : "no file fits this pattern")));
    }
    files.insert(files.end(), found.begin(), found.end());
  }
  return files;
}

TestContents read_test_files(const Study& study) {
  const std::vector<std::filesystem::path> files = list_test_files(study);
  TestContents contents;
  for (const std::filesystem::path& file : files) {
    read_one(study, file, contents);
    if (contents.table && files.size() > 1) {
      throw InvalidInput(
          located(study, study.test->key,
                  fmt::format("{} is a table with one row for each specimen, which must be the only file; {} files "
                              "are named",
                              file.string(), files.size())));
    }
  }
  return contents;
}

}  // namespace mottle::study
