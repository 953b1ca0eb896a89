// Pages that only the start of a process needed.
#include "mottle/core/idle_memory.hpp"

#include <gtest/gtest.h>

#include <fstream>
#include <string>

namespace {

/// kB of resident pages of files.
long resident_kb() {
  std::ifstream status("/proc/self/status");
  for (std::string line; std::getline(status, line);) {
    if (line.starts_with("RssFile:")) return std::stol(line.substr(8));
  }
  return 0;
}

TEST(IdleMemory, PagesOfProgramsAndLibrariesGoAndComeBack) {
  const long before = resident_kb();
  ASSERT_GT(before, 1000);
  mottle::release_idle_memory();
  EXPECT_LT(resident_kb(), before);
  EXPECT_THROW(static_cast<void>(std::stol("no number")), std::invalid_argument);  // of code that was given back
}

}  // namespace
