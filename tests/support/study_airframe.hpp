// The airframe of the examples with the ten aeroplanes that were tested, a universal file each.
#pragma once

#include <string>
#include <vector>

#include "mottle/study/jobs/study_objects.hpp"
#include "support/study_folder.hpp"

namespace mottle::test {

inline std::filesystem::path examples() {
  return std::filesystem::path(MOTTLE_SOURCE_DIR) / "examples";
}

/// Tests of a study as its model's outputs.
struct TestsOfModel {
  std::vector<std::string> names;  ///< of the outputs
  study::StudyTests tests;

  double value(std::size_t specimen, const std::string& name) const {
    return tests.data.values(static_cast<Eigen::Index>(specimen), column(name));
  }
  Eigen::Index column(const std::string& name) const {
    const auto found = std::find(names.begin(), names.end(), name);
    if (found == names.end()) throw std::logic_error("no output is called '" + name + "'");
    return found - names.begin();
  }
  WrittenTable pairing() const { return table_of(tests.pairing); }
};

/// examples/02-airframe/airframe.bdf, and study.toml, truth.toml and specimens/ of examples/05-uff-population beside
/// it.
class AirframeFolder {
 public:
  AirframeFolder() {
    folder.write("02-airframe/airframe.bdf", read_file(examples() / "02-airframe/airframe.bdf"));
    for (const char* name : {"study.toml", "truth.toml"}) {
      folder.write(std::string("05/") + name, read_file(examples() / "05-uff-population" / name));
    }
    std::filesystem::copy(examples() / "05-uff-population/specimens", folder / "05/specimens");
  }

  /// The study with changes.
  void change(const std::vector<TextChange>& changes) const {
    folder.write("05/study.toml", edited(read_file(examples() / "05-uff-population/study.toml"), changes));
  }
  TestsOfModel tests() const {
    const study::Study study = folder.study({.study = "05/study.toml"});
    const study::StudyModel made = study::make_model(study, study.parameters);
    TestsOfModel result{.names = {}, .tests = study::read_tests(study, *made.model)};
    for (const auto& output : made.model->outputs()) result.names.push_back(output.name());
    return result;
  }
  std::string check() const { return folder.check({.study = "05/study.toml"}); }
  std::string refusal() const { return folder.refusal({.study = "05/study.toml"}); }

  StudyFolder folder;
};

}  // namespace mottle::test
