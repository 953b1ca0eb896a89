#include "study/jobs/study_reach.hpp"

#include <set>

#include "mottle/core/error.hpp"
#include "mottle/core/text.hpp"
#include "mottle/study/models/model_source.hpp"
#include "study/tests/test_files.hpp"

namespace mottle::study {
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

/// The files themselves, which may be links within a folder.
void add_tests(const Study& study, std::vector<StudyFile>& files) {
  std::vector<fs::path> listed = study.test->files;
  try {
    listed = list_test_files(study);
  } catch (const InvalidInput&) {  // reported where they are read
  }
  for (const fs::path& file : listed) files.push_back({study.test->key, file});
  if (study.test->repeats_file) files.push_back({"test.repeatability", *study.test->repeats_file});
}

}  // namespace

std::vector<StudyFile> files_of(const Study& study) {
  std::vector<StudyFile> files;
  for (const NamedFile& named : study.model->files()) files.push_back({named.label, named.file});
  if (study.test) add_tests(study, files);
  if (study.predict && study.predict->held_out) files.push_back({"predict.held_out", *study.predict->held_out});
  return files;
}

std::vector<fs::path> paths_of(const Study& study) {
  std::vector<fs::path> paths{study.file};
  for (StudyFile& named : files_of(study)) paths.push_back(std::move(named.file));
  return paths;
}

StudyReach reach_of(const Study& study, const std::vector<std::string>& read) {
  Reach reach(study);
  for (const StudyFile& named : files_of(study)) reach.add(named.key, named.file);
  for (const std::string& file : read) reach.add("included", file);  // those above are there already
  return {study.model->programs(), std::move(reach).found()};
}

std::vector<std::string> reach_lines(const StudyReach& reach) {
  std::vector<std::string> lines;
  for (const std::string& program : reach.programs) lines.push_back("runs by " + program);
  for (const std::string& file : reach.outside) lines.push_back("reads outside of the study's folder by " + file);
  return lines;
}

}  // namespace mottle::study
