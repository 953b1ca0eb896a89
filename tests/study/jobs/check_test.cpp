// What a check says of a study, and that it needs no folder.
#include "mottle/study/jobs/check.hpp"

#include <gtest/gtest.h>

#include "support/study_commands.hpp"
#include "support/study_folder.hpp"

namespace mottle::study {
namespace {

using test::StudyFolder;
using testing::HasSubstr;

TEST(Check, SaysWhatWouldRun) {
  const std::string said = StudyFolder().check();
  for (const char* part : {"total mass 3", "k1", "mode 1", "6 specimens", "mares", "200 samples"}) {
    EXPECT_THAT(said, HasSubstr(part));
  }
}

TEST(Check, NeedsNoFolderForAModelByCommand) {
  const StudyFolder folder;
  folder.write("input.txt", "{{k1}} {{k2}}\n");
  folder.write("solver.py", "open('f.txt', 'w').write('0.16\\n0.32\\n0.45\\n')\n");
  folder.write("study.toml", test::command_study({"python3", "-S", "-E", "solver.py"}));
  const std::vector<std::string> files = folder.files();
  EXPECT_THAT(folder.check(), HasSubstr("one model run took"));
  EXPECT_EQ(folder.files(), files);
}

}  // namespace
}  // namespace mottle::study
