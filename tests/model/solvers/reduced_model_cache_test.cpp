#include "model/solvers/reduced_model_cache.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <chrono>
#include <set>
#include <string>
#include <vector>

#include "core/file_size_limit.hpp"
#include "core/temporary_folder.hpp"
#include "linalg/chain.hpp"
#include "model/structures.hpp"
#include "mottle/core/files.hpp"

namespace mottle::model {
namespace {

namespace fs = std::filesystem;
using test::Chain;
using test::have_same_bits;
using test::TemporaryFolder;
using ::testing::AllOf;
using ::testing::ElementsAre;
using ::testing::HasSubstr;
using ::testing::MatchesRegex;

class Notes final : public ProgressObserver {
 public:
  void progress(const std::string&, std::int64_t, std::int64_t) override {}
  void warning(const std::string&) override { FAIL() << "a cache warns of nothing"; }
  void note(const std::string& text) override { texts.push_back(text); }

  std::vector<std::string> texts;
};

struct Answer {
  std::unique_ptr<ReducedModel> model;
  std::vector<std::string> notes;
};

Answer ask(const ReducedModelCache& cache, const Chain& chain = Chain()) {
  Notes notes;
  auto model = find_or_train(cache, chain.inputs(), {.observer = &notes});
  return {std::move(model), notes.texts};
}

void expect_same_answers(const ReducedModel& a, const ReducedModel& b) {
  const TermCoefficients samples = Chain::samples(20, 0.2, 5);
  EXPECT_TRUE(have_same_bits(a.solve(samples, 1).vectors, b.solve(samples, 1).vectors));
}

std::vector<fs::path> files_in(const fs::path& folder) {
  std::vector<fs::path> files;
  for (const auto& entry : fs::directory_iterator(folder)) files.push_back(entry.path());
  return files;
}

/// As if the file had not been touched for that long.
void age(const fs::path& file, std::chrono::hours hours) {
  fs::last_write_time(file, fs::file_time_type::clock::now() - hours);
}

TEST(ReducedModelCache, TrainsOnceAndReadsFromThenOn) {
  const TemporaryFolder folder;
  const Answer first = ask({folder / "cache"});
  const Answer second = ask({folder / "cache"});
  EXPECT_THAT(first.notes, ElementsAre(MatchesRegex("reduced model: basis of .* trained in .* s, kept in .*")));
  EXPECT_THAT(second.notes, ElementsAre(MatchesRegex("reduced model: basis of .* read from .* .trained in .* s.")));
  expect_same_answers(*first.model, *second.model);
  EXPECT_EQ(fs::status(folder / "cache").permissions(), fs::perms::owner_all);
}

TEST(ReducedModelCache, KeepsNothingWithoutAFolder) {
  const Answer answer = ask({});
  EXPECT_THAT(answer.notes, ElementsAre());
  ASSERT_NE(answer.model, nullptr);
}

TEST(ReducedModelCache, AnotherModelIsAnotherFile) {
  const TemporaryFolder folder;
  ask({folder.path()});
  const Answer other = ask({folder.path()}, Chain(1.2));
  EXPECT_THAT(other.notes, ElementsAre(HasSubstr("kept in")));
  EXPECT_EQ(files_in(folder.path()).size(), 2U);
  expect_same_answers(*other.model, *Chain(1.2).trained());
}

TEST(ReducedModelCache, AGarbledFileIsReplaced) {
  const TemporaryFolder folder;
  const Answer first = ask({folder.path()});
  const fs::path file = files_in(folder.path()).front();
  const std::string whole = read_file(file);
  std::string garbled = whole;
  garbled[whole.size() / 2] ^= 1;
  for (const std::string& bytes : {garbled, whole.substr(0, whole.size() / 2), std::string()}) {
    write_file_atomically(file, bytes);
    const Answer answer = ask({folder.path()});
    EXPECT_THAT(answer.notes, ElementsAre(HasSubstr("is not used and the basis trained anew: it"), HasSubstr("kept")));
    expect_same_answers(*answer.model, *first.model);
    EXPECT_THAT(ask({folder.path()}).notes, ElementsAre(HasSubstr("read from")));
  }
}

TEST(ReducedModelCache, APlaceThatCannotBeUsedCostsTheReuseAlone) {
  const TemporaryFolder folder;
  write_file_atomically(folder / "file", "");
  const Answer answer = ask({folder / "file" / "cache"});
  EXPECT_THAT(answer.notes, ElementsAre(AllOf(HasSubstr("not kept in"), HasSubstr("cannot be"))));
  expect_same_answers(*answer.model, *Chain().trained());
}

TEST(ReducedModelCache, AFullDiskCostsTheReuseAlone) {
  const TemporaryFolder folder;
  const Answer answer = [&] {
    const test::FileSizeLimit limit(4000);
    return ask({folder.path()});
  }();
  EXPECT_THAT(answer.notes, ElementsAre(AllOf(HasSubstr("not kept in"), HasSubstr("cannot be written"))));
  EXPECT_TRUE(files_in(folder.path()).empty());
  expect_same_answers(*answer.model, *Chain().trained());
}

TEST(ReducedModelCache, AFolderInTheFilesPlaceCostsTheReuseAlone) {
  const TemporaryFolder folder;
  ask({folder.path()});
  const fs::path file = files_in(folder.path()).front();
  fs::remove(file);
  fs::create_directories(file / "inside");
  const Answer answer = ask({folder.path()});
  EXPECT_THAT(answer.notes, ElementsAre(HasSubstr("trained anew"), HasSubstr("cannot be put in place")));
  expect_same_answers(*answer.model, *Chain().trained());
  EXPECT_EQ(files_in(folder.path()).size(), 1U);
}

TEST(ReducedModelCache, TheLeastRecentlyUsedGoFirst) {
  const TemporaryFolder folder;
  ask({folder.path()}, Chain(1.1));
  const fs::path first = files_in(folder.path()).front();
  ask({folder.path()}, Chain(1.2));
  fs::path second;
  for (const fs::path& file : files_in(folder.path())) {
    if (file != first) second = file;
  }
  age(first, std::chrono::hours(3));
  age(second, std::chrono::hours(2));
  ask({folder.path()}, Chain(1.1));  // used again: the second one is older now
  const std::uintmax_t room = 5 * fs::file_size(first) / 2;
  ask({folder.path(), room}, Chain(1.3));
  EXPECT_TRUE(fs::exists(first));
  EXPECT_FALSE(fs::exists(second));
  EXPECT_EQ(files_in(folder.path()).size(), 2U);
}

TEST(ReducedModelCache, WhatIsTooLargeByItselfStaysUntilTheNext) {
  const TemporaryFolder folder;
  ask({folder.path(), 1});
  EXPECT_THAT(ask({folder.path(), 1}).notes, ElementsAre(HasSubstr("read from")));
}

TEST(ReducedModelCache, ForeignFilesStayAndAbandonedOnesGo) {
  const TemporaryFolder folder;
  const std::string digest(32, 'a');
  const std::set<std::string> stays{"orbitals.basis", "notes.txt", digest + ".basis.7.partial",
                                    "b" + digest + ".basis"};
  for (const std::string& name : stays) write_file_atomically(folder / name, "x");
  const fs::path abandoned = folder / (digest + ".basis.8.partial");
  write_file_atomically(abandoned, "x");
  for (const fs::path& file : files_in(folder.path())) {
    if (file.filename() != digest + ".basis.7.partial") age(file, std::chrono::hours(5));
  }
  ask({folder.path(), 1});
  for (const std::string& name : stays) EXPECT_TRUE(fs::exists(folder / name)) << name;
  EXPECT_FALSE(fs::exists(abandoned));
}

}  // namespace
}  // namespace mottle::model
