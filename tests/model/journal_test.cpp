#include "mottle/model/journal.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <atomic>
#include <cmath>
#include <fstream>
#include <limits>

#include "core/message_of.hpp"
#include "core/temporary_folder.hpp"
#include "model/structures.hpp"
#include "mottle/core/files.hpp"
#include "mottle/model/region_model.hpp"

namespace mottle::model {
namespace {

using test::TemporaryFolder;

constexpr Digest k_study = {0x0123456789abcdefULL, 0xfedcba9876543210ULL};
constexpr Digest k_other = {k_study[0], k_study[1] + 1};

/// y = (x1 + x2, x1 x2), fails where x1 < 0; counts the samples it is asked for; three samples a batch.
class CountingModel final : public Model {
 public:
  Eigen::Index parameter_count() const override { return 2; }
  const std::vector<Quantity>& outputs() const override { return outputs_; }
  Eigen::Index batch_size() const override { return 3; }
  Evaluation evaluate(const Eigen::Ref<const Eigen::MatrixXd>& samples, const RunContext&) const override {
    evaluated += static_cast<int>(samples.rows());
    Evaluation result;
    result.outputs.resize(samples.rows(), 2);
    for (Eigen::Index s = 0; s < samples.rows(); ++s) {
      result.outputs.row(s) << samples.row(s).sum(), samples.row(s).prod();
      if (samples(s, 0) >= 0.0) continue;
      result.outputs.row(s).setConstant(std::numeric_limits<double>::quiet_NaN());
      result.failures.push_back({s, fmt::format("x1 = {} is negative", samples(s, 0))});
    }
    return result;
  }
  mutable int evaluated = 0;

 private:
  std::vector<Quantity> outputs_{named_quantity("sum", "-"), named_quantity("product", "-")};
};

/// Eight samples, those of index 4 and 7 fail: batches of 3, 3 and 2.
Eigen::MatrixXd samples() {
  Eigen::MatrixXd x(8, 2);
  for (Eigen::Index s = 0; s < 8; ++s) x.row(s) << 0.1 + static_cast<double>(s), 1.0 / (1.0 + static_cast<double>(s));
  x(4, 0) = -4.5;
  x(7, 0) = -7.5;
  return x;
}

bool are_same(const Evaluation& a, const Evaluation& b) {
  if (!test::have_same_bits(a.outputs, b.outputs) || a.failures.size() != b.failures.size()) return false;
  for (std::size_t i = 0; i < a.failures.size(); ++i) {
    if (a.failures[i].sample != b.failures[i].sample || a.failures[i].reason != b.failures[i].reason) return false;
  }
  return true;
}

/// What a kill left in the file: plainly written, as thousands of flushes to the disk would take their time.
void leave(const std::filesystem::path& path, std::string_view bytes) {
  std::ofstream(path, std::ios::binary) << bytes;
}

class Journal : public ::testing::Test {
 protected:
  struct Run {
    Evaluation evaluation;
    int evaluated = 0;        ///< samples that the model itself computed
    std::int64_t reused = 0;  ///< samples from the journal
  };

  Run run(const Eigen::MatrixXd& x, bool resume, const Digest& study = k_study) const {
    const CountingModel model;
    const JournalledModel journalled(model, path, study, resume);
    Run result;
    result.evaluation = journalled.evaluate(x, {});
    result.evaluated = model.evaluated;
    result.reused = journalled.reused();
    return result;
  }

