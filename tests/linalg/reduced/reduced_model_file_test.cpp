#include "mottle/linalg/reduced/reduced_model_file.hpp"

#include <gtest/gtest.h>
#include <sys/stat.h>
#include <sys/wait.h>
#include <unistd.h>

#include <cstring>
#include <limits>

#include "core/message_of.hpp"
#include "core/temporary_folder.hpp"
#include "linalg/chain.hpp"
#include "mottle/core/error.hpp"
#include "mottle/core/files.hpp"

namespace mottle::linalg {
namespace {

using Eigen::Index;
using Eigen::MatrixXd;
using test::Chain;
using test::message_of;
using test::TemporaryFolder;

constexpr const char* k_taken = "nothing thrown";

bool have_same_bits(const MatrixXd& a, const MatrixXd& b) {
  const auto bytes = static_cast<std::size_t>(a.size()) * sizeof(double);
  return a.rows() == b.rows() && a.cols() == b.cols() && (bytes == 0 || std::memcmp(a.data(), b.data(), bytes) == 0);
}

void expect_same_answers(const ReducedModel& a, const ReducedModel& b) {
  EXPECT_TRUE(have_same_bits(a.basis(), b.basis()));
  const TermCoefficients samples = Chain::samples(50, 0.3, 2);
  const CertifiedModes first = a.solve(samples, 1);
  const CertifiedModes second = b.solve(samples, 1);
  EXPECT_TRUE(have_same_bits(first.values, second.values));
  EXPECT_TRUE(have_same_bits(first.vectors, second.vectors));
  EXPECT_TRUE(have_same_bits(first.bounds, second.bounds));
  EXPECT_TRUE(have_same_bits(a.leading_directions(), b.leading_directions()));
  if (a.leading_directions().size() == 0) return;
  const CertifiedModes leading = a.solve_leading(samples, 1), other = b.solve_leading(samples, 1);
  EXPECT_TRUE(have_same_bits(leading.vectors, other.vectors));
  EXPECT_TRUE(have_same_bits(leading.bounds, other.bounds));
}

/// A file of a trained chain, and what becomes of reading it.
class ReducedModelFileTest : public ::testing::Test {
 protected:
  void SetUp() override { file.write(*model, 1.5); }
  std::string refusal() const {
    return message_of<InvalidInput>([&] { file.read(chain.inputs()); });
  }

