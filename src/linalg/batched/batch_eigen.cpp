// Checks and packs a family, sends chunks of samples to the SIMD kernels and the remaining samples to solve_modes.
#include "mottle/linalg/batched/batch_eigen.hpp"

#include <Eigen/Core>
#include <algorithm>
#include <atomic>
#include <cmath>
#include <limits>
#include <memory>
#include <new>

#include "linalg/batched/simd_kernels.hpp"
#include "mottle/core/error.hpp"
#include "mottle/core/parallel.hpp"
#include "mottle/linalg/batched/dense_modes.hpp"
#include "mottle/linalg/dense/decompositions.hpp"
#include "mottle/linalg/dense/products.hpp"

namespace mottle::linalg {
namespace {

using simd_kernels::Kernels;
using simd_kernels::MassKind;
using Coefficients = Eigen::Ref<const Eigen::MatrixXd>;

std::atomic<SimdLevel>& widest_allowed() {
  static std::atomic<SimdLevel> level{SimdLevel::avx512};
  return level;
}

SimdLevel widest_level() {
  if (is_simd_level_available(SimdLevel::avx512)) return SimdLevel::avx512;
  if (is_simd_level_available(SimdLevel::avx2)) return SimdLevel::avx2;
  return SimdLevel::plain;
}

void require_square(const Eigen::MatrixXd& matrix, Eigen::Index order, const char* name, std::size_t term) {
  require(matrix.rows() == order && matrix.cols() == order, "{}[{}]: {} x {}, need {} x {}", name, term, matrix.rows(),
          matrix.cols(), order, order);
}

void check_family(const PencilFamily& family) {
  const Eigen::Index order = family.stiffness_constant.rows();
  require(order >= 1, "stiffness_constant: empty, need at least one degree of freedom");
  require_square(family.stiffness_constant, order, "stiffness_constant", 0);
  require_square(family.mass_constant, order, "mass_constant", 0);
  for (std::size_t i = 0; i < family.stiffness_terms.size(); ++i) {
    require_square(family.stiffness_terms[i], order, "stiffness_terms", i);
  }
  for (std::size_t i = 0; i < family.mass_terms.size(); ++i) {
    require_square(family.mass_terms[i], order, "mass_terms", i);
  }
}

void check_coefficients(const PencilFamily& family, const Coefficients& stiffness, const Coefficients& mass) {
  const auto stiffness_terms = static_cast<Eigen::Index>(family.stiffness_terms.size());
  const auto mass_terms = static_cast<Eigen::Index>(family.mass_terms.size());
  require(stiffness.rows() == stiffness_terms, "stiffness_coefficients: {} rows, need one for each of {} terms",
          stiffness.rows(), stiffness_terms);
  require(mass_terms == 0 || mass.rows() == mass_terms, "mass_coefficients: {} rows, need one for each of {} terms",
          mass.rows(), mass_terms);
  require(mass_terms == 0 || mass.cols() == stiffness.cols(),
          "mass_coefficients: {} samples, but stiffness_coefficients has {}", mass.cols(), stiffness.cols());
}

bool is_lower_triangle_diagonal(const Eigen::MatrixXd& matrix) {
  for (Eigen::Index j = 0; j < matrix.cols(); ++j) {
    if ((matrix.col(j).tail(matrix.rows() - j - 1).array() != 0.0).any()) return false;
  }
  return true;
}

void append_packed(const Eigen::MatrixXd& matrix, std::vector<double>& packed) {
  for (Eigen::Index j = 0; j < matrix.cols(); ++j) {
    for (Eigen::Index i = j; i < matrix.rows(); ++i) packed.push_back(matrix(i, j));
  }
}

void append_diagonal(const Eigen::MatrixXd& matrix, std::vector<double>& packed) {
  for (Eigen::Index i = 0; i < matrix.rows(); ++i) packed.push_back(matrix(i, i));
}

/// K / sqrt(m_i m_j): for equal masses an exact division, unlike two multiplications by rounded 1 / sqrt(m).
Eigen::MatrixXd reduce_by_diagonal(const Eigen::MatrixXd& stiffness, const Eigen::VectorXd& masses) {
  Eigen::MatrixXd reduced = stiffness;
  for (Eigen::Index j = 0; j < reduced.cols(); ++j) {
    for (Eigen::Index i = 0; i < reduced.rows(); ++i) reduced(i, j) /= std::sqrt(masses(i) * masses(j));
  }
  return reduced;
}

Eigen::MatrixXd reduce_by_factor(const Eigen::MatrixXd& stiffness, const CholeskyFactor& factor) {
  Eigen::MatrixXd reduced = stiffness.selfadjointView<Eigen::Lower>();
  factor.solve_lower_in_place(reduced);
  reduced.transposeInPlace();
  factor.solve_lower_in_place(reduced);
  return reduced;
}

/// A family in the kernels' layout.
struct PackedFamily {
  MassKind mass_kind = MassKind::full;
  bool mass_is_definite = true;  ///< false: a constant mass that no sample can be solved with
  std::vector<double> stiffness;
  std::vector<double> mass;
  Eigen::MatrixXd back_transform;
};

void fold_constant_mass(const PencilFamily& family, PackedFamily& packed) {
  const Eigen::Index order = family.mass_constant.rows();
  const bool diagonal = is_lower_triangle_diagonal(family.mass_constant);
  const Eigen::VectorXd masses = family.mass_constant.diagonal();
  const CholeskyFactor factor(family.mass_constant);
  packed.mass_is_definite = masses.allFinite() && factor.is_positive_definite();
  if (!packed.mass_is_definite) return;
  packed.mass_kind = diagonal ? MassKind::folded_diagonal : MassKind::folded;
  packed.back_transform = Eigen::MatrixXd::Identity(order, order);
  factor.solve_upper_in_place(packed.back_transform);
  // Where many large terms are to be reduced, products by the BLAS library cost a fifth of triangular solutions.
  constexpr Eigen::Index k_large = 64;
  const auto reduce = [&](const Eigen::MatrixXd& stiffness) -> Eigen::MatrixXd {
    if (diagonal) return reduce_by_diagonal(stiffness, masses);
    if (order <= k_large) return reduce_by_factor(stiffness, factor);
    const Eigen::MatrixXd full = stiffness.selfadjointView<Eigen::Lower>();
    return transposed_product(packed.back_transform, product(full, packed.back_transform));
  };
  append_packed(reduce(family.stiffness_constant), packed.stiffness);
  for (const Eigen::MatrixXd& term : family.stiffness_terms) append_packed(reduce(term), packed.stiffness);
  if (diagonal) packed.back_transform = masses.cwiseSqrt().cwiseInverse().asDiagonal();
}

void pack_parametric_mass(const PencilFamily& family, PackedFamily& packed) {
  bool diagonal =
      family.mass_constant.rows() > simd_kernels::k_jacobi_limit && is_lower_triangle_diagonal(family.mass_constant);
  for (const Eigen::MatrixXd& term : family.mass_terms) diagonal = diagonal && is_lower_triangle_diagonal(term);
  packed.mass_kind = diagonal ? MassKind::diagonal : MassKind::full;
  const auto append_mass = diagonal ? append_diagonal : append_packed;
  append_mass(family.mass_constant, packed.mass);
  for (const Eigen::MatrixXd& term : family.mass_terms) append_mass(term, packed.mass);
  append_packed(family.stiffness_constant, packed.stiffness);
  for (const Eigen::MatrixXd& term : family.stiffness_terms) append_packed(term, packed.stiffness);
}

PackedFamily pack(const PencilFamily& family) {
  PackedFamily packed;
  if (family.mass_terms.empty()) {
    fold_constant_mass(family, packed);
  } else {
    pack_parametric_mass(family, packed);
  }
  return packed;
}

Eigen::MatrixXd combine(const Eigen::MatrixXd& constant, const std::vector<Eigen::MatrixXd>& terms,
                        const Coefficients& coefficients, Eigen::Index sample) {
  Eigen::MatrixXd sum = constant;
  for (std::size_t i = 0; i < terms.size(); ++i) sum += coefficients(static_cast<Eigen::Index>(i), sample) * terms[i];
  return sum;
}

/// One sample by the dense solver: orders above the kernels' limit, and samples whose modes they cannot guarantee.
void solve_alone(const PencilFamily& family, const Coefficients& stiffness_coefficients,
                 const Coefficients& mass_coefficients, Eigen::Index sample, BatchModes& result) {
  const DenseModes modes =
      solve_modes(combine(family.stiffness_constant, family.stiffness_terms, stiffness_coefficients, sample),
                  combine(family.mass_constant, family.mass_terms, mass_coefficients, sample),
                  static_cast<int>(result.values.rows()));
  result.values.col(sample) = modes.values;
  if (result.vectors.size() > 0) result.vectors.col(sample) = modes.vectors.reshaped();
  result.failed[static_cast<std::size_t>(sample)] = modes.failed ? 1 : 0;
}

simd_kernels::Problem describe(const PencilFamily& family, const PackedFamily& packed, const Coefficients& stiffness,
                               const Coefficients& mass, const BatchModes& result) {
  return {.order = static_cast<int>(family.stiffness_constant.rows()),
          .modes = static_cast<int>(result.values.rows()),
          .vectors = result.vectors.size() > 0,
          .mass_kind = packed.mass_kind,
          .stiffness_terms = static_cast<int>(family.stiffness_terms.size()),
          .mass_terms = static_cast<int>(family.mass_terms.size()),
          .stiffness = packed.stiffness.data(),
          .mass = packed.mass.data(),
          .back_transform = packed.back_transform.data(),
          .stiffness_coefficients = stiffness.data(),
          .mass_coefficients = mass.data(),
          .stiffness_stride = static_cast<long>(stiffness.outerStride()),
          .mass_stride = static_cast<long>(mass.outerStride())};
}

void mark_all_failed(BatchModes& result) {
  result.values.setConstant(std::numeric_limits<double>::quiet_NaN());
  result.vectors.setConstant(std::numeric_limits<double>::quiet_NaN());
  std::fill(result.failed.begin(), result.failed.end(), std::uint8_t{1});
}

}  // namespace

const Kernels& simd_kernels::kernels_for(SimdLevel level) {
  require(is_simd_level_available(level), "simd: this processor lacks the instructions of the level asked for; {}",
          "use SimdLevel::automatic");
  switch (level == SimdLevel::automatic ? widest_level() : level) {
#if defined(__x86_64__)
    case SimdLevel::avx512:
      return simd_kernels::k_avx512;
    case SimdLevel::avx2:
      return simd_kernels::k_avx2;
#endif
    default:
      return simd_kernels::k_plain;
  }
}

double* simd_kernels::thread_workspace(long doubles) {
  struct FreeAligned {
    void operator()(double* memory) const { ::operator delete[](memory, std::align_val_t{64}); }
  };
  thread_local std::unique_ptr<double[], FreeAligned> memory;
  thread_local long size = 0;
  if (doubles > size) {
    memory.reset();
    size = 0;
    memory.reset(static_cast<double*>(
        ::operator new[](static_cast<std::size_t>(doubles) * sizeof(double), std::align_val_t{64})));
    size = doubles;
  }
  return memory.get();
}

void limit_simd_level(SimdLevel widest) {
  widest_allowed() = widest;
}

bool is_simd_level_available(SimdLevel level) {
  if (level > widest_allowed()) return false;
  switch (level) {
    case SimdLevel::automatic:
    case SimdLevel::plain:
      return true;
#if defined(__x86_64__)
    case SimdLevel::avx2:
      return __builtin_cpu_supports("avx2") && __builtin_cpu_supports("fma");
    case SimdLevel::avx512:
      return __builtin_cpu_supports("avx512f") && __builtin_cpu_supports("avx512dq") &&
             __builtin_cpu_supports("avx512vl") && __builtin_cpu_supports("avx2") && __builtin_cpu_supports("fma");
#endif
    default:
      return false;
  }
}

BatchModes solve_batch(const PencilFamily& family, const Coefficients& stiffness_coefficients,
                       const Coefficients& mass_coefficients, const BatchEigenOptions& options) {
  check_family(family);
  check_coefficients(family, stiffness_coefficients, mass_coefficients);
  const Eigen::Index order = family.stiffness_constant.rows(), samples = stiffness_coefficients.cols();
  require(0 <= options.modes && options.modes <= order, "modes: {}, need 0 (all) to {}", options.modes, order);
  require(options.threads >= 1, "threads: {}, need at least 1", options.threads);
  const Kernels& kernels = simd_kernels::kernels_for(options.simd);
  const Eigen::Index modes = options.modes == 0 ? order : options.modes;

  BatchModes result{Eigen::MatrixXd(modes, samples), {}, std::vector<std::uint8_t>(static_cast<std::size_t>(samples))};
  if (options.vectors) result.vectors.resize(order * modes, samples);
  const PackedFamily packed = pack(family);
  if (!packed.mass_is_definite) {
    mark_all_failed(result);
    return result;
  }

  const bool is_small = order <= simd_kernels::k_jacobi_limit, in_lanes = order <= simd_kernels::k_order_limit;
  const auto problem = describe(family, packed, stiffness_coefficients, mass_coefficients, result);
  std::vector<unsigned char> valid(static_cast<std::size_t>(samples), 0);
  const simd_kernels::Output output{result.values.data(), result.vectors.data(), valid.data()};
  // Multiples of the widest register; small enough that threads finish together.
  const std::int64_t grain = is_small ? 512 : in_lanes ? 32 : 1;
  parallel_for(samples, grain, options.threads, [&](std::int64_t begin, std::int64_t end) {
    if (is_small) {
      kernels.solve_small(problem, output, begin, end);
    } else if (in_lanes) {
      kernels.solve_large(problem, output, begin, end,
                          simd_kernels::thread_workspace(kernels.workspace_doubles(problem)));
    }
    for (std::int64_t sample = begin; sample < end; ++sample) {
      if (valid[static_cast<std::size_t>(sample)] == 0) {
        solve_alone(family, stiffness_coefficients, mass_coefficients, sample, result);
      }
    }
  });
  return result;
}

}  // namespace mottle::linalg