  const TemporaryFolder folder;
  const std::filesystem::path path = folder / "journal";
  const Evaluation truth = CountingModel().evaluate(samples(), {});
};

TEST_F(Journal, AnswersLikeTheModelItKeeps) {
  EXPECT_TRUE(are_same(run(samples(), false).evaluation, truth));
}

TEST_F(Journal, PassesOnTheModelsShape) {
  const CountingModel model;
  const JournalledModel journalled(model, path, k_study, false);
  EXPECT_EQ(journalled.parameter_count(), 2);
  EXPECT_EQ(journalled.outputs()[1].name(), "product");
}

TEST_F(Journal, ResumesWithoutCallingTheModel) {
  run(samples(), false);
  const Run resumed = run(samples(), true);
  EXPECT_EQ(resumed.evaluated, 0);
  EXPECT_EQ(resumed.reused, 8);
}

// Failed samples have nan outputs, so this covers both.
TEST_F(Journal, KeepsFailuresAndOutputsThatAreNoNumbers) {
  run(samples(), false);
  const Evaluation resumed = run(samples(), true).evaluation;
  EXPECT_TRUE(are_same(resumed, truth));
  ASSERT_EQ(resumed.failures.size(), 2U);
  EXPECT_EQ(resumed.failures[1].sample, 7);
  EXPECT_EQ(resumed.failures[1].reason, "x1 = -7.5 is negative");
}

TEST_F(Journal, GoesOnBehindWhatAnEarlierRunLeft) {
  run(samples().topRows(6), false);
  const Run resumed = run(samples(), true);
  EXPECT_EQ(resumed.reused, 6);
  EXPECT_EQ(resumed.evaluated, 2);
  EXPECT_TRUE(are_same(resumed.evaluation, truth));
}

TEST_F(Journal, ComputesAgainFromTheFirstBatchThatDiffers) {
  run(samples(), false);
  Eigen::MatrixXd changed = samples();
  changed(3, 1) = 0.7;  // in the second batch of three
  const Run resumed = run(changed, true);
  EXPECT_EQ(resumed.reused, 3);
  EXPECT_EQ(resumed.evaluated, 5);
  EXPECT_TRUE(are_same(resumed.evaluation, CountingModel().evaluate(changed, {})));
}

TEST_F(Journal, StartsEmptyWithoutResume) {
  run(samples(), false);
  EXPECT_EQ(run(samples(), false).evaluated, 8);
}

TEST_F(Journal, ResumesFromNothingWhereNoFileIs) {
  EXPECT_EQ(run(samples(), true).evaluated, 8);
}

TEST_F(Journal, ResumesAtEveryByteThatAKillMayHaveLeft) {
  run(samples(), false);
  const std::string whole = read_file(path);
  for (std::size_t size = 0; size <= whole.size(); ++size) {
    leave(path, std::string_view(whole).substr(0, size));
    const Run resumed = run(samples(), true);
    ASSERT_TRUE(are_same(resumed.evaluation, truth)) << size << " bytes";
    ASSERT_EQ(resumed.evaluated + resumed.reused, 8) << size << " bytes";
    ASSERT_EQ(read_file(path), whole) << size << " bytes";
  }
}

TEST_F(Journal, TornWithinTheLastRecordLosesThatRecordAlone) {
  run(samples().topRows(6), false);
  const auto second_end = std::filesystem::file_size(path);
  run(samples(), false);
  for (auto size = second_end; size < std::filesystem::file_size(path); ++size) {
    const std::string whole = read_file(path);
    leave(path, std::string_view(whole).substr(0, size));
    ASSERT_EQ(run(samples(), true).reused, 6) << size << " bytes";
  }
}

TEST_F(Journal, DamagedInAnyByteOfItsRecordsNeverGivesAWrongAnswer) {
  run(samples(), false);
  const std::string whole = read_file(path);
  constexpr std::size_t k_head = 17 + 16;  // "mottle journal 6\n" and the fingerprint
  for (std::size_t byte = k_head; byte < whole.size(); ++byte) {
    std::string damaged = whole;
    damaged[byte] = static_cast<char>(damaged[byte] ^ 0x40);
    leave(path, damaged);
    ASSERT_TRUE(are_same(run(samples(), true).evaluation, truth)) << "byte " << byte;
  }
}

TEST_F(Journal, RefusesAnotherStudy) {
  run(samples(), false);
  EXPECT_THAT(test::message_of<InvalidInput>([&] { run(samples(), true, k_other); }),
              ::testing::AllOf(::testing::StartsWith(path.string()), ::testing::HasSubstr("have changed since")));
}

TEST_F(Journal, RefusesAnOlderFormAsAChangedStudy) {
  run(samples(), false);
  std::string older = read_file(path);
  older[std::string("mottle journal ").size()] = '5';
  leave(path, older);
  EXPECT_THAT(test::message_of<InvalidInput>([&] { run(samples(), true); }),
              ::testing::HasSubstr("have changed since"));
}

TEST_F(Journal, KeepsItsFileWhenAnotherStudyIsRefused) {
  run(samples(), false);
  EXPECT_THROW(run(samples(), true, k_other), InvalidInput);
  EXPECT_EQ(run(samples(), true).reused, 8);
}

TEST_F(Journal, RefusesAnotherVersion) {
  const std::string other = "mottle journal 3\n" + std::string(100, 'x');
  leave(path, other);
  EXPECT_THROW(run(samples(), true), InvalidInput);
  EXPECT_EQ(read_file(path), other);
}

TEST_F(Journal, WhereNothingCanBeWrittenAsksForAnotherFolder) {
  const CountingModel model;
  EXPECT_THROW(JournalledModel(model, folder / "none" / "journal", k_study, false), InvalidInput);
}

TEST_F(Journal, EvaluatesNoSampleToNothing) {
  EXPECT_EQ(run(Eigen::MatrixXd(0, 2), false).evaluation.outputs.rows(), 0);
}

TEST_F(Journal, StopsBetweenBatchesOnRequest) {
  const std::atomic<bool> stop{true};
  const CountingModel model;
  const JournalledModel journalled(model, path, k_study, false);
  EXPECT_THROW(journalled.evaluate(samples(), {.stop = &stop}), Stopped);
  EXPECT_EQ(model.evaluated, 0);
}

/// Adds the first coordinate of the region's centre to the outputs.
class RegionalModel final : public Model {
 public:
  Eigen::Index parameter_count() const override { return 2; }
  const std::vector<Quantity>& outputs() const override { return model_.outputs(); }
  bool adapts_to_regions() const override { return true; }
  Evaluation evaluate(const Eigen::Ref<const Eigen::MatrixXd>& samples, const RunContext& context) const override {
    return model_.evaluate(samples, context);
  }
  Evaluation evaluate_in(const SampleRegion& region, const Eigen::Ref<const Eigen::MatrixXd>& samples,
                         const RunContext& context) const override {
    Evaluation result = model_.evaluate(samples, context);
    result.outputs.array() += region.centre()(0);
    return result;
  }
  int evaluated() const { return model_.evaluated; }

