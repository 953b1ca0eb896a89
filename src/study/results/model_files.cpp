#include "study/results/model_files.hpp"

#include <filesystem>

#include "mottle/core/checksum.hpp"
#include "mottle/core/files.hpp"
#include "mottle/study/models/model_source.hpp"
#include "study/tests/test_files.hpp"

namespace mottle::study {
namespace {

namespace fs = std::filesystem;

/// Where the names of a model's files begin: it moves with them.
fs::path folder_of_model(const Study& study) {
  const std::vector<NamedFile> named = study.model->files();
  return named.empty() ? fs::path() : fs::absolute(named.front().file).lexically_normal().parent_path();
}

}  // namespace

std::vector<ModelFile> digest_model_files(const Study& study, const std::vector<std::string>& files) {
  const fs::path folder = folder_of_model(study);
  std::vector<ModelFile> result;
  for (const std::string& file : files) {
    const fs::path path = fs::absolute(file).lexically_normal();
    result.push_back({path.lexically_proximate(folder).generic_string(), hexadecimal(digest_of(read_file(file)))});
  }
  return result;
}

std::vector<ModelFile> digest_study_files(const Study& study) {
  std::vector<ModelFile> result;
  if (study.file.empty()) return result;
  const fs::path folder = fs::absolute(study.file).lexically_normal().parent_path();
  const auto add = [&](const fs::path& file) {
    const fs::path path = fs::absolute(file).lexically_normal();
    result.push_back({path.lexically_proximate(folder).generic_string(), hexadecimal(digest_of(read_file(path)))});
  };
  if (fs::is_regular_file(study.file)) add(study.file);
  if (!study.test) return result;
  for (const fs::path& file : list_test_files(study)) add(file);
  return result;
}

Json model_files_json(const std::vector<ModelFile>& files) {
  Json list = Json::array();
  for (const ModelFile& file : files) list.push_back({{"name", file.name}, {"digest", file.digest}});
  return list;
}

std::vector<std::string> changes_of_model_files(const Study& study, const Json& result) {
  std::vector<std::string> changes;
  const auto recorded = result.find("model_files");
  if (recorded == result.end() || !recorded->is_array()) return changes;
  const fs::path folder = folder_of_model(study);
  for (const Json& file : *recorded) {
    const auto name = file.value("name", std::string());
    const fs::path path = folder / name;
    if (!fs::is_regular_file(path)) {
      changes.push_back(name + " is missing");
    } else if (hexadecimal(digest_of(read_file(path))) != file.value("digest", std::string())) {
      changes.push_back(name + " has changed");
    }
  }
  return changes;
}

}  // namespace mottle::study
