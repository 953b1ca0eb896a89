// libFuzzer target for what is read by the HDF5 library: whatever the bytes behind its signature, matrices and MATLAB
// files of version 7.3 throw InvalidInput or give what the headers promise. The library is not instrumented, so the
// search steers by our own code. Seeds: tests/fuzz/hdf5, tests/formats/matrices/octave.h5.
#include <algorithm>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <cstdlib>
#include <string>
#include <string_view>

#include "mottle/core/error.hpp"
#include "mottle/formats/matrices/mat.hpp"
#include "mottle/formats/matrices/matrix_file.hpp"

namespace {

void expect(bool claim) {
  if (!claim) std::abort();
}

template <typename Action>
void attempt(const Action& action) {
  try {
    action();
  } catch (const mottle::InvalidInput& error) {
    expect(std::string_view(error.what()).size() < 8192);
  }
}

std::string matlab_head() {
  std::string head(512, ' ');
  head.replace(124, 4, std::string("\0\2IM", 4));
  return head;
}

}  // namespace

/// The library asks for what a file says, goes on where it does not get it, and leaks on files that it refuses.
extern "C" const char* __asan_default_options() {  // NOLINT(bugprone-reserved-identifier): the sanitizer's name
  return "allocator_may_return_null=1:detect_leaks=0";
}

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  constexpr std::string_view k_signature = "\x89HDF\r\n\x1a\n";
  std::string bytes(reinterpret_cast<const char*>(data), size);
  bytes.replace(0, std::min(size, k_signature.size()), k_signature);
  for (const char* name : {"", "K", "A/value"}) {
    attempt([&] {
      const mottle::linalg::SparseMatrix lower = mottle::formats::parse_symmetric_matrix(bytes, "fuzz.h5", name).lower;
      expect(lower.rows() > 0 && lower.rows() == lower.cols());
      for (Eigen::Index k = 0; k < lower.nonZeros(); ++k) expect(std::isfinite(lower.valuePtr()[k]));
    });
  }
  attempt([&] {
    for (const auto& [name, variable] : mottle::formats::parse_mat(matlab_head() + bytes, "fuzz.mat")) {
      expect(variable.numbers.empty() != variable.texts.empty());
    }
  });
  return 0;
}