 private:
  CountingModel model_;
};

TEST_F(Journal, AnAnswerBelongsToItsRegion) {
  const auto region = [](double centre) {
    return std::make_shared<const SampleRegion>(Eigen::Vector2d(centre, 0.0), Eigen::MatrixXd::Zero(1, 2));
  };
  const Eigen::MatrixXd x = samples().topRows(3);
  const auto ask = [&](const JournalledModel& journalled, double centre) {
    return RegionModel(journalled, region(centre)).evaluate(x, {}).outputs;
  };
  const RegionalModel first;
  Eigen::MatrixXd anywhere, near, far;
  {
    const JournalledModel journalled(first, path, k_study, false);
    anywhere = journalled.evaluate(x, {}).outputs;
    near = ask(journalled, 1.0);
    far = ask(journalled, 100.0);
  }
  EXPECT_TRUE(near.isApprox((anywhere.array() + 1.0).matrix()));
  const RegionalModel second;
  const JournalledModel resumed(second, path, k_study, true);
  EXPECT_EQ(resumed.evaluate(x, {}).outputs, anywhere);
  EXPECT_EQ(ask(resumed, 1.0), near);
  EXPECT_EQ(second.evaluated(), 0);
  EXPECT_EQ(ask(resumed, 99.0), (far.array() - 1.0).matrix());  // of a region that was not asked about
  EXPECT_EQ(second.evaluated(), 3);
}

}  // namespace
}  // namespace mottle::model
