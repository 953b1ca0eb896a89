#include "mottle/core/launcher.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cstdlib>
#include <map>

#include "core/message_of.hpp"
#include "core/temporary_folder.hpp"
#include "mottle/core/error.hpp"
#include "mottle/core/files.hpp"

namespace mottle {
namespace {

/// A launcher's variables, and no others of its kind.
class LauncherTest : public testing::Test {
 protected:
  void TearDown() override {
    for (const auto& [name, value] : set_) ::unsetenv(name.c_str());
  }
  void set(const std::string& name, const std::string& value) {
    ::setenv(name.c_str(), value.c_str(), 1);
    set_[name] = value;
  }

 private:
  std::map<std::string, std::string> set_;
};

TEST_F(LauncherTest, WithoutVariablesTheProcessIsAlone) {
  EXPECT_FALSE(find_launch().is_shared());
}

TEST_F(LauncherTest, MpirunSaysHowManyThereAre) {
  set("OMPI_COMM_WORLD_SIZE", "64");
  set("OMPI_COMM_WORLD_RANK", "17");
  EXPECT_EQ(find_launch().count, 64);
  EXPECT_EQ(find_launch().rank, 17);
}

TEST_F(LauncherTest, ABatchScriptOfSlurmIsNoStep) {
  set("SLURM_NTASKS", "4");
  set("SLURM_PROCID", "0");
  EXPECT_FALSE(find_launch().is_shared());
  set("SLURM_STEP_NUM_TASKS", "4");
  EXPECT_TRUE(find_launch().is_shared());
}

TEST_F(LauncherTest, OneProcessIsAloneWhoeverStartsIt) {
  set("PMI_SIZE", "1");
  set("PMI_RANK", "0");
  EXPECT_FALSE(find_launch().is_shared());
}

TEST_F(LauncherTest, TheInnermostLauncherCounts) {
  set("SLURM_STEP_NUM_TASKS", "4");  // mpirun -n 1 within srun -n 4
  set("SLURM_PROCID", "2");
  set("OMPI_COMM_WORLD_SIZE", "1");
  set("OMPI_COMM_WORLD_RANK", "0");
  EXPECT_FALSE(find_launch().is_shared());
}

TEST_F(LauncherTest, TheUserMayRefuse) {
  set("PMI_SIZE", "2");
  set("PMI_RANK", "1");
  set("MOTTLE_RANKS", "off");
  EXPECT_FALSE(find_launch().is_shared());
}

TEST_F(LauncherTest, WhatIsNoNumberIsNoLaunch) {
  set("PMI_SIZE", "2x");
  set("PMI_RANK", "1");
  EXPECT_FALSE(find_launch().is_shared());
}

TEST(LaunchVariables, AreThoseOfTheLauncherAndNotTheUsersOwn) {
  EXPECT_TRUE(is_launch_variable("OMPI_COMM_WORLD_RANK"));
  EXPECT_TRUE(is_launch_variable("PMIX_NAMESPACE"));
  EXPECT_TRUE(is_launch_variable("SLURM_STEP_NUM_TASKS"));
  EXPECT_FALSE(is_launch_variable("SLURM_JOB_ID"));
  EXPECT_FALSE(is_launch_variable("OMP_NUM_THREADS"));
  EXPECT_FALSE(is_launch_variable("OMPI_ALLOW_RUN_AS_ROOT"));
  EXPECT_FALSE(is_launch_variable("PATH"));
}

TEST(JoinRanks, WithoutModuleSaysWhatToInstall) {
  const Launch launch{.variable = "PMI_SIZE", .count = 4, .rank = 0};
  const std::string message = test::message_of<SystemFailure>([&] { join_ranks(launch, {"/nowhere/module.so"}); });
  EXPECT_THAT(message, testing::HasSubstr("PMI_SIZE=4"));
  EXPECT_THAT(message, testing::HasSubstr("mottle-mpi"));
}

TEST(JoinRanks, AFileThatIsNoModuleIsNamed) {
  const test::TemporaryFolder folder;
  write_file_atomically(folder / "module.so", "no library");
  const Launch launch{.variable = "PMI_SIZE", .count = 4, .rank = 0};
  const std::string message = test::message_of<SystemFailure>([&] { join_ranks(launch, {folder / "module.so"}); });
  EXPECT_THAT(message, testing::HasSubstr("module.so"));
}

}  // namespace
}  // namespace mottle
