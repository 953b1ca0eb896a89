// Digest of everything that the bits of a trained reduced model depend on.
#include <dlfcn.h>
#include <suitesparse/cholmod.h>

#include <filesystem>
#include <string>

#include "build_identity.hpp"
#include "mottle/core/error.hpp"
#include "mottle/linalg/batched/batch_eigen.hpp"
#include "mottle/linalg/blas_kernels.hpp"
#include "mottle/linalg/reduced/reduced_model_file.hpp"

extern "C" void dgemm_();  // NOLINT(readability-identifier-naming): Fortran's name; only its address is asked for

namespace mottle::linalg {
namespace {

/// The library that holds a function: path, size and time, which change when it is replaced.
std::string library_of(const void* function) {
  Dl_info info = {};
  if (function == nullptr || dladdr(function, &info) == 0 || info.dli_fname == nullptr) return "none";
  std::error_code error;
  const std::filesystem::path path = std::filesystem::canonical(info.dli_fname, error);
  if (error) return info.dli_fname;
  const auto size = std::filesystem::file_size(path, error);
  const auto time = std::filesystem::last_write_time(path, error).time_since_epoch().count();
  return fmt::format("{} {} {}", path.string(), size, time);
}

std::string numerics_identity() {
  std::string text = fmt::format("{}\n{}\n{}\n{}\n{}", k_build_identity, __VERSION__,
                                 library_of(reinterpret_cast<const void*>(&dgemm_)), blas_kernels(),
                                 library_of(reinterpret_cast<const void*>(&cholmod_factorize)));
  text += library_of(dlsym(RTLD_DEFAULT, "METIS_NodeND"));
  for (const SimdLevel complete_to : {SimdLevel::avx2, SimdLevel::avx512})
    text += is_simd_level_available(complete_to) ? '1' : '0';
  return text;
}

class Hasher {
 public:
  void add(const Eigen::MatrixXd& matrix) {
    add_count(matrix.rows());
    add_count(matrix.cols());
    add_array(matrix.data(), matrix.size());
  }
  void add(const SparseMatrix& matrix) {
    if (!matrix.isCompressed()) {
      SparseMatrix lean = matrix;
      lean.makeCompressed();
      return add(lean);
    }
    add_count(matrix.rows());
    add_count(matrix.cols());
    add_count(matrix.nonZeros());
    add_array(matrix.outerIndexPtr(), matrix.outerSize() + 1);
    add_array(matrix.innerIndexPtr(), matrix.nonZeros());
    add_array(matrix.valuePtr(), matrix.nonZeros());
  }
  void add(const std::vector<SparseMatrix>& matrices) {
    add_count(static_cast<Eigen::Index>(matrices.size()));
    for (const SparseMatrix& matrix : matrices) add(matrix);
  }
  void add(const PencilTerms& terms) {
    const auto& [stiffness_constant, stiffness, mass_constant, mass, stiffness_known, mass_known] = terms;
    add(stiffness_constant);
    add(stiffness);
    add(mass_constant);
    add(mass);
    for (const std::vector<bool>* known : {&stiffness_known, &mass_known}) {
      add_count(static_cast<Eigen::Index>(known->size()));
      for (const bool is_known : *known) add_count(is_known ? 1 : 0);
    }
  }
  void add(const TermCoefficients& coefficients) {
    add(coefficients.stiffness);
    add(coefficients.mass);
  }
  void add(const ReducedModelOptions& options) {
    const auto& [modes, guards, tolerance, max_vectors] =
        options;  // a new option does not compile here until it is added
    add_array(&modes, 1);
    add_array(&guards, 1);
    add_array(&tolerance, 1);
    add_array(&max_vectors, 1);
  }
  void add(const std::string& text) {
    add_count(static_cast<Eigen::Index>(text.size()));
    checksum_.add(text);
  }
  Digest digest() const { return checksum_.digest(); }

 private:
  void add_count(std::int64_t count) { checksum_.add(&count, sizeof(count)); }
  template <typename Number>
  void add_array(const Number* numbers, Eigen::Index count) {
    checksum_.add(numbers, static_cast<std::size_t>(count) * sizeof(Number));
  }

  Checksum checksum_;
};

}  // namespace

Digest fingerprint(const ReducedModelInputs& inputs) {
  Hasher hasher;
  hasher.add(numerics_identity());
  hasher.add(inputs.terms);
  hasher.add(inputs.nominal);
  hasher.add(inputs.stiffness);
  hasher.add(inputs.mass);
  hasher.add(inputs.options);
  hasher.add(inputs.training);
  return hasher.digest();
}

}  // namespace mottle::linalg
