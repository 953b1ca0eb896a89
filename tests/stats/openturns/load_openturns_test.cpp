#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cstdio>
#include <cstdlib>
#include <filesystem>
#include <fstream>

#include "mottle/core/error.hpp"
#include "mottle/stats/surrogates/surrogate.hpp"
#include "stats/openturns/openturns.hpp"

namespace mottle::stats {
namespace {

namespace fs = std::filesystem;

class OpenTurnsModule : public ::testing::Test {
 protected:
  void SetUp() override {
    // A module is loaded once in a process: what fails is tried in one of its own, which starts anew.
    GTEST_FLAG_SET(death_test_style, "threadsafe");
    fs::create_directories(folder_);
  }
  void TearDown() override { fs::remove_all(folder_); }

  /// Loads the module with the folder named in the environment, and ends by the code that the command would end with.
  [[noreturn]] void load_and_exit() const {
    setenv("MOTTLE_MODULES", folder_.c_str(), 1);
    try {
      static_cast<void>(openturns());
    } catch (const SystemFailure& error) {
      std::fputs(error.what(), stderr);
      std::exit(3);
    }
    std::exit(0);
  }

  fs::path folder_ = fs::path(::testing::TempDir()) /
                     ("mottle-modules-" + std::string(::testing::UnitTest::GetInstance()->current_test_info()->name()));
};

TEST_F(OpenTurnsModule, IsTheFirstOfTheFolders) {
  std::ofstream(folder_ / "mottle_openturns.so") << "not a library";
  EXPECT_EQ(find_openturns_module({"/nonexistent", folder_}), folder_ / "mottle_openturns.so");
}

TEST_F(OpenTurnsModule, MissingIsSaidWithThePackageThatHasIt) {
  try {
    static_cast<void>(find_openturns_module({folder_, "/nonexistent"}));
    FAIL();
  } catch (const SystemFailure& error) {
    EXPECT_THAT(error.what(), ::testing::StartsWith("Sobol designs and the surrogates kriging and chaos need"));
    EXPECT_THAT(error.what(), ::testing::HasSubstr("install the package mottle,"));
  }
}

TEST_F(OpenTurnsModule, ThatIsNoLibraryFails) {
  std::ofstream(folder_ / "mottle_openturns.so") << "not a library";
  EXPECT_EXIT(load_and_exit(), ::testing::ExitedWithCode(3), "the module for OpenTURNS cannot be loaded: .*modules-");
}

TEST_F(OpenTurnsModule, IsFoundAlongTheRunPathWhereTheNamedFolderHasNone) {
  EXPECT_EXIT(load_and_exit(), ::testing::ExitedWithCode(0), "");
}

// OpenTURNS refuses a number of columns that is not the fit's by an exception of its own.
TEST_F(OpenTurnsModule, ErrorsOfOpenTurnsArriveAsSystemFailures) {
  const Eigen::MatrixXd x = Eigen::MatrixXd::Random(20, 2);
  const auto fit = openturns().chaos(x, x.col(0));
  EXPECT_THROW(static_cast<void>(fit->at(Eigen::MatrixXd::Random(5, 3))), SystemFailure);
}

}  // namespace
}  // namespace mottle::stats
