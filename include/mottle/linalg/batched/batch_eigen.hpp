// Lowest modes of many dense pencils of one affine family, several samples per SIMD register. Knows nothing of
// structures or frequencies; for a single pencil see dense_modes.hpp.
#pragma once

#include <Eigen/Core>
#include <cstdint>
#include <vector>

namespace mottle::linalg {

/// Which instructions the kernels use.
enum class SimdLevel {
  automatic,  ///< the widest that this processor has
  plain,      ///< 2 doubles a register, the processor family's common ground
  avx2,       ///< 4 doubles a register, with FMA
  avx512,     ///< 8 doubles a register
};

/// Symmetric dense pencils that depend affinely on coefficients:
///
///   K(s) = K_0 + sum_i a_i(s) K_i,   M(s) = M_0 + sum_j b_j(s) M_j
///
/// All matrices are [dof x dof]; the lower triangles are read.
struct PencilFamily {
  Eigen::MatrixXd stiffness_constant;
  std::vector<Eigen::MatrixXd> stiffness_terms;
  Eigen::MatrixXd mass_constant;
  std::vector<Eigen::MatrixXd> mass_terms;
};

/// How much to compute, and with what.
struct BatchEigenOptions {
  int modes = 0;                          ///< lowest modes wanted, 0..dof; 0 means all
  bool vectors = true;                    ///< values alone are cheaper
  int threads = 1;                        ///< changes no bit of the result
  SimdLevel simd = SimdLevel::automatic;  ///< forced by tests; levels agree to rounding, not to the bit
};

/// Lowest modes of a batch of pencils.
struct BatchModes {
  Eigen::MatrixXd values;  ///< [mode x sample], ascending; nan for a failed sample
  /// [dof * mode x sample]: a column is that sample's [dof x mode] block, column by column; phi' M phi = 1, the
  /// component of largest magnitude positive (ties: first); nan for a failed sample; 0 x 0 when not asked for.
  Eigen::MatrixXd vectors;
  std::vector<std::uint8_t> failed;  ///< [sample], 1: mass not positive definite, or an entry not finite

  /// Modes of one sample, [dof x mode].
  Eigen::Map<const Eigen::MatrixXd> sample_vectors(Eigen::Index sample) const {
    return {vectors.col(sample).data(), vectors.rows() / values.rows(), values.rows()};
  }
};

/// Lowest modes of every sample of a family.
///
///   K(s) phi = lambda M(s) phi,   phi' M(s) phi = 1
///
/// Up to 8 degrees of freedom: cyclic Jacobi; up to 400: Householder tridiagonalisation, bisection and inverse
/// iteration; both with one sample in each SIMD lane. Larger orders, and samples whose modes the
/// SIMD kernels cannot guarantee, go one by one through solve_modes. A sample's result has the same bits whatever its
/// neighbours, its position in the batch and the number of threads, on one machine with one binary. A constant mass is
/// reduced once for the family.
///
/// @param stiffness_coefficients  [stiffness term x sample], a_i(s)
/// @param mass_coefficients       [mass term x sample], b_j(s); may be 0 x 0 if there are no mass terms
/// @return                        modes of every sample; a sample that cannot be solved is marked, not thrown
/// @throws InvalidInput           shapes that do not fit, too many modes, a SIMD level that this processor lacks
/// Source: [GolubVanLoan2013], sections 8.3 to 8.7; [Demmel1997], section 5.3.
BatchModes solve_batch(const PencilFamily& family, const Eigen::Ref<const Eigen::MatrixXd>& stiffness_coefficients,
                       const Eigen::Ref<const Eigen::MatrixXd>& mass_coefficients,
                       const BatchEigenOptions& options = {});

/// Whether this processor (and this build) can run kernels of a level, and the limit allows it.
bool is_simd_level_available(SimdLevel level);

/// From now on no kernel uses wider registers than those of this level: processes on different processors compute the
/// same numbers so. Before anything is computed.
void limit_simd_level(SimdLevel widest);

}  // namespace mottle::linalg