  const TemporaryFolder folder;
  const Chain chain;
  const std::unique_ptr<ReducedModel> model = chain.trained();
  const std::filesystem::path path = folder / "a.basis";
  const ReducedModelFile file{path, fingerprint(chain.inputs())};
};

TEST_F(ReducedModelFileTest, GivesBackAModelThatAnswersWithTheSameBits) {
  const ReducedModelFile::Contents contents = file.read(chain.inputs());
  expect_same_answers(*contents.model, *model);
  EXPECT_EQ(contents.training_seconds, 1.5);
  EXPECT_EQ(contents.model->exact_seconds(), model->exact_seconds());
}

TEST_F(ReducedModelFileTest, GivesBackAModelThatLearnsOnWithTheSameBits) {
  const TermCoefficients far = Chain::samples(60, 0.8, 3);
  ReducedModel read = *file.read(chain.inputs()).model;
  const Index before = read.basis().cols();
  read.train(far, 1);
  model->train(far, 1);
  EXPECT_NE(read.basis().cols(), before);
  expect_same_answers(read, *model);
}

TEST_F(ReducedModelFileTest, GivesBackAModelWithoutLeadingDirections) {
  ASSERT_GT(model->leading_directions().size(), 0);
  const ReducedModelInputs inputs = chain.inputs();
  const ReducedModel untrained(inputs.terms, inputs.nominal, inputs.stiffness, inputs.mass, inputs.options);
  ASSERT_EQ(untrained.leading_directions().size(), 0);
  file.write(untrained, 0.5);
  expect_same_answers(*file.read(inputs).model, untrained);
}

TEST_F(ReducedModelFileTest, CopiesOfAModelFromAFileLearnBothAlike) {  // the second finds the factor of the first
  const ReducedModelFile::Contents contents = file.read(chain.inputs());
  const TermCoefficients far = Chain::samples(60, 0.8, 4);
  ReducedModel first = *contents.model;
  first.train(far, 1);
  ReducedModel second = *contents.model;
  second.train(far, 1);
  expect_same_answers(first, second);
}

TEST_F(ReducedModelFileTest, EveryByteCounts) {
  const std::string whole = read_file(path);
  const std::size_t step = whole.size() / 100 + 1;  // the head byte by byte, the rest here and there
  for (std::size_t i = 0; i < whole.size(); i += i < 96 ? 1 : step) {
    std::string garbled = whole;
    garbled[i] = static_cast<char>(garbled[i] ^ 0x41);
    write_file_atomically(path, garbled);
    EXPECT_NE(refusal(), k_taken) << "byte " << i;
  }
}

TEST_F(ReducedModelFileTest, NoPartOfAFileIsTaken) {
  const std::string whole = read_file(path);
  const std::size_t step = whole.size() / 100 + 1;
  for (std::size_t size = 0; size < whole.size(); size += size < 96 ? 1 : step) {
    write_file_atomically(path, whole.substr(0, size));
    EXPECT_NE(refusal(), k_taken) << size << " bytes";
  }
  write_file_atomically(path, whole + " ");
  EXPECT_NE(refusal(), k_taken);
}

/// The file with the checksum that its bytes have: a fault of ours or ill will, not of the disk.
std::string with_matching_checksum(std::string bytes) {
  constexpr std::size_t k_head = 64, k_checksum_at = 48;
  Checksum checksum;
  checksum.add(std::string_view(bytes).substr(k_head));
  const Digest digest = checksum.digest();
  std::memcpy(bytes.data() + k_checksum_at, digest.data(), sizeof(digest));
  return bytes;
}

TEST_F(ReducedModelFileTest, SizesThatDoNotFitAreRefusedWithoutRoomForThem) {
  const std::string whole = read_file(path);
  for (const std::int64_t size : {std::int64_t{-1}, std::int64_t{1} << 40, std::numeric_limits<std::int64_t>::max()}) {
    for (std::size_t i = 64; i + 8 <= whole.size() && i < 400; i += 3) {
      std::string garbled = whole;
      std::memcpy(garbled.data() + i, &size, sizeof(size));
      write_file_atomically(path, with_matching_checksum(garbled));
      refusal();  // a number may be anything; what matters is that no size crashes or exhausts the memory
    }
  }
  write_file_atomically(path, with_matching_checksum(whole));
  EXPECT_EQ(refusal(), k_taken);
}

TEST_F(ReducedModelFileTest, BelongsToOneFingerprint) {
  Digest other = fingerprint(chain.inputs());
  other[1] ^= 1;
  EXPECT_EQ(message_of<InvalidInput>([&] { ReducedModelFile(path, other).read(chain.inputs()); }),
            "it belongs to another model, prior or version");
}

TEST_F(ReducedModelFileTest, APlaceThatCannotBeWrittenIsAnError) {
  const ReducedModelFile nowhere(folder / "missing" / "a.basis", fingerprint(chain.inputs()));
  EXPECT_THROW(nowhere.write(*model, 1.0), InvalidInput);
}

TEST_F(ReducedModelFileTest, APipeInItsPlaceIsNotWaitedFor) {
  std::filesystem::remove(path);
  ASSERT_EQ(::mkfifo(path.c_str(), 0600), 0);
  EXPECT_EQ(refusal(), "it is no file");
}

TEST_F(ReducedModelFileTest, IsWholeWhileOthersWriteIt) {
  constexpr int k_writers = 3, k_times = 30;
  std::vector<pid_t> writers;
  for (int i = 0; i < k_writers; ++i) {
    const pid_t child = ::fork();
    if (child == 0) {
      for (int k = 0; k < k_times; ++k) file.write(*model, 1.5);
      ::_exit(0);
    }
    writers.push_back(child);
  }
  for (int k = 0; k < k_times; ++k) EXPECT_EQ(refusal(), k_taken);
  for (const pid_t writer : writers) {
    int status = -1;
    ::waitpid(writer, &status, 0);
    EXPECT_EQ(status, 0);
  }
  expect_same_answers(*file.read(chain.inputs()).model, *model);
  const auto entries = std::filesystem::directory_iterator(folder.path());
  EXPECT_EQ(std::distance(begin(entries), end(entries)), 1);  // nobody left anything else behind
}

TEST(ReducedModelFingerprint, IsTheSameForTheSameInputs) {
  EXPECT_EQ(fingerprint(Chain().inputs()), fingerprint(Chain().inputs()));
}

TEST(ReducedModelFingerprint, SeesEveryInput) {
  const Digest before = fingerprint(Chain().inputs());
  const auto changed = [&](const auto& change) {
    Chain chain;
    change(chain);
    return fingerprint(chain.inputs()) != before;
  };
  const double tiny = 1e-15;
  EXPECT_TRUE(changed([&](Chain& chain) { chain.terms.stiffness_constant.coeffRef(0, 0) += tiny; }));
  EXPECT_TRUE(changed([&](Chain& chain) { chain.terms.stiffness[1].coeffRef(50, 50) += tiny; }));
  EXPECT_TRUE(changed([&](Chain& chain) { chain.terms.mass_constant.coeffRef(9, 9) += tiny; }));
  EXPECT_TRUE(changed([](Chain& chain) { chain = Chain(1.1); }));
  EXPECT_TRUE(changed([](Chain& chain) { chain.terms.stiffness[1].coeffRef(50, 20) = 0.0; }));  // the pattern alone
  EXPECT_TRUE(changed([](Chain& chain) { std::swap(chain.terms.stiffness[0], chain.terms.stiffness[1]); }));
  EXPECT_TRUE(changed([&](Chain& chain) { chain.stiffness.coeffRef(7, 7) += tiny; }));
  EXPECT_TRUE(changed([&](Chain& chain) { chain.mass.coeffRef(7, 7) += tiny; }));
  EXPECT_TRUE(changed([&](Chain& chain) { chain.nominal.stiffness(2, 0) += tiny; }));
  EXPECT_TRUE(changed([&](Chain& chain) { chain.nominal.mass(0, 0) += tiny; }));
  EXPECT_TRUE(changed([&](Chain& chain) { chain.training.stiffness(1, 40) += tiny; }));
  EXPECT_TRUE(changed([](Chain& chain) { chain.training = chain.training.range(0, 79); }));
  EXPECT_TRUE(changed([](Chain& chain) { chain.terms.is_stiffness_semidefinite = {false, true}; }));
  EXPECT_TRUE(changed([](Chain& chain) { chain.terms.is_mass_semidefinite = {true}; }));
  EXPECT_TRUE(changed([](Chain& chain) { chain.options.modes = 5; }));
  EXPECT_TRUE(changed([](Chain& chain) { chain.options.guards = 1; }));
  EXPECT_TRUE(changed([](Chain& chain) { chain.options.tolerance = 2e-6; }));
  EXPECT_TRUE(changed([](Chain& chain) { chain.options.max_vectors = 399; }));
}

TEST(ReducedModelFingerprint, DoesNotSeeRoomBetweenEntries) {
  Chain chain;
  const Digest before = fingerprint(chain.inputs());
  chain.stiffness.uncompress();
  EXPECT_EQ(fingerprint(chain.inputs()), before);
}

}  // namespace
}  // namespace mottle::linalg
