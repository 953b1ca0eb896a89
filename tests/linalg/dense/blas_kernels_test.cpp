#include "mottle/linalg/blas_kernels.hpp"

#include <dlfcn.h>
#include <fmt/format.h>
#include <gtest/gtest.h>

#include <Eigen/Core>
#include <array>
#include <cstdio>
#include <cstdlib>
#include <filesystem>
#include <memory>
#include <string>
#include <vector>

#include "mottle/core/checksum.hpp"
#include "mottle/linalg/sparse/symmetric_factor.hpp"

namespace mottle::linalg {
namespace {

using Eigen::MatrixXd;

/// Of BLAS or LAPACK, by its name in Fortran; which library has it is the system's business.
template <typename Function>
Function* fortran(const char* name) {
  auto* const function = reinterpret_cast<Function*>(::dlsym(RTLD_DEFAULT, name));
  EXPECT_NE(function, nullptr) << name;
  return function;
}

using Dgemm = void(const char*, const char*, const int*, const int*, const int*, const double*, const double*,
                   const int*, const double*, const int*, const double*, double*, const int*);
using Dsyrk = void(const char*, const char*, const int*, const int*, const double*, const double*, const int*,
                   const double*, double*, const int*);
using Dpotrf = void(const char*, const int*, double*, const int*, int*);
using Dsyevd = void(const char*, const char*, const int*, double*, const int*, double*, double*, const int*, int*,
                    const int*, int*);

/// Digest of products, factors and eigenvectors of one size.
void add_dense(Checksum& checksum, int size) {
  constexpr double k_one = 1.0, k_half = 0.5;
  const auto add = [&](const MatrixXd& matrix) {
    checksum.add(matrix.data(), static_cast<std::size_t>(matrix.size()) * sizeof(double));
  };
  std::srand(static_cast<unsigned>(size));
  const MatrixXd a = MatrixXd::Random(size, size);
  const MatrixXd b = MatrixXd::Random(size, size);
  for (const char* transposes : {"NN", "TN", "NT"}) {
    MatrixXd c = MatrixXd::Ones(size, size);
    fortran<Dgemm>("dgemm_")(transposes, transposes + 1, &size, &size, &size, &k_one, a.data(), &size, b.data(), &size,
                             &k_half, c.data(), &size);
    add(c);
  }
  MatrixXd square = MatrixXd::Identity(size, size);
  fortran<Dsyrk>("dsyrk_")("L", "N", &size, &size, &k_one, a.data(), &size, &k_one, square.data(), &size);
  add(square);
  int info = 0;
  MatrixXd factor = square;
  fortran<Dpotrf>("dpotrf_")("L", &size, factor.data(), &size, &info);
  EXPECT_EQ(info, 0);
  add(factor);
  MatrixXd values(size, 1), work(1 + 6 * size + 2 * size * size, 1);
  Eigen::VectorXi numbers(3 + 5 * size);
  const int work_size = static_cast<int>(work.size()), numbers_size = static_cast<int>(numbers.size());
  fortran<Dsyevd>("dsyevd_")("V", "L", &size, square.data(), &size, values.data(), work.data(), &work_size,
                             numbers.data(), &numbers_size, &info);
  EXPECT_EQ(info, 0);
  add(values);
  add(square);
}

/// Digest of a solution by the sparse packages, whose fronts call BLAS.
void add_sparse(Checksum& checksum) {
  constexpr int k_side = 14;
  constexpr int k_size = k_side * k_side * k_side;
  std::vector<Eigen::Triplet<double>> entries;
  for (int i = 0; i < k_size; ++i) {
    entries.emplace_back(i, i, 6.5);
    if (i % k_side > 0) entries.emplace_back(i, i - 1, -1.0);
    if (i / k_side % k_side > 0) entries.emplace_back(i, i - k_side, -1.0);
    if (i >= k_side * k_side) entries.emplace_back(i, i - k_side * k_side, -1.0);
  }
  SparseMatrix matrix(k_size, k_size);
  matrix.setFromTriplets(entries.begin(), entries.end());
  std::srand(5);
  const MatrixXd loads = MatrixXd::Random(k_size, 7);
  for (const bool is_definite : {true, false}) {
    const auto factor = is_definite ? make_definite_factor() : make_indefinite_factor();
    factor->factorise(matrix);
    MatrixXd solution = loads;
    factor->solve(solution);
    checksum.add(solution.data(), static_cast<std::size_t>(solution.size()) * sizeof(double));
  }
}

/// Of small and large matrices, by one thread and by several, which stay.
std::string digest_of_results() {
  Checksum checksum;
  auto* const set_threads = reinterpret_cast<void (*)(int)>(::dlsym(RTLD_DEFAULT, "openblas_set_num_threads"));
  for (const int threads : {1, 3}) {
    if (set_threads != nullptr) set_threads(threads);
    for (const int size : {1, 2, 7, 16, 33, 100, 257, 600}) add_dense(checksum, size);
    add_sparse(checksum);
  }
  return hexadecimal(checksum.digest());
}

TEST(BlasKernels, ChosenInTheProcessComputeTheBitsOfThoseNamedAtTheStart) {
  constexpr const char* k_asked = "MOTTLE_TEST_PRINTS_RESULTS";
  if (std::getenv(k_asked) != nullptr) {  // in the process that is started below
    std::printf("kernels %s results %s\n", blas_kernels().c_str(), digest_of_results().c_str());
    return;
  }
  const std::string before = blas_kernels();
  if (before.empty()) GTEST_SKIP() << "BLAS is not OpenBLAS";
  static_cast<void>(digest_of_results());  // buffers and threads of the kernels before are there
  choose_blas_kernels();
  const std::string after = blas_kernels();
  if (after == before) GTEST_SKIP() << "OpenBLAS has found the kernels itself: " << before;

  // Anything in the environment would have named them already.
  EXPECT_EQ(std::getenv("OPENBLAS_CORETYPE"), nullptr);
  const std::string expected = "kernels " + after + " results " + digest_of_results();
  const std::string command = fmt::format(
      "unset GTEST_TOTAL_SHARDS GTEST_SHARD_INDEX; OPENBLAS_CORETYPE={} {}=1 '{}' --gtest_filter=BlasKernels.Chosen*",
      after, k_asked, std::filesystem::read_symlink("/proc/self/exe").string());
  const std::unique_ptr<FILE, int (*)(FILE*)> pipe(::popen(command.c_str(), "r"), ::pclose);
  ASSERT_NE(pipe, nullptr);
  std::string output;
  std::array<char, 4096> part{};
  for (std::size_t size = 0; (size = std::fread(part.data(), 1, part.size(), pipe.get())) > 0;) {
    output.append(part.data(), size);
  }
  EXPECT_NE(output.find(expected), std::string::npos) << output << "in place of " << expected;
}

TEST(BlasKernels, AreNotOutdatedOnceTheyAreChosen) {
  choose_blas_kernels();
  EXPECT_FALSE(are_blas_kernels_outdated());
}

TEST(BlasKernels, NamedByTheUserStay) {
  const std::string before = blas_kernels();
  ::setenv("OPENBLAS_CORETYPE", "PRESCOTT", 1);
  choose_blas_kernels();
  EXPECT_EQ(blas_kernels(), before);
  EXPECT_STREQ(std::getenv("OPENBLAS_CORETYPE"), "PRESCOTT");
  ::unsetenv("OPENBLAS_CORETYPE");
}

}  // namespace
}  // namespace mottle::linalg
