#include "study/jobs/study_reach.hpp"

#include <set>

#include "mottle/core/error.hpp"
#include "mottle/core/text.hpp"
#include "mottle/formats/matrices/matrix_file.hpp"
#include "study/tests/test_files.hpp"

namespace mottle {
namespace {

namespace fs = std::filesystem;

class Reach {
 public:
  explicit Reach(const Study& study) : folder_(fs::weakly_canonical(fs::absolute(study.file).parent_path())) {}

  void add(const std::string& key, const fs::path& file) {
    if (file.empty()) return;
    std::error_code error;
    const fs::path path = fs::weakly_canonical(fs::absolute(file), error);
    const fs::path relative = path.lexically_relative(folder_);
    if (!error && !relative.empty() && *relative.begin() != "..") return;
    if (seen_.insert(path).second) found_.push_back(fmt::format("{}: {}", key, path.string()));
  }
  std::vector<std::string> found() && { return std::move(found_); }

 private:
  fs::path folder_;
  std::set<fs::path> seen_;
  std::vector<std::string> found_;
};

std::vector<std::string> programs_of(const StudyModelSource& model) {
  std::vector<std::string> programs;
  if (model.kind == StudyModelSource::Kind::calculix) programs.push_back("model.program: " + model.program);
  if (model.kind != StudyModelSource::Kind::command) return programs;
  const auto add = [&](const char* key, const CommandLine& line) {
    programs.push_back(fmt::format("{}: {}", key, join(line.arguments, " ")));
  };
  add("model.command", model.command.command);
  if (model.command.retry_command) add("model.retry_command", *model.command.retry_command);
  for (const auto& [name, value] : model.command.environment) {
    programs.push_back(fmt::format("model.environment: {}={}", name, value));
  }
  return programs;
}

void add_matrices(Reach& reach, const StudyMatrixPart& part) {
  for (const std::string& place : {part.stiffness, part.mass}) {
    if (place.empty()) continue;
    const fs::path file = file_of_matrix(place);
    reach.add("model", file);
    for (const char* extension : k_names_beside_matrices) {
      std::error_code ignored;
      const fs::path beside = fs::path(file).replace_extension(extension);
      if (fs::exists(beside, ignored)) reach.add("model", beside);
    }
  }
}

/// The files themselves, which may be links within a folder; what is named where they cannot be listed.
void add_tests(Reach& reach, const Study& study) {
  std::vector<fs::path> files = study.test->files;
  try {
    files = list_test_files(study);
  } catch (const InvalidInput&) {  // told where they are read
  }
  for (const fs::path& file : files) reach.add(study.test->key, file);
  if (study.test->repeats_file) reach.add("test.repeatability", *study.test->repeats_file);
}

}  // namespace

StudyReach reach_of(const Study& study, const std::vector<std::string>& read) {
  Reach reach(study);
  const StudyModelSource& model = study.model;
  reach.add("model.file", model.deck);
  reach.add("model.degrees_of_freedom", model.row_names);
  add_matrices(reach, model.constant_part);
  for (const StudyMatrixPart& part : model.parts) add_matrices(reach, part);
  for (const RunFile& file : model.command.templates) reach.add("model.templates", file.source);
  for (const RunFile& file : model.command.files) reach.add("model.files", file.source);
  if (study.test) add_tests(reach, study);
  if (study.predict && study.predict->held_out) reach.add("predict.held_out", *study.predict->held_out);
  for (const std::string& file : read) reach.add("included", file);  // those above are there already
  return {programs_of(model), std::move(reach).found()};
}

std::vector<std::string> reach_lines(const StudyReach& reach) {
  std::vector<std::string> lines;
  for (const std::string& program : reach.programs) lines.push_back("runs by " + program);
  for (const std::string& file : reach.outside) lines.push_back("reads outside of the study's folder by " + file);
  return lines;
}

}  // namespace mottle
