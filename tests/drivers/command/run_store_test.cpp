// The store of runs: what is kept is there again, whatever a kill or a full disk does to its end.
#include "mottle/drivers/command/run_store.hpp"

#include <gmock/gmock.h>
#include <sys/wait.h>
#include <unistd.h>

#include <csignal>

#include "core/file_size_limit.hpp"
#include "core/temporary_folder.hpp"
#include "mottle/core/error.hpp"
#include "mottle/core/files.hpp"
#include "mottle/drivers/command/run_folders.hpp"

namespace {

using mottle::Digest;
using mottle::drivers::RunRecord;
using mottle::drivers::RunStore;

RunRecord record_of(double value) {
  RunRecord record;
  record.modes.eigenvalues = Eigen::Vector2d(value, 2.0 * value);
  record.modes.shapes = Eigen::MatrixXd::Constant(3, 2, value);
  record.modes.degree_of_freedom_names = {"1:+X", "tip", "2"};
  return record;
}

class RunStoreTest : public testing::Test {
 protected:
  void fill(int runs) {
    RunStore store(file_);
    for (std::uint64_t i = 0; i < static_cast<std::uint64_t>(runs); ++i)
      store.keep({i, 7}, record_of(1.0 + static_cast<double>(i)));
  }

  mottle::test::TemporaryFolder folder_;
  std::filesystem::path file_ = folder_ / "runs.store";
};

TEST_F(RunStoreTest, WhatIsKeptIsThereAgain) {
  fill(3);
  {
    RunStore store(file_);
    store.keep({9, 9}, {.failure = "exit status 3", .modes = {}});
  }
  const RunStore store(file_);
  EXPECT_EQ(store.size(), 4U);
  EXPECT_EQ(store.find({9, 9})->failure, "exit status 3");
  EXPECT_FALSE(store.find({9, 8}));
  const RunRecord found = *store.find({2, 7});
  EXPECT_EQ(found.modes.eigenvalues, record_of(3.0).modes.eigenvalues);
  EXPECT_EQ(found.modes.shapes, record_of(3.0).modes.shapes);
  EXPECT_EQ(found.modes.degree_of_freedom_names, record_of(3.0).modes.degree_of_freedom_names);
}

TEST_F(RunStoreTest, WhatIsKeptIsThereAfterAKill) {
  const pid_t mottle = ::fork();
  if (mottle == 0) {
    RunStore store(file_);
    for (std::uint64_t i = 0; i < 5; ++i) store.keep({i, 7}, record_of(1.0));
    ::kill(::getpid(), SIGKILL);
  }
  ::waitpid(mottle, nullptr, 0);
  EXPECT_EQ(RunStore(file_).size(), 5U);
}

TEST_F(RunStoreTest, WhatAnotherRankKeepsIsFoundHere) {
  const std::filesystem::path other = folder_ / "runs-1.store";
  RunStore store(file_, {other});  // which is not there yet
  RunStore of_rank_1(other, {file_});
  EXPECT_FALSE(store.find({1, 7}));
  of_rank_1.keep({1, 7}, record_of(4.0));
  EXPECT_FALSE(store.find({1, 7})) << "nobody looks at other files for each run";
  store.look_at_others();
  ASSERT_TRUE(store.find({1, 7}));
  EXPECT_EQ(store.find({1, 7})->modes.eigenvalues, record_of(4.0).modes.eigenvalues);
  EXPECT_TRUE(store.is_new({1, 7}));
  const RunStore later(folder_ / "runs-2.store", {file_, other});
  EXPECT_TRUE(later.find({1, 7}));
  EXPECT_FALSE(later.is_new({1, 7}));
}

TEST_F(RunStoreTest, ARunThatSucceededOnAnotherRankCountsBeforeOneThatFailedHere) {
  const std::filesystem::path other = folder_ / "runs-1.store";
  RunStore store(file_, {other});
  store.keep({1, 7}, {.failure = "exit status 3", .modes = {}});
  RunStore(other).keep({1, 7}, record_of(4.0));
  RunStore again(folder_ / "runs-2.store", {file_, other});
  EXPECT_TRUE(again.find({1, 7})->failure.empty());
}

TEST_F(RunStoreTest, ReadsTheWholeRecordsOfAnotherRanksStore) {
  fill(3);
  const std::string three = mottle::read_file(file_);
  mottle::write_file_atomically(file_, three.substr(0, three.size() - 1));
  const RunStore store(folder_ / "runs-1.store", {file_});
  EXPECT_TRUE(store.find({1, 7}));
  EXPECT_FALSE(store.find({2, 7}));
  EXPECT_EQ(mottle::read_file(file_).size(), three.size() - 1);  // which is its owner's to cut
}

TEST_F(RunStoreTest, StoresOfEarlierRanksAreAmongTheOthers) {
  fill(1);
  RunStore(folder_ / "runs-5.store").keep({1, 1}, record_of(1.0));
  const auto files = mottle::drivers::run_store_files(folder_ / "", 1, 3);
  EXPECT_EQ(files.own.filename(), "runs-1.store");
  std::vector<std::string> names;
  for (const auto& file : files.others) names.push_back(file.filename().string());
  EXPECT_THAT(names, testing::UnorderedElementsAre("runs.store", "runs-2.store", "runs-5.store"));
}

TEST_F(RunStoreTest, ALastRecordTornAtAnyByteIsDroppedAndTheStoreGoesOn) {
  fill(2);
  const std::string two = mottle::read_file(file_);
  fill(3);
  const std::string three = mottle::read_file(file_);
  for (std::size_t size = two.size(); size < three.size(); ++size) {
    mottle::write_file_atomically(file_, three.substr(0, size));
    RunStore store(file_);
    ASSERT_EQ(store.size(), 2U) << size;
    store.keep({5, 7}, record_of(5.0));
    ASSERT_EQ(store.find({5, 7})->modes.eigenvalues(0), 5.0);
    ASSERT_TRUE(store.find({1, 7}));
  }
}

TEST_F(RunStoreTest, ADamagedRecordIsNotBelieved) {
  fill(3);
  std::string bytes = mottle::read_file(file_);
  bytes[bytes.size() - 5] ^= 1;
  mottle::write_file_atomically(file_, bytes);
  EXPECT_EQ(RunStore(file_).size(), 2U);
}

TEST_F(RunStoreTest, AnotherFileIsNotOverwritten) {
  mottle::write_file_atomically(file_, "my own notes");
  EXPECT_THROW(RunStore{file_}, mottle::InvalidInput);
  EXPECT_EQ(mottle::read_file(file_), "my own notes");
}

TEST_F(RunStoreTest, ASecondMottleIsKeptOut) {
  const RunStore store(file_);
  const pid_t other = ::fork();
  if (other == 0) {
    try {
      const RunStore second(file_);
      ::_exit(1);
    } catch (const mottle::InvalidInput&) {
      ::_exit(0);
    }
  }
  int status = -1;
  ::waitpid(other, &status, 0);
  EXPECT_EQ(status, 0);
}

TEST_F(RunStoreTest, AFullDiskLeavesTheFinishedRuns) {
  fill(2);
  const std::string before = mottle::read_file(file_);
  {
    RunStore store(file_);
    const mottle::test::FileSizeLimit limit(before.size() + 50);
    EXPECT_THROW(store.keep({8, 7}, record_of(8.0)), mottle::SystemFailure);
  }
  EXPECT_EQ(mottle::read_file(file_), before);
}

}  // namespace
